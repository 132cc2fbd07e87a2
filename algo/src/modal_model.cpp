// Impulse and step response, peak, settling time and Gramians of the error system.
#include "emax/modal_model.hpp"

#include "emax/complex_exp.hpp"
#include "emax/elementary.hpp"
#include "emax/units.hpp"

namespace emax {
namespace {

constexpr std::uint32_t kMaxSamples = 1u << 20;
constexpr double kSamplesPerPeriod = 64.0;

/// Re sum residue * pole^power * e^(pole t), with power 0 or 1.
double response(Span<const Mode> modes, int power, double time_s) noexcept {
  double sum = 0.0;
  for (const Mode& mode : modes) {
    const Complex factor = power == 0 ? mode.residue : mode.residue * mode.pole;
    sum += real_of_product(factor, exp(time_s * mode.pole));
  }
  return sum;
}

/// An upper bound of |k| from this time on.
double envelope(Span<const Mode> modes, double time_s) noexcept {
  double sum = 0.0;
  for (const Mode& mode : modes) {
    sum += sqrt(norm(mode.residue)) * exp(time_s * mode.pole.re);
  }
  return sum;
}

double sample_step_s(Span<const Mode> modes) noexcept {
  double fastest = 0.0;
  for (const Mode& mode : modes) {
    const double rate = norm(mode.pole);
    fastest = rate > fastest ? rate : fastest;
  }
  return kTwoPi / (kSamplesPerPeriod * sqrt(fastest));
}

/// Where a function of time with opposite signs at both ends is zero: bisection down to
/// neighbouring doubles.
template <typename Function>
double bisect(double low_s, double high_s, const Function& function) noexcept {
  const bool positive_at_low = function(low_s) > 0.0;
  for (int i = 0; i < 80; ++i) {
    const double middle_s = low_s + 0.5 * (high_s - low_s);
    if (!(middle_s > low_s && middle_s < high_s)) {
      break;
    }
    if ((function(middle_s) > 0.0) == positive_at_low) {
      low_s = middle_s;
    } else {
      high_s = middle_s;
    }
  }
  return low_s + 0.5 * (high_s - low_s);
}

/// Samples k and its derivative at equal steps and hands over each interval; ends where the
/// envelope says that nothing as large as `floor_of()` can follow, or after kMaxSamples.
///
/// @returns False if the samples ran out.
template <typename Floor, typename Visit>
bool scan(Span<const Mode> modes, const Floor& floor_of, const Visit& visit) noexcept {
  constexpr std::uint32_t kEnvelopeStride = 16;
  const double step_s = sample_step_s(modes);
  double slope = response(modes, 1, 0.0);
  for (std::uint32_t i = 1; i <= kMaxSamples; ++i) {
    const double start_s = (i - 1) * step_s;
    const double end_s = i * step_s;
    const double next_slope = response(modes, 1, end_s);
    visit(start_s, end_s, (slope > 0.0) != (next_slope > 0.0));
    slope = next_slope;
    if (i % kEnvelopeStride == 0 && envelope(modes, end_s) < floor_of()) {
      return true;
    }
  }
  return false;
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
  device_ = device;
  filter_ = filter;
  criterion_ = criterion;
  const FilterModes filter_modes = modes_of(filter);
  modes_[0] = mode_of(device);
  for (std::size_t i = 0; i < filter_modes.count; ++i) {
    modes_[1 + i] = {filter_modes.modes[i].pole, -filter_modes.modes[i].residue};
  }
  count_ = 1 + filter_modes.count;
  fill_gramians(count_);
  fill_sums_over_filter();
  fill_vectors();
  return Status::kOk;
}

Status ModalModel::set_device(const Accelerometer& device) noexcept {
  const Status status = validate(device);
  if (status != Status::kOk) {
    return status;
  }
  device_ = device;
  modes_[0] = mode_of(device);
  fill_gramians(1);
  fill_vectors();
  return Status::kOk;
}

Status ModalModel::set_gain(double gain) noexcept {
  Butterworth filter = filter_;
  filter.gain = gain;
  const Status status = validate(filter);
  if (status != Status::kOk) {
    return status;
  }
  filter_ = filter;
  const FilterModes filter_modes = modes_of(filter);
  for (std::size_t i = 0; i < filter_modes.count; ++i) {
    modes_[1 + i].residue = -filter_modes.modes[i].residue;
  }
  fill_sums_over_filter();
  fill_vectors();
  return Status::kOk;
}

void ModalModel::fill_gramians(std::size_t first_row_count) noexcept {
  const bool difference = criterion_ == Criterion::kEnergyDifference;
  for (std::size_t i = 0; i < first_row_count; ++i) {
    for (std::size_t j = i; j < count_; ++j) {
      double weight = 1.0;
      if (difference) {
        weight = j == 0 ? 1.0 : (i == 0 ? 0.0 : -1.0);
      }
      const Complex numerator{weight, 0.0};
      gramian_[i][j] = numerator / (modes_[i].pole + modes_[j].pole);
      gramian_[j][i] = gramian_[i][j];
      conjugate_gramian_[i][j] = numerator / (modes_[i].pole + conj(modes_[j].pole));
      conjugate_gramian_[j][i] = conj(conjugate_gramian_[i][j]);
    }
  }
}

Complex ModalModel::gramian_row(std::size_t i, const Complex* output) const noexcept {
  Complex sum;
  for (std::size_t j = 0; j < count_; ++j) {
    sum = sum + gramian_[i][j] * output[j] + conjugate_gramian_[i][j] * conj(output[j]);
  }
  return 0.5 * sum;
}

void ModalModel::fill_sums_over_filter() noexcept {
  for (std::size_t i = 1; i < count_; ++i) {
    inverse_pole_[i] = Complex{1.0, 0.0} / modes_[i].pole;
    settled_[i] = modes_[i].residue * inverse_pole_[i];
  }
  for (std::size_t i = 1; i < count_; ++i) {
    filter_settled_[i] = {};
    filter_kernel_[i] = {};
    for (std::size_t j = 1; j < count_; ++j) {
      filter_settled_[i] = filter_settled_[i] + gramian_[i][j] * settled_[j] +
                           conjugate_gramian_[i][j] * conj(settled_[j]);
      filter_kernel_[i] = filter_kernel_[i] + gramian_[i][j] * modes_[j].residue +
                          conjugate_gramian_[i][j] * conj(modes_[j].residue);
    }
  }
}

void ModalModel::fill_vectors() noexcept {
  inverse_pole_[0] = Complex{1.0, 0.0} / modes_[0].pole;
  settled_[0] = modes_[0].residue * inverse_pole_[0];
  Complex settled[kMaxModes];
  Complex kernel[kMaxModes];
  for (std::size_t i = 1; i < count_; ++i) {
    settled[i] = filter_settled_[i] + gramian_[i][0] * settled_[0] +
                 conjugate_gramian_[i][0] * conj(settled_[0]);
    kernel[i] = filter_kernel_[i] + gramian_[i][0] * modes_[0].residue +
                conjugate_gramian_[i][0] * conj(modes_[0].residue);
  }
  settled[0] = 2.0 * gramian_row(0, settled_);
  for (std::size_t j = 0; j < count_; ++j) {
    kernel[0] = kernel[0] + gramian_[0][j] * modes_[j].residue +
                conjugate_gramian_[0][j] * conj(modes_[j].residue);
  }
  // What a constant unit input ends up as in the output that a mode is part of: y for the
  // integral-square error, ya or minus yf, each with its own sign, for the energy difference.
  const double sum = device_.sensitivity + filter_.gain;
  const double difference = device_.sensitivity - filter_.gain;
  const bool is_difference = criterion_ == Criterion::kEnergyDifference;
  static_power_ = difference * (is_difference ? sum : difference);
  for (std::size_t i = 0; i < count_; ++i) {
    const double of_its_part = i == 0 ? device_.sensitivity : filter_.gain;
    const double static_gain = is_difference ? of_its_part : difference;
    switch_weight_[i] = 0.5 * (modes_[i].residue * settled[i]) + static_gain * settled_[i];
    correlation_[i] = -0.5 * (modes_[i].residue * kernel[i]);
  }
}

double ModalModel::impulse_response(double time_s) const noexcept {
  return time_s < 0.0 ? 0.0 : response(modes(), 0, time_s);
}

double ModalModel::device_impulse_response(double time_s) const noexcept {
  return time_s < 0.0 ? 0.0 : response(modes().first(1), 0, time_s);
}

double ModalModel::filter_impulse_response(double time_s) const noexcept {
  return time_s < 0.0 ? 0.0 : -response(modes().from(1), 0, time_s);
}

double ModalModel::step_response(double time_s) const noexcept {
  if (!(time_s > 0.0)) {
    return 0.0;
  }
  double sum = device_.sensitivity - filter_.gain;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += real_of_product(settled_[i], exp(time_s * modes_[i].pole));
  }
  return sum;
}

Peak ModalModel::peak() const noexcept {
  Peak best{impulse_response(0.0), 0.0};
  const auto consider = [&](double time_s) {
    const double value = impulse_response(time_s);
    if (abs(value) > abs(best.value)) {
      best = {value, time_s};
    }
  };
  scan(
      modes(), [&] { return abs(best.value); },
      [&](double start_s, double end_s, bool turns) {
        consider(turns ? bisect(start_s, end_s, [&](double t) { return response(modes(), 1, t); })
                       : end_s);
      });
  return best;
}

SettlingTime ModalModel::settling_time(double fraction) const noexcept {
  const double limit = fraction * abs(peak().value);
  const auto above = [&](double t) { return abs(impulse_response(t)) - limit; };
  SettlingTime result;
  const auto look = [&](double from_s, double to_s) {
    if (above(to_s) > 0.0) {
      result.time_s = to_s;
    } else if (above(from_s) > 0.0) {
      result.time_s = bisect(from_s, to_s, above);
    }
  };
  result.found = scan(
      modes(), [&] { return limit; },
      [&](double start_s, double end_s, bool turns) {
        if (!turns) {
          look(start_s, end_s);
          return;
        }
        const double extremum_s =
            bisect(start_s, end_s, [&](double t) { return response(modes(), 1, t); });
        look(start_s, extremum_s);
        look(extremum_s, end_s);
      });
  return result;
}

}  // namespace emax
