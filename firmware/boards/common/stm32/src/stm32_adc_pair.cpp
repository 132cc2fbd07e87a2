// From the regulator to the first trigger, in the order that the converters need.
#include "emax/board/stm32_adc_pair.hpp"

#include "emax/board/cycle_counter.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kStatus = 0x00;
constexpr std::uintptr_t kControl = 0x08;
constexpr std::uintptr_t kConfiguration = 0x0C;
constexpr std::uintptr_t kConfiguration2 = 0x10;
constexpr std::uintptr_t kPreselection = 0x1C;
constexpr std::uintptr_t kSequence1 = 0x30;
constexpr std::uintptr_t kData = 0x40;
// From those of both on.
constexpr std::uintptr_t kCommonControl = 0x08;
constexpr std::uintptr_t kCommonData = 0x0C;

constexpr std::uint32_t kReady = 1U << 0;
constexpr std::uint32_t kConverted = 1U << 2;
constexpr std::uint32_t kAllFlags = 0x7FF;

// Bits of the control register that begin something when written as 1 are never written back; the
// others stay, as some of them tell of the calibration.
constexpr std::uint32_t kBegins = 0x8000003F;
constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kDisable = 1U << 1;
constexpr std::uint32_t kStart = 1U << 2;
constexpr std::uint32_t kStop = 1U << 4;
constexpr std::uint32_t kCalibrate = 1U << 31;

constexpr std::uint32_t kRegulator_us = 30;
constexpr std::uint32_t kMost_us = 1'000;
constexpr std::uint32_t kPauseBetween_us = 10;

void command(std::uintptr_t adc, std::uint32_t bits) noexcept {
  reg(adc + kControl) = (reg(adc + kControl) & ~kBegins) | bits;
}

bool is_cleared(std::uintptr_t adc, std::uint32_t bits, std::uint32_t most_us) noexcept {
  return wait_for([=] { return (reg(adc + kControl) & bits) == 0; }, most_us);
}

bool is_flagged(std::uintptr_t adc, std::uint32_t flag) noexcept {
  return wait_for([=] { return (reg(adc + kStatus) & flag) == flag; }, kMost_us);
}

bool enable(std::uintptr_t adc) noexcept {
  reg(adc + kStatus) = kAllFlags;
  // The bit is not taken within four cycles of the calibration's end, so it is set until it is.
  return wait_for(
      [=] {
        if ((reg(adc + kControl) & kEnable) == 0) {
          command(adc, kEnable);
        }
        return (reg(adc + kStatus) & kReady) != 0;
      },
      kMost_us);
}

void configure(const AdcInput& input, std::uint32_t configuration, std::uint32_t average) noexcept {
  reg(input.adc + kConfiguration) = configuration;
  reg(input.adc + kConfiguration2) = average;
  reg(input.adc + input.time_at) = input.time;
  if (input.preselect != 0) {
    reg(input.adc + kPreselection) = input.preselect;
  }
  reg(input.adc + kSequence1) = input.channel << 6U;
}

// @returns False if it does not stop: then it takes nothing else either.
bool switch_off(std::uintptr_t adc) noexcept {
  if ((reg(adc + kControl) & kStart) != 0) {
    command(adc, kStop);
    if (!is_cleared(adc, kStop | kStart, kMost_us)) {
      return false;
    }
  }
  if ((reg(adc + kControl) & kEnable) != 0) {
    command(adc, kDisable);
  }
  return is_cleared(adc, kDisable | kEnable | kCalibrate, kMost_us);
}

}  // namespace

std::uintptr_t Stm32AdcPair::data_register() const noexcept {
  return settings_->common + kCommonData;
}

bool Stm32AdcPair::power_up() noexcept {
  const std::uintptr_t adcs[] = {settings_->reference.adc, settings_->device.adc};
  for (const std::uintptr_t adc : adcs) {
    // Out of deep power down, which is a write by itself.
    reg(adc + kControl) = 0;
    reg(adc + kControl) = settings_->on;
  }
  pause_us(kRegulator_us);
  return is_flagged(settings_->reference.adc, settings_->is_powered) &&
         is_flagged(settings_->device.adc, settings_->is_powered);
}

// By one alone, before anything of DMA is set.
bool Stm32AdcPair::measure() noexcept {
  const AdcInput& input = settings_->reference;
  if (!enable(input.adc)) {
    return false;
  }
  configure(input, settings_->no_trigger, settings_->average);
  start_cycle_counter();
  const std::uint32_t begin = cycles();
  command(input.adc, kStart);
  const bool is_done = is_flagged(input.adc, kConverted);
  conversion_cycles_ = cycles() - begin;
  const std::uint32_t result = reg(input.adc + kData);
  (void)result;
  constexpr std::uint32_t kCyclesPer_us = EMAX_BOARD_CLOCK_HZ / 1'000'000;
  const bool is_in_time = conversion_cycles_ <= settings_->most_conversion_us * kCyclesPer_us;
  return switch_off(input.adc) && is_done && is_in_time;
}

Status Stm32AdcPair::prepare() noexcept {
  conversion_cycles_ = 0;
  if (!stop()) {
    return Status::kHardwareFault;
  }
  const std::uintptr_t adcs[] = {settings_->reference.adc, settings_->device.adc};
  // The clock first, as a calibration is that of its clock; and that alone, as it goes wrong with
  // DMA on: the stream before this one has left it so, in each converter's own settings, too.
  reg(settings_->common + kCommonControl) = settings_->clock;
  if (!power_up()) {
    return Status::kHardwareFault;
  }
  for (const std::uintptr_t adc : adcs) {
    reg(adc + kConfiguration) = settings_->no_trigger;
    command(adc, settings_->calibrate);
    if (!is_cleared(adc, kCalibrate, settings_->most_calibration_us)) {
      return Status::kHardwareFault;
    }
  }
  if (settings_->most_conversion_us != 0 && !measure()) {
    return Status::kHardwareFault;
  }
  reg(settings_->common + kCommonControl) = settings_->clock | settings_->together;
  // One after the other, with a pause: two at once have been seen to come up wrong.
  for (const std::uintptr_t adc : adcs) {
    pause_us(kPauseBetween_us);
    if (!enable(adc)) {
      return Status::kHardwareFault;
    }
  }
  configure(settings_->reference, settings_->reference.configure, settings_->average);
  configure(settings_->device, settings_->device.configure, settings_->average);
  return Status::kOk;
}

void Stm32AdcPair::start() noexcept { command(settings_->reference.adc, kStart); }

bool Stm32AdcPair::stop() noexcept {
  const bool is_master_off = switch_off(settings_->reference.adc);
  return switch_off(settings_->device.adc) && is_master_off;
}

bool Stm32AdcPair::has_overrun() const noexcept {
  return ((reg(settings_->reference.adc + kStatus) | reg(settings_->device.adc + kStatus)) &
          settings_->overrun) != 0;
}

}  // namespace emax::board
