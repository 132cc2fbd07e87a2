// Timer -> ADC1 and ADC2 -> DMA -> memory -> DMA -> DAC1.
#include "emax/board/stm32_stream.hpp"

#include "emax/board/converter_words.hpp"
#include "emax/board/dma_memory.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kTimerControl1 = 0x00;
constexpr std::uintptr_t kTimerControl2 = 0x04;
constexpr std::uintptr_t kTimerStatus = 0x10;
constexpr std::uintptr_t kTimerCount = 0x24;
constexpr std::uintptr_t kTimerPrescaler = 0x28;
constexpr std::uintptr_t kTimerAutoReload = 0x2C;
constexpr std::uint32_t kTimerOn = 1U << 0;
constexpr std::uint32_t kTriggerAtUpdate = 2U << 4;

// Until the DAC has asked for its first value, if it does so before the first trigger.
constexpr std::uint32_t kFirstRequest_us = 5;

// Where DMA reaches them: the board's memory.ld, or sections.ld.
[[gnu::section(".bss.dma"), gnu::aligned(32)]] volatile std::uint32_t output_ring[kRingFrames];
[[gnu::section(".bss.dma"), gnu::aligned(32)]] volatile std::uint32_t input_ring[kRingFrames];

void fill(volatile std::uint32_t (&ring)[kRingFrames], std::uint32_t value) noexcept {
  for (volatile std::uint32_t& word : ring) {
    word = value;
  }
}

}  // namespace

void Stm32Stream::lose_clock() noexcept {
  is_clock_exact_.store(false, std::memory_order_relaxed);
  stop_output();
}

void Stm32Stream::on_output_interrupt() noexcept {
  output_halves_ += output_dma_.take_halves();
  const std::uint32_t end_of_next = (output_halves_ + 1) * (kRingFrames / 2);
  const std::uint32_t written = output_written_.load(std::memory_order_relaxed);
  if (static_cast<std::int32_t>(written - end_of_next) < 0) {
    is_starved_.store(true, std::memory_order_relaxed);
    stop_output();
  }
}

bool Stm32Stream::force_to_zero() noexcept {
  (void)stop();
  if (!drive_is_at_zero()) {
    (void)do_ramp_to_zero(limits().step_per_frame);
    do_stop();
  }
  return drive_is_at_zero();
}

Status Stm32Stream::check_inputs() noexcept {
  const Status prepared = inputs_.prepare();
  return inputs_.stop() ? prepared : Status::kHardwareFault;
}

Status Stm32Stream::do_start() noexcept {
  if (!is_clock_exact_.load(std::memory_order_relaxed) || !do_drive_is_at_zero()) {
    return Status::kHardwareFault;
  }
  fill(output_ring, kMidScale);
  fill(input_ring, 0);
  finish_writes();
  if (inputs_.prepare() != Status::kOk || !start_dma()) {
    return Status::kHardwareFault;
  }
  start_timer();
  return settle() ? Status::kOk : Status::kHardwareFault;
}

bool Stm32Stream::start_dma() noexcept {
  if (!input_dma_.start(inputs_.data_register(), dma_address(input_ring), kRingFrames, false)) {
    return false;
  }
  inputs_.start();
  is_starved_.store(false, std::memory_order_relaxed);
  output_halves_ = 0;
  output_written_.store(kRingFrames, std::memory_order_relaxed);
  if (!output_dma_.start(dac_.data_register(), dma_address(output_ring), kRingFrames, true)) {
    return false;
  }
  // What DMA has fetched for itself, so that it is quick, the DAC does not have yet.
  const std::uint32_t left = output_dma_.left();
  dac_.follow_timer();
  pause_us(kFirstRequest_us);
  rings_.start(output_dma_.left() != left, kRingFrames - left);
  return true;
}

void Stm32Stream::start_timer() noexcept {
  const std::uintptr_t timer = settings_.dac.timer;
  // No update by software, which would be a trigger.
  reg(timer + kTimerControl1) = 0;
  reg(timer + kTimerControl2) = kTriggerAtUpdate;
  reg(timer + kTimerPrescaler) = 0;
  reg(timer + kTimerAutoReload) = settings_.timer_hz / 1'000'000 * settings_.frame_us - 1;
  reg(timer + kTimerCount) = 0;
  reg(timer + kTimerStatus) = 0;
  reg(timer + kTimerControl1) = kTimerOn;
  clock_us_ = timebase_us();
  clock_frames_ = 0;
  first_frame_ = 0;
}

bool Stm32Stream::settle() noexcept {
  Deadline deadline(most_wait_us());
  for (;;) {
    const RingState state = rings_.settle(look());
    if (state != RingState::kWaiting) {
      return state == RingState::kHere && fault() == Status::kOk;
    }
    if (deadline.passed()) {
      return false;
    }
  }
}

hal::Exchange Stm32Stream::do_exchange(Span<const hal::Word> drive,
                                       Span<hal::Frame> response) noexcept {
  const Status waited = wait_for_block();
  if (waited != Status::kOk) {
    return {waited, first_frame_};
  }
  for (std::uint32_t i = 0; i < kBlockFrames; ++i) {
    response[i] = frame_of_adcs(input_ring[rings_.input_place(i)]);
    output_ring[rings_.output_place(i)] = dac_of_word(drive[i]);
  }
  finish_writes();
  if (!rings_.finish(look())) {
    return {Status::kLostBlock, first_frame_};
  }
  output_written_.store(rings_.output_written(), std::memory_order_relaxed);
  const hal::Exchange done = {fault(), first_frame_};
  first_frame_ += kBlockFrames;
  return done;
}

Status Stm32Stream::wait_for_block() noexcept {
  Deadline deadline(most_wait_us());
  for (;;) {
    const Status status = fault();
    if (status != Status::kOk) {
      return status;
    }
    switch (rings_.look(look())) {
      case RingState::kHere:
        return Status::kOk;
      case RingState::kLost:
        return Status::kLostBlock;
      case RingState::kOutputStopped:
        return Status::kHardwareFault;
      case RingState::kWaiting:
        break;
    }
    if (deadline.passed()) {
      return Status::kLateBlock;
    }
  }
}

Status Stm32Stream::fault() const noexcept {
  if (!is_clock_exact_.load(std::memory_order_relaxed) || input_dma_.has_failed() ||
      output_dma_.has_failed() || dac_.has_underrun()) {
    return Status::kHardwareFault;
  }
  const bool is_lost = is_starved_.load(std::memory_order_relaxed) || inputs_.has_overrun();
  return is_lost ? Status::kLostBlock : Status::kOk;
}

RingLook Stm32Stream::look() noexcept {
  const std::uint32_t input_left = input_dma_.left();
  const std::uint32_t output_left = output_dma_.left();
  const std::uint32_t passed = (timebase_us() - clock_us_) / settings_.frame_us;
  clock_us_ += passed * settings_.frame_us;
  clock_frames_ += passed;
  return {clock_frames_, input_left, output_left};
}

void Stm32Stream::stop_output() noexcept {
  dac_.hold();
  output_dma_.hold();
}

std::uint32_t Stm32Stream::do_ramp_to_zero(hal::Word step_per_frame) noexcept {
  // It asks DMA for nothing more, first of all.
  return dac_.ramp_to_zero(step_per_frame);
}

void Stm32Stream::do_stop() noexcept {
  stop_output();
  reg(settings_.dac.timer + kTimerControl1) = 0;
  (void)inputs_.stop();
  input_dma_.stop();
  output_dma_.stop();
  dac_.rest();
}

bool Stm32Stream::do_drive_is_at_zero() const noexcept { return dac_.word() == 0; }

}  // namespace emax::board
