#include "chip/uart.hpp"

#include <cmath>
#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kCr1 = 0x00, kCr2 = 0x04, kCr3 = 0x08, kBrr = 0x0C, kRqr = 0x18;
constexpr std::uint32_t kIsr = 0x1C, kIcr = 0x20, kRdr = 0x24, kTdr = 0x28, kPresc = 0x2C;
constexpr std::uint32_t kReceiver = 1U << 2, kTransmitter = 1U << 3;
constexpr std::uint32_t kParity = 1, kFraming = 2, kNoise = 4, kOverrun = 8, kIdle = 1U << 4;
constexpr std::uint32_t kReceived = 1U << 5, kComplete = 1U << 6, kEmpty = 1U << 7;
constexpr std::uint32_t kTransmitReady = 1U << 21, kReceiveReady = 1U << 22;
constexpr std::uint32_t kAllEmpty = 1U << 23, kFull = 1U << 24;
constexpr std::uint32_t kHalfSampling = 1U << 15;  // OVER8, which an LPUART has not.
constexpr unsigned kBits = 10;                     // Start, eight, stop.
/// Of the rate; a receiver samples in the middle of the tenth bit.
constexpr double kBaudTolerance = 0.02;

}  // namespace

void Uart::on_reset() {
  received_.clear();
  waiting_.clear();
  shifting_ = false;
  arm_line();
  refresh();
}

std::string Uart::take_sent() { return std::exchange(sent_, {}); }

void Uart::send(const std::string& text) {
  const bool was_idle = line_.empty();
  line_.insert(line_.end(), text.begin(), text.end());
  if (was_idle) {
    arm_line();
  }
}

// Also after a reset of the chip, which the line knows nothing of.
void Uart::arm_line() {
  context_.events.cancel(std::exchange(line_event_, 0));
  if (!line_.empty()) {
    line_event_ = context_.events.after(cycles_of(kBits, line_baud), [this] { receive(); });
  }
}

void Uart::receive() {
  const std::uint8_t character = line_.front();
  line_.pop_front();
  line_event_ = 0;
  arm_line();
  if (!enabled() || !has(kCr1, kReceiver)) {
    ++lost_;
    return;
  }
  if (port_.mode(kind_.rx_pin) != PinMode::kAlternate ||
      port_.alternate(kind_.rx_pin) != kind_.function) {
    report("uart_pin_not_connected", kRdr, kind_.rx_pin);
    ++lost_;
    return;
  }
  check_baud();
  accept(character);
}

void Uart::accept(std::uint8_t character) {
  const std::uint32_t flags[] = {0, kNoise, kFraming, kParity};
  const std::uint32_t fault = flags[static_cast<unsigned>(std::exchange(fault_, LineFault::kNone))];
  if (received_.size() >= depth()) {
    ++lost_;
    if (!has(kCr3, 1U << 12)) {
      set_bits(kIsr, kOverrun);
    }
  } else {
    received_.push_back(static_cast<std::uint16_t>(character | fault << 8));
    if (received_.size() == 1) {
      show_faults();
    }
  }
  if (line_.empty()) {
    set_bits(kIsr, kIdle);
  }
  refresh();
}

double Uart::baud() const {
  constexpr unsigned kDividers[] = {1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256};
  const unsigned code = stored(kPresc);
  const unsigned divider = kDividers[code < 12 ? code : 11];
  const std::uint32_t rate = stored(kBrr);
  return rate == 0 ? 0.0 : 1.0 * kind_.rate_factor * clocks_.uart_hz / divider / rate;
}

void Uart::check_baud() const {
  const double wrong = baud() / line_baud - 1.0;
  if (!(std::fabs(wrong) <= kBaudTolerance) || stored(kBrr) < kind_.least_divider) {
    report(clocks_.uart_hz == 0 ? "uart_no_clock" : "uart_baud_rate", kBrr,
           static_cast<std::uint32_t>(baud()));
  }
}

std::uint32_t Uart::on_read(std::uint32_t offset, std::uint32_t value) {
  if (offset != kRdr || received_.empty()) {
    return value;
  }
  const std::uint32_t character = received_.front() & 0xFF;
  received_.pop_front();
  put(kRdr, character);
  show_faults();
  refresh();
  return character;
}

// The flags of faults are those of the character that would be read next; they stay.
void Uart::show_faults() {
  if (!received_.empty()) {
    set_bits(kIsr, static_cast<std::uint32_t>(received_.front()) >> 8);
  }
}

void Uart::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kCr1:
      write_control(value);
      break;
    case kCr2:
    case kCr3:
    case kBrr:
    case kPresc: {
      // CR3 has interrupt enables, which may change at any time.
      const std::uint32_t fixed = offset == kCr3 ? ~0x10C00601U : ~0U;
      if (enabled() && ((stored(offset) ^ value) & fixed) != 0) {
        report("uart_setting_while_enabled", offset, value);
        break;
      }
      put(offset, masked(offset, value));
      break;
    }
    case kRqr:
      if ((value & 1U << 3) != 0) {
        received_.clear();
      }
      if ((value & 1U << 4) != 0) {
        waiting_.clear();
      }
      break;
    case kIcr:
      put(kIsr, stored(kIsr) & ~(value & 0x25F));
      break;
    case kTdr:
      if (!enabled() || !has(kCr1, kTransmitter)) {
        report("uart_transmitter_off", offset, value);
      } else if (waiting_.size() >= depth()) {
        report("uart_data_overwritten", offset, value);
      } else {
        waiting_.push_back(static_cast<std::uint8_t>(value));
        clear_bits(kIsr, kComplete);
        transmit();
      }
      break;
    default:
      break;
  }
  refresh();
}

void Uart::write_control(std::uint32_t value) {
  constexpr std::uint32_t kFixed = 0x30001600;  // FIFO, lengths, parity.
  if (enabled() && (value & 1) != 0 && ((stored(kCr1) ^ value) & kFixed) != 0) {
    report("uart_setting_while_enabled", kCr1, value);
    value = (value & ~kFixed) | (stored(kCr1) & kFixed);
  }
  if ((value & (kFixed | kHalfSampling) & ~(1U << 29)) != 0) {
    report("not_modelled", kCr1, value);
  }
  const bool starts = !enabled() && (value & 1) != 0;
  put(kCr1, masked(kCr1, value));
  if (starts) {
    check_baud();
    set_bits(kIsr, kComplete);
  }
  if (!enabled()) {
    received_.clear();
    waiting_.clear();
  }
  transmit();
}

void Uart::transmit() {
  if (shifting_ || waiting_.empty() || !enabled() || baud() <= 0.0) {
    return;
  }
  shifting_ = true;
  const std::uint8_t character = waiting_.front();
  waiting_.pop_front();
  context_.events.after(ticks(kBits / baud()), [this, character] {
    shifting_ = false;
    if (port_.mode(kind_.tx_pin) != PinMode::kAlternate ||
        port_.alternate(kind_.tx_pin) != kind_.function) {
      report("uart_pin_not_connected", kTdr, kind_.tx_pin);
    } else {
      check_baud();
      sent_.push_back(static_cast<char>(character));
    }
    if (waiting_.empty()) {
      set_bits(kIsr, kComplete);
    }
    transmit();
    refresh();
  });
}

void Uart::refresh() {
  constexpr std::uint32_t kComputed =
      kReceived | kEmpty | kAllEmpty | kFull | kTransmitReady | kReceiveReady;
  std::uint32_t flags = stored(kIsr) & ~kComputed;
  const auto set = [&flags](bool on, std::uint32_t bits) { flags |= on ? bits : 0; };
  set(!received_.empty(), kReceived);
  set(received_.size() >= depth() && fifo(), kFull);
  set(waiting_.size() < depth(), kEmpty);
  set(waiting_.empty() && fifo(), kAllEmpty);
  set(enabled() && has(kCr1, kTransmitter), kTransmitReady);
  set(enabled() && has(kCr1, kReceiver), kReceiveReady);
  put(kIsr, flags);
  const std::uint32_t seen = get(kIsr);
  const std::uint32_t control = get(kCr1);
  // IDLE, RXNE, TC, TXE have their enables at the same place; overrun comes with RXNE's.
  bool line = (seen & control & (kIdle | kReceived | kComplete | kEmpty)) != 0;
  line |= (control & kReceived) != 0 && (seen & kOverrun) != 0;
  line |= has(kCr3, 1) && (seen & (kFraming | kNoise | kOverrun)) != 0;
  line |= (control >> 30 & 1) != 0 && (seen & kAllEmpty) != 0;
  line |= (control >> 31 & 1) != 0 && (seen & kFull) != 0;
  line |= (control >> 8 & 1) != 0 && (seen & kParity) != 0;
  context_.wires.set(interrupt(kind_.interrupt), this, line && enabled());
}

}  // namespace emax::chip
