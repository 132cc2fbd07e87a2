#include "chip/adc.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kIsr = 0x00, kIer = 0x04, kCr = 0x08, kCfgr = 0x0C, kCfgr2 = 0x10;
constexpr std::uint32_t kSmpr1 = 0x14, kSmpr2 = 0x18, kDr = 0x40;
constexpr std::uint32_t kReady = 1, kEndOfConversion = 4, kEndOfSequence = 8, kOverrun = 16;
constexpr std::uint32_t kEnable = 1, kDisable = 2, kStart = 4, kStop = 16;
constexpr std::uint32_t kRegulator = 1U << 28, kPowerDown = 1U << 29;
constexpr std::uint32_t kCalibrate = 1U << 31, kLinear = 1U << 16;
constexpr std::uint32_t kRegulatorReady = 1U << 12;
constexpr unsigned kInterrupt = 18;  // Of ADC1 and ADC2.

const Time kStabilization = ticks(5e-6);
const Time kStopTime = ticks(0.5e-6);
const Time kRest = ticks(1e-3);
constexpr std::uint32_t kPauseCycles = 4;
/// By how much a first result is wrong here, of full scale; the erratum states none.
constexpr double kFirstResultError = 0.05;

}  // namespace

Adc::Adc(Context context, const std::string& name, AdcPair& pair, bool master)
    : RegisterBlock(context, name, pair.family().converter), pair_(pair), master_(master) {}

void Adc::on_reset() {
  calibrated_ = linear_ = stable_ = false;
  dma_over = false;
  regulator_at_ = calibrated_at_ = last_end_ = 0;
  rested_ = true;
  if (master_) {
    pair_.abort();
  }
  refresh();
}

std::uint32_t Adc::on_read(std::uint32_t offset, std::uint32_t value) {
  return offset == kDr ? take_data() : value;
}

std::uint32_t Adc::take_data() {
  clear_bits(kIsr, kEndOfConversion);
  refresh();
  return get(kDr);
}

void Adc::refresh() {
  context_.wires.set(interrupt(kInterrupt), this, (get(kIsr) & get(kIer)) != 0);
}

void Adc::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kIsr:
      clear_bits(kIsr, value & ~kRegulatorReady);
      refresh();
      return;
    case kIer:
      put(offset, masked(offset, value));
      refresh();
      return;
    case kCr:
      write_control(value);
      return;
    default:
      break;
  }
  if (started()) {
    report("adc_setting_while_started", offset, value);
    return;
  }
  if (enabled() && offset == pair_.family().difsel) {
    report("adc_setting_while_enabled", offset, value);
    return;
  }
  if (pair_.family().is_not_modelled(offset, value)) {
    report("not_modelled", offset, value);
  }
  put(offset, masked(offset, value));
}

void Adc::write_control(std::uint32_t value) {
  if (has(kCr, kCalibrate)) {
    report("adc_busy_calibrating", kCr, value);
    return;
  }
  write_supply(value);
  if ((value & kCalibrate) != 0) {
    calibrate();
  }
  if ((value & kEnable) != 0 && !enabled()) {
    enable();
  }
  if ((value & kStart) != 0 && !started()) {
    start();
  }
  if ((value & kStop) != 0 && started()) {
    set_bits(kCr, kStop);
    context_.events.after(kStopTime, [this] {
      clear_bits(kCr, kStop | kStart);
      pair_.abort();
      pair_.slave.clear_bits(kCr, kStart);
    });
  }
  if ((value & kDisable) != 0 && enabled()) {
    if (started()) {
      report("adc_disable_while_started", kCr, value);
      return;
    }
    set_bits(kCr, kDisable);
    context_.events.after(kStopTime, [this] {
      clear_bits(kCr, kDisable | kEnable);
      stable_ = false;
      clear_bits(kIsr, kReady);
    });
  }
}

void Adc::write_supply(std::uint32_t value) {
  const std::uint32_t old = stored(kCr);
  if (enabled() && ((old ^ value) & (kRegulator | kPowerDown)) != 0) {
    report("adc_regulator_off", kCr, value);
  }
  if ((value & kRegulator) != 0 && (value & kPowerDown) != 0) {
    report("adc_regulator_off", kCr, value);
  }
  const std::uint32_t kept = pair_.family().kept_control;
  put(kCr, (old & ~kept) | (value & kept));
  if ((value & kRegulator) != 0 && (old & kRegulator) == 0) {
    regulator_at_ = context_.events.now();
    if (pair_.family().tells_regulator) {
      context_.events.after(ticks(pair_.family().regulator_start_s),
                            [this] { set_bits(kIsr, kRegulatorReady); });
    }
  }
  if ((value & kPowerDown) != 0) {
    calibrated_ = linear_ = false;
  }
  if ((value & kRegulator) == 0) {
    clear_bits(kIsr, kRegulatorReady);
  }
}

bool Adc::regulator_is_up(std::uint32_t value) {
  if (!has(kCr, kRegulator) || has(kCr, kPowerDown)) {
    report("adc_regulator_off", kCr, value);
    return false;
  }
  if (context_.events.now() < regulator_at_ + ticks(pair_.family().regulator_start_s)) {
    report("adc_regulator_too_soon", kCr, value);
  }
  return true;
}

void Adc::check_clock() const {
  const std::uint32_t clock_hz = pair_.clock_hz();
  const char* const fault =
      clock_hz == 0 ? "adc_no_clock"
                    : pair_.family().clock_fault(clock_hz, pair_.is_pair(), stored(kCr));
  if (fault != nullptr) {
    report(fault, kCr, clock_hz);
  }
}

void Adc::calibrate() {
  if (!regulator_is_up(kCalibrate)) {
    return;
  }
  if (enabled()) {
    report("adc_calibration_while_enabled", kCr);
    return;
  }
  if (settings().dma || (pair_.is_pair() && pair_.common.dma_mode() != 0)) {
    report("adc_calibration_with_dma", kCr);
  }
  check_clock();
  if (pair_.clock_hz() == 0) {
    return;
  }
  set_bits(kCr, kCalibrate);
  calibrated_hz_ = pair_.clock_hz();
  const bool linear = pair_.family().linear_cycles != 0 && has(kCr, kLinear);
  const std::uint32_t cycles =
      linear ? pair_.family().linear_cycles : pair_.family().calibration_cycles;
  context_.events.after(cycles_of(cycles, calibrated_hz_), [this, linear] {
    clear_bits(kCr, kCalibrate);
    put(pair_.family().calfact, 0x40);
    calibrated_ = true;
    linear_ = linear_ || linear;
    rested_ = true;
    calibrated_at_ = context_.events.now();
  });
}

void Adc::enable() {
  if (!regulator_is_up(kEnable)) {
    return;
  }
  if (!calibrated_) {
    report("adc_not_calibrated", kCr);
  } else if (pair_.family().linear_cycles != 0 && !linear_) {
    report("adc_not_linear", kCr);
  }
  if (calibrated_ &&
      context_.events.now() < calibrated_at_ + cycles_of(kPauseCycles, pair_.clock_hz())) {
    report("adc_enable_too_soon", kCr);  // And then it does not become enabled.
    return;
  }
  check_clock();
  set_bits(kCr, kEnable);
  context_.events.after(kStabilization, [this] {
    if (enabled()) {
      stable_ = true;
      set_bits(kIsr, kReady);
      refresh();
    }
  });
}

void Adc::start() {
  if (!ready()) {
    report("adc_start_before_ready", kCr);
    return;
  }
  if (calibrated_ && calibrated_hz_ != pair_.clock_hz()) {
    report("adc_clock_changed", kCr, pair_.clock_hz());
  }
  check_clock();
  dma_over = false;
  set_bits(kCr, kStart);
  const bool both = master_ && pair_.is_pair();
  pair_.check_settings(both);
  if (both && pair_.slave.ready()) {
    pair_.slave.set_bits(kCr, kStart);
    pair_.slave.dma_over = false;
  }
  if (field(stored(kCfgr), 10, 2) == 0) {
    pair_.convert(both);
  }
}

void Adc::end_without_trigger() {
  if (field(stored(kCfgr), 10, 2) == 0) {
    clear_bits(kCr, kStart);
  }
}

bool Adc::waits_for_trigger(unsigned selection) const {
  const std::uint32_t settings = get(kCfgr);
  return started() && field(settings, 10, 2) != 0 && field(settings, 5, 5) == selection;
}

AdcSettings Adc::settings() const {
  const unsigned at = channel();
  const std::uint32_t sample =
      at < 10 ? field(stored(kSmpr1), 3 * at, 3) : field(stored(kSmpr2), 3 * (at - 10), 3);
  return pair_.family().settings(stored(kCfgr), stored(kCfgr2), sample, stored(kSmpr1));
}

std::uint32_t Adc::half_cycles() const {
  const AdcSettings now = settings();
  return (now.sample_half_cycles + now.conversion_half_cycles) * now.ratio;
}

void Adc::begin(double input_v) {
  input_v_ = input_v;
  clear_bits(kIsr, kEndOfSequence);
}

// The chip's own noise makes the sum finer than a single code: here the sum is that of a converter
// of so many bits more, rounded down.
std::uint32_t Adc::convert(double input_v) const {
  const AdcSettings now = settings();
  const double full = std::ldexp(1.0, static_cast<int>(now.bits));
  const double code = std::clamp(input_v / AdcPair::kReference_v * full, 0.0, full - 1.0);
  const auto sum = static_cast<std::uint32_t>(std::floor(code * now.ratio)) >> now.right;
  const std::uint32_t greatest = (((1U << now.bits) - 1) * now.ratio >> now.right) << now.left;
  const bool is_narrow = !pair_.family().wide || pair_.is_pair();
  if (is_narrow && greatest > 0xFFFF && now.ratio > 1) {
    report("adc_oversampling_overflow", kCfgr2, stored(kCfgr2));
  }
  return is_narrow ? sum << now.left & 0xFFFF : sum << now.left;
}

void Adc::finish() {
  const Time now = context_.events.now();
  const bool wrong = pair_.first_result_is_wrong && (rested_ || now > last_end_ + kRest);
  rested_ = false;
  last_end_ = now;
  const double error_v = wrong ? kFirstResultError * AdcPair::kReference_v : 0.0;
  std::uint32_t data = convert(input_v_ + error_v);
  if (!master_ && pair_.slave_has_slipped()) {
    std::swap(data, last_data_);
  } else {
    last_data_ = data;
  }
  const bool unread = (stored(kIsr) & kEndOfConversion) != 0;
  if (unread) {
    report("adc_overrun", kDr);
    set_bits(kIsr, kOverrun);
  }
  if (!unread || !keeps_old_data()) {
    put(kDr, data);
  }
  set_bits(kIsr, kEndOfConversion | kEndOfSequence | 2U);
  refresh();
}

bool AdcPair::may_slip() const {
  return family_.slave_slips && common.dma_mode() != 0 &&
         (master.keeps_old_data() || slave.keeps_old_data());
}

AdcCommon::AdcCommon(Context context, AdcPair& pair)
    : RegisterBlock(context, "ADC12", pair.family().common), pair_(pair) {}

std::uint32_t AdcCommon::on_read(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x00) {
    return (pair_.master.flags() & 0x7FF) | (pair_.slave.flags() & 0x7FF) << 16;
  }
  if (offset == 0x0C) {
    const std::uint32_t low = pair_.master.take_data();
    return (low & 0xFFFF) | pair_.slave.take_data() << 16;
  }
  return value;
}

void AdcCommon::on_write(std::uint32_t offset, std::uint32_t value) {
  if (pair_.master.enabled() || pair_.slave.enabled()) {
    report("adc_common_while_enabled", offset, value);
    return;
  }
  const std::uint32_t mode = value & 0x1F;
  if ((mode != 0 && mode != 6) || (value >> 14 & 3) == 3 || (value & 0xF00) != 0) {
    report("not_modelled", offset, value);
  }
  put(offset, masked(offset, value));
}

AdcPair::AdcPair(Context context, Clocks& clocks, DmaRequests& requests, AdcFamily& family)
    : family_(family),
      master(context, "ADC1", *this, true),
      slave(context, "ADC2", *this, false),
      common(context, *this),
      first_result_is_wrong(family.first_result_is_wrong),
      context_(context),
      clocks_(clocks),
      requests_(requests) {}

std::uint32_t AdcPair::clock_hz() const { return source_hz() / family_.clock_divider; }

std::uint32_t AdcPair::source_hz() const {
  constexpr std::uint32_t kDividers[] = {1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256};
  switch (common.clock_mode()) {
    case 0:
      return common.prescaler() < 12 ? clocks_.adc_async_hz / kDividers[common.prescaler()] : 0;
    case 1:
      return clocks_.hclk_hz;
    case 2:
      return clocks_.hclk_hz / 2;
    default:
      return clocks_.hclk_hz / 4;
  }
}

void AdcPair::check_settings(bool both) {
  if (!both) {
    return;
  }
  if (!slave.ready()) {
    context_.findings.report("adc_slave_not_ready", "ADC2.CR");
  }
  if (master.channel() == slave.channel()) {
    context_.findings.report("adc_same_channel", "ADC2.SQR1", slave.channel());
  }
  if (!master.settings().is_like(slave.settings())) {
    context_.findings.report("adc_pair_differs", "ADC2.SMPR1");
  }
  frames_ = 0;
  if (may_slip()) {
    context_.findings.report("adc_slave_may_slip", "ADC1.CFGR");
  }
}

void AdcPair::trigger(unsigned selection) {
  if (!master.waits_for_trigger(selection)) {
    return;
  }
  if (busy_ != 0) {
    context_.findings.report("adc_trigger_during_conversion", "ADC1.CFGR", selection);
    return;
  }
  convert(is_pair());
}

double AdcPair::input_v(const Adc& adc) {
  const unsigned channel = adc.channel();
  const double volts = input_(channel);
  if (std::isnan(volts)) {
    context_.findings.report("adc_channel_not_connected", adc.name() + ".SQR1", channel);
    return 0.0;
  }
  if (!analog_(channel)) {
    context_.findings.report("adc_pin_not_analog", "GPIO.MODER", channel);
    return 0.0;
  }
  if (family_.preselects && !adc.preselects(channel)) {
    context_.findings.report("adc_channel_not_preselected", adc.name() + ".PCSEL", channel);
    return 0.0;
  }
  return volts;
}

void AdcPair::convert(bool both) {
  if (dead_ || clock_hz() == 0) {
    return;
  }
  both = both && slave.ready();
  master.begin(input_v(master));
  std::uint32_t half_cycles = master.half_cycles();
  if (both) {
    slave.begin(input_v(slave));
    half_cycles = std::max(half_cycles, slave.half_cycles());
  }
  const Time duration = cycles_of(half_cycles, clock_hz()) / 2;
  busy_ = context_.events.after(duration, [this, both] {
    busy_ = 0;
    finish(both);
  });
}

void AdcPair::finish(bool both) {
  ++conversions_;
  master.finish();
  frames_ += both && may_slip() ? 1U : 0U;
  if (both) {
    slave.finish();
  }
  if (!(master.overrun() && master.keeps_old_data())) {
    hand_over(both);
  }
  master.end_without_trigger();
}

void AdcPair::hand_over(bool both) {
  if (both && common.dma_mode() != 0) {
    const bool goes_round =
        family_.round_in_common ? common.dma_goes_round() : master.settings().dma_goes_round;
    ask(master, family_.dma_request, goes_round);
    return;
  }
  if (master.settings().dma) {
    ask(master, family_.dma_request, master.settings().dma_goes_round);
  }
  if (both && slave.settings().dma) {
    ask(slave, family_.slave_request, slave.settings().dma_goes_round);
  }
}

void AdcPair::ask(Adc& adc, unsigned request, bool goes_round) {
  if (adc.dma_over) {
    context_.findings.report("adc_dma_one_shot", adc.name() + ".CFGR");
    return;
  }
  adc.dma_over = requests_.request(request) == DmaAnswer::kLast && !goes_round;
}

}  // namespace emax::chip
