// Lays a polynomial through the logarithm of the largest energies at Chebyshev nodes.
#include "emax/uncertainty/resonance_surface.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/energy/refinement.hpp"
#include "emax/energy/switching_signal.hpp"

namespace emax {
namespace {

/// How far nodes reach, in standard deviations of a normal distribution: of 2e5 draws one or two
/// are outside.
constexpr double kNormalReach = 4.5;
/// The farthest that the resonance may move, as part of it; and the largest damping.
constexpr double kFarthest = 0.6;
constexpr double kLargestDamping = 0.7;
/// How near to the least damping the nodes go: not quite, for rounding.
constexpr double kNearLeast = 1.0 + 1e-9;
/// Nodes of f0 and of the damping, and as many more where these do not do.
constexpr std::size_t kNodesOfFrequency = 4;
constexpr std::size_t kNodesOfDamping = 8;
constexpr std::size_t kNodesOfDampingInBox = 5;
constexpr std::size_t kMoreNodes = 4;
/// S is moved by this part of it to see which power of it the energy follows.
constexpr double kMove = 0.01;
/// So much may the resonant signal be below what the search has found at the estimate.
constexpr double kAcceptedAtEstimate = 1e-3;
constexpr std::uint32_t kDrawsForDeviation = 1024;
constexpr double kRounding = 1e-9;
constexpr double kPhases[] = {0.25, 0.75};

/// Sets a square wave whose last switch is `phase` of half a period before T. @returns False if it
/// has too many switches.
bool set_wave(double half_period_s, double phase, double duration_s, Span<double> scratch,
              SwitchingSignal& signal) noexcept {
  const double halves = duration_s / half_period_s - phase;
  if (!(halves > 0.0) || !(halves < static_cast<double>(kMaxSwitches))) {
    return false;
  }
  std::size_t count = 0;
  for (double before = floor(halves); before >= 0.0; before -= 1.0) {
    const double time_s = duration_s - (before + phase) * half_period_s;
    if (time_s > 0.0) {
      scratch[count++] = time_s;
    }
  }
  return signal.set(scratch.first(count), duration_s) == Status::kOk;
}

/// Chebyshev's polynomials at a point.
template <std::size_t kCount>
void fill_orders(double point, std::size_t count, double (&orders)[kCount]) noexcept {
  double before = point;
  double order = 1.0;
  for (std::size_t i = 0; i < count; ++i) {
    orders[i] = order;
    const double next = 2.0 * point * order - before;
    before = order;
    order = next;
  }
}

double node(std::size_t index, std::size_t count) noexcept {
  const double part = static_cast<double>(2 * index + 1) / static_cast<double>(2 * count);
  return 2 * index + 1 == count ? 0.0 : cos(0.5 * kTwoPi * part);
}

}  // namespace

double resonant_energy(const ModalModel& model, double duration_s,
                       GridWorkspace& workspace) noexcept {
  const double half_period_s = 0.5 / model.device().natural_frequency_hz;
  double energies[2] = {};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!set_wave(half_period_s, kPhases[i], duration_s, workspace.refinement(),
                  workspace.signal())) {
      return 0.0;
    }
    energies[i] = refine(model, workspace.signal(), workspace.refinement()).energy;
  }
  if (energies[0] > energies[1]) {  // Cannot fail: it has been set before.
    (void)set_wave(half_period_s, kPhases[0], duration_s, workspace.refinement(),
                   workspace.signal());
    (void)refine(model, workspace.signal(), workspace.refinement());
  }
  return std::max(energies[0], energies[1]);
}

bool ResonanceSurface::Axis::reaches(double point) const noexcept {
  return abs(point) <= 1.0 + kRounding;
}

void ResonanceSurface::start(const DeviceDraws& draws, double duration_s,
                             double best_energy) noexcept {
  *this = ResonanceSurface();
  is_box_ = draws.distribution() == Distribution::kBox;
  duration_s_ = duration_s;
  best_energy_ = best_energy;
  lay_out(draws, duration_s);
  phase_ = Phase::kEstimate;
}

void ResonanceSurface::lay_out(const DeviceDraws& draws, double duration_s) noexcept {
  estimate_ = draws.estimate();
  const double f0_hz = estimate_.natural_frequency_hz;
  const double reach = is_box_ ? 1.0 : kNormalReach;
  const double half_hz = std::min(reach * draws.spread(1), kFarthest * f0_hz);
  frequency_ = {f0_hz, half_hz, half_hz > 0.0 ? kNodesOfFrequency : 1};
  knee_ = 1.0 / (kTwoPi * f0_hz * duration_s);
  const double spread = reach * draws.spread(2);
  const double low = std::max(estimate_.damping - spread, kMinDamping * kNearLeast);
  const double high = std::min(estimate_.damping + spread, kLargestDamping);
  if (!(spread > 0.0) || !(low < high)) {
    damping_ = {log(estimate_.damping + knee_), 0.0, 1};
    return;
  }
  const double first = log(low + knee_);
  const double last = log(high + knee_);
  damping_ = {0.5 * (first + last), 0.5 * (last - first),
              is_box_ ? kNodesOfDampingInBox : kNodesOfDamping};
}

void ResonanceSurface::begin_nodes(std::size_t more) noexcept {
  frequency_.nodes += frequency_.half > 0.0 ? more / 2 : 0;
  damping_.nodes += damping_.half > 0.0 ? more : 0;
  for (std::size_t i = 0; i < frequency_.nodes * damping_.nodes; ++i) {
    logarithm_[i] = 0.0;
    power_[i] = 0.0;
  }
  misfit_ = 0.0;
  largest_error_ = 0.0;
  point_ = 0;
  phase_ = Phase::kNodes;
}

double ResonanceSurface::progress() const noexcept {
  constexpr double kNodes = 0.6;
  const auto made = static_cast<double>(point_);
  if (phase_ == Phase::kNodes) {
    return kNodes * made / static_cast<double>(frequency_.nodes * damping_.nodes);
  }
  if (phase_ == Phase::kChecks) {
    return kNodes + (1.0 - kNodes) * made / static_cast<double>(kChecks);
  }
  return phase_ == Phase::kEstimate ? 0.0 : 1.0;
}

void ResonanceSurface::step(const DeviceDraws& draws, EnergyBranches& branches,
                            EnergySearch& search, GridWorkspace& workspace) noexcept {
  switch (phase_) {
    case Phase::kEstimate: {
      branches.set_device(estimate_);
      const double found = resonant_energy(branches.model(), duration_s_, workspace);
      phase_ = Phase::kFailed;
      if (found > 0.0 && found >= best_energy_ * (1.0 - kAcceptedAtEstimate)) {
        begin_nodes(0);
      }
      return;
    }
    case Phase::kNodes:
      step_node(branches, workspace);
      return;
    case Phase::kChecks:
      step_check(draws, branches, search, workspace);
      return;
    case Phase::kDone:
    case Phase::kFailed:
      return;
  }
}

void ResonanceSurface::step_node(EnergyBranches& branches, GridWorkspace& workspace) noexcept {
  const std::size_t i = point_ / damping_.nodes;
  const std::size_t j = point_ % damping_.nodes;
  const double x = node(i, frequency_.nodes);
  const double y = node(j, damping_.nodes);
  Accelerometer device = estimate_;
  device.natural_frequency_hz = frequency_.value(x);
  device.damping = damping_.half > 0.0 ? exp(damping_.value(y)) - knee_ : estimate_.damping;
  branches.set_device(device);
  const double found = resonant_energy(branches.model(), duration_s_, workspace);
  double moved[2] = {};
  for (std::size_t side = 0; side < 2; ++side) {
    Accelerometer other = device;
    other.sensitivity *= side == 0 ? 1.0 - kMove : 1.0 + kMove;
    branches.set_device(other);
    moved[side] = emax::energy(branches.model(), workspace.signal());
  }
  if (!(found > 0.0) || !(moved[0] > 0.0) || !(moved[1] > 0.0)) {
    phase_ = Phase::kFailed;
    return;
  }
  const double value = log(found);
  const double power = log(moved[1] / moved[0]) / log((1.0 + kMove) / (1.0 - kMove));
  double along[kMostNodes];
  double across[kMostNodes];
  fill_orders(x, frequency_.nodes, along);
  fill_orders(y, damping_.nodes, across);
  const double share = 1.0 / static_cast<double>(frequency_.nodes * damping_.nodes);
  std::size_t place = 0;
  for (std::size_t p = 0; p < frequency_.nodes; ++p) {
    for (std::size_t q = 0; q < damping_.nodes; ++q, ++place) {
      const double weight =
          share * (p == 0 ? 1.0 : 2.0) * (q == 0 ? 1.0 : 2.0) * along[p] * across[q];
      logarithm_[place] += weight * value;
      power_[place] += weight * power;
    }
  }
  if (++point_ == frequency_.nodes * damping_.nodes) {
    end_nodes();
  }
}

void ResonanceSurface::end_nodes() noexcept {
  point_ = 0;
  phase_ = Phase::kChecks;
  if (is_lowered_) {  // Checked before.
    misfit_ = first_misfit_;
    rough_part_ = first_rough_part_;
    phase_ = Phase::kDone;
  }
}

double ResonanceSurface::frequency_point(const Accelerometer& device) const noexcept {
  return frequency_.point(device.natural_frequency_hz);
}

double ResonanceSurface::damping_point(const Accelerometer& device) const noexcept {
  return damping_.point(log(device.damping + knee_));
}

bool ResonanceSurface::reaches(const Accelerometer& device) const noexcept {
  return frequency_.reaches(frequency_point(device)) && damping_.reaches(damping_point(device));
}

double ResonanceSurface::energy(const Accelerometer& device) const noexcept {
  double along[kMostNodes];
  double across[kMostNodes];
  fill_orders(frequency_point(device), frequency_.nodes, along);
  fill_orders(damping_point(device), damping_.nodes, across);
  double logarithm = 0.0;
  double power = 0.0;
  std::size_t place = 0;
  for (std::size_t p = 0; p < frequency_.nodes; ++p) {
    double line = 0.0;
    double power_line = 0.0;
    for (std::size_t q = 0; q < damping_.nodes; ++q, ++place) {
      line += across[q] * logarithm_[place];
      power_line += across[q] * power_[place];
    }
    logarithm += along[p] * line;
    power += along[p] * power_line;
  }
  return exp(logarithm + power * log(device.sensitivity / estimate_.sensitivity));
}

/// The first draws; some of them by a whole search.
void ResonanceSurface::step_check(const DeviceDraws& draws, EnergyBranches& branches,
                                  EnergySearch& search, GridWorkspace& workspace) noexcept {
  DeviceDraws drawn = draws;
  const bool is_device = drawn.draw(static_cast<std::uint32_t>(point_));
  const Accelerometer device = drawn.device();
  if (is_device && reaches(device)) {
    branches.set_device(device);
    double found = resonant_energy(branches.model(), duration_s_, workspace);
    if (point_ < kFullChecks) {
      Status status = search.start(branches.model(), {Method::kBest, duration_s_, 0.0, 0});
      while (status == Status::kOk && !search.done()) {
        status = search.step(branches.model(), workspace);
      }
      found = status == Status::kOk ? std::max(found, search.result().energy) : found;
    }
    const double error = abs(energy(branches.model().device()) - found);
    largest_error_ = std::max(largest_error_, error);
    misfit_ = std::max(misfit_, error / found);
  }
  if (++point_ == kChecks) {
    end_checks(draws);
  }
}

void ResonanceSurface::end_checks(const DeviceDraws& draws) noexcept {
  rough_part_ = largest_error_ / deviation(draws);
  if (rough_part_ <= kGood || (is_raised_ && rough_part_ <= kAccepted)) {
    phase_ = Phase::kDone;
    return;
  }
  if (!is_raised_) {
    is_raised_ = true;
    first_rough_part_ = rough_part_;
    first_misfit_ = misfit_;
    begin_nodes(kMoreNodes);
    return;
  }
  phase_ = Phase::kFailed;
  if (first_rough_part_ <= kAccepted) {
    is_lowered_ = true;
    take_nodes_away(kMoreNodes);
    begin_nodes(0);
  }
}

void ResonanceSurface::take_nodes_away(std::size_t nodes) noexcept {
  frequency_.nodes -= frequency_.half > 0.0 ? nodes / 2 : 0;
  damping_.nodes -= damping_.half > 0.0 ? nodes : 0;
}

/// The standard deviation of the energy over the draws, from the first of them.
double ResonanceSurface::deviation(DeviceDraws draws) const noexcept {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::uint32_t trial = 0; trial < kDrawsForDeviation; ++trial) {
    const bool is_device = draws.draw(trial);
    const Accelerometer device = draws.device();
    if (is_device && reaches(device)) {
      const double part = energy(device) / best_energy_ - 1.0;
      sum += part;
      squares += part * part;
      count += 1.0;
    }
  }
  const double mean = sum / count;
  return best_energy_ * sqrt(std::max(squares / count - mean * mean, 0.0));
}

}  // namespace emax
