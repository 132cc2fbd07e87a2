// The drive's last step, and its way to zero.
#include "emax/board/stm32_dac.hpp"

#include "emax/board/converter_words.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kControl = 0x00;
constexpr std::uintptr_t kLeftJustified = 0x0C;  // DHR12L1.
constexpr std::uintptr_t kOutput = 0x2C;         // DOR1.
constexpr std::uintptr_t kStatus = 0x34;
constexpr std::uintptr_t kMode = 0x3C;

constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kTriggered = 1U << 1;
constexpr unsigned kTriggerAt = 2;
constexpr std::uint32_t kDma = 1U << 12;
constexpr std::uint32_t kUnderrun = 1U << 13;
constexpr std::uint32_t kOutputBits = 0xFFF;

constexpr std::uintptr_t kTimerStatus = 0x10;
constexpr std::uint32_t kUpdate = 1U << 0;

// Its amplifier needs 10 us from being switched on; what it is given before it takes late.
constexpr std::uint32_t kWakeUp_us = 20;
// A look takes eight cycles or more: three frames of 20 us at 170 MHz are past, or half a one.
constexpr std::uint32_t kMostLooks = 4000;
constexpr std::uint32_t kLooksWithoutTrigger = 400;

}  // namespace

std::uintptr_t Stm32Dac::data_register() const noexcept { return settings_.base + kLeftJustified; }

void Stm32Dac::park(std::uint32_t mode) const noexcept {
  // Its mode is taken while it is off only, and its value must be there before it is on: with
  // triggers from the start the pin would go to 0 V, which is the drive's full scale.
  reg(settings_.base + kControl) = 0;
  reg(settings_.base + kMode) = mode;
  reg(settings_.base + kLeftJustified) = kMidScale;
  reg(settings_.base + kControl) = kEnable;
  pause_us(kWakeUp_us);
  reg(settings_.base + kLeftJustified) = kMidScale;
}

void Stm32Dac::follow_timer() const noexcept {
  const std::uint32_t control = kEnable | settings_.trigger << kTriggerAt;
  reg(settings_.base + kStatus) = kUnderrun;
  reg(settings_.base + kControl) = control;
  reg(settings_.base + kControl) = control | kTriggered;
  reg(settings_.base + kControl) = control | kTriggered | kDma;
}

void Stm32Dac::hold() const noexcept { reg(settings_.base + kControl) &= ~kDma; }

void Stm32Dac::rest() const noexcept {
  reg(settings_.base + kControl) = kEnable;
  reg(settings_.base + kLeftJustified) = kMidScale;
  reg(settings_.base + kStatus) = kUnderrun;
}

bool Stm32Dac::has_underrun() const noexcept {
  return (reg(settings_.base + kStatus) & kUnderrun) != 0;
}

hal::Word Stm32Dac::word() const noexcept {
  return word_of_dac(reg(settings_.base + kOutput) & kOutputBits);
}

std::uint32_t Stm32Dac::ramp_to_zero(hal::Word permitted_step) const noexcept {
  hold();
  hal::Word now = word();
  const hal::Word step = ramp_step(now, permitted_step);
  std::uint32_t frames = 0;
  std::uint32_t most_looks = kMostLooks;
  // One frame more than a ramp takes: a trigger may come between the two lines that follow.
  for (std::uint32_t i = 0; i <= hal::kMaxRampFrames; ++i) {
    reg(settings_.timer + kTimerStatus) = 0;
    const hal::Word next = towards_zero(now, step);
    reg(settings_.base + kLeftJustified) = dac_of_word(next);
    if (now == 0 && word() == 0) {
      break;
    }
    if (!wait_for_trigger(most_looks)) {
      // Nothing lets values out any more, so they do it themselves.
      most_looks = kLooksWithoutTrigger;
      reg(settings_.base + kControl) = kEnable;
      reg(settings_.base + kLeftJustified) = dac_of_word(next);
    }
    ++frames;
    const hal::Word out = word();
    const bool is_as_asked = dac_of_word(out) == dac_of_word(next);
    now = out == 0 || !is_as_asked ? out : next;
  }
  return frames;
}

bool Stm32Dac::wait_for_trigger(std::uint32_t most_looks) const noexcept {
  for (std::uint32_t look = 0; look < most_looks; ++look) {
    if ((reg(settings_.timer + kTimerStatus) & kUpdate) != 0) {
      return true;
    }
  }
  return false;
}

}  // namespace emax::board
