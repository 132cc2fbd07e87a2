// A UART of the kind 16550 as a console.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/board/console_rings.hpp"
#include "emax/hal/byte_stream.hpp"

namespace emax::board {

/// 8 data bits, no parity, one stop bit, no flow control; a missing peer goes unnoticed. The UART
/// itself holds one byte each way: switching its FIFOs on would drop what has come in before the
/// start.
class Ns16550 final : public hal::ByteStream {
 public:
  /// @param[in] base Of its registers, which are one byte each.
  constexpr explicit Ns16550(std::uintptr_t base) noexcept : base_(base) {}

  /// Switches both directions on. @param[in] baud At most clock_hz/16.
  void start(std::uint32_t clock_hz, std::uint32_t baud) noexcept;

  /// For the interrupt.
  void on_interrupt() noexcept;

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

  bool can_take() const noexcept;
  void put_polled(char byte) noexcept;

  const std::uintptr_t base_;
  ConsoleRings rings_;
};

}  // namespace emax::board
