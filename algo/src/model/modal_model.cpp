// Impulse and step response, peak, settling time and Gramians of the error system.
#include "emax/model/modal_model.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/model/in_band.hpp"
#include "emax/model/response_scan.hpp"

namespace emax {
namespace {

/// Modes closer than this are the same: some roundings of poles and residues.
constexpr double kSameMode = 0x1p-48;

bool is_same(Complex a, Complex b) noexcept {
  return norm(a - b) <= kSameMode * kSameMode * norm(a);
}

/// Re sum residue * e^(pole t).
double response(Span<const Mode> modes, double time_s) noexcept {
  double sum = 0.0;
  for (const Mode& mode : modes) {
    sum += real_of_product(mode.residue, exp(time_s * mode.pole));
  }
  return sum;
}

}  // namespace

Status ModalModel::set(const Accelerometer& device, const Butterworth& filter,
                       Criterion criterion) noexcept {
  const Status device_status = validate(device);
  if (device_status != Status::kOk) {
    return device_status;
  }
  const Status filter_status = validate(filter);
  if (filter_status != Status::kOk) {
    return filter_status;
  }
  return set(device, butterworth(filter), ErrorMeasure{criterion});
}

Status ModalModel::set(const Accelerometer& device, const ReferenceFilter& filter,
                       const ErrorMeasure& measure) noexcept {
  const Status status = validate(device);
  const bool is_in_band = measure.criterion == Criterion::kInBandError;
  if (status != Status::kOk) {
    return status;
  }
  if (is_in_band && !(filter.gain > 0.0)) {
    return Status::kInvalidArgument;
  }
  double delay_s = 0.0;
  if (is_in_band && measure.delay.mode != DelayMode::kNone) {
    const double of_sensor_s = 2.0 * device.damping / (kTwoPi * device.natural_frequency_hz);
    delay_s = measure.delay.mode == DelayMode::kGiven ? measure.delay.given_s : of_sensor_s;
  }
  if (!(delay_s >= 0.0) || !(delay_s * (kTwoPi * filter.band_hz) <= 1.0)) {
    return Status::kDelayTooLong;
  }
  take_delay(filter, delay_s);
  feedthrough_ = 0.0;
  take(device, filter, measure.criterion);
  return Status::kOk;
}

Status ModalModel::set_ideal(double sensitivity, const ReferenceFilter& filter, Criterion criterion,
                             double delay_s) noexcept {
  const bool is_in_band = criterion == Criterion::kInBandError;
  if (!(sensitivity > 0.0) || !is_finite(sensitivity) || (is_in_band && !(filter.gain > 0.0))) {
    return Status::kInvalidArgument;
  }
  take_delay(filter, delay_s);
  feedthrough_ = is_in_band ? 0.0 : sensitivity;
  take(Accelerometer{sensitivity, 0.0, 0.0}, filter, criterion);
  return Status::kOk;
}

void ModalModel::take_delay(const ReferenceFilter& filter, double delay_s) noexcept {
  delay_s_ = delay_s;
  delay_reach_ = delay_s > 0.0 ? reach_before_start(filter, delay_s) : 0.0;
  delay_error_ = abs(delay_reach_);
}

void ModalModel::take(const Accelerometer& device, const ReferenceFilter& filter,
                      Criterion criterion) noexcept {
  device_ = device;
  filter_ = filter;
  criterion_ = criterion;
  count_ = 1 + filter.count;
  fill_modes();
}

Status ModalModel::set_device(const Accelerometer& device) noexcept {
  const Status status = validate(device);
  if (status != Status::kOk) {
    return status;
  }
  const bool is_in_band = criterion_ == Criterion::kInBandError;
  const bool was_nothing = is_nothing_;
  device_ = device;
  feedthrough_ = 0.0;
  fill_residues();
  fill_gramians(1);
  if (is_in_band || is_nothing_ != was_nothing) {
    fill_sums_over_filter();
  }
  fill_switch_weights();
  return Status::kOk;
}

Status ModalModel::set_gain(double gain) noexcept {
  if (!(gain >= 0.0) || !is_finite(gain) || (filter_.gain == 0.0 && gain > 0.0)) {
    return Status::kInvalidArgument;
  }
  if (gain == filter_.gain) {
    return Status::kOk;
  }
  const double ratio = gain / filter_.gain;
  for (Mode& mode : filter_.modes) {
    mode.residue = ratio * mode.residue;
  }
  filter_.gain = gain;
  fill_modes();
  return Status::kOk;
}

double ModalModel::grid_hz() const noexcept {
  constexpr double kInBand[] = {0.5, 0.7, 0.85, 1.0};
  constexpr double kOfResonance = 0.1;
  constexpr double kBands = 4.0;
  constexpr double kCoarsest = 1.0 / 16.0;
  const double f0 = device_.natural_frequency_hz;
  const double band = filter_.band_hz;
  if (criterion_ != Criterion::kInBandError || !(f0 > kBands * band)) {
    return f0 > band ? f0 : band;
  }
  double in_band = 0.0;
  for (const double part : kInBand) {
    const double size = in_band_amplitude(device_, filter_, delay_s_, part * band);
    in_band = size > in_band ? size : in_band;
  }
  if (in_band_amplitude(device_, filter_, delay_s_, f0) > kOfResonance * in_band) {
    return f0;
  }
  return kBands * band > kCoarsest * f0 ? kBands * band : kCoarsest * f0;
}

/// Poles and residues of k, and what a constant input settles at.
void ModalModel::fill_residues() noexcept {
  const bool is_ideal = device_.natural_frequency_hz == 0.0;
  const double offset = device_.sensitivity - filter_.gain;
  is_nothing_ = false;
  moved_by_ = 0.0;
  static_gain_ = offset;
  if (is_ideal) {
    modes_[0] = {{-kTwoPi * filter_.band_hz, 0.0}, {}};
  } else {
    modes_[0] = mode_of(device_);
  }
  if (criterion_ != Criterion::kInBandError) {
    for (std::size_t i = 0; i < filter_.count; ++i) {
      modes_[1 + i] = {filter_.modes[i].pole, -filter_.modes[i].residue};
    }
    is_nothing_ = !is_ideal && count_ == 2 && is_same(modes_[0].pole, modes_[1].pole) &&
                  is_same(modes_[0].residue, -modes_[1].residue);
  } else {
    static_gain_ = offset - filter_.gain * delay_reach_;
    const Accelerometer device = is_ideal ? device_ : with_simple_poles(device_, filter_);
    if (device.natural_frequency_hz != device_.natural_frequency_hz) {
      moved_by_ = change_by_move(device_);
    }
    if (!is_ideal) {
      modes_[0] = {mode_of(device).pole, in_band_residue(device, filter_)};
    }
    for (std::size_t i = 0; i < filter_.count; ++i) {
      const Mode& mode = filter_.modes[i];
      modes_[1 + i] = {mode.pole, in_band_residue(device, filter_, mode, delay_s_)};
    }
    is_nothing_ = is_ideal && offset == 0.0 && delay_s_ == 0.0;
  }
  if (is_nothing_) {
    static_gain_ = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      modes_[i].residue = {};
    }
  }
}

void ModalModel::fill_modes() noexcept {
  fill_residues();
  fill_gramians(count_);
  fill_sums_over_filter();
  fill_switch_weights();
}

void ModalModel::fill_gramians(std::size_t first_row_count) noexcept {
  const bool difference = criterion_ == Criterion::kEnergyDifference;
  for (std::size_t i = 0; i < first_row_count; ++i) {
    const Complex pole = modes_[i].pole;
    for (std::size_t j = i; j < count_; ++j) {
      double weight = 1.0;
      if (difference) {
        weight = j == 0 ? 1.0 : (i == 0 ? 0.0 : -1.0);
      }
      gramian_[pair(i, j)] = weight * reciprocal(pole + modes_[j].pole);
      conjugate_gramian_[pair(i, j)] = weight * reciprocal(pole + conj(modes_[j].pole));
    }
  }
}

Complex ModalModel::gramian_row(std::size_t i, const Complex* output) const noexcept {
  Complex sum;
  for (std::size_t j = 0; j < count_; ++j) {
    sum = sum + gramian(i, j) * output[j] + conjugate_gramian(i, j) * conj(output[j]);
  }
  return 0.5 * sum;
}

double ModalModel::gramian_form(const Complex* output) const noexcept {
  double diagonal = 0.0;
  double pairs = 0.0;
  const Complex* g = gramian_;
  const Complex* h = conjugate_gramian_;
  for (std::size_t j = 0; j < count_; ++j) {
    // Re(w_i (G_ij w_j + H_ij conj w_j)), as a real form of the two real and imaginary parts.
    const Complex w = output[j];
    double row = 0.0;
    for (std::size_t i = 0; i < j; ++i, ++g, ++h) {
      row += output[i].re * ((g->re + h->re) * w.re + (h->im - g->im) * w.im) -
             output[i].im * ((g->im + h->im) * w.re + (g->re - h->re) * w.im);
    }
    pairs += row;
    diagonal += real_of_product(*g, w * w) + h->re * norm(w);
    ++g;
    ++h;
  }
  return pairs + 0.5 * diagonal;
}

Complex ModalModel::correlation(std::size_t i) const noexcept {
  Complex kernel;
  for (std::size_t j = 1; j < count_; ++j) {
    kernel = kernel + gramian(i, j) * modes_[j].residue +
             conjugate_gramian(i, j) * conj(modes_[j].residue);
  }
  kernel = kernel + gramian(i, 0) * modes_[0].residue +
           conjugate_gramian(i, 0) * conj(modes_[0].residue);
  const Complex sum = -0.5 * (modes_[i].residue * kernel);
  // What passes at once correlates with the output of the modes; only within one output.
  return is_square() && feedthrough_ != 0.0 ? sum + feedthrough_ * modes_[i].residue : sum;
}

void ModalModel::fill_sums_over_filter() noexcept {
  for (std::size_t i = 1; i < count_; ++i) {
    inverse_pole_[i] = reciprocal(modes_[i].pole);
    settled_[i] = modes_[i].residue * inverse_pole_[i];
  }
  for (std::size_t i = 1; i < count_; ++i) {
    filter_settled_[i] = {};
    for (std::size_t j = 1; j < count_; ++j) {
      filter_settled_[i] = filter_settled_[i] + gramian(i, j) * settled_[j] +
                           conjugate_gramian(i, j) * conj(settled_[j]);
    }
  }
}

void ModalModel::fill_switch_weights() noexcept {
  inverse_pole_[0] = reciprocal(modes_[0].pole);
  settled_[0] = modes_[0].residue * inverse_pole_[0];
  Complex settled[kMaxModes];
  settled[0] = gramian(0, 0) * settled_[0] + conjugate_gramian(0, 0) * conj(settled_[0]);
  for (std::size_t i = 1; i < count_; ++i) {
    const Complex g = gramian_[pair(0, i)];
    const Complex h = conjugate_gramian_[pair(0, i)];
    settled[0] = settled[0] + g * settled_[i] + h * conj(settled_[i]);
    settled[i] = filter_settled_[i] + g * settled_[0] + conj(h) * conj(settled_[0]);
  }
  // What a constant unit input ends up as in the output that a mode is part of: y for the
  // integral-square error, ya or minus yf, each with its own sign, for the energy difference.
  const double sum = is_nothing_ ? 0.0 : device_.sensitivity + filter_.gain;
  const double difference = static_gain_;
  const bool is_difference = criterion_ == Criterion::kEnergyDifference;
  static_power_ = difference * (is_difference ? sum : difference);
  for (std::size_t i = 0; i < count_; ++i) {
    const double of_its_part = i == 0 ? device_.sensitivity : filter_.gain;
    const double static_gain = is_difference ? of_its_part : difference;
    switch_weight_[i] = 0.5 * (modes_[i].residue * settled[i]) + static_gain * settled_[i];
  }
}

double ModalModel::impulse_response(double time_s) const noexcept {
  return time_s < 0.0 ? 0.0 : response(modes(), time_s);
}

double ModalModel::device_impulse_response(double time_s) const noexcept {
  if (time_s < 0.0) {
    return 0.0;
  }
  const Mode mode = device_.natural_frequency_hz > 0.0 ? mode_of(device_) : Mode{};
  return response(Span<const Mode>(&mode, 1), time_s);
}

double ModalModel::filter_impulse_response(double time_s) const noexcept {
  return time_s < 0.0 ? 0.0 : response(filter_.terms(), time_s);
}

double ModalModel::step_response(double time_s) const noexcept {
  if (!(time_s > 0.0)) {
    return 0.0;
  }
  double sum = static_gain_;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += real_of_product(settled_[i], exp(time_s * modes_[i].pole));
  }
  return sum;
}

Peak ModalModel::peak() const noexcept {
  PeakSearch search;
  search.start(*this);
  while (!search.done()) {
    search.step(*this);
  }
  return search.result();
}

SettlingTime ModalModel::settling_time(double fraction) const noexcept {
  SettlingSearch search;
  search.start(*this, fraction * abs(peak().value));
  while (!search.done()) {
    search.step(*this);
  }
  return search.result();
}

}  // namespace emax
