// A UART with its FIFOs, and the line at its pins.
#pragma once

#include <deque>
#include <string>
#include <utility>

#include "chip/clocks.hpp"
#include "chip/gpio.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// What happens to a character on its way in.
enum class LineFault { kNone, kNoise, kFraming, kParity };

/// Found here: "uart_setting_while_enabled", "uart_baud_rate", "uart_transmitter_off",
/// "uart_data_overwritten", "uart_pin_not_connected", "uart_no_clock".
class Uart final : public RegisterBlock {
 public:
  /// What differs between the console's UARTs.
  struct Kind {
    const char* name;
    unsigned rate_factor;  ///< The divider is the clock times this through the rate.
    std::uint32_t least_divider;
    std::size_t fifo_depth;
    unsigned tx_pin, rx_pin, function;
    unsigned interrupt;
  };

  Uart(Context context, Clocks& clocks, const Gpio& port, const Kind& kind, Registers registers)
      : RegisterBlock(context, kind.name, std::move(registers)),
        kind_(kind),
        clocks_(clocks),
        port_(port) {}

  /// What has gone out since the last call of `take_sent()`.
  const std::string& sent() const { return sent_; }
  std::string take_sent();
  /// Puts characters on the line, one after the other at the line's rate.
  void send(const std::string& text);
  /// The next character that comes in has this fault.
  void spoil_next(LineFault fault) { fault_ = fault; }
  bool line_is_idle() const { return line_.empty(); }
  std::uint32_t line_baud = 115200;
  /// Characters that came while there was no room, no receiver or no pin.
  unsigned lost() const { return lost_; }

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;

  bool enabled() const { return has(0x00, 1); }
  bool fifo() const { return has(0x00, 1U << 29); }
  std::size_t depth() const { return fifo() ? kind_.fifo_depth : 1; }
  double baud() const;
  void check_baud() const;
  void write_control(std::uint32_t value);
  void transmit();
  void receive();
  void accept(std::uint8_t character);
  void show_faults();
  void arm_line();
  void refresh();

  Kind kind_;
  Clocks& clocks_;
  const Gpio& port_;
  std::string sent_;
  std::deque<std::uint8_t> line_;
  std::deque<std::uint16_t> received_;  ///< With the fault's flags above the character.
  std::deque<std::uint8_t> waiting_;    ///< To go out.
  LineFault fault_ = LineFault::kNone;
  unsigned lost_ = 0;
  bool shifting_ = false;
  Events::Id line_event_ = 0;
};

}  // namespace emax::chip
