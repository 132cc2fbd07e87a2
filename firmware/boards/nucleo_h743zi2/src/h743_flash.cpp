// Sectors of 128 KiB that are erased, units of eight words that are programmed once.
#include "emax/board/h743_flash.hpp"

#include "emax/board/bus_faults.hpp"
#include "emax/board/dma_memory.hpp"
#include "emax/board/flash_words.hpp"
#include "emax/board/h743.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

// Of bank 2, but for the options.
constexpr std::uintptr_t kOptionControl = kFlash + 0x18;
constexpr std::uintptr_t kOptions = kFlash + 0x1C;
constexpr std::uintptr_t kKey = kFlash + 0x104;
constexpr std::uintptr_t kControl = kFlash + 0x10C;
constexpr std::uintptr_t kStatus = kFlash + 0x110;
constexpr std::uintptr_t kClear = kFlash + 0x114;

// Being worked on, or waiting in the queue.
constexpr std::uint32_t kBusy = 1U << 0 | 1U << 1 | 1U << 2;
// Protected, out of order, twice, incomplete, failed, and not to be read.
constexpr std::uint32_t kErrors = 0xF7U << 17;
constexpr std::uint32_t kNotCorrected = 1U << 26;
constexpr std::uint32_t kAllFlags = 0x0FEF0000;

constexpr std::uint32_t kLock = 1U << 0;
constexpr std::uint32_t kProgram = 1U << 1;
constexpr std::uint32_t kEraseSector = 1U << 2;
// 64 bits at once, as from 2.7 V on.
constexpr std::uint32_t kParallel64 = 3U << 4;
constexpr std::uint32_t kStart = 1U << 7;
constexpr unsigned kSectorAt = 8;

constexpr std::uint32_t kBanksSwapped = 1U << 31;
constexpr std::uint32_t kFirstSector = 6;

// Twice and five times what they take.
constexpr std::uint32_t kMostErase_us = 4'000'000;
constexpr std::uint32_t kMostProgram_us = 1'000;

std::uintptr_t address_of(std::uint32_t sector, std::uint32_t offset) noexcept {
  return kFlashBank2 + std::uintptr_t{kFirstSector + sector} * kH743SectorBytes + offset;
}

bool has_bank_2() noexcept { return ((reg(kOptionControl) | reg(kOptions)) & kBanksSwapped) == 0; }

bool is_idle(std::uint32_t most_us) noexcept {
  return wait_for([] { return (reg(kStatus) & kBusy) == 0; }, most_us);
}

// Ready to erase or program: idle, without a flag of before, unlocked.
bool open() noexcept {
  if (!has_bank_2() || !is_idle(kMostErase_us)) {
    return false;
  }
  reg(kClear) = kAllFlags;
  if ((reg(kControl) & kLock) != 0) {
    reg(kKey) = kFirstKey;
    reg(kKey) = kSecondKey;
  }
  return (reg(kControl) & kLock) == 0;
}

// @returns Whether what has been begun ended well.
bool close(std::uint32_t most_us) noexcept {
  const bool is_done = is_idle(most_us) && (reg(kStatus) & kErrors) == 0;
  reg(kClear) = kAllFlags;
  if ((reg(kControl) & kLock) == 0) {
    // First what was asked for is taken back.
    reg(kControl) = kParallel64;
    reg(kControl) = kParallel64 | kLock;
  }
  return is_done;
}

}  // namespace

Status H743Sectors::read_sector(std::uint32_t sector, std::uint32_t offset,
                                Span<std::uint8_t> bytes) noexcept {
  if (!has_bank_2()) {
    return Status::kHardwareFault;
  }
  reg(kClear) = kNotCorrected;
  const IgnoredBusFaults faults;
  for (std::size_t i = 0; i < bytes.size();) {
    const std::uintptr_t at = address_of(sector, offset + static_cast<std::uint32_t>(i));
    const std::uint32_t word = reg(at & ~std::uintptr_t{3});
    for (std::size_t byte = at % 4; byte < 4 && i < bytes.size(); ++byte, ++i) {
      bytes[i] = static_cast<std::uint8_t>(word >> (8 * byte));
    }
  }
  finish_writes();
  const bool is_fault = faults.happened() || (reg(kStatus) & kNotCorrected) != 0;
  reg(kClear) = kNotCorrected;
  return is_fault ? Status::kHardwareFault : Status::kOk;
}

Status H743Sectors::erase_sector(std::uint32_t sector) noexcept {
  if (!open()) {
    (void)close(0);
    return Status::kHardwareFault;
  }
  const std::uint32_t what = kEraseSector | kParallel64 | (kFirstSector + sector) << kSectorAt;
  reg(kControl) = what;
  reg(kControl) = what | kStart;
  return close(kMostErase_us) ? Status::kOk : Status::kHardwareFault;
}

Status H743Sectors::program_unit(std::uint32_t sector, std::uint32_t offset,
                                 Span<const std::uint8_t> unit) noexcept {
  if (!open()) {
    (void)close(0);
    return Status::kHardwareFault;
  }
  reg(kControl) = kProgram | kParallel64;
  finish_writes();
  for (std::uint32_t at = 0; at < kH743UnitBytes; at += 4) {
    reg(address_of(sector, offset + at)) = word_of(&unit[at]);
    finish_writes();
  }
  return close(kMostProgram_us) ? Status::kOk : Status::kHardwareFault;
}

}  // namespace emax::board
