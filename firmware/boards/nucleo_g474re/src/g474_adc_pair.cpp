// From the regulator to the first trigger, in the order that the converters need.
#include "emax/board/g474_adc_pair.hpp"

#include "emax/board/g474.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kStatus = 0x00;
constexpr std::uintptr_t kControl = 0x08;
constexpr std::uintptr_t kConfiguration = 0x0C;
constexpr std::uintptr_t kConfiguration2 = 0x10;
constexpr std::uintptr_t kSampleTimes1 = 0x14;
constexpr std::uintptr_t kSequence1 = 0x30;
constexpr std::uintptr_t kCommonControl = kAdcCommon + 0x08;
constexpr std::uintptr_t kCommonData = kAdcCommon + 0x0C;

constexpr std::uint32_t kReady = 1U << 0;
constexpr std::uint32_t kOverrun = 1U << 4;
constexpr std::uint32_t kAllFlags = 0x7FF;

// Bits of the control register begin something when written as 1, so it is never read back into
// itself: only the regulator's bit stays.
constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kDisable = 1U << 1;
constexpr std::uint32_t kStart = 1U << 2;
constexpr std::uint32_t kStop = 1U << 4;
constexpr std::uint32_t kRegulator = 1U << 28;
constexpr std::uint32_t kCalibrate = 1U << 31;

// A quarter of the bus clock and in step with it (3): 42.5 MHz.
constexpr std::uint32_t kClock = 3U << 16;
// Both at once (6), results together by DMA (2) that goes round (1).
constexpr std::uint32_t kTogether = 6U << 0 | 1U << 13 | 2U << 14;
// The injected queue is off, as after a reset. Only the master needs the trigger: TIM6 (13), its
// rising edge (1).
constexpr std::uint32_t kNoQueue = 1U << 31;
constexpr std::uint32_t kMasterTrigger = 13U << 5 | 1U << 10;
// 32 conversions (4), their sum shifted by one.
constexpr std::uint32_t kMeanOf32 = 1U << 0 | 4U << 2 | 1U << 5;
// 12.5 cycles to sample: 32 times 25 cycles are 18.8 us of the 20 us of a frame.
constexpr std::uint32_t kSample12Cycles = 2;

constexpr std::uint32_t kRegulator_us = 30;
constexpr std::uint32_t kMostCalibration_us = 5'000;
constexpr std::uint32_t kMost_us = 1'000;
constexpr std::uint32_t kPauseBetween_us = 10;

struct Input {
  std::uintptr_t adc;
  unsigned channel;
};
constexpr Input kReference = {kAdc1, 1};
constexpr Input kDevice = {kAdc2, 2};
constexpr Input kInputs[] = {kReference, kDevice};

bool is_cleared(std::uintptr_t adc, std::uint32_t bits, std::uint32_t most_us) noexcept {
  return wait_for([=] { return (reg(adc + kControl) & bits) == 0; }, most_us);
}

bool calibrate(std::uintptr_t adc) noexcept {
  reg(adc + kControl) = kRegulator | kCalibrate;
  return is_cleared(adc, kCalibrate, kMostCalibration_us);
}

bool enable(std::uintptr_t adc) noexcept {
  reg(adc + kStatus) = kAllFlags;
  // The bit is not taken within four cycles of the calibration's end, so it is set until it is.
  return wait_for(
      [=] {
        if ((reg(adc + kControl) & kEnable) == 0) {
          reg(adc + kControl) = kRegulator | kEnable;
        }
        return (reg(adc + kStatus) & kReady) != 0;
      },
      kMost_us);
}

void configure(const Input& input, std::uint32_t trigger) noexcept {
  reg(input.adc + kConfiguration) = kNoQueue | trigger;
  reg(input.adc + kConfiguration2) = kMeanOf32;
  reg(input.adc + kSampleTimes1) = kSample12Cycles << (3 * input.channel);
  reg(input.adc + kSequence1) = input.channel << 6U;
}

// @returns False if it does not stop: then it takes nothing else either.
bool switch_off(std::uintptr_t adc) noexcept {
  if ((reg(adc + kControl) & kStart) != 0) {
    reg(adc + kControl) = kRegulator | kStop;
    if (!is_cleared(adc, kStop | kStart, kMost_us)) {
      return false;
    }
  }
  if ((reg(adc + kControl) & kEnable) != 0) {
    reg(adc + kControl) = kRegulator | kDisable;
  }
  return is_cleared(adc, kDisable | kEnable | kCalibrate, kMost_us);
}

}  // namespace

std::uintptr_t G474AdcPair::data_register() noexcept { return kCommonData; }

Status G474AdcPair::prepare() noexcept {
  if (!stop()) {
    return Status::kHardwareFault;
  }
  // The clock first, as a calibration is that of its clock; and that alone, as it goes wrong with
  // DMA on.
  reg(kCommonControl) = kClock;
  for (const Input& input : kInputs) {
    // Out of deep power down, which is a write by itself.
    reg(input.adc + kControl) = 0;
    reg(input.adc + kControl) = kRegulator;
  }
  pause_us(kRegulator_us);
  for (const Input& input : kInputs) {
    if (!calibrate(input.adc)) {
      return Status::kHardwareFault;
    }
  }
  reg(kCommonControl) = kClock | kTogether;
  // One after the other, with a pause: two at once have been seen to come up wrong.
  for (const Input& input : kInputs) {
    pause_us(kPauseBetween_us);
    if (!enable(input.adc)) {
      return Status::kHardwareFault;
    }
  }
  configure(kReference, kMasterTrigger);
  configure(kDevice, 0);
  return Status::kOk;
}

void G474AdcPair::start() noexcept { reg(kAdc1 + kControl) = kRegulator | kStart; }

bool G474AdcPair::stop() noexcept {
  const bool is_master_off = switch_off(kAdc1);
  return switch_off(kAdc2) && is_master_off;
}

bool G474AdcPair::has_overrun() const noexcept {
  return ((reg(kAdc1 + kStatus) | reg(kAdc2 + kStatus)) & kOverrun) != 0;
}

}  // namespace emax::board
