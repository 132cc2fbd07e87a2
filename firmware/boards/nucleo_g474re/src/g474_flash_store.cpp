// Pages of 2 KiB that are erased, double words that are programmed once.
#include "emax/board/g474_flash_store.hpp"

#include "emax/board/dma_memory.hpp"
#include "emax/board/flash_words.hpp"
#include "emax/board/g474.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kAccess = kFlash + 0x00;
constexpr std::uintptr_t kKey = kFlash + 0x08;
constexpr std::uintptr_t kStatus = kFlash + 0x10;
constexpr std::uintptr_t kControl = kFlash + 0x14;
constexpr std::uintptr_t kCorrection = kFlash + 0x18;
constexpr std::uintptr_t kOptions = kFlash + 0x20;

constexpr std::uint32_t kDataCache = 1U << 10;
constexpr std::uint32_t kDataCacheReset = 1U << 12;

constexpr std::uint32_t kDone = 1U << 0;
constexpr std::uint32_t kErrors = 0xC3FA;
constexpr std::uint32_t kBusy = 1U << 16;

constexpr std::uint32_t kProgram = 1U << 0;
constexpr std::uint32_t kErasePage = 1U << 1;
constexpr unsigned kPageAt = 3;
constexpr std::uint32_t kBank2 = 1U << 11;
constexpr std::uint32_t kStart = 1U << 16;
constexpr std::uint32_t kLock = 1U << 31;

constexpr std::uint32_t kNotCorrected = 1U << 31;
constexpr std::uint32_t kTwoBanks = 1U << 22;

// Four times what they take.
constexpr std::uint32_t kMostErase_us = 100'000;
constexpr std::uint32_t kMostProgram_us = 1'000;

std::uint32_t page_of(std::uint32_t slot) noexcept {
  return kFirstRecordPage + slot * kPagesPerSlot;
}

std::uintptr_t address_of(std::uint32_t slot, std::uint32_t offset) noexcept {
  return kFlashBank2 + std::uintptr_t{page_of(slot)} * kFlashPageBytes + offset;
}

bool is_idle(std::uint32_t most_us) noexcept {
  return wait_for([] { return (reg(kStatus) & kBusy) == 0; }, most_us);
}

// Ready to erase or program: idle, without a flag of before, which would be one of now, unlocked.
bool open() noexcept {
  if ((reg(kOptions) & kTwoBanks) == 0 || !is_idle(kMostErase_us)) {
    return false;
  }
  reg(kStatus) = kErrors | kDone;
  if ((reg(kControl) & kLock) != 0) {
    reg(kKey) = kFirstKey;
    reg(kKey) = kSecondKey;
  }
  // What the cache takes from one bank while the other one is written may be wrong.
  reg(kAccess) &= ~kDataCache;
  return (reg(kControl) & kLock) == 0;
}

// @returns Whether what has been begun ended well.
bool close(std::uint32_t most_us) noexcept {
  const bool is_done = is_idle(most_us) && (reg(kStatus) & kErrors) == 0;
  reg(kStatus) = kErrors | kDone;
  reg(kControl) = kLock;
  reg(kAccess) |= kDataCacheReset;
  reg(kAccess) &= ~kDataCacheReset;
  reg(kAccess) |= kDataCache;
  return is_done;
}

bool erase_page(std::uint32_t page) noexcept {
  if (!open()) {
    (void)close(0);
    return false;
  }
  const std::uint32_t what = kErasePage | page << kPageAt | kBank2;
  reg(kControl) = what;
  reg(kControl) = what | kStart;
  return close(kMostErase_us);
}

}  // namespace

bool G474FlashStore::take_read_error() noexcept {
  if ((reg(kCorrection) & kNotCorrected) == 0 || !is_reading_.load(std::memory_order_relaxed)) {
    return false;
  }
  reg(kCorrection) = kNotCorrected;
  has_read_error_.store(true, std::memory_order_relaxed);
  return true;
}

Status G474FlashStore::do_read(std::uint32_t slot, std::uint32_t offset,
                               Span<std::uint8_t> bytes) noexcept {
  if ((reg(kOptions) & kTwoBanks) == 0) {
    return Status::kHardwareFault;
  }
  has_read_error_.store(false, std::memory_order_relaxed);
  is_reading_.store(true, std::memory_order_seq_cst);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = reg<std::uint8_t>(address_of(slot, offset + static_cast<std::uint32_t>(i)));
  }
  finish_writes();
  // Should the interrupt be on its way still, its flag is there.
  (void)take_read_error();
  is_reading_.store(false, std::memory_order_seq_cst);
  const bool is_fault = has_read_error_.load(std::memory_order_relaxed);
  return is_fault ? Status::kHardwareFault : Status::kOk;
}

Status G474FlashStore::do_erase(std::uint32_t slot) noexcept {
  for (std::uint32_t i = 0; i < kPagesPerSlot; ++i) {
    if (!erase_page(page_of(slot) + i)) {
      return Status::kHardwareFault;
    }
  }
  return Status::kOk;
}

Status G474FlashStore::do_program(std::uint32_t slot, std::uint32_t offset,
                                  Span<const std::uint8_t> unit) noexcept {
  if (!open()) {
    (void)close(0);
    return Status::kHardwareFault;
  }
  reg(kControl) = kProgram;
  const std::uintptr_t at = address_of(slot, offset);
  reg(at) = word_of(&unit[0]);
  finish_writes();
  reg(at + 4) = word_of(&unit[4]);
  finish_writes();
  return close(kMostProgram_us) ? Status::kOk : Status::kHardwareFault;
}

}  // namespace emax::board
