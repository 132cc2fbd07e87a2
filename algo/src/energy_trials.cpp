// Draws a device, and takes the estimate's best signal to where it is best for that device.
#include "emax/energy_trials.hpp"

#include "emax/distributions.hpp"
#include "emax/elementary.hpp"
#include "emax/refinement.hpp"

namespace emax {
namespace {

/// What the predicted signal may stay below the refined one, as part of the energy.
constexpr double kPermittedLoss = 1e-10;
/// Times are predicted up to this many standard deviations along each axis of a normal
/// distribution; the corners are then inside kMaxDeviations.
constexpr double kPredictedDeviations = 3.4;
/// A variance that the earlier parameters explain to this part is zero.
constexpr double kDependent = 1e-12;
/// Rounding that a covariance of a parameter without a variance of its own may show.
constexpr double kSemidefinite = 1e-6;

/// The two parameters of each product among the terms.
constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};

Accelerometer moved(const Accelerometer& estimate, const double (&deviation)[3]) noexcept {
  return {estimate.sensitivity + deviation[0], estimate.natural_frequency_hz + deviation[1],
          estimate.damping + deviation[2]};
}

bool is_uncertainty(double u) noexcept { return u >= 0.0 && is_finite(u); }

}  // namespace

Status EnergyTrials::start(const ModalModel& at_estimate, const MaximumEnergy& best,
                           const TrialSettings& settings, GridWorkspace& workspace) noexcept {
  double factor[3][3];
  Status status = factor_of(settings, factor);
  if (status == Status::kOk) {
    status = check_range(at_estimate.device(), settings.distribution, factor);
  }
  if (status != Status::kOk) {
    return status;
  }
  if (!(settings.search.duration_s > 0.0) || best.cells == 0) {
    return Status::kInvalidArgument;
  }
  if (best.cells > kMaxCells) {
    return Status::kTooManyCells;
  }
  model_ = at_estimate;
  best_signal_ = best.signal;
  settings_ = settings;
  estimate_ = at_estimate.device();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      factor_[i][j] = factor[i][j];
    }
  }
  range_ = settings.distribution == Distribution::kBox ? 1.0 : kPredictedDeviations;
  generator_ = settings.generator;
  next_trial_ = 0;
  cells_ = best.cells;
  if (settings.gain_follows) {
    (void)model_.set_gain(estimate_.sensitivity);  // A device's sensitivity is a valid gain.
  }
  predicts_ = settings.search.method == Method::kBest && lay_quadratic(workspace) &&
              holds_at_corners(workspace);
  return Status::kOk;
}

/// The lower triangular matrix that independent deviations of variance 1 (or up to 1) are
/// multiplied by.
Status EnergyTrials::factor_of(const TrialSettings& settings, double (&factor)[3][3]) noexcept {
  const ParameterBox& box = settings.box;
  const double half_widths[3] = {box.sensitivity, box.natural_frequency_hz, box.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      factor[i][j] = 0.0;
    }
  }
  if (settings.distribution == Distribution::kBox) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (!is_uncertainty(half_widths[i])) {
        return Status::kInvalidArgument;
      }
      factor[i][i] = half_widths[i];
    }
    return Status::kOk;
  }
  const double(&c)[3][3] = settings.covariance;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double size = sqrt(c[i][i] * c[j][j]);
      if (!is_uncertainty(c[i][i]) || !(abs(c[i][j] - c[j][i]) <= kDependent * size)) {
        return Status::kInvalidArgument;
      }
      double rest = c[i][j];
      for (std::size_t k = 0; k < j; ++k) {
        rest -= factor[i][k] * factor[j][k];
      }
      if (i == j) {
        if (!(rest >= -kDependent * c[i][i])) {
          return Status::kInvalidArgument;
        }
        factor[i][i] = rest > kDependent * c[i][i] ? sqrt(rest) : 0.0;
        continue;
      }
      // A parameter without a share of its own leaves no share to later ones.
      if (factor[j][j] == 0.0 && abs(rest) > kSemidefinite * size) {
        return Status::kInvalidArgument;
      }
      factor[i][j] = factor[j][j] == 0.0 ? 0.0 : rest / factor[j][j];
    }
  }
  return Status::kOk;
}

/// Whether the estimate with all parameters at either end of their ranges is still a device.
Status EnergyTrials::check_range(const Accelerometer& estimate, Distribution distribution,
                                 const double (&factor)[3][3]) noexcept {
  for (const double side : {-1.0, 1.0}) {
    double deviation[3];
    for (std::size_t i = 0; i < 3; ++i) {
      double variance = 0.0;
      for (std::size_t j = 0; j <= i; ++j) {
        variance += factor[i][j] * factor[i][j];
      }
      deviation[i] = distribution == Distribution::kBox ? side * factor[i][i]
                                                        : side * kMaxDeviations * sqrt(variance);
    }
    const Status status = validate(moved(estimate, deviation));
    if (status != Status::kOk) {
      return status;
    }
  }
  return Status::kOk;
}

Accelerometer EnergyTrials::device(std::uint32_t trial) noexcept {
  const bool is_box = settings_.distribution == Distribution::kBox;
  if (trial != next_trial_) {
    generator_ = settings_.generator;
    generator_.jump(std::uint64_t{is_box ? 3U : 4U} * trial);
  }
  next_trial_ = trial + 1;
  if (!is_box) {
    return normal_device();
  }
  const ParameterBox& box = settings_.box;
  const auto draw = [this](double estimate, double half_width) {
    return uniform_in(estimate - half_width, estimate + half_width, generator_.next());
  };
  Accelerometer device;
  device.sensitivity = draw(estimate_.sensitivity, box.sensitivity);
  device.natural_frequency_hz = draw(estimate_.natural_frequency_hz, box.natural_frequency_hz);
  device.damping = draw(estimate_.damping, box.damping);
  return device;
}

Accelerometer EnergyTrials::normal_device() noexcept {
  double u[4];
  for (double& number : u) {
    number = generator_.next();
  }
  const NormalPair first = box_muller(u[0], u[1]);
  const NormalPair second = box_muller(u[2], u[3]);
  double z[3] = {first.first, first.second, second.first};
  const double square = z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
  if (square > kMaxDeviations * kMaxDeviations) {
    const double shorter = kMaxDeviations / sqrt(square);
    for (double& element : z) {
      element *= shorter;
    }
  }
  return device_at(z);
}

Accelerometer EnergyTrials::device_at(const double (&z)[3]) const noexcept {
  double deviation[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      deviation[i] += factor_[i][j] * z[j];
    }
  }
  return moved(estimate_, deviation);
}

EnergyTrials::Place EnergyTrials::place_of(const Accelerometer& device) const noexcept {
  constexpr double kRounding = 1e-9;
  const double deviation[3] = {device.sensitivity - estimate_.sensitivity,
                               device.natural_frequency_hz - estimate_.natural_frequency_hz,
                               device.damping - estimate_.damping};
  Place place;
  place.inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    double rest = deviation[i];
    for (std::size_t j = 0; j < i; ++j) {
      rest -= factor_[i][j] * place.part[j] * range_;
    }
    if (factor_[i][i] == 0.0) {
      place.inside = place.inside && rest == 0.0;
      continue;
    }
    place.part[i] = rest / (factor_[i][i] * range_);
    place.inside = place.inside && abs(place.part[i]) <= 1.0 + kRounding;
  }
  return place;
}

double EnergyTrials::scale_of(const Accelerometer& device) const noexcept {
  const double ratio = device.sensitivity / estimate_.sensitivity;
  return settings_.gain_follows ? ratio * ratio : 1.0;
}

void EnergyTrials::set_model(const Accelerometer& device) noexcept {
  Accelerometer scaled = device;
  if (settings_.gain_follows) {
    scaled.sensitivity = estimate_.sensitivity;
  }
  (void)model_.set_device(scaled);  // `start()` has seen that the whole range is valid.
}

/// Sets the signal to the predicted switching times. @returns False if they are out of order.
bool EnergyTrials::predict(const double (&part)[3]) noexcept {
  double factors[kTerms];
  for (std::size_t a = 0; a < 3; ++a) {
    factors[a] = part[a];
    factors[3 + a] = part[a] * part[a];
    factors[6 + a] = part[kPairs[a][0]] * part[kPairs[a][1]];
  }
  const std::size_t count = best_signal_.count();
  double times_s[kMaxPredicted];
  for (std::size_t i = 0; i < count; ++i) {
    double move_s = 0.0;
    for (std::size_t k = 0; k < kTerms; ++k) {
      move_s += factors[k] * terms_[k][i];
    }
    times_s[i] = best_signal_.times_s()[i] + move_s;
  }
  return signal_.set(Span<const double>(times_s, count), best_signal_.duration_s()) == Status::kOk;
}

/// Refines the estimate's signal for the device at a place of the range.
///
/// @returns Whether it has kept all its switches; `signal_` is the refined one.
bool EnergyTrials::refine_at(const double (&part)[3], GridWorkspace& workspace) noexcept {
  const double z[3] = {range_ * part[0], range_ * part[1], range_ * part[2]};
  set_model(device_at(z));
  signal_ = best_signal_;
  (void)refine(model_, signal_, workspace.refinement());
  return signal_.count() == best_signal_.count();
}

/// Fills the terms of the quadratic that goes through the refined times at the estimate, at both
/// ends of each axis, and at the positive ends of each two axes together.
bool EnergyTrials::lay_quadratic(GridWorkspace& workspace) noexcept {
  const std::size_t count = best_signal_.count();
  if (count > kMaxPredicted) {
    return false;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    double part[3] = {};
    part[a] = 1.0;
    if (!refine_at(part, workspace)) {
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
      terms_[a][i] = signal_.times_s()[i] - best_signal_.times_s()[i];
    }
    part[a] = -1.0;
    if (!refine_at(part, workspace)) {
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double up = terms_[a][i];
      const double down = signal_.times_s()[i] - best_signal_.times_s()[i];
      terms_[a][i] = 0.5 * (up - down);
      terms_[3 + a][i] = 0.5 * (up + down);
    }
  }
  for (std::size_t pair = 0; pair < 3; ++pair) {
    const std::size_t a = kPairs[pair][0];
    const std::size_t b = kPairs[pair][1];
    double part[3] = {};
    part[a] = 1.0;
    part[b] = 1.0;
    if (!refine_at(part, workspace)) {
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
      terms_[6 + pair][i] = (signal_.times_s()[i] - best_signal_.times_s()[i]) - terms_[a][i] -
                            terms_[3 + a][i] - terms_[b][i] - terms_[3 + b][i];
    }
  }
  return true;
}

bool EnergyTrials::holds_at_corners(GridWorkspace& workspace) noexcept {
  for (unsigned corner = 0; corner < 8; ++corner) {
    const double part[3] = {(corner & 1U) != 0 ? 1.0 : -1.0, (corner & 2U) != 0 ? 1.0 : -1.0,
                            (corner & 4U) != 0 ? 1.0 : -1.0};
    if (!refine_at(part, workspace)) {
      return false;
    }
    const double reached = emax::energy(model_, signal_);
    if (!predict(part) ||
        !(emax::energy(model_, signal_) >= reached - kPermittedLoss * abs(reached))) {
      return false;
    }
  }
  return true;
}

double EnergyTrials::energy(std::uint32_t trial, GridWorkspace& workspace) noexcept {
  return energy_of(device(trial), workspace);
}

double EnergyTrials::energy_of(const Accelerometer& device, GridWorkspace& workspace) noexcept {
  set_model(device);
  return scale_of(device) * (settings_.search.method == Method::kBest
                                 ? best_energy(device, workspace)
                                 : paper_energy(workspace));
}

double EnergyTrials::best_energy(const Accelerometer& device, GridWorkspace& workspace) noexcept {
  if (predicts_) {
    const Place place = place_of(device);
    if (place.inside && predict(place.part)) {
      return emax::energy(model_, signal_);
    }
  }
  signal_ = best_signal_;
  return refine(model_, signal_, workspace.refinement()).energy;
}

double EnergyTrials::paper_energy(GridWorkspace& workspace) noexcept {
  (void)phi_.set(model_, settings_.search.duration_s, cells_);
  const Span<std::int8_t> signs = workspace.signs(cells_);
  const Span<double> product = workspace.product(cells_);
  signs_of_column(phi_, 0, signs, product);
  return run_fixed_point(phi_, settings_.search.max_iterations, 0.0, signs,
                         workspace.best_signs(cells_), product, Span<double>())
      .energy;
}

}  // namespace emax
