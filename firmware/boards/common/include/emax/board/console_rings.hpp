// What a console on a UART keeps between the program and the interrupts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/board/byte_ring.hpp"

namespace emax::board {

/// At 115200 baud, 1024 bytes come in within 89 ms, which is the longest pause between two looks of
/// the program that loses nothing.
inline constexpr std::size_t kReceiveRoom = 1024;
inline constexpr std::size_t kTransmitRoom = 512;

/// Both directions of a console and the count of what found no room. The program calls one half of
/// the functions, the interrupts of the UART call the other. 1.5 KiB.
class ConsoleRings {
 public:
  /// For the program, as `hal::ByteStream` asks.
  std::size_t read(Span<char> bytes) noexcept;
  std::size_t write(Span<const char> bytes) noexcept;
  std::uint32_t take_lost_count() noexcept;
  bool take_break() noexcept;
  bool has_received() const noexcept { return !receive_.empty(); }

  /// @returns True if all that was written has been taken by the UART.
  bool sent() const noexcept { return transmit_.empty(); }

  /// For the interrupt: a byte has come in.
  void received(char byte) noexcept;
  /// For the interrupt: a byte has come in and cannot be used.
  void lose() noexcept;
  /// For the interrupt: the line has a break; what has come in before it goes.
  void broken() noexcept;
  /// For the interrupt: the next byte that goes out. @returns False if there is none.
  bool take_next(char& byte) noexcept { return transmit_.take(byte); }

 private:
  ByteRing<kReceiveRoom> receive_;
  ByteRing<kTransmitRoom> transmit_;
  // Modulo 2^32; each is written by one side, and their difference is what is told.
  std::atomic<std::uint32_t> lost_count_ = 0;
  std::atomic<std::uint32_t> told_count_ = 0;
  std::atomic<bool> is_broken_ = false;
};

}  // namespace emax::board
