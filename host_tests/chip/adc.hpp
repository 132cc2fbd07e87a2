// ADC1 and ADC2: supply, calibration, settings, conversions with oversampling, alone or as a pair.
#pragma once

#include <functional>

#include "chip/clocks.hpp"
#include "chip/dma.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

class AdcPair;

/// Found here: "adc_regulator_too_soon", "adc_regulator_off", "adc_calibration_while_enabled",
/// "adc_calibration_with_dma", "adc_busy_calibrating", "adc_not_calibrated", "adc_enable_too_soon",
/// "adc_disable_while_started", "adc_start_before_ready", "adc_setting_while_started",
/// "adc_setting_while_enabled", "adc_no_clock", "adc_too_fast", "adc_too_slow",
/// "adc_clock_changed", "adc_overrun", "adc_oversampling_overflow", "not_modelled".
class Adc final : public RegisterBlock {
 public:
  Adc(Context context, const std::string& name, AdcPair& pair, bool master);

  bool enabled() const { return has(0x08, 1); }
  bool ready() const { return enabled() && stable_; }
  bool started() const { return has(0x08, 4); }
  unsigned channel() const { return field(stored(0x30), 6, 5); }
  /// Cycles of a whole conversion, twice, with all that is summed up.
  std::uint32_t half_cycles() const;
  /// What two converters of a pair must have alike.
  std::uint32_t pair_settings() const;
  bool waits_for_trigger(unsigned selection) const;
  bool uses_dma() const { return has(0x0C, 1); }
  bool dma_goes_round() const { return has(0x0C, 2); }
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
  bool rested_ = true;  ///< No conversion yet since calibration.
  double input_v_ = 0.0;
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
/// "adc_slave_not_ready", "adc_channel_not_connected", "adc_pin_not_analog", "adc_dma_one_shot".
class AdcPair {
 public:
  AdcPair(Context context, Clocks& clocks, DmaRequests& requests);

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
  bool first_result_is_wrong = true;
  static constexpr double kReference_v = 3.3;
  /// Conversions that have ended.
  std::uint64_t conversions() const { return conversions_; }
  void abort() { context_.events.cancel(std::exchange(busy_, 0)); }
  void check_settings(bool both);

 private:
  double input_v(const Adc& adc);
  void finish(bool both);
  void hand_over(bool both);

  Context context_;
  Clocks& clocks_;
  DmaRequests& requests_;
  std::function<double(unsigned)> input_;
  std::function<bool(unsigned)> analog_;
  Events::Id busy_ = 0;
  std::uint64_t conversions_ = 0;
  bool dead_ = false;
};

}  // namespace emax::chip
