// Bounds of the slope of the kernel phi on a mesh, and the energy of a pulse.
#include "emax/bound/kernel_bounds.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/energy/switching_signal.hpp"

namespace emax {
namespace {

constexpr double kMeshResolution = 16.0;
/// Above this many intervals every second point in t has to do.
constexpr std::size_t kFineIntervals = 4000;
constexpr double kRounding = 1.0 + 1e-9;
constexpr std::size_t kRowsPerStep = 16;
/// Of the energy of the constant signal, which is no more than the greatest one.
constexpr double kLeastDigits = 1e-6;

double fastest_rate(const ModalModel& model) noexcept {
  double fastest = 0.0;
  for (const Mode& mode : model.modes()) {
    const double rate = norm(mode.pole);
    fastest = rate > fastest ? rate : fastest;
  }
  return sqrt(fastest);
}

Complex power_of(Complex pole, std::size_t exponent) noexcept {
  Complex power{1.0, 0.0};
  for (std::size_t i = 0; i < exponent; ++i) {
    power = power * pole;
  }
  return power;
}

double maximum(double a, double b) noexcept { return a > b ? a : b; }

/// The energy of Re sum c_i e^(p_i u) for u from 0 to `length_s`.
double tail_energy(const ModalModel& model, const Complex* c, double length_s) noexcept {
  const Span<const Mode> modes = model.modes();
  Complex late[kMaxModes];
  for (std::size_t i = 0; i < modes.size(); ++i) {
    late[i] = exp(length_s * modes[i].pole) * c[i];
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t j = 0; j < modes.size(); ++j) {
      sum += real_of_product(model.gramian(i, j), late[i] * late[j] - c[i] * c[j]);
      sum += real_of_product(model.conjugate_gramian(i, j),
                             late[i] * conj(late[j]) - c[i] * conj(c[j]));
    }
  }
  return 0.5 * sum;
}

/// The square of the response to a unit step, or the difference of the two squares.
double step_power(const ModalModel& model, double time_s) noexcept {
  if (model.is_square()) {
    const double output = model.step_response(time_s);
    return output * output;
  }
  const Span<const Mode> modes = model.modes();
  double sensor = 0.0;
  double filter = 0.0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    (i == 0 ? sensor : filter) +=
        time_s * real_of_product(modes[i].residue, phi1(time_s * modes[i].pole));
  }
  return sensor * sensor - filter * filter;
}

}  // namespace

std::size_t mesh_intervals(const ModalModel& model, double duration_s) noexcept {
  const double wanted = duration_s * fastest_rate(model) * kMeshResolution;
  if (!(wanted < static_cast<double>(kMaxMesh))) {
    return kMaxMesh + 1;
  }
  // Even, so that every second point ends on T.
  return 2 * (static_cast<std::size_t>(0.5 * wanted) + 1);
}

void held_responses(const ModalModel& model, double tau_s, Complex* held) noexcept {
  const Span<const Mode> modes = model.modes();
  Complex late[kMaxModes];
  for (std::size_t i = 0; i < modes.size(); ++i) {
    late[i] = exp(tau_s * modes[i].pole);
  }
  const Complex one{1.0, 0.0};
  for (std::size_t i = 0; i < modes.size(); ++i) {
    Complex sum;
    for (std::size_t j = 0; j < modes.size(); ++j) {
      sum = sum + modes[j].residue * model.gramian(i, j) * (late[i] * late[j] - one);
      sum = sum + conj(modes[j].residue) * model.conjugate_gramian(i, j) *
                      (late[i] * conj(late[j]) - one);
    }
    held[i] = 0.5 * sum;
  }
}

double pulse_energy(const ModalModel& model, double left_s, double width_s) noexcept {
  // Gauss-Legendre with 8 nodes on [-1, 1], for the square of the step response during the pulse.
  constexpr double kNodes[] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                               0.96028985649753623};
  constexpr double kWeights[] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                 0.10122853629037626};
  const auto pieces = static_cast<std::size_t>(2.0 * width_s * fastest_rate(model)) + 1;
  const double half_s = 0.5 * width_s / static_cast<double>(pieces);
  double during = 0.0;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const double middle_s = (2.0 * static_cast<double>(piece) + 1.0) * half_s;
    for (std::size_t n = 0; n < 4; ++n) {
      const double before = step_power(model, middle_s - half_s * kNodes[n]);
      const double after = step_power(model, middle_s + half_s * kNodes[n]);
      during += half_s * kWeights[n] * (before + after);
    }
  }
  const Span<const Mode> modes = model.modes();
  Complex c[kMaxModes];
  for (std::size_t i = 0; i < modes.size(); ++i) {
    c[i] = width_s * (modes[i].residue * phi1(width_s * modes[i].pole));
  }
  return during + tail_energy(model, c, left_s - width_s);
}

Status KernelBounds::start(const ModalModel& model, double duration_s,
                           Span<double> numbers) noexcept {
  const bool is_exact = model.moved_by() == 0.0 && !model.is_nothing();
  if (!(duration_s > 0.0) || model.feedthrough() != 0.0 || !is_exact) {
    return Status::kInvalidArgument;
  }
  const std::size_t intervals = mesh_intervals(model, duration_s);
  if (intervals > kMaxMesh) {
    return Status::kTooManyCells;
  }
  if (numbers.size() < kernel_bounds_numbers(intervals)) {
    return Status::kBufferTooSmall;
  }
  model_ = &model;
  duration_s_ = duration_s;
  intervals_ = intervals;
  step_s_ = duration_s / static_cast<double>(intervals);
  stride_ = intervals > kFineIntervals ? 2 : 1;
  next_row_ = 0;
  fill_tables(numbers);
  return fill_remainder() && has_digits() ? Status::kOk : Status::kLostDigits;
}

void KernelBounds::fill_tables(Span<double> numbers) noexcept {
  const std::size_t points = intervals_ + 1;
  const auto take = [&]() {
    const Span<double> table = numbers.first(points);
    numbers = numbers.from(points);
    return table;
  };
  const Span<const Mode> modes = model_->modes();
  for (std::size_t i = 0; i < modes.size(); ++i) {
    exponential_re_[i] = take();
    exponential_im_[i] = take();
    held_re_[i] = take();
    held_im_[i] = take();
  }
  impulse_ = take();
  taken_off_ = take();
  integrals_ = take();
  const bool is_square = model_->is_square();
  for (std::size_t point = 0; point < points; ++point) {
    const double time_s = static_cast<double>(point) * step_s_;
    Complex held[kMaxModes];
    held_responses(*model_, duration_s_ - time_s > 0.0 ? duration_s_ - time_s : 0.0, held);
    double impulse = 0.0;
    double taken_off = 0.0;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const Complex exponential = exp(time_s * modes[i].pole);
      exponential_re_[i][point] = exponential.re;
      exponential_im_[i][point] = exponential.im;
      held_re_[i][point] = held[i].re;
      held_im_[i][point] = held[i].im;
      const bool is_sensor = i == 0;
      (is_square || is_sensor ? impulse : taken_off) +=
          real_of_product(modes[i].residue, exponential);
    }
    impulse_[point] = impulse;
    taken_off_[point] = taken_off;
  }
}

/// Whether the energy of the constant signal is much more than what its sums round off: Phi is a
/// difference of the same sums. The energy difference may be small by itself; then it is that of
/// the sensor's settled output that counts.
bool KernelBounds::has_digits() const noexcept {
  const double constant = energy(*model_, Span<const double>(), duration_s_);
  const double gain = model_->device().sensitivity;
  const double size = model_->is_square() ? constant : duration_s_ * gain * gain;
  return energy_rounding(*model_, duration_s_, 0, constant) <= kLeastDigits * size;
}

/// Of an impulse response and its derivatives.
struct KernelBounds::Norms {
  static constexpr std::size_t kDerivatives = 4;
  double norms[kDerivatives] = {};   // Roots of the integrals of their squares.
  double starts[kDerivatives] = {};  // Their sizes at 0.
  bool starts_at_zero = false;

  bool are_known() const noexcept {
    for (const double norm : norms) {
      if (!(norm > 0.0) || !is_finite(norm)) {
        return false;
      }
    }
    return true;
  }
};

/// Of the modes from `first` to before `last`, which are one output.
KernelBounds::Norms KernelBounds::norms_of(std::size_t first, std::size_t last) const noexcept {
  const Span<const Mode> modes = model_->modes();
  Norms all;
  all.starts_at_zero = model_->starts_at_zero();
  for (std::size_t n = 0; n < Norms::kDerivatives; ++n) {
    double start = 0.0;
    double energy = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const Complex c = modes[i].residue * power_of(modes[i].pole, n);
      start += c.re;
      for (std::size_t j = first; j < last; ++j) {
        const Complex d = modes[j].residue * power_of(modes[j].pole, n);
        energy += 0.5 * (real_of_product(c * d, model_->gramian(i, j)) +
                         real_of_product(c * conj(d), model_->conjugate_gramian(i, j)));
      }
    }
    all.starts[n] = abs(start) * kRounding;
    // The Gramian of a square is negative, that of what is taken off positive.
    all.norms[n] = sqrt(abs(energy)) * kRounding;
  }
  return all;
}

// The third derivatives that the remainder asks for are integrals of products k^(i) k^(j) with i +
// j = 3, bounded by norms, and what the moving end of the integral adds, with the integral of
// |k^(n)| over [0, T] at most sqrt(T) times its norm.
double KernelBounds::remainder_of(const Norms& norms) const noexcept {
  const double root = sqrt(duration_s_);
  const double t_step_s = static_cast<double>(stride_) * step_s_;
  const double squares = 0.125 * (t_step_s * t_step_s + step_s_ * step_s_);
  const double* const size = norms.norms;
  if (norms.starts_at_zero) {
    const double smooth = maximum(size[3] * size[0], size[1] * size[2]);
    // On both sides of t.
    const double moving_end = 2.0 * root * (norms.starts[1] * size[1] + norms.starts[2] * size[0]);
    return squares * (duration_s_ * smooth + moving_end);
  }
  double largest[3];
  double moving_end = 0.0;
  for (std::size_t n = 0; n < 3; ++n) {
    // The square at t is -2 times the integral of k^(n) k^(n+1) from t on.
    largest[n] = sqrt(2.0 * size[n] * size[n + 1]);
    moving_end += root * largest[n] * size[2 - n];
  }
  const double slope = 2.0 * largest[0] * largest[1] + size[0] * size[2];
  const double jump = norms.starts[0] * norms.starts[0];
  return squares * (duration_s_ * size[0] * size[3] + moving_end) +
         t_step_s * (0.5 * jump + t_step_s * slope);
}

/// @returns False if rounding hides a norm.
bool KernelBounds::fill_remainder() noexcept {
  const std::size_t count = model_->modes().size();
  if (model_->is_square()) {
    const Norms norms = norms_of(0, count);
    remainder_ = remainder_of(norms);
    return norms.are_known();
  }
  const Norms sensor = norms_of(0, 1);
  const Norms filter = norms_of(1, count);
  remainder_ = remainder_of(sensor) + remainder_of(filter);
  return sensor.are_known() && filter.are_known();
}

void KernelBounds::step() noexcept {
  for (std::size_t i = 0; i < kRowsPerStep && !done(); ++i) {
    fill_row(next_row_);
    next_row_ += stride_;
  }
}

/// Sums of |f| by the trapezoidal rule, a chunk of mesh points at a time.
struct KernelBounds::RowSums {
  static constexpr std::size_t kChunk = 256;

  /// Takes the first terms; an end of the range of one formula counts half.
  void add(std::size_t count, bool starts, bool ends) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      sum += abs(terms[i]);
    }
    sum -= starts ? 0.5 * abs(terms[0]) : 0.0;
    sum -= ends ? 0.5 * abs(terms[count - 1]) : 0.0;
  }

  double sum = 0.0;
  double terms[kChunk] = {};
};

void KernelBounds::fill_row(std::size_t row) noexcept {
  RowSums sums;
  add_from_row_on(row, sums);
  add_up_to_row(row, sums);
  integrals_[row] = sums.sum * step_s_;
}

// s >= t: minus the integral of k'(w + s - t) k(w).
void KernelBounds::add_from_row_on(std::size_t row, RowSums& sums) const noexcept {
  const Span<const Mode> modes = model_->modes();
  for (std::size_t first = row; first <= intervals_; first += RowSums::kChunk) {
    const std::size_t left = intervals_ + 1 - first;
    const std::size_t count = left < RowSums::kChunk ? left : RowSums::kChunk;
    for (std::size_t i = 0; i < count; ++i) {
      sums.terms[i] = 0.0;
    }
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const Complex c = modes[m].residue * modes[m].pole;
      const double* ere = &exponential_re_[m][first - row];
      const double* eim = &exponential_im_[m][first - row];
      const double* ure = &held_re_[m][first];
      const double* uim = &held_im_[m][first];
      for (std::size_t i = 0; i < count; ++i) {
        sums.terms[i] +=
            c.re * (ere[i] * ure[i] - eim[i] * uim[i]) - c.im * (ere[i] * uim[i] + eim[i] * ure[i]);
      }
    }
    sums.add(count, first == row, first + count > intervals_);
  }
}

// s <= t, by the distance t - s.
void KernelBounds::add_up_to_row(std::size_t row, RowSums& sums) const noexcept {
  const Span<const Mode> modes = model_->modes();
  const double* impulse = impulse_.data();
  const double* taken_off = taken_off_.data();
  const std::size_t end = intervals_ - row;  // T - t.
  for (std::size_t first = 0; first <= row; first += RowSums::kChunk) {
    const std::size_t left = row + 1 - first;
    const std::size_t count = left < RowSums::kChunk ? left : RowSums::kChunk;
    for (std::size_t i = 0; i < count; ++i) {
      sums.terms[i] =
          taken_off[end] * taken_off[end + first + i] - impulse[end] * impulse[end + first + i];
    }
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const Complex c =
          modes[m].residue * modes[m].pole * Complex{held_re_[m][row], held_im_[m][row]};
      const double* ere = &exponential_re_[m][first];
      const double* eim = &exponential_im_[m][first];
      for (std::size_t i = 0; i < count; ++i) {
        sums.terms[i] += c.re * ere[i] - c.im * eim[i];
      }
    }
    sums.add(count, first == 0, first + count > row);
  }
}

double KernelBounds::filter_slope() const noexcept {
  const ReferenceFilter& filter = model_->filter();
  return model_->is_square() ? 0.0 : filter.gain * kTwoPi * filter.band_hz * kRounding;
}

double KernelBounds::bound(double from_s, double to_s) const noexcept {
  const double t_step_s = static_cast<double>(stride_) * step_s_;
  const std::size_t last_row = intervals_ / stride_;
  const double last = static_cast<double>(last_row);
  const double low = floor(maximum(from_s, 0.0) / t_step_s - 1e-6);
  const double high = floor(to_s / t_step_s + 1e-6) + 1.0;
  double largest = 0.0;
  for (double point = maximum(low, 0.0); point <= (high < last ? high : last); point += 1.0) {
    largest = maximum(largest, integrals_[static_cast<std::size_t>(point) * stride_]);
  }
  return (largest + remainder_) * kRounding;
}

}  // namespace emax
