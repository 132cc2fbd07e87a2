#include "chip/dac.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace emax::chip {
namespace {

constexpr std::uint32_t kCr = 0x00, kSwtrgr = 0x04, kDhr12r1 = 0x08, kDhr12l1 = 0x0C;
constexpr std::uint32_t kDhr8r1 = 0x10, kDhr12rd = 0x20, kDhr12ld = 0x24, kDhr8rd = 0x28;
constexpr std::uint32_t kDor1 = 0x2C, kSr = 0x34, kMcr = 0x3C;
constexpr std::uint32_t kEnable = 1, kTrigger = 2, kDmaEnable = 1U << 12;
constexpr std::uint32_t kUnderrunInterrupt = 1U << 13, kUnderrun = 1U << 13,
                        kOutputReady = 1U << 11;
/// Waves, calibration, the second channel.
constexpr std::uint32_t kOtherModes = 0x7FFF0000 | 1U << 14 | 3U << 6;
constexpr unsigned kPin = 4;
constexpr unsigned kInterrupt = 54;
constexpr double kBufferMargin_v = 0.2;
const Time kWakeUp = ticks(8e-6);

}  // namespace

void Dac::on_reset() {
  holding_ = 0;
  request_waits_ = underrun_ = false;
  refresh();
  show();
}

void Dac::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kCr:
      write_control(value);
      return;
    case kMcr:
      write_mode(value);
      return;
    case kSwtrgr:
      if ((value & 1) != 0) {
        trigger(0);
      }
      return;
    case kSr:
      clear_bits(kSr, value & kUnderrun);
      refresh();
      return;
    default:
      break;
  }
  put(offset, masked(offset, value));
  switch (offset) {
    case kDhr12r1:
    case kDhr12rd:
      hold(value & 0xFFF);
      break;
    case kDhr12l1:
    case kDhr12ld:
      hold(value >> 4 & 0xFFF);
      break;
    case kDhr8r1:
    case kDhr8rd:
      hold((value & 0xFF) << 4);
      break;
    default:
      break;
  }
}

void Dac::write_mode(std::uint32_t value) {
  if (enabled()) {
    report("dac_mode_while_enabled", kMcr, value);
    return;
  }
  if ((value & 0x03070304) != 0) {
    report("not_modelled", kMcr, value);
  }
  put(kMcr, masked(kMcr, value));
}

void Dac::write_control(std::uint32_t value) {
  const std::uint32_t old = stored(kCr);
  if ((value & kOtherModes) != 0) {
    report("not_modelled", kCr, value);
  }
  put(kCr, masked(kCr, value));
  if ((value & kDmaEnable) == 0) {
    request_waits_ = underrun_ = false;
  }
  if ((value & kEnable) != 0 && (old & kEnable) == 0) {
    const unsigned wanted = clocks_.hclk_hz > 160'000'000  ? 2
                            : clocks_.hclk_hz > 80'000'000 ? 1
                                                           : 0;
    if (kind_.has_speed && field(stored(kMcr), 14, 2) != wanted) {
      report("dac_hfsel", kMcr, stored(kMcr));
    }
    if (uses_trigger() && stored(kDor1) != holding_) {
      report("dac_output_before_first_trigger", kCr, value);
    }
    context_.events.after(kWakeUp, [this] {
      if (enabled() && kind_.tells_ready) {
        set_bits(kSr, kOutputReady);
      }
    });
  }
  if (!enabled()) {
    clear_bits(kSr, kOutputReady);
  } else if (!uses_trigger()) {
    put(kDor1, holding_);
  }
  refresh();
  show();
}

void Dac::hold(std::uint32_t code) {
  holding_ = code;
  if (!uses_trigger()) {
    put(kDor1, code);
    show();
  }
}

void Dac::trigger(unsigned selection) {
  if (!enabled() || !uses_trigger() || field(stored(kCr), 2, 4) != selection) {
    return;
  }
  put(kDor1, holding_);
  show();
  // Triggers of software ask for no data.
  if (selection != 0 && (stored(kCr) & kDmaEnable) != 0) {
    request();
  }
}

void Dac::request() {
  if (underrun_) {
    return;
  }
  if (request_waits_) {
    report("dac_underrun", kSr);
    underrun_ = true;
    set_bits(kSr, kUnderrun);
    refresh();
    return;
  }
  request_waits_ = requests_.request(kind_.request) == DmaAnswer::kNobody;
}

void Dac::refresh() {
  const bool high = has(kSr, kUnderrun) && has(kCr, kUnderrunInterrupt);
  context_.wires.set(interrupt(kInterrupt), this, high);
}

void Dac::show() {
  if (!output_) {
    return;
  }
  if (!enabled()) {
    output_(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  if (port_.mode(kPin) != PinMode::kAnalog) {
    report("dac_pin_not_analog", kCr, kPin);
  }
  double pin_v = static_cast<double>(stored(kDor1)) * kReference_v / 4096.0;
  if ((stored(kMcr) & 3) < 2) {  // Through the buffer, which does not reach the rails.
    pin_v = std::clamp(pin_v, kBufferMargin_v, kReference_v - kBufferMargin_v);
  }
  output_(pin_v);
}

}  // namespace emax::chip
