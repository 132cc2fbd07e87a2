// Counts of 32 bits, of which only differences mean something.
#include "emax/board/converter_rings.hpp"

namespace emax::board {
namespace {

// What clock and counts may be apart, since they are not read at the same moment.
constexpr std::uint32_t kMostDrift = 2;
// While a block's place is used, the hardware stays this far away from it.
constexpr std::int32_t kMargin = 3;

std::int32_t difference(std::uint32_t a, std::uint32_t b) noexcept {
  return static_cast<std::int32_t>(a - b);
}

bool is_apart(std::int32_t frames) noexcept {
  return frames > static_cast<std::int32_t>(kMostDrift) ||
         frames < -static_cast<std::int32_t>(kMostDrift);
}

}  // namespace

// The count nearest to what is expected that has this place in the ring.
std::uint32_t ConverterRings::nearest(std::uint32_t left, std::uint32_t expected) const noexcept {
  const std::uint32_t ahead = (ring_frames_ - left - expected) & mask();
  return ahead < ring_frames_ / 2 ? expected + ahead : expected + ahead - ring_frames_;
}

void ConverterRings::start(bool is_output_ahead, std::uint32_t fetched) noexcept {
  ahead_ = is_output_ahead ? 1 : 0;
  fetched_ = fetched;
  next_ = 0;
  input_ = 0;
  input_lag_ = 0;
  output_lead_ = 0;
}

RingState ConverterRings::settle(const RingLook& look) noexcept {
  // The first turn: the places are the counts.
  input_ = (ring_frames_ - look.input_left) & mask();
  if (input_ < block_frames_) {
    return RingState::kWaiting;
  }
  // The clock counts the frame that is under way, and the output may have fetched two more.
  input_lag_ = look.clock_frames - input_;
  output_lead_ = nearest(look.output_left, input_) - input_;
  next_ = block_frames_;
  if (input_lag_ > kMostDrift) {
    return RingState::kLost;
  }
  return output_lead_ > ahead_ + fetched_ + kMostDrift ? RingState::kOutputStopped
                                                       : RingState::kHere;
}

RingState ConverterRings::look(const RingLook& look) noexcept {
  const std::uint32_t expected = look.clock_frames - input_lag_;
  const std::uint32_t input = nearest(look.input_left, expected);
  const std::uint32_t output_expected = expected + output_lead_;
  const bool has_moved = input != input_;
  input_ = input;
  const std::int32_t drift = difference(input, expected);
  if (is_apart(drift)) {
    // Inputs that stand still are late; whether they ever come, time will tell.
    return has_moved ? RingState::kLost : RingState::kWaiting;
  }
  const std::int32_t lead = difference(nearest(look.output_left, output_expected), output_expected);
  if (is_apart(lead)) {
    return RingState::kOutputStopped;
  }
  if (is_too_late(input)) {
    return RingState::kLost;
  }
  const bool is_here = difference(input, next_) >= static_cast<std::int32_t>(block_frames_);
  return is_here ? RingState::kHere : RingState::kWaiting;
}

bool ConverterRings::finish(const RingLook& look) noexcept {
  if (is_too_late(nearest(look.input_left, look.clock_frames - input_lag_))) {
    return false;
  }
  next_ += block_frames_;
  return true;
}

bool ConverterRings::is_too_late(std::uint32_t input) const noexcept {
  return difference(input, next_) > static_cast<std::int32_t>(ring_frames_) - kMargin;
}

}  // namespace emax::board
