// Draws a device, and takes the estimate's best signal to where it is best for that device.
#include "emax/uncertainty/energy_trials.hpp"

#include "emax/base/distributions.hpp"
#include "emax/base/elementary.hpp"
#include "emax/energy/refinement.hpp"

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

/// What trials cost, in cells of a product.
constexpr std::size_t kWorkOfPrediction = 24;
constexpr std::size_t kWorkOfSwitch = 6;
constexpr std::size_t kWorkOfRefinement = 32;

/// The two parameters of each product among the terms.
constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};

Accelerometer moved(const Accelerometer& estimate, const double (&deviation)[3]) noexcept {
  return {estimate.sensitivity + deviation[0], estimate.natural_frequency_hz + deviation[1],
          estimate.damping + deviation[2]};
}

bool is_uncertainty(double u) noexcept { return u >= 0.0 && is_finite(u); }

}  // namespace

Status EnergyTrials::start(const ModalModel& at_estimate, const MaximumEnergy& best,
                           const TrialSettings& settings) noexcept {
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
  const bool paper = settings.search.method == Method::kPaper;
  if (paper && best.cells > GridWorkspace::kMaxTrialCells) {
    return Status::kTooManyCells;
  }
  model_ = at_estimate;
  search_ = settings.search;
  box_ = settings.box;
  distribution_ = settings.distribution;
  gain_follows_ = settings.gain_follows;
  estimate_ = at_estimate.device();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      factor_[i][j] = factor[i][j];
    }
  }
  range_ = settings.distribution == Distribution::kBox ? 1.0 : kPredictedDeviations;
  first_generator_ = settings.generator;
  generator_ = settings.generator;
  next_trial_ = 0;
  cells_ = best.cells;
  if (gain_follows_) {
    (void)model_.set_gain(estimate_.sensitivity);  // A device's sensitivity is a valid gain.
  }
  places_ = 0;
  refining_ = false;
  predicts_ = false;
  ready_ = paper || best.signal.count() > kMaxPredicted;
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
  const bool is_box = distribution_ == Distribution::kBox;
  if (trial != next_trial_) {
    generator_ = first_generator_;
    generator_.jump(std::uint64_t{is_box ? 3U : 4U} * trial);
  }
  next_trial_ = trial + 1;
  if (!is_box) {
    return normal_device();
  }
  const ParameterBox& box = box_;
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
  return gain_follows_ ? ratio * ratio : 1.0;
}

void EnergyTrials::set_model(const Accelerometer& device) noexcept {
  Accelerometer scaled = device;
  if (gain_follows_) {
    scaled.sensitivity = estimate_.sensitivity;
  }
  (void)model_.set_device(scaled);  // `start()` has seen that the whole range is valid.
}

/// Sets a signal to the predicted switching times. @returns False if they are out of order.
bool EnergyTrials::predict(const double (&part)[3], const SwitchingSignal& best,
                           SwitchingSignal& signal) const noexcept {
  double factors[kTerms];
  for (std::size_t a = 0; a < 3; ++a) {
    factors[a] = part[a];
    factors[3 + a] = part[a] * part[a];
    factors[6 + a] = part[kPairs[a][0]] * part[kPairs[a][1]];
  }
  const std::size_t count = best.count();
  double times_s[kMaxPredicted];
  for (std::size_t i = 0; i < count; ++i) {
    double move_s = 0.0;
    for (std::size_t k = 0; k < kTerms; ++k) {
      move_s += factors[k] * terms_[k][i];
    }
    times_s[i] = best.times_s()[i] + move_s;
  }
  return signal.set(Span<const double>(times_s, count), best.duration_s()) == Status::kOk;
}

/// Where the quadratic is laid through, then where it is looked at.
EnergyTrials::Place EnergyTrials::place_number(std::size_t index) noexcept {
  Place place;
  if (index < kEnds) {
    place.part[index / 2] = index % 2 == 0 ? 1.0 : -1.0;
    return place;
  }
  if (index < kNodes) {
    place.part[kPairs[index - kEnds][0]] = 1.0;
    place.part[kPairs[index - kEnds][1]] = 1.0;
    return place;
  }
  const std::size_t corner = index - kNodes;
  for (std::size_t a = 0; a < 3; ++a) {
    place.part[a] = (corner >> a & 1U) != 0 ? 1.0 : -1.0;
  }
  return place;
}

/// Refines the estimate's signal for the device at the next place of the range.
void EnergyTrials::prepare(const MaximumEnergy& best, GridWorkspace& workspace) noexcept {
  if (ready_) {
    return;
  }
  SwitchingSignal& signal = workspace.signal();
  const Place place = place_number(places_);
  if (!refining_) {
    const double z[3] = {range_ * place.part[0], range_ * place.part[1], range_ * place.part[2]};
    set_model(device_at(z));
    signal = best.signal;
    refiner_.start(signal);
    refining_ = true;
  }
  refiner_.step(model_, signal, workspace.refinement());
  if (!refiner_.done()) {
    return;
  }
  refining_ = false;
  if (!take_place(place, best.signal, signal)) {
    ready_ = true;
    return;
  }
  ++places_;
  if (places_ == kPlaces) {
    nearby_.prepare(model_, best.signal);
    predicts_ = true;
    ready_ = true;
  }
}

/// @returns False if the quadratic does not hold: there is nothing to predict then.
bool EnergyTrials::take_place(const Place& place, const SwitchingSignal& best,
                              SwitchingSignal& refined) noexcept {
  if (refined.count() != best.count()) {
    return false;
  }
  if (places_ < kNodes) {
    take_node(best, refined);
    return true;
  }
  const double reached = emax::energy(model_, refined);
  return predict(place.part, best, refined) &&
         emax::energy(model_, refined) >= reached - kPermittedLoss * abs(reached);
}

/// Makes the quadratic go through the refined times of this place.
void EnergyTrials::take_node(const SwitchingSignal& best, const SwitchingSignal& refined) noexcept {
  for (std::size_t i = 0; i < best.count(); ++i) {
    const double moved_s = refined.times_s()[i] - best.times_s()[i];
    if (places_ >= kEnds) {
      const std::size_t pair = places_ - kEnds;
      const std::size_t a = kPairs[pair][0];
      const std::size_t b = kPairs[pair][1];
      terms_[6 + pair][i] =
          moved_s - terms_[a][i] - terms_[3 + a][i] - terms_[b][i] - terms_[3 + b][i];
      continue;
    }
    const std::size_t a = places_ / 2;
    if (places_ % 2 == 0) {
      terms_[a][i] = moved_s;
      continue;
    }
    const double up = terms_[a][i];
    terms_[a][i] = 0.5 * (up - moved_s);
    terms_[3 + a][i] = 0.5 * (up + moved_s);
  }
}

double EnergyTrials::energy(std::uint32_t trial, const MaximumEnergy& best,
                            GridWorkspace& workspace) noexcept {
  return energy_of(device(trial), best, workspace);
}

double EnergyTrials::energy_of(const Accelerometer& device, const MaximumEnergy& best,
                               GridWorkspace& workspace) noexcept {
  begin(device, best, workspace);
  while (!done()) {
    step(workspace);
  }
  return energy();
}

std::size_t EnergyTrials::work(const MaximumEnergy& best) const noexcept {
  if (search_.method == Method::kPaper) {
    return cells_;
  }
  return predicts_ ? kWorkOfPrediction + kWorkOfSwitch * best.signal.count()
                   : kWorkOfRefinement * (best.signal.count() + 1);
}

void EnergyTrials::begin(const Accelerometer& device, const MaximumEnergy& best,
                         GridWorkspace& workspace) noexcept {
  set_model(device);
  scale_ = scale_of(device);
  done_ = false;
  if (search_.method == Method::kPaper) {
    PhiOperator phi;
    (void)phi.set(model_, search_.duration_s, cells_);
    signs_of_column(phi, 0, workspace.signs(cells_), workspace.product(cells_));
    fixed_point_.start(search_.max_iterations, 0.0);
    return;
  }
  SwitchingSignal& signal = workspace.signal();
  if (predicts_) {
    const Place place = place_of(device);
    if (place.inside && predict(place.part, best.signal, signal)) {
      energy_ = nearby_.energy(model_, signal, best.signal);
      done_ = true;
      return;
    }
  }
  signal = best.signal;
  refiner_.start(signal);
}

void EnergyTrials::step(GridWorkspace& workspace) noexcept {
  if (search_.method == Method::kBest) {
    refiner_.step(model_, workspace.signal(), workspace.refinement());
    energy_ = refiner_.result().energy;
    done_ = refiner_.done();
    return;
  }
  PhiOperator phi;
  (void)phi.set(model_, search_.duration_s, cells_);
  fixed_point_.step(phi, workspace.signs(cells_), workspace.best_signs(cells_),
                    workspace.product(cells_), Span<double>());
  energy_ = fixed_point_.result().energy;
  done_ = fixed_point_.done();
}

}  // namespace emax
