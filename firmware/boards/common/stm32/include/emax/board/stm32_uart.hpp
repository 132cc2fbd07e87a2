// A USART or LPUART of an STM32 with FIFOs as a console.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/board/console_rings.hpp"
#include "emax/hal/byte_stream.hpp"

namespace emax::board {

/// How the divider of the rate is made.
enum class UartKind : std::uint8_t {
  kUsart,   ///< clock/baud.
  kLpuart,  ///< 256 clock/baud; the clock is 3 to 4096 times the rate.
};

/// 8 data bits, no parity, one stop bit, no flow control; a missing peer goes unnoticed. One
/// interrupt for both directions. A byte that came with noise or without its stop bit is counted as
/// lost; a break, which is a zero without its stop bit, is told.
class Stm32Uart final : public hal::ByteStream {
 public:
  /// @param[in] base Of its registers.
  constexpr Stm32Uart(std::uintptr_t base, UartKind kind) noexcept : base_(base), kind_(kind) {}

  /// Switches both directions on; again, with another clock, it goes on at the same rate.
  void start(std::uint32_t clock_hz, std::uint32_t baud) noexcept;

  /// For the interrupt.
  void on_interrupt() noexcept;

  /// @returns True if a byte waits to be read.
  bool has_received() const noexcept { return rings_.has_received(); }

  /// @returns True if nothing waits to go out.
  bool sent() const noexcept;

  /// As the function of this name in fault_report.hpp.
  void write_polled(Span<const char> text) noexcept;

 private:
  std::size_t do_read(Span<char> bytes) noexcept override { return rings_.read(bytes); }
  std::size_t do_write(Span<const char> bytes) noexcept override;
  bool do_connected() const noexcept override { return true; }
  std::uint32_t do_take_lost_count() noexcept override { return rings_.take_lost_count(); }
  bool do_take_break() noexcept override { return rings_.take_break(); }

  void receive() noexcept;
  void transmit() noexcept;
  bool can_take() const noexcept;
  void put_polled(char byte) noexcept;
  void wait_until(std::uint32_t flag) const noexcept;

  const std::uintptr_t base_;
  const UartKind kind_;
  ConsoleRings rings_;
};

}  // namespace emax::board
