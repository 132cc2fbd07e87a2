// The integral of |k| from zero to zero of k.
#include "emax/model/absolute_error.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/model/cascade_response.hpp"

namespace emax {
namespace {

constexpr double kMaxSamples = 1048576.0;
constexpr double kSamplesPerPeriod = 64.0;
constexpr std::uint32_t kSamplesPerStep = 24;

double samples_for(const ModalModel& model, double duration_s) noexcept {
  double fastest = 0.0;
  for (const Mode& mode : model.modes()) {
    const double rate = norm(mode.pole);
    fastest = rate > fastest ? rate : fastest;
  }
  return floor(kSamplesPerPeriod / kTwoPi * sqrt(fastest) * duration_s) + 1.0;
}

/// By how much rounding may move a step response.
double step_rounding(const ModalModel& model) noexcept {
  double sum = abs(model.static_gain());
  for (std::size_t i = 0; i < model.modes().size(); ++i) {
    sum += sqrt(norm(model.modes()[i].residue) * norm(model.inverse_pole(i)));
  }
  return 8.0 * 0x1p-53 * sum;
}

/// The step response of the sensor itself, also where the modes are those of a neighbour.
double step_response(const ModalModel& model, double time_s) noexcept {
  CascadeResponse response;
  if (model.moved_by() == 0.0 || !response.start(model, time_s)) {
    return model.step_response(time_s);
  }
  response.advance(time_s, 1.0);
  return response.output();
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

Status AbsoluteError::start(const ModalModel& model, double duration_s) noexcept {
  *this = AbsoluteError();
  const double samples = samples_for(model, duration_s);
  if (!(duration_s > 0.0) || !(samples <= kMaxSamples)) {
    return Status::kInvalidArgument;
  }
  duration_s_ = duration_s;
  samples_ = samples;
  const OneSidedResponse constant = one_sided_response(model, duration_s);
  if (constant.holds) {
    value_ = constant.output;
    rounding_ = constant.output_rounding;
    return Status::kOk;
  }
  last_step_ = model.feedthrough();  // Just after 0.
  // If k(0) is 0 the first sign is that of the first sample.
  next_ = 1;
  if (model.starts_at_zero()) {
    last_s_ = duration_s / samples;
    next_ = 2;
  }
  positive_ = model.impulse_response(last_s_) > 0.0;
  running_ = true;
  return Status::kOk;
}

void AbsoluteError::take_zero(const ModalModel& model, double zero_s,
                              Span<double> zeros_s) noexcept {
  const double step = step_response(model, zero_s);
  value_ += abs(step - last_step_);
  last_step_ = step;
  if (zeros_ < zeros_s.size()) {
    zeros_s[zeros_] = zero_s;
  }
  ++zeros_;
}

void AbsoluteError::step(const ModalModel& model, Span<double> zeros_s) noexcept {
  const auto last = static_cast<std::uint32_t>(samples_);
  for (std::uint32_t k = 0; k < kSamplesPerStep && next_ <= last; ++k, ++next_) {
    const double time_s = duration_s_ * (static_cast<double>(next_) / samples_);
    const bool positive = model.impulse_response(time_s) > 0.0;
    if (positive != positive_) {
      take_zero(model, zero_between(model, last_s_, time_s), zeros_s);
    }
    positive_ = positive;
    last_s_ = time_s;
  }
  if (running_ && next_ > last) {
    value_ += abs(step_response(model, duration_s_) - last_step_);
    value_ += abs(model.feedthrough());
    rounding_ = static_cast<double>(2 * zeros_ + 1) * step_rounding(model);
    running_ = false;
  }
}

}  // namespace emax
