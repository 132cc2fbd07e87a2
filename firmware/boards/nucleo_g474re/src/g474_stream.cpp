// TIM6 -> ADC1 and ADC2 -> DMA1 channel 1 -> memory -> DMA1 channel 2 -> DAC1.
#include "emax/board/g474_stream.hpp"

#include "emax/board/converter_words.hpp"
#include "emax/board/dma_memory.hpp"
#include "emax/board/g474.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

// DMA1; channel 1 has the inputs, channel 2 the output.
constexpr std::uintptr_t kDmaStatus = kDma1 + 0x00;
constexpr std::uintptr_t kDmaClear = kDma1 + 0x04;
constexpr std::uintptr_t kInputChannel = kDma1 + 0x08;
constexpr std::uintptr_t kOutputChannel = kDma1 + 0x1C;
constexpr std::uintptr_t kCount = 0x04;
constexpr std::uintptr_t kPeripheral = 0x08;
constexpr std::uintptr_t kMemory = 0x0C;
constexpr std::uint32_t kChannelOn = 1U << 0;
constexpr std::uint32_t kAtEnd = 1U << 1;
constexpr std::uint32_t kAtHalf = 1U << 2;
constexpr std::uint32_t kFromMemory = 1U << 4;
// Round and round (5), memory goes on (7), words of 32 bits on both sides (8, 10): with 16 bits the
// DAC takes nothing.
constexpr std::uint32_t kRingOfWords = 1U << 5 | 1U << 7 | 2U << 8 | 2U << 10;
constexpr std::uint32_t kHighPriority = 2U << 12;
constexpr std::uint32_t kHighestPriority = 3U << 12;
constexpr std::uint32_t kFlagsOfBoth = 0xFF;
constexpr std::uint32_t kErrors = 1U << 3 | 1U << 7;
constexpr std::uint32_t kOutputAtEnd = 1U << 5;
constexpr std::uint32_t kOutputAtHalf = 1U << 6;

constexpr std::uintptr_t kInputRequest = kDmamux + 0x00;
constexpr std::uintptr_t kOutputRequest = kDmamux + 0x04;
constexpr std::uint32_t kRequestOfAdc1 = 5;
constexpr std::uint32_t kRequestOfDac1 = 6;

constexpr std::uintptr_t kTimerControl1 = kTim6 + 0x00;
constexpr std::uintptr_t kTimerControl2 = kTim6 + 0x04;
constexpr std::uintptr_t kTimerStatus = kTim6 + 0x10;
constexpr std::uintptr_t kTimerCount = kTim6 + 0x24;
constexpr std::uintptr_t kTimerPrescaler = kTim6 + 0x28;
constexpr std::uintptr_t kTimerAutoReload = kTim6 + 0x2C;
constexpr std::uint32_t kTimerOn = 1U << 0;
constexpr std::uint32_t kTriggerAtUpdate = 2U << 4;
static_assert(EMAX_BOARD_CLOCK_HZ % 1'000'000 == 0);
constexpr std::uint32_t kFrameCycles = EMAX_BOARD_CLOCK_HZ / 1'000'000 * kFrame_us;

// TIM6 (7) triggers.
constexpr Stm32Dac kDac({kDac1, kTim6, 7});
// Above 160 MHz the DAC needs the slower of its ways to the bus (HFSEL 2); 80 to 160 are not used.
constexpr std::uint32_t kSlowAccess = 2U << 14;
constexpr std::uint32_t kFastBus_hz = 160'000'000;

constexpr std::uint32_t kMostWait_us = 2 * kBlockFrames * kFrame_us;
// Until the DAC has asked for its first value, if it does so before the first trigger.
constexpr std::uint32_t kFirstRequest_us = 5;

// In SRAM1.
[[gnu::section(".bss.dma")]] volatile std::uint32_t output_ring[kRingFrames];
[[gnu::section(".bss.dma")]] volatile std::uint32_t input_ring[kRingFrames];

void set_up(std::uintptr_t channel, std::uintptr_t peripheral, std::uint32_t memory,
            std::uint32_t control) noexcept {
  reg(channel + kCount) = kRingFrames;
  reg(channel + kPeripheral) = static_cast<std::uint32_t>(peripheral);
  reg(channel + kMemory) = memory;
  reg(channel) = control;
  reg(channel) = control | kChannelOn;
}

}  // namespace

void G474Stream::park(std::uint32_t clock_hz) noexcept {
  kDac.park(clock_hz > kFastBus_hz ? kSlowAccess : 0);
}

void G474Stream::lose_clock() noexcept {
  is_clock_exact_.store(false, std::memory_order_relaxed);
  stop_output();
}

void G474Stream::on_output_interrupt() noexcept {
  const std::uint32_t flags = reg(kDmaStatus) & (kOutputAtEnd | kOutputAtHalf);
  reg(kDmaClear) = flags;
  output_halves_ += (flags & kOutputAtEnd) != 0 ? 1 : 0;
  output_halves_ += (flags & kOutputAtHalf) != 0 ? 1 : 0;
  const std::uint32_t end_of_next = (output_halves_ + 1) * (kRingFrames / 2);
  const std::uint32_t written = output_written_.load(std::memory_order_relaxed);
  if (static_cast<std::int32_t>(written - end_of_next) < 0) {
    is_starved_.store(true, std::memory_order_relaxed);
    stop_output();
  }
}

bool G474Stream::force_to_zero() noexcept {
  (void)stop();
  if (!drive_is_at_zero()) {
    (void)do_ramp_to_zero(limits().step_per_frame);
    do_stop();
  }
  return drive_is_at_zero();
}

Status G474Stream::do_start() noexcept {
  if (!is_clock_exact_.load(std::memory_order_relaxed) || !do_drive_is_at_zero()) {
    return Status::kHardwareFault;
  }
  for (volatile std::uint32_t& word : output_ring) {
    word = kMidScale;
  }
  finish_writes();
  if (inputs_.prepare() != Status::kOk) {
    return Status::kHardwareFault;
  }
  reg(kDmaClear) = kFlagsOfBoth;
  reg(kInputRequest) = kRequestOfAdc1;
  reg(kOutputRequest) = kRequestOfDac1;
  set_up(kInputChannel, G474AdcPair::data_register(), dma_address(input_ring),
         kRingOfWords | kHighPriority);
  inputs_.start();
  is_starved_.store(false, std::memory_order_relaxed);
  output_halves_ = 0;
  output_written_.store(kRingFrames, std::memory_order_relaxed);
  set_up(kOutputChannel, kDac.data_register(), dma_address(output_ring),
         kRingOfWords | kHighestPriority | kFromMemory | kAtEnd | kAtHalf);
  kDac.follow_timer();
  pause_us(kFirstRequest_us);
  rings_.start(reg(kOutputChannel + kCount) != kRingFrames);
  // No update by software, which would be a trigger.
  reg(kTimerControl1) = 0;
  reg(kTimerControl2) = kTriggerAtUpdate;
  reg(kTimerPrescaler) = 0;
  reg(kTimerAutoReload) = kFrameCycles - 1;
  reg(kTimerCount) = 0;
  reg(kTimerStatus) = 0;
  reg(kTimerControl1) = kTimerOn;
  clock_us_ = timebase_us();
  clock_frames_ = 0;
  first_frame_ = 0;
  return settle() ? Status::kOk : Status::kHardwareFault;
}

bool G474Stream::settle() noexcept {
  Deadline deadline(kMostWait_us);
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

hal::Exchange G474Stream::do_exchange(Span<const hal::Word> drive,
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

Status G474Stream::wait_for_block() noexcept {
  Deadline deadline(kMostWait_us);
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

Status G474Stream::fault() const noexcept {
  if (!is_clock_exact_.load(std::memory_order_relaxed) || (reg(kDmaStatus) & kErrors) != 0 ||
      kDac.has_underrun()) {
    return Status::kHardwareFault;
  }
  const bool is_lost = is_starved_.load(std::memory_order_relaxed) || inputs_.has_overrun();
  return is_lost ? Status::kLostBlock : Status::kOk;
}

RingLook G474Stream::look() noexcept {
  const std::uint32_t input_left = reg(kInputChannel + kCount);
  const std::uint32_t output_left = reg(kOutputChannel + kCount);
  const std::uint32_t passed = (timebase_us() - clock_us_) / kFrame_us;
  clock_us_ += passed * kFrame_us;
  clock_frames_ += passed;
  return {clock_frames_, input_left, output_left};
}

void G474Stream::stop_output() noexcept {
  kDac.hold();
  reg(kOutputChannel) &= ~kChannelOn;
}

std::uint32_t G474Stream::do_ramp_to_zero(hal::Word step_per_frame) noexcept {
  stop_output();
  return kDac.ramp_to_zero(step_per_frame);
}

void G474Stream::do_stop() noexcept {
  stop_output();
  reg(kTimerControl1) = 0;
  (void)inputs_.stop();
  reg(kInputChannel) = 0;
  reg(kOutputChannel) = 0;
  kDac.rest();
}

bool G474Stream::do_drive_is_at_zero() const noexcept { return kDac.word() == 0; }

}  // namespace emax::board
