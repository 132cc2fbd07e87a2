// ADC1 and ADC2 of an STM32G4 or STM32H7, which convert both inputs at the same moments.
#pragma once

#include <cstdint>

#include "emax/base/status.hpp"

namespace emax::board {

/// One of both.
struct AdcInput {
  std::uintptr_t adc;       ///< Its registers.
  std::uint32_t channel;    ///< Of the pin.
  std::uint32_t configure;  ///< CFGR while the stream runs.
  std::uintptr_t time_at;   ///< SMPR1 or SMPR2, from `adc` on: that of the channel.
  std::uint32_t time;       ///< What goes there.
  std::uint32_t preselect;  ///< PCSEL, of chips that have it; 0 of others.
};

/// What differs from chip to chip.
struct AdcPairSettings {
  AdcInput reference;        ///< ADC1, the master: timer's trigger and DMA are its own.
  AdcInput device;           ///< ADC2.
  std::uintptr_t common;     ///< Registers of both.
  std::uint32_t clock;       ///< CCR while they are calibrated,
  std::uint32_t together;    ///< and what is added: both at once, results by DMA.
  std::uint32_t no_trigger;  ///< CFGR for a conversion that the program starts.
  std::uint32_t average;     ///< CFGR2: how many conversions make a result.
  std::uint32_t on;          ///< CR: the regulator, and what goes with the clock.
  std::uint32_t calibrate;   ///< CR: begins a calibration.
  std::uint32_t is_powered;  ///< ISR, once the regulator is ready; 0 where it does not tell.
  std::uint32_t overrun;     ///< ISR: a result was not fetched; 0 where that means nothing.
  std::uint32_t most_calibration_us;
  /// The most that a result may take, which is then measured, as on some chips nobody is sure of
  /// the clock; 0: it is not.
  std::uint32_t most_conversion_us;
};

/// Both start at the triggers of a timer. A result of each is the mean of some conversions, scaled
/// to 16 bits; both come as one word, the reference in the lower half, the device in the upper one.
class Stm32AdcPair {
 public:
  constexpr explicit Stm32AdcPair(const AdcPairSettings& settings) noexcept
      : settings_(&settings) {}

  /// With other settings from now on, as another revision of the chip needs them.
  void use(const AdcPairSettings& settings) noexcept { settings_ = &settings; }

  /// Where DMA fetches both results.
  std::uintptr_t data_register() const noexcept;

  /// Switches both on and calibrates them, which takes some 0.3 ms on an STM32G4 and some 13 ms on
  /// an STM32H7. Their DMA does not run.
  /// @returns kOk, or kHardwareFault if one of them does not get ready, or a result takes longer
  /// than there is time for; `stop()` follows.
  Status prepare() noexcept;

  /// Lets them wait for the first trigger. Their DMA runs.
  void start() noexcept;

  /// Also after a start that failed halfway. @returns False if one of them does not stop.
  bool stop() noexcept;

  /// @returns True if a result was not fetched in time.
  bool has_overrun() const noexcept;

  /// @returns What one result took at the last start, in cycles of the processor; 0 if that was not
  /// measured.
  std::uint32_t conversion_cycles() const noexcept { return conversion_cycles_; }

 private:
  bool power_up() noexcept;
  bool measure() noexcept;

  const AdcPairSettings* settings_;
  std::uint32_t conversion_cycles_ = 0;
};

}  // namespace emax::board
