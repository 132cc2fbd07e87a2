// ADC1 and ADC2: supply, calibration, settings, conversions with oversampling, alone or as a pair.
#pragma once

#include <functional>
#include <tuple>

#include "chip/clocks.hpp"
#include "chip/dma.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

class AdcPair;

/// What a converter's settings say, in whatever bits its family keeps them.
struct AdcSettings {
  std::uint32_t sample_half_cycles = 0;
  std::uint32_t conversion_half_cycles = 0;
  unsigned bits = 12;
  std::uint32_t ratio = 1;  ///< Conversions that are summed up.
  unsigned right = 0, left = 0;
  bool dma = false, dma_goes_round = false;

  /// What two converters of a pair must have alike.
  bool is_like(const AdcSettings& other) const {
    const auto parts = [](const AdcSettings& of) {
      return std::tuple(of.sample_half_cycles, of.conversion_half_cycles, of.bits, of.ratio,
                        of.right, of.left);
    };
    return parts(*this) == parts(other);
  }
};

/// What differs between the converters of two families.
class AdcFamily {
 public:
  /// Of the registers CFGR, CFGR2, and the six bits of the channel's time: its code, and SMPR1.
  virtual AdcSettings settings(std::uint32_t cfgr, std::uint32_t cfgr2, std::uint32_t sample,
                               std::uint32_t smpr1) const = 0;
  /// What is wrong with this clock: the name of a finding, or null.
  virtual const char* clock_fault(std::uint32_t clock_hz, bool pair, std::uint32_t cr) const = 0;
  /// Whether a register is asked for what this model does not do.
  virtual bool is_not_modelled(std::uint32_t offset, std::uint32_t value) const = 0;

  Registers converter, common;
  unsigned dma_request = 0, slave_request = 0;
  std::uint32_t difsel = 0, calfact = 0;
  std::uint32_t kept_control = 0x70000000;  ///< Bits of CR that stay as they are written.
  double regulator_start_s = 20e-6;
  std::uint32_t calibration_cycles = 116;
  std::uint32_t linear_cycles = 0;     ///< Linear calibration, zero: there is none.
  bool tells_regulator = false;        ///< ISR.LDORDY
  bool preselects = false;             ///< PCSEL
  bool wide = false;                   ///< DR has 32 bits; only a pair's share has 16.
  bool slave_slips = false;            ///< Erratum: with OVRMOD 0.
  bool first_result_is_wrong = false;  ///< Erratum.
  bool round_in_common = true;         ///< CCR.DMACFG, else CFGR of the master.
  std::uint32_t clock_divider = 1;

 protected:
  ~AdcFamily() = default;
};

/// Found here: "adc_regulator_too_soon", "adc_regulator_off", "adc_calibration_while_enabled",
/// "adc_calibration_with_dma", "adc_busy_calibrating", "adc_not_calibrated", "adc_enable_too_soon",
/// "adc_disable_while_started", "adc_start_before_ready", "adc_setting_while_started",
/// "adc_setting_while_enabled", "adc_no_clock", "adc_too_fast", "adc_too_slow",
/// "adc_clock_changed", "adc_boost", "adc_not_linear", "adc_overrun", "adc_oversampling_overflow",
/// "not_modelled".
class Adc final : public RegisterBlock {
 public:
  Adc(Context context, const std::string& name, AdcPair& pair, bool master);

  bool enabled() const { return has(0x08, 1); }
  bool ready() const { return enabled() && stable_; }
  bool started() const { return has(0x08, 4); }
  unsigned channel() const { return field(stored(0x30), 6, 5); }
  /// Cycles of a whole conversion, twice, with all that is summed up.
  std::uint32_t half_cycles() const;
  AdcSettings settings() const;
  bool waits_for_trigger(unsigned selection) const;
  bool keeps_old_data() const { return !has(0x0C, 1U << 12); }

  void begin(double input_v);
  /// Takes the result into the register, unless the last was not read and is to be kept.
  void finish();
  std::uint32_t take_data();
  std::uint32_t flags() const { return get(0x00); }
  void end_without_trigger();
  /// The DMA requests with DMACFG 0 end with the DMA's last transfer.
  bool dma_over = false;
  bool overrun() const { return has(0x00, 1U << 4); }
  bool preselects(unsigned channel) const { return has(0x1C, 1U << channel); }

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;

  void write_control(std::uint32_t value);
  void write_supply(std::uint32_t value);
  bool regulator_is_up(std::uint32_t value);
  void calibrate();
  void enable();
  void start();
  void check_clock() const;
  void refresh();
  std::uint32_t convert(double input_v) const;

  AdcPair& pair_;
  bool master_;
  bool calibrated_ = false;
  bool stable_ = false;  ///< Enabled for long enough; the flag may have been cleared since.
  Time regulator_at_ = 0;
  Time calibrated_at_ = 0;
  std::uint32_t calibrated_hz_ = 0;
  Time last_end_ = 0;
  bool rested_ = true;   ///< No conversion yet since calibration.
  bool linear_ = false;  ///< Calibrated so.
  double input_v_ = 0.0;
  std::uint32_t last_data_ = 0;
};

/// Found here: "adc_common_while_enabled".
class AdcCommon final : public RegisterBlock {
 public:
  AdcCommon(Context context, AdcPair& pair);
  unsigned dual() const { return field(get(0x08), 0, 5); }
  unsigned dma_mode() const { return field(get(0x08), 14, 2); }
  bool dma_goes_round() const { return has(0x08, 1U << 13); }
  unsigned clock_mode() const { return field(get(0x08), 16, 2); }
  unsigned prescaler() const { return field(get(0x08), 18, 4); }

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;

  AdcPair& pair_;
};

/// Found here: "adc_trigger_during_conversion", "adc_same_channel", "adc_pair_differs",
/// "adc_slave_not_ready", "adc_channel_not_connected", "adc_channel_not_preselected",
/// "adc_pin_not_analog", "adc_dma_one_shot", "adc_slave_may_slip".
class AdcPair {
 public:
  AdcPair(Context context, Clocks& clocks, DmaRequests& requests, AdcFamily& family);

 private:
  AdcFamily& family_;

 public:
  Adc master;
  Adc slave;
  AdcCommon common;

  /// Volts at a channel of both converters; not a number where nothing is connected.
  void measure_with(std::function<double(unsigned channel)> input) { input_ = std::move(input); }
  /// Whether the channel's pin is in analog mode.
  void look_at_pin_with(std::function<bool(unsigned channel)> analog) {
    analog_ = std::move(analog);
  }
  /// A trigger, by its number in EXTSEL.
  void trigger(unsigned selection);
  std::uint32_t clock_hz() const;
  bool is_pair() const { return common.dual() == 6; }
  void convert(bool both);

  /// Test: no conversion ends any more.
  void set_dead(bool dead) { dead_ = dead; }
  /// Erratum: the first result after a rest of a millisecond or a calibration is wrong.
  bool first_result_is_wrong;
  AdcFamily& family() { return family_; }
  unsigned dma_request() const { return family_.dma_request; }
  /// Erratum: the slave's data of a pair come a frame late, after so many frames.
  bool slave_has_slipped() const { return frames_ > kFramesBeforeSlip; }
  static constexpr double kReference_v = 3.3;
  /// Conversions that have ended.
  std::uint64_t conversions() const { return conversions_; }
  void abort() { context_.events.cancel(std::exchange(busy_, 0)); }
  void check_settings(bool both);

 private:
  static constexpr unsigned kFramesBeforeSlip = 1000;
  double input_v(const Adc& adc);
  void finish(bool both);
  bool may_slip() const;
  std::uint32_t source_hz() const;
  void hand_over(bool both);
  void ask(Adc& adc, unsigned request, bool goes_round);

  Context context_;
  Clocks& clocks_;
  DmaRequests& requests_;
  unsigned frames_ = 0;  ///< Of a pair whose slave may slip.
  std::function<double(unsigned)> input_;
  std::function<bool(unsigned)> analog_;
  Events::Id busy_ = 0;
  std::uint64_t conversions_ = 0;
  bool dead_ = false;
};

}  // namespace emax::chip
