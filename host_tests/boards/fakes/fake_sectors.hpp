// Two sectors of memory whose power can be cut in any operation, and which keeps count of what must
// not happen.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "emax/board/log_store.hpp"

namespace emax::test {

/// What a cut leaves of the unit that was being programmed.
enum class Cut : std::uint8_t { kUntouched, kUnreadable, kGarbage, kDone };
inline constexpr Cut kCuts[] = {Cut::kUntouched, Cut::kUnreadable, Cut::kGarbage, Cut::kDone};

class FakeSectors final : public board::SectorPair {
 public:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  FakeSectors(std::uint32_t sector_bytes, std::uint32_t unit_bytes)
      : sector_bytes_(sector_bytes),
        unit_bytes_(unit_bytes),
        memory_(std::size_t{2} * sector_bytes, hal::kErasedByte) {}
  FakeSectors(const FakeSectors& other)
      : SectorPair(),
        sector_bytes_(other.sector_bytes_),
        unit_bytes_(other.unit_bytes_),
        memory_(other.memory_),
        programmed_(other.programmed_),
        unreadable_(other.unreadable_),
        operations_(other.operations_),
        erasures_(other.erasures_),
        misuses_(other.misuses_) {}

  /// The power fails in the operation after these.
  void cut_power_after(std::uint64_t operations, Cut cut) {
    operations_left_ = operations;
    cut_ = cut;
  }
  void restore_power() {
    operations_left_ = kNever;
    is_powered_ = true;
  }
  bool powered() const { return is_powered_; }
  std::uint64_t operations() const { return operations_; }
  std::uint64_t erasures() const { return erasures_; }
  /// Units programmed twice, off their bounds, or of the wrong size.
  std::uint64_t misuses() const { return misuses_; }

  std::size_t bytes() const { return memory_.size(); }
  void flip(std::size_t byte, unsigned bit) {
    memory_[byte] = static_cast<std::uint8_t>(memory_[byte] ^ 1U << bit);
  }
  /// As what error correction gives up on.
  void spoil_unit_of(std::size_t byte) { unreadable_.insert(byte / unit_bytes_); }

  Status read_sector(std::uint32_t sector, std::uint32_t offset,
                     Span<std::uint8_t> bytes) noexcept override {
    const std::size_t begin = std::size_t{sector} * sector_bytes_ + offset;
    if (!is_powered_ || offset + bytes.size() > sector_bytes_) {
      return Status::kHardwareFault;
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (unreadable_.count((begin + i) / unit_bytes_) != 0) {
        return Status::kHardwareFault;
      }
      bytes[i] = memory_[begin + i];
    }
    return Status::kOk;
  }

  Status erase_sector(std::uint32_t sector) noexcept override {
    const bool is_whole = begin_operation();
    if (!was_powered_) {
      return Status::kHardwareFault;
    }
    ++erasures_;
    const std::size_t first = std::size_t{sector} * sector_bytes_ / unit_bytes_;
    for (std::size_t i = 0; i < sector_bytes_ / unit_bytes_; ++i) {
      const std::size_t unit = first + i;
      // A cut one leaves all stages side by side.
      const bool is_done =
          is_whole || cut_ == Cut::kDone || (cut_ != Cut::kUntouched && i % 3 == 0);
      if (is_done) {
        programmed_.erase(unit);
        unreadable_.erase(unit);
        std::fill_n(memory_.begin() + static_cast<std::ptrdiff_t>(unit * unit_bytes_), unit_bytes_,
                    hal::kErasedByte);
      } else if (cut_ != Cut::kUntouched && i % 3 == 1) {
        spoil(unit);
      }
    }
    return is_whole ? Status::kOk : Status::kHardwareFault;
  }

  Status program_unit(std::uint32_t sector, std::uint32_t offset,
                      Span<const std::uint8_t> unit) noexcept override {
    const std::size_t begin = std::size_t{sector} * sector_bytes_ + offset;
    const std::size_t at = begin / unit_bytes_;
    if (sector > 1 || offset % unit_bytes_ != 0 || unit.size() != unit_bytes_ ||
        offset + unit_bytes_ > sector_bytes_ || programmed_.count(at) != 0) {
      ++misuses_;
      return Status::kHardwareFault;
    }
    const bool is_whole = begin_operation();
    if (!was_powered_ || (!is_whole && cut_ == Cut::kUntouched)) {
      return Status::kHardwareFault;
    }
    programmed_.insert(at);
    std::copy(unit.begin(), unit.end(), memory_.begin() + static_cast<std::ptrdiff_t>(begin));
    if (!is_whole && cut_ != Cut::kDone) {
      spoil(at);
    }
    return is_whole ? Status::kOk : Status::kHardwareFault;
  }

 private:
  void spoil(std::size_t unit) {
    programmed_.insert(unit);
    if (cut_ == Cut::kUnreadable) {
      unreadable_.insert(unit);
      return;
    }
    for (std::uint32_t i = 0; i < unit_bytes_; i += 2) {
      memory_[unit * unit_bytes_ + i] &= 0x5A;
    }
  }

  // @returns Whether it ends; without power nothing even begins.
  bool begin_operation() {
    was_powered_ = is_powered_;
    if (!is_powered_) {
      return false;
    }
    ++operations_;
    if (operations_left_ == 0) {
      is_powered_ = false;
      return false;
    }
    operations_left_ -= operations_left_ == kNever ? 0 : 1;
    return true;
  }

  std::uint32_t sector_bytes_;
  std::uint32_t unit_bytes_;
  std::vector<std::uint8_t> memory_;
  std::set<std::size_t> programmed_;
  std::set<std::size_t> unreadable_;
  std::uint64_t operations_ = 0;
  std::uint64_t erasures_ = 0;
  std::uint64_t misuses_ = 0;
  std::uint64_t operations_left_ = kNever;
  Cut cut_ = Cut::kUnreadable;
  bool is_powered_ = true;
  bool was_powered_ = true;
};

}  // namespace emax::test
