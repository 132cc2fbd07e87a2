// The integral of |k| from zero to zero of k.
#include "emax/absolute_error.hpp"

#include "emax/elementary.hpp"
#include "emax/units.hpp"

namespace emax {
namespace {

constexpr double kMaxSamples = 1048576.0;
constexpr double kSamplesPerPeriod = 64.0;

double samples_for(const ModalModel& model, double duration_s) noexcept {
  double fastest = 0.0;
  for (const Mode& mode : model.modes()) {
    const double rate = norm(mode.pole);
    fastest = rate > fastest ? rate : fastest;
  }
  return floor(kSamplesPerPeriod / kTwoPi * sqrt(fastest) * duration_s) + 1.0;
}

/// Where k has its zero between two times at which its signs differ, to neighbouring doubles.
double zero_between(const ModalModel& model, double low_s, double high_s) noexcept {
  const bool positive_at_high = model.impulse_response(high_s) > 0.0;
  for (int i = 0; i < 64; ++i) {
    const double middle_s = low_s + 0.5 * (high_s - low_s);
    if (!(middle_s > low_s && middle_s < high_s)) {
      break;
    }
    if ((model.impulse_response(middle_s) > 0.0) == positive_at_high) {
      high_s = middle_s;
    } else {
      low_s = middle_s;
    }
  }
  return high_s;
}

}  // namespace

AbsoluteError largest_absolute_error(const ModalModel& model, double duration_s) noexcept {
  AbsoluteError result;
  const double samples = samples_for(model, duration_s);
  if (!(duration_s > 0.0) || !(samples <= kMaxSamples)) {
    result.status = Status::kInvalidArgument;
    return result;
  }
  double zeros_s[kMaxSwitches];
  std::size_t count = 0;
  double last_step = 0.0;
  double last_s = 0.0;
  // k(0) may be 0: the first sign is that of the first sample.
  const auto last = static_cast<std::uint32_t>(samples);
  bool positive = model.impulse_response(duration_s / samples) > 0.0;
  for (std::uint32_t i = 2; i <= last; ++i) {
    const double time_s = duration_s * (static_cast<double>(i) / samples);
    const bool next = model.impulse_response(time_s) > 0.0;
    if (next == positive) {
      last_s = time_s;
      continue;
    }
    const double before_s = i == 2 ? duration_s / samples : last_s;
    const double zero_s = zero_between(model, before_s, time_s);
    const double step = model.step_response(zero_s);
    result.value += abs(step - last_step);
    last_step = step;
    positive = next;
    last_s = time_s;
    if (count < kMaxSwitches) {
      zeros_s[count] = zero_s;
    }
    ++count;
  }
  result.value += abs(model.step_response(duration_s) - last_step);
  if (count > kMaxSwitches) {
    result.status = Status::kTooManySwitches;
    return result;
  }
  // The last zero is the first switch; a zero at T itself would be a switch at 0.
  for (std::size_t i = 0; i < count / 2; ++i) {
    const double early_s = zeros_s[i];
    zeros_s[i] = zeros_s[count - 1 - i];
    zeros_s[count - 1 - i] = early_s;
  }
  for (std::size_t i = 0; i < count; ++i) {
    zeros_s[i] = duration_s - zeros_s[i];
  }
  const std::size_t at_start = count > 0 && !(zeros_s[0] > 0.0) ? 1 : 0;
  const Span<const double> times_s(zeros_s + at_start, count - at_start);
  result.status = result.signal.set(times_s, duration_s);
  return result;
}

}  // namespace emax
