// The UART of Arm's Cortex-M System Design Kit as a console.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/board/console_rings.hpp"
#include "emax/hal/byte_stream.hpp"

namespace emax::board {

/// 8 data bits, no parity, one stop bit, no flow control; a missing peer goes unnoticed. The UART
/// itself holds one byte each way: whatever is longer than that waits in `ConsoleRings`.
class CmsdkUart final : public hal::ByteStream {
 public:
  /// @param[in] base Of its registers.
  /// @param[in] transmit_interrupt Its number, for `write()` to trigger.
  /// @param[in] rings Its alone, and not inside: they are zero before use, so they take no flash.
  constexpr CmsdkUart(std::uintptr_t base, unsigned transmit_interrupt,
                      ConsoleRings& rings) noexcept
      : base_(base), transmit_interrupt_(transmit_interrupt), rings_(rings) {}

  /// Switches both directions on. @param[in] baud At most clock_hz/16.
  void start(std::uint32_t clock_hz, std::uint32_t baud) noexcept;

  /// For the interrupts.
  void on_receive() noexcept;
  void on_transmit() noexcept;

  /// @returns True if nothing waits to go out.
  bool sent() const noexcept;

  /// As the function of this name in fault_report.hpp.
  void write_polled(Span<const char> text) noexcept;

 private:
  std::size_t do_read(Span<char> bytes) noexcept override { return rings_.read(bytes); }
  std::size_t do_write(Span<const char> bytes) noexcept override;
  bool do_connected() const noexcept override { return true; }
  std::uint32_t do_take_lost_count() noexcept override { return rings_.take_lost_count(); }

  bool can_take() const noexcept;
  void put_polled(char byte) noexcept;

  const std::uintptr_t base_;
  const unsigned transmit_interrupt_;
  ConsoleRings& rings_;
};

}  // namespace emax::board
