// Taylor steps of a chain of sections.
#include "emax/model/cascade_response.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr double kLongestStep = 0.5;  // Radians of the fastest pole.
constexpr double kOneSidedSteps = 1024.0;
/// Half units in the last place of the states: of poles and single steps; and of many steps, whose
/// roundings have no common sign and die away with the modes.
constexpr double kFirstRounding = 16.0 * 0x1p-53;
constexpr double kStepRounding = 4.0 * 0x1p-53;
/// A delayed filter begins with terms of both signs, which cancel while t is not much more than the
/// delay: they are this many times its output at most where the delay is not refused for it.
constexpr double kDelayedTerms = 64.0;
/// Squares below it are no longer numbers of full precision.
constexpr double kSmallest = 1e-290;

double larger(double a, double b) noexcept { return b > a ? b : a; }

/// The integral over a step of the square of a series of the part of the step.
template <std::size_t kTerms>
double square_of(const double (&series)[kTerms]) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < kTerms; ++i) {
    double row = 0.5 * series[i] / static_cast<double>(2 * i + 1);
    for (std::size_t j = 0; j < i; ++j) {
      row += series[j] / static_cast<double>(i + j + 1);
    }
    sum += 2.0 * series[i] * row;
  }
  return sum;
}

}  // namespace

bool CascadeResponse::start(const ModalModel& model, double duration_s) noexcept {
  *this = CascadeResponse();
  const Accelerometer& device = model.device();
  criterion_ = model.criterion();
  sensitivity_ = device.sensitivity;
  gain_ = model.filter().gain;
  is_ideal_ = device.natural_frequency_hz == 0.0;
  is_delayed_ = model.delay_s() > 0.0;
  fill_sections(model);
  const double w0 = kTwoPi * device.natural_frequency_hz;
  sensor_.speed2 = w0 * w0;
  sensor_.drag = 2.0 * device.damping * w0;
  double fastest2 = sensor_.speed2;
  for (const Mode& mode : model.filter().terms()) {
    fastest2 = larger(fastest2, norm(mode.pole));
  }
  longest_step_s_ = kLongestStep / sqrt(fastest2);
  if (is_delayed_) {
    fill_entry(model.delay_s());
  }
  return duration_s > 0.0 && duration_s <= static_cast<double>(kMaxSteps) * longest_step_s_;
}

/// In the order of the filter's modes.
void CascadeResponse::fill_sections(const ModalModel& model) noexcept {
  for (const Mode& mode : model.filter().terms()) {
    Section& section = sections_[count_++];
    section.is_single = mode.pole.im == 0.0;
    section.speed2 = section.is_single ? -mode.pole.re : norm(mode.pole);
    section.drag = -2.0 * mode.pole.re;
  }
}

/// What an impulse leaves in the states, taken back by the delay: e^(-A tau) B by its series.
void CascadeResponse::fill_entry(double delay_s) noexcept {
  Chain term;
  differentiate(Chain(), 1.0, 1.0, term);
  entry_ = term;
  for (std::size_t n = 1; n < kTerms; ++n) {
    Chain next;
    differentiate(term, 0.0, -delay_s / static_cast<double>(n), next);
    term = next;
    for (std::size_t i = 0; i < 2 * count_; ++i) {
      entry_.state[i] += term.state[i];
    }
  }
}

/// slope = scale times the derivative of a chain's states.
void CascadeResponse::differentiate(const Chain& chain, double input, double scale,
                                    Chain& slope) const noexcept {
  double before = input;
  for (std::size_t i = 0; i < count_; ++i) {
    const Section& section = sections_[i];
    const double q = chain.state[2 * i];
    const double v = chain.state[2 * i + 1];
    const double drive = section.speed2 * (before - q);
    slope.state[2 * i] = scale * (section.is_single ? drive : v);
    slope.state[2 * i + 1] = section.is_single ? 0.0 : scale * (drive - section.drag * v);
    before = q;
  }
}

/// The series of the outputs over a step; the states become those at its end.
void CascadeResponse::take_series(double step_s, double value, Series& series) noexcept {
  double sensor[2] = {sensor_state_[0], sensor_state_[1]};
  Chain compared = compared_;
  Chain reference = reference_;
  const bool is_in_band = criterion_ == Criterion::kInBandError;
  for (std::size_t n = 0; n < kTerms; ++n) {
    const double input = n == 0 ? value : 0.0;
    const double device = sensitivity_ * (is_ideal_ ? input : sensor[0]);
    const double filter = end_of(reference);
    series.device[n] = device;
    series.filter[n] = filter;
    if (is_in_band) {
      series.output[n] = end_of(compared) - (is_delayed_ ? gain_ * filter : 0.0);
    } else {
      series.output[n] = device - gain_ * filter;
    }
    if (n + 1 == kTerms) {
      break;
    }
    const double scale = step_s / static_cast<double>(n + 1);
    Chain slope;
    differentiate(compared, is_delayed_ ? device : device - gain_ * input, scale, slope);
    compared = slope;
    differentiate(reference, is_delayed_ ? 0.0 : input, scale, slope);
    for (std::size_t i = 0; i < 2 * count_; ++i) {
      reference.state[i] =
          slope.state[i] + (is_delayed_ && n == 0 ? scale * value * entry_.state[i] : 0.0);
      reference_.state[i] += reference.state[i];
      compared_.state[i] += compared.state[i];
    }
    const double next[2] = {scale * sensor[1], scale * (sensor_.speed2 * (input - sensor[0]) -
                                                        sensor_.drag * sensor[1])};
    for (std::size_t i = 0; i < 2; ++i) {
      sensor[i] = next[i];
      sensor_state_[i] += next[i];
    }
  }
}

void CascadeResponse::add_energy(const Series& series, double step_s) noexcept {
  if (criterion_ == Criterion::kEnergyDifference) {
    const double device = step_s * square_of(series.device);
    const double filter = step_s * gain_ * gain_ * square_of(series.filter);
    energy_ += device - filter;
    terms_ += device + filter;
    return;
  }
  energy_ += step_s * square_of(series.output);
}

/// At 4 points of the step.
void CascadeResponse::look_for_turns(const Series& series) noexcept {
  for (const double part : {0.25, 0.5, 0.75, 1.0}) {
    double slope = 0.0;
    for (std::size_t n = kTerms; n-- > 1;) {
      slope = part * slope + static_cast<double>(n) * series.output[n];
    }
    rises_ = rises_ || slope > 0.0;
    falls_ = falls_ || slope < 0.0;
  }
}

double CascadeResponse::advance_step(double length_s, double value) noexcept {
  const double step_s = length_s < longest_step_s_ ? length_s : longest_step_s_;
  Series series;
  take_series(step_s, value, series);
  add_energy(series, step_s);
  look_for_turns(series);
  double output = 0.0;
  double device = 0.0;
  double filter = 0.0;
  for (std::size_t n = kTerms; n-- > 0;) {
    output += series.output[n];
    device += series.device[n];
    filter += series.filter[n];
  }
  output_ = output;
  largest_device_ = larger(largest_device_, abs(device));
  largest_filter_ = larger(largest_filter_, abs(filter));
  elapsed_s_ += step_s;
  ++steps_;
  return length_s - step_s;
}

void CascadeResponse::advance(double length_s, double value) noexcept {
  // One step more than fit in: rounding may leave a little.
  for (std::size_t i = 0; i < kMaxSteps + 1 && length_s > 0.0; ++i) {
    length_s = advance_step(length_s, value);
  }
}

/// A pole that is off by a rounding turns the phase of its mode by that times 1/beta at most.
double CascadeResponse::relative_rounding() const noexcept {
  const double turns = is_ideal_ ? 0.0 : sqrt(sensor_.speed2) / sensor_.drag;
  const double terms = is_delayed_ ? kDelayedTerms * kFirstRounding : kFirstRounding;
  return terms + kStepRounding * (sqrt(static_cast<double>(steps_)) + turns);
}

double CascadeResponse::output_rounding() const noexcept {
  const double relative = relative_rounding();
  return relative * (criterion_ == Criterion::kInBandError
                         ? (largest_device_ + gain_) * largest_filter_
                         : largest_device_ + gain_ * largest_filter_);
}

KnownEnergy CascadeResponse::energy() const noexcept {
  const double relative = relative_rounding();
  if (criterion_ == Criterion::kEnergyDifference) {
    return {energy_, 2.0 * relative * terms_ + kSmallest};
  }
  // |2 y dy + dy^2| over the time, by Cauchy and Schwarz.
  const double off = output_rounding();
  return {energy_, relative * energy_ + 2.0 * off * sqrt(energy_ * elapsed_s_) +
                       off * off * elapsed_s_ + kSmallest};
}

OneSidedResponse one_sided_response(const ModalModel& model, double duration_s) noexcept {
  OneSidedResponse result;
  if (model.is_nothing()) {
    result.holds = true;
    return result;
  }
  if (!model.is_square() || model.feedthrough() != 0.0) {
    return result;
  }
  CascadeResponse response;
  if (!response.start(model, duration_s)) {
    return result;
  }
  double left_s = duration_s;
  for (double step = 0.0; left_s > 0.0; step += 1.0) {
    if (!response.is_monotone() || step == kOneSidedSteps) {
      return result;
    }
    left_s = response.advance_step(left_s, 1.0);
  }
  result.holds = response.is_monotone();
  result.energy = response.energy();
  result.output = abs(response.output());
  result.output_rounding = response.output_rounding();
  return result;
}

}  // namespace emax
