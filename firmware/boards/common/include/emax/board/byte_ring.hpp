// Bytes on their way between the program and an interrupt.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace emax::board {

/// A queue of bytes for one that puts and one that takes, either of which may interrupt the other.
///
/// Neither waits or locks. kRoom is a power of two, and all of it is used. 8 bytes beside the room.
template <std::size_t kRoom>
class ByteRing {
 public:
  static_assert(kRoom >= 2 && (kRoom & (kRoom - 1)) == 0);

  /// @returns False if there is no room; nothing has changed.
  bool put(char byte) noexcept {
    const std::uint32_t put_count = put_count_.load(std::memory_order_relaxed);
    if (put_count - taken_count_.load(std::memory_order_acquire) == kRoom) {
      return false;
    }
    bytes_[put_count % kRoom] = byte;
    put_count_.store(put_count + 1, std::memory_order_release);
    return true;
  }

  /// @returns False if there is none; `byte` is untouched.
  bool take(char& byte) noexcept {
    const std::uint32_t taken_count = taken_count_.load(std::memory_order_relaxed);
    if (put_count_.load(std::memory_order_acquire) == taken_count) {
      return false;
    }
    byte = bytes_[taken_count % kRoom];
    taken_count_.store(taken_count + 1, std::memory_order_release);
    return true;
  }

  bool empty() const noexcept {
    return put_count_.load(std::memory_order_acquire) ==
           taken_count_.load(std::memory_order_acquire);
  }

 private:
  std::array<char, kRoom> bytes_ = {};
  // Of all times, modulo 2^32; each is written by one side.
  std::atomic<std::uint32_t> put_count_ = 0;
  std::atomic<std::uint32_t> taken_count_ = 0;
};

}  // namespace emax::board
