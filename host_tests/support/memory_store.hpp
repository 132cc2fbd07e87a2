// A store in memory whose power can be cut at any byte.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "emax/hal/store.hpp"

namespace emax::test {

/// Programs byte by byte and erases byte by byte, so that a cut can strike between any two.
/// Programming clears bits and never sets one, as in flash memory.
class MemoryStore final : public hal::Store {
 public:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  explicit MemoryStore(const hal::StoreFormat& format)
      : Store(format),
        memory_(std::size_t{format.slot_count} * format.slot_bytes, hal::kErasedByte) {}

  /// The power fails after this many more bytes were erased or programmed; the byte at which it
  /// fails has only some of its bits changed. Everything is kHardwareFault from then on.
  void cut_power_after(std::uint64_t bytes) { bytes_left_ = bytes; }
  /// Power is back, with what the memory held when it failed.
  void restore_power() {
    bytes_left_ = kNever;
    powered_ = true;
  }
  bool powered() const { return powered_; }
  /// Bytes that were erased or programmed so far.
  std::uint64_t bytes_changed() const { return bytes_changed_; }
  /// Units that were programmed without being erased.
  std::uint64_t misuses() const { return misuses_; }

  /// The memory itself, to damage it.
  std::uint8_t& at(std::uint32_t slot, std::uint32_t offset) {
    return memory_[std::size_t{slot} * format().slot_bytes + offset];
  }

  MemoryStore& store() { return *this; }

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override {
    if (!powered_) {
      return Status::kHardwareFault;
    }
    std::copy_n(&at(slot, offset), bytes.size(), bytes.data());
    return Status::kOk;
  }

  Status do_erase(std::uint32_t slot) noexcept override {
    for (std::uint32_t i = 0; i < format().slot_bytes; ++i) {
      change(at(slot, i), hal::kErasedByte);
    }
    return powered_ ? Status::kOk : Status::kHardwareFault;
  }

  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override {
    const auto erased = [this, slot, offset](std::uint32_t i) {
      return at(slot, offset + i) == hal::kErasedByte;
    };
    bool all_erased = offset % format().unit_bytes == 0 && unit.size() == format().unit_bytes;
    for (std::uint32_t i = 0; i < unit.size(); ++i) {
      all_erased = all_erased && erased(i);
      change(at(slot, offset + i), at(slot, offset + i) & unit[i]);
    }
    misuses_ += all_erased ? 0U : 1U;
    return powered_ ? Status::kOk : Status::kHardwareFault;
  }

  void change(std::uint8_t& byte, int value) {
    if (!powered_) {
      return;
    }
    if (bytes_left_ == 0) {
      powered_ = false;
      byte = static_cast<std::uint8_t>((byte & 0xF0) | (value & 0x0F));
      return;
    }
    --bytes_left_;
    ++bytes_changed_;
    byte = static_cast<std::uint8_t>(value);
  }

  std::vector<std::uint8_t> memory_;
  std::uint64_t bytes_left_ = kNever;
  std::uint64_t bytes_changed_ = 0;
  std::uint64_t misuses_ = 0;
  bool powered_ = true;
};

}  // namespace emax::test
