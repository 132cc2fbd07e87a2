// Finds the signals that may be the worst within the ranges, and lays polynomials through them.
#include "emax/uncertainty/energy_branches.hpp"

#include <algorithm>
#include <limits>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

/// What a polynomial may be off by, as part of the energy,
constexpr double kAcceptedError = 1e-10;
/// or if that is more, as part of the standard deviation of the energy over the draws.
constexpr double kAcceptedDeviation = 1e-6;
/// the same where no higher degree is left: below what 2e5 draws say of an interval by a factor 50.
constexpr double kAcceptedAtLast = 1e-4;
/// In a piece, which has few of the draws.
constexpr double kAcceptedInPiece = 1e-3;
/// With many switches refinements of all draws would take minutes, and as signals end and others
/// begin all over the ranges, no polynomial is that good. So more is accepted, and said, as the
/// square of what there are more switches than so many;
constexpr double kFewSwitches = 8.0;
/// with more than so many, up to this part of the standard deviation.
constexpr std::size_t kManySwitches = 128;
constexpr double kMostAccepted = 0.2;
/// The most refinements times switches that a higher degree is worth.
constexpr std::size_t kMostWorkOfDegree = 30000;
/// The farthest from the estimate that polynomials of the normal distribution hold, in standard
/// deviations along each axis; and where its corners are.
constexpr double kNormalReach = 4.0;
constexpr double kInverseRoot3 = 0.57735026918962576;
/// Where devices end nearer to the estimate than this, there is nothing to lay a polynomial on.
constexpr double kLeastReach = 1.0;
/// A degree more makes the error some 10 to 100 times smaller.
constexpr double kMostHope = 1e4;
/// The error elsewhere, as a multiple of the largest one found; apart for the inner eighth of the
/// cube, as a signal that ends near a corner spoils less there.
constexpr double kDoubt = 3.0;
constexpr double kInner = 0.5;
/// Part of the change of the best energy, and of that energy: how far a branch may stay below the
/// best at all nodes and still be the best between them.
constexpr double kRoomBetweenNodes = 0.05;
constexpr double kSame = 1e-9;
/// On the way from one device to another a refinement is made wherever the resonance has moved by
/// this angle, as far back as it is remembered. Longer legs can end on another signal.
constexpr double kLeg_rad = 0.5;
/// As many legs as are worth their time; where the resonance moves farther, the signal is stretched
/// to where its pulses belong.
constexpr double kMostLegs = 8.0;
constexpr double kMemory = 3.0;  // In time constants.

/// Stretches a signal by a factor as seen from T: pulses at a resonance then are those at another
/// one. Pulses of that one go before them where the record begins.
///
/// @param scratch kMaxSwitches doubles.
void stretch(double factor, double pulse_s, Span<double> scratch,
             SwitchingSignal& signal) noexcept {
  const double duration_s = signal.duration_s();
  const Span<const double> times_s = signal.times_s();
  const double first_s = times_s.empty() ? 0.0 : duration_s - factor * (duration_s - times_s[0]);
  const auto room = static_cast<double>(kMaxSwitches - times_s.size());
  const double wanted = first_s > 0.0 && factor < 1.0 ? floor(first_s / pulse_s) : 0.0;
  std::size_t count = 0;
  for (double before = std::min(wanted, room); before >= 1.0; before -= 1.0) {
    const double time_s = first_s - before * pulse_s;
    if (time_s > 0.0) {
      scratch[count++] = time_s;
    }
  }
  for (const double time_s : times_s) {
    const double moved_s = duration_s - factor * (duration_s - time_s);
    if (moved_s > 0.0) {
      scratch[count++] = moved_s;
    }
  }
  // Cannot fail: the times ascend inside (0, T).
  (void)signal.set(scratch.first(count), duration_s);
}

/// Whether a signal has a good part of the switches that one at the resonance has. Others move
/// little with it, and one leg does.
bool is_resonant(const SwitchingSignal& signal, const Accelerometer& device) noexcept {
  constexpr double kPart = 0.5;
  return static_cast<double>(signal.count() + 1) >=
         kPart * device.natural_frequency_hz * signal.duration_s();
}

bool is_inner(const CubePoint& point) noexcept {
  return abs(point[0]) <= kInner && abs(point[1]) <= kInner && abs(point[2]) <= kInner;
}

/// Van der Corput's sequence: the digits of a number behind the point, in reverse.
double radical_inverse(std::size_t number, std::size_t base) noexcept {
  double result = 0.0;
  double digit = 1.0;
  for (; number > 0; number /= base) {
    digit /= static_cast<double>(base);
    result += digit * static_cast<double>(number % base);
  }
  return result;
}

}  // namespace

void EnergyBranches::start(const ModalModel& at_estimate, const MaximumEnergy& best,
                           const DeviceDraws& draws, const SearchSettings& search,
                           bool gain_follows) noexcept {
  model_ = at_estimate;
  search_ = search;
  estimate_ = at_estimate.device();
  gain_follows_ = gain_follows;
  if (gain_follows) {
    (void)model_.set_gain(estimate_.sensitivity);  // A device's sensitivity is a valid gain.
  }
  is_normal_ = draws.distribution() == Distribution::kNormal;
  const double most = is_normal_ ? kNormalReach : 1.0;
  scale_.start(draws, search.duration_s, most);
  const bool has_logarithm = scale_.is_logarithm();
  const double reach = has_logarithm ? draws.reach_without_damping(most) : draws.reach(most);
  is_unit_ = reach == 1.0 && !has_logarithm;
  is_piece_ = false;
  has_pieces_ = false;
  is_accurate_ = false;
  corner_ = is_normal_ ? kInverseRoot3 : 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    axes_[a] = draws.moves(a, gain_follows);
    middle_[a] = 0.0;
    reach_[a] = reach;
  }
  if (has_logarithm) {
    middle_[2] = 0.5 * (scale_.low() + scale_.high());
    reach_[2] = 0.5 * (scale_.high() - scale_.low());
  }
  for (std::size_t a = 0; a < 3; ++a) {
    inverse_reach_[a] = 1.0 / reach_[a];
  }
  pool_.clear();
  pool_.add(0, best.signal);
  degree_ = 0;
  terms_ = 0;
  tolerance_ = 0.0;
  rough_part_ = 0.0;
  unsearched_ = 0;
  pending_ = 0;
  point_ = 0;
  branch_ = 0;
  is_refining_ = false;
  phase_ = Phase::kKnown;
}

void EnergyBranches::prepare(const DeviceDraws& draws, EnergySearch& search,
                             GridWorkspace& workspace) noexcept {
  switch (phase_) {
    case Phase::kKnown:
      step_known(draws, search, workspace);
      return;
    case Phase::kSearch:
      step_search(search, workspace);
      return;
    case Phase::kMissing:
      step_missing(draws, workspace);
      return;
    case Phase::kNodes:
      step_nodes(draws, workspace);
      return;
    case Phase::kChecks:
      step_checks(draws, workspace);
      return;
    case Phase::kSeeds:
    case Phase::kReady:
      return;
  }
}

void EnergyBranches::start_piece(const EnergyBranches& whole, const CubePoint& middle,
                                 const CubePoint& half) noexcept {
  model_ = whole.model_;
  search_ = whole.search_;
  estimate_ = whole.estimate_;
  gain_follows_ = whole.gain_follows_;
  is_normal_ = whole.is_normal_;
  axes_ = whole.axes_;
  scale_ = whole.scale_;
  is_unit_ = false;
  is_piece_ = true;
  is_accurate_ = false;
  corner_ = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    middle_[a] = whole.middle_[a] + whole.reach_[a] * middle[a];
    reach_[a] = half[a] * whole.reach_[a];
    inverse_reach_[a] = 1.0 / reach_[a];
  }
  pool_.clear();
  degree_ = 0;
  terms_ = 0;
  tolerance_ = 0.0;
  rough_part_ = 0.0;
  unsearched_ = 0;
  pending_ = 0;
  point_ = 0;
  branch_ = 0;
  is_refining_ = false;
  phase_ = Phase::kSeeds;
}

void EnergyBranches::prepare_piece(const EnergyBranches& whole, const DeviceDraws& draws,
                                   GridWorkspace& workspace) noexcept {
  switch (phase_) {
    case Phase::kSeeds:
      step_seeds(whole, draws, workspace);
      return;
    case Phase::kMissing:
      step_missing(draws, workspace);
      return;
    case Phase::kNodes:
      step_nodes(draws, workspace);
      return;
    case Phase::kChecks:
      step_checks(draws, workspace);
      return;
    case Phase::kKnown:
    case Phase::kSearch:
    case Phase::kReady:
      return;
  }
}

/// Takes what the whole's signals become in the middle of the piece and at the four corners where S
/// is small: a signal that has ended in the middle may be the best at one of them.
void EnergyBranches::step_seeds(const EnergyBranches& whole, const DeviceDraws& draws,
                                GridWorkspace& workspace) noexcept {
  if (branch_ < pool_.count()) {  // As the signals of places before.
    if (refine_at(draws, place_at(point_), workspace)) {
      pool_.know(branch_, point_, refiner_.result().energy);
      branch_ += branch_ + 1 < pool_.count() ? 1 : kBranches - branch_;
    }
    return;
  }
  branch_ = std::max(branch_, kBranches);  // From here on the seeds are counted.
  const std::size_t seed = branch_ - kBranches;
  if (!is_refining_) {
    whole.pool_.load(seed, search_.duration_s, workspace.refinement(), workspace.signal());
    begin_legs(draws.device_at(whole.place_at(whole.pool_.home(seed))),
               draws.device_at(place_at(point_)), workspace);
  }
  if (!step_refinement(workspace)) {
    return;
  }
  pool_.offer(point_, workspace.signal(), refiner_.result().energy);
  if (seed + 1 < whole.pool_.count()) {
    ++branch_;
    return;
  }
  next_place_of_seeds();
}

void EnergyBranches::next_place_of_seeds() noexcept {
  branch_ = 0;
  do {
    ++point_;
  } while (point_ < kPlaces && (!is_corner(point_ - 1) || ((point_ - 1) & 1U) != 0));
  if (point_ == kPlaces) {
    point_ = 0;
    phase_ = Phase::kMissing;
  }
}

void EnergyBranches::stand_for_surface(double tolerance, double rough_part) noexcept {
  tolerance_ = tolerance;
  rough_part_ = rough_part;
  degree_ = kFirstDegree;
  phase_ = Phase::kReady;
}

double EnergyBranches::progress() const noexcept {
  // Searches take most of the time, and checks are a quarter of the rest.
  constexpr double kSearches = 0.6;
  constexpr double kNodes = 0.9;
  switch (phase_) {
    case Phase::kKnown:
    case Phase::kSearch:
      return kSearches * static_cast<double>(point_) / static_cast<double>(kPlaces);
    case Phase::kSeeds:
    case Phase::kMissing:
      return kSearches;
    case Phase::kNodes:
      return kSearches + (kNodes - kSearches) * static_cast<double>(point_) /
                             static_cast<double>(nodes().size());
    case Phase::kChecks:
      return kNodes + (1.0 - kNodes) * static_cast<double>(point_) / static_cast<double>(kChecks);
    case Phase::kReady:
      break;
  }
  return 1.0;
}

BranchNotes EnergyBranches::notes() const noexcept {
  BranchNotes notes;
  notes.branches = static_cast<std::uint8_t>(pool_.count());
  notes.degree = static_cast<std::uint8_t>(degree_);
  for (std::size_t b = 0; b < pool_.count() && degree_ != 0; ++b) {
    if (!fits_[b].has_failed) {
      ++notes.predicted;
    }
  }
  notes.unsearched = unsearched_;
  notes.is_crowded = pool_.is_crowded();
  return notes;
}

std::size_t EnergyBranches::most_switches() const noexcept {
  std::size_t most = 0;
  for (std::size_t b = 0; b < pool_.count(); ++b) {
    most = std::max(most, pool_.switches(b));
  }
  return most;
}

void EnergyBranches::set_device(const Accelerometer& device) noexcept {
  Accelerometer scaled = device;
  if (gain_follows_) {
    scaled.sensitivity = estimate_.sensitivity;
  }
  (void)model_.set_device(scaled);  // Draws and places within their reach are devices.
}

/// A corner on the axes that matter: bit a of the index is the side of axis a.
CubePoint EnergyBranches::corner(std::size_t index) const noexcept {
  CubePoint point = {};
  for (std::size_t a = 0; a < 3; ++a) {
    if (axes_[a]) {
      point[a] = (index >> a & 1U) != 0 ? corner_ : -corner_;
    }
  }
  return point;
}

/// Whether a corner is another one than those before it.
bool EnergyBranches::is_corner(std::size_t index) const noexcept {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!axes_[a] && (index >> a & 1U) != 0) {
      return false;
    }
  }
  return true;
}

/// The estimate or the middle, then the corners.
DeviceDraws::Place EnergyBranches::place_at(std::size_t index) const noexcept {
  return index == 0 ? from_point({}) : from_point(corner(index - 1));
}

/// The corners, then Halton's sequence.
CubePoint EnergyBranches::check_at(std::size_t index) const noexcept {
  if (index < kCorners) {
    return corner(index);
  }
  constexpr std::size_t kBases[3] = {2, 3, 5};
  CubePoint point = {};
  for (std::size_t a = 0; a < 3; ++a) {
    if (axes_[a]) {
      point[a] = 2.0 * radical_inverse(index - kCorners + 1, kBases[a]) - 1.0;
    }
  }
  return point;
}

DeviceDraws::Place EnergyBranches::from_point(const CubePoint& point) const noexcept {
  return scale_.to_place({middle_[0] + reach_[0] * point[0], middle_[1] + reach_[1] * point[1],
                          middle_[2] + reach_[2] * point[2]});
}

CubePoint EnergyBranches::to_point(const DeviceDraws::Place& place) const noexcept {
  if (is_unit_) {
    return place;
  }
  const DeviceDraws::Place c = scale_.to_coordinates(place);
  return {inverse_reach_[0] * (c[0] - middle_[0]), inverse_reach_[1] * (c[1] - middle_[1]),
          inverse_reach_[2] * (c[2] - middle_[2])};
}

bool EnergyBranches::is_within_reach(const DeviceDraws::Place& place) const noexcept {
  constexpr double kRounding = 1e-9;
  const DeviceDraws::Place c = scale_.to_coordinates(place);
  for (std::size_t a = 0; a < 3; ++a) {
    if (axes_[a] && !(abs(c[a] - middle_[a]) <= reach_[a] * (1.0 + kRounding))) {
      return false;
    }
  }
  return true;
}

double EnergyBranches::share_of_draws(std::size_t axis, double middle, double half) const noexcept {
  if (axis == 2 && scale_.is_logarithm()) {
    const double low = scale_.distance(middle_[2] + reach_[2] * (middle - half));
    const double high = scale_.distance(middle_[2] + reach_[2] * (middle + half));
    return share_between(low, high);
  }
  return is_normal_ ? share_between(reach_[axis] * (middle - half), reach_[axis] * (middle + half))
                    : half;
}

/// The share of the draws that are so many standard deviations from the estimate, nearly.
double EnergyBranches::share_between(double low, double high) const noexcept {
  if (!is_normal_) {
    return 0.5 * kInverseRoot3 * (high - low);
  }
  constexpr double kInverseRootOfTurn = 0.39894228040143268;  // 1 over the root of 2 pi.
  const double nearest = low > 0.0 ? low : std::min(high, 0.0);
  const double share = kInverseRootOfTurn * (high - low) * exp(-0.5 * nearest * nearest);
  return std::min(share, 1.0);
}

/// By the sizes of the coefficients of the third and higher powers.
std::size_t EnergyBranches::roughest_axis() const noexcept {
  double sums[3] = {};
  for (std::size_t b = 0; b < pool_.count(); ++b) {
    const double* coefficient = coefficients(b).data();
    for (std::size_t i = degree_ + 1; i-- > 0;) {
      for (std::size_t j = degree_ - i + 1; j-- > 0;) {
        for (std::size_t k = degree_ - i - j + 1; k-- > 0; ++coefficient) {
          sums[1] += j > 2 ? abs(*coefficient) : 0.0;
          sums[2] += k > 2 ? abs(*coefficient) : 0.0;
        }
      }
    }
  }
  return axes_[2] && (sums[2] > sums[1] || !axes_[1]) ? 2 : 1;
}

std::size_t EnergyBranches::legs_between(const Accelerometer& from,
                                         const Accelerometer& to) const noexcept {
  const double w0 = kTwoPi * from.natural_frequency_hz;
  const double memory_s = std::min(search_.duration_s, kMemory / (w0 * from.damping));
  const double moved_rad =
      kTwoPi * abs(to.natural_frequency_hz - from.natural_frequency_hz) * memory_s;
  return 1U + static_cast<std::size_t>(std::min(moved_rad / kLeg_rad, kMostLegs));
}

/// Refines a branch for a device, coming from the one that it was found at.
void EnergyBranches::start_refinement(const DeviceDraws& draws, std::size_t branch,
                                      const Accelerometer& device,
                                      GridWorkspace& workspace) noexcept {
  pool_.load(branch, search_.duration_s, workspace.refinement(), workspace.signal());
  begin_legs(draws.device_at(place_at(pool_.home(branch))), device, workspace);
}

/// Refines the workspace's signal along the way from one device to another.
void EnergyBranches::begin_legs(const Accelerometer& home, const Accelerometer& device,
                                GridWorkspace& workspace) noexcept {
  home_ = home;
  target_ = device;
  legs_ = is_resonant(workspace.signal(), home_) ? legs_between(home_, device) : 1;
  if (legs_ > static_cast<std::size_t>(kMostLegs)) {
    stretch(home_.natural_frequency_hz / device.natural_frequency_hz,
            0.5 / device.natural_frequency_hz, workspace.refinement(), workspace.signal());
    legs_ = 1;
  }
  leg_ = 0;
  begin_leg(workspace);
  is_refining_ = true;
}

void EnergyBranches::begin_leg(GridWorkspace& workspace) noexcept {
  ++leg_;
  if (leg_ == legs_) {
    set_device(target_);
  } else {
    const double part = static_cast<double>(leg_) / static_cast<double>(legs_);
    const auto between = [part](double from, double to) { return from + part * (to - from); };
    set_device({between(home_.sensitivity, target_.sensitivity),
                between(home_.natural_frequency_hz, target_.natural_frequency_hz),
                between(home_.damping, target_.damping)});
  }
  refiner_.start(workspace.signal());
}

/// @returns True with the last step.
bool EnergyBranches::step_refinement(GridWorkspace& workspace) noexcept {
  refiner_.step(model_, workspace.signal(), workspace.refinement());
  if (refiner_.done() && leg_ < legs_) {
    begin_leg(workspace);
  }
  is_refining_ = !refiner_.done();
  return refiner_.done();
}

/// A step of the refinement of the next branch. @returns True if it is refined.
bool EnergyBranches::refine_at(const DeviceDraws& draws, const DeviceDraws::Place& place,
                               GridWorkspace& workspace) noexcept {
  if (!is_refining_) {
    start_refinement(draws, branch_, draws.device_at(place), workspace);
  }
  return step_refinement(workspace);
}

void EnergyBranches::step_known(const DeviceDraws& draws, EnergySearch& search,
                                GridWorkspace& workspace) noexcept {
  const DeviceDraws::Place place = place_at(point_);
  if (branch_ < pool_.count()) {
    if (refine_at(draws, place, workspace)) {
      pool_.know(branch_, point_, refiner_.result().energy);
      ++branch_;
    }
    return;
  }
  set_device(draws.device_at(place));
  if (search.start(model_, search_) != Status::kOk) {
    ++unsearched_;
    next_place();
    return;
  }
  phase_ = Phase::kSearch;
}

void EnergyBranches::step_search(EnergySearch& search, GridWorkspace& workspace) noexcept {
  const Status status = search.step(model_, workspace);
  if (search.has_refined()) {
    pool_.offer(point_, workspace.signal(), search.refined_energy());
  }
  if (status != Status::kOk) {
    ++unsearched_;
  }
  if (status != Status::kOk || search.done()) {
    next_place();
  }
}

void EnergyBranches::next_place() noexcept {
  do {
    ++point_;
  } while (point_ < kPlaces && !is_corner(point_ - 1));
  branch_ = 0;
  phase_ = Phase::kKnown;
  if (point_ == kPlaces) {
    point_ = 0;
    phase_ = Phase::kMissing;
  }
}

/// Branches found at later places are refined at the earlier ones.
void EnergyBranches::step_missing(const DeviceDraws& draws, GridWorkspace& workspace) noexcept {
  while (point_ < kPlaces && (branch_ == pool_.count() || pool_.knows(branch_, point_) ||
                              (point_ > 0 && !is_corner(point_ - 1)))) {
    const bool is_last = branch_ == pool_.count();
    point_ += is_last ? 1U : 0U;
    branch_ = is_last ? 0 : branch_ + 1;
  }
  if (point_ == kPlaces) {
    end_places();
    return;
  }
  if (refine_at(draws, place_at(point_), workspace)) {
    pool_.know(branch_, point_, refiner_.result().energy);
  }
}

void EnergyBranches::end_places() noexcept {
  pool_.drop_low();
  origin_ = pool_.best_at(0);
  if (is_whole() && reach_[0] < kLeastReach) {
    phase_ = Phase::kReady;
    return;
  }
  begin_fit(kFirstDegree);
}

void EnergyBranches::begin_fit(std::size_t degree) noexcept {
  degree_ = degree;
  terms_ = cube_terms(degree);
  for (double& coefficient : coefficients_) {
    coefficient = 0.0;
  }
  for (Fit& fit : fits_) {
    fit = Fit();
    fit.nearest = std::numeric_limits<double>::infinity();
    fit.nearest_other = fit.nearest;
  }
  for (std::uint32_t& sets : best_sets_) {
    sets = 0;
  }
  point_ = 0;
  branch_ = 0;
  phase_ = Phase::kNodes;
}

void EnergyBranches::step_nodes(const DeviceDraws& draws, GridWorkspace& workspace) noexcept {
  const CubeNodes nodes = this->nodes();
  if (!refine_at(draws, from_point(nodes.point(point_)), workspace)) {
    return;
  }
  energies_[branch_] = refiner_.result().energy;
  nodes.add(point_, energies_[branch_] - origin_, coefficients(branch_));
  if (++branch_ < pool_.count()) {
    return;
  }
  compare_branches();
  branch_ = 0;
  if (++point_ == nodes.size()) {
    end_fit();
  }
}

void EnergyBranches::end_fit() noexcept {
  for (std::size_t b = 0; b < pool_.count(); ++b) {
    const Span<double> terms = coefficients(b);
    to_powers(degree_, terms);
    terms[terms_ - 1] += origin_;  // The constant one.
  }
  point_ = 0;
  phase_ = Phase::kChecks;
}

void EnergyBranches::step_checks(const DeviceDraws& draws, GridWorkspace& workspace) noexcept {
  const CubePoint point = check_at(point_);
  if (!refine_at(draws, from_point(point), workspace)) {
    return;
  }
  energies_[branch_] = refiner_.result().energy;
  const double error = abs(value(branch_, point) - energies_[branch_]);
  fits_[branch_].error = std::max(fits_[branch_].error, error);
  if (is_inner(point)) {
    fits_[branch_].inner_error = std::max(fits_[branch_].inner_error, error);
  }
  if (++branch_ < pool_.count()) {
    return;
  }
  compare_branches();
  branch_ = 0;
  do {
    ++point_;
  } while (point_ < kCorners && !is_corner(point_));
  if (point_ == checks()) {
    end_checks();
  }
}

/// How far each branch is below the best at a point where all have been refined.
void EnergyBranches::compare_branches() noexcept {
  const double best = *std::max_element(energies_, energies_ + pool_.count());
  std::uint32_t set = 0;
  for (std::size_t b = 0; b < pool_.count(); ++b) {
    const double below = (best - energies_[b]) / abs(best);
    fits_[b].nearest = std::min(fits_[b].nearest, below);
    if (below <= kSame) {
      set |= 1U << b;
    } else {
      fits_[b].nearest_other = std::min(fits_[b].nearest_other, below);
    }
  }
  best_sets_[set / 32] |= std::uint32_t{1} << (set % 32);
}

/// Branches, a bit each, of which one is the best at all points: those that are it alone, and of
/// several that have become the same signal the one whose polynomial is the best.
std::uint32_t EnergyBranches::needed() const noexcept {
  std::uint32_t needed = 0;
  for (const bool alone : {true, false}) {
    for (std::uint32_t set = 1; set < (1U << pool_.count()); ++set) {
      const bool is_alone = (set & (set - 1)) == 0;
      const bool occurs = (best_sets_[set / 32] >> (set % 32) & 1U) != 0;
      if (!occurs || is_alone != alone || (set & needed) != 0) {
        continue;
      }
      std::size_t best = static_cast<std::size_t>(__builtin_ctz(set));
      for (std::size_t b = best + 1; b < pool_.count(); ++b) {
        best = (set >> b & 1U) != 0 && fits_[b].error < fits_[best].error ? b : best;
      }
      needed |= 1U << best;
    }
  }
  return needed;
}

/// The standard deviation of a branch's energy over the draws, nearly.
double EnergyBranches::deviation_of(std::size_t branch) const noexcept {
  // A unit of a place has the variance 1, or that of a uniform number within +-1.
  const double unit = is_normal_ ? 1.0 : kInverseRoot3;
  const double units[3] = {unit, unit, scale_.is_logarithm() ? scale_.deviation() : unit};
  const CubePoint slopes = cube_slopes(degree_, coefficients(branch));
  double variance = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double slope = slopes[a] * (units[a] * inverse_reach_[a]);
    variance += slope * slope;
  }
  return sqrt(variance);
}

double EnergyBranches::accepted_error(std::size_t branch, double part) const noexcept {
  return std::max(kAcceptedError * abs(origin_), part * deviation_of(branch));
}

void EnergyBranches::end_checks() noexcept {
  drop_low();
  accept(kAcceptedDeviation);
  if (can_raise_degree()) {
    begin_fit(degree_ + 1);
    return;
  }
  is_accurate_ = is_predicted();
  accept(accepted_at_last());
  phase_ = Phase::kReady;
}

double EnergyBranches::accepted_at_last() const noexcept {
  if (most_switches() > kManySwitches) {
    return kMostAccepted;
  }
  const double more = std::max(static_cast<double>(most_switches()) / kFewSwitches, 1.0);
  return std::max(kAcceptedAtLast * more * more, is_piece_ ? kAcceptedInPiece : 0.0);
}

/// Says which polynomials hold, to this part of the standard deviation of their energies.
void EnergyBranches::accept(double part) noexcept {
  tolerance_ = kAcceptedError;
  rough_part_ = 0.0;
  for (std::size_t b = 0; b < pool_.count(); ++b) {
    const double error = fits_[b].error;
    fits_[b].has_failed = !(error <= accepted_error(b, part));
    if (fits_[b].has_failed) {
      continue;
    }
    tolerance_ = std::max(tolerance_, error / abs(origin_));
    if (!(error <= accepted_error(b, kAcceptedDeviation))) {
      rough_part_ = std::max(rough_part_, error / deviation_of(b));
    }
  }
}

bool EnergyBranches::can_raise_degree() const noexcept {
  if (is_piece_ || degree_ == kMaxCubeDegree ||
      pool_.count() * cube_terms(degree_ + 1) > kCoefficients ||
      work_of_fit(degree_ + 1) > kMostWorkOfDegree) {
    return false;
  }
  bool has_hope = false;
  for (std::size_t b = 0; b < pool_.count(); ++b) {
    if (fits_[b].has_failed) {
      const bool hope = fits_[b].error <= kMostHope * accepted_error(b, kAcceptedDeviation);
      if (has_pieces_ && !hope) {
        return false;
      }
      has_hope = has_hope || hope;
    }
  }
  return has_hope;
}

/// In a piece of a box three nodes are enough along the sensitivity: a signal's energy is a
/// quadratic function of it, and the signal changes little.
CubeNodes EnergyBranches::nodes() const noexcept { return nodes_of(degree_); }

CubeNodes EnergyBranches::nodes_of(std::size_t degree) const noexcept {
  return CubeNodes(degree, axes_, is_piece_ && !is_normal_ ? 3 : degree + 1);
}

std::size_t EnergyBranches::work_of_fit(std::size_t degree) const noexcept {
  return nodes_of(degree).size() * pool_.count() * (most_switches() + 1);
}

void EnergyBranches::drop_low() noexcept {
  const double room = kRoomBetweenNodes * pool_.variation() + kSame;
  // In a piece a branch may end: from there on it is another one, and no loss.
  const std::uint32_t kept = is_piece_ ? needed() : ~std::uint32_t{0};
  for (std::size_t b = pool_.count(); b-- > 0;) {
    const bool is_needed = (kept >> b & 1U) != 0;
    if ((is_needed ? fits_[b].nearest : fits_[b].nearest_other) > room) {
      remove(b);
    }
  }
}

void EnergyBranches::remove(std::size_t branch) noexcept {
  const std::size_t end = pool_.count();
  std::copy(coefficients_ + (branch + 1) * terms_, coefficients_ + end * terms_,
            coefficients_ + branch * terms_);
  std::copy(fits_ + branch + 1, fits_ + end, fits_ + branch);
  pool_.remove(branch);
}

double EnergyBranches::value(std::size_t branch, const CubePoint& point) const noexcept {
  return cube_value(degree_, coefficients(branch), point);
}

void EnergyBranches::begin() noexcept {
  pending_ = (1U << pool_.count()) - 1U;
  energy_ = -std::numeric_limits<double>::infinity();
}

void EnergyBranches::begin(const DeviceDraws::Place& place) noexcept {
  if (phase_ != Phase::kReady || degree_ == 0 || !is_within_reach(place)) {
    begin();
    return;
  }
  predict(to_point(place));
}

void EnergyBranches::predict(const CubePoint& point) noexcept {
  const std::size_t count = pool_.count();
  pending_ = 0;
  if (count == 1 && !fits_[0].has_failed) {
    energy_ = value(0, point);
    return;
  }
  const bool inner = is_inner(point);
  const auto doubt = [&](std::size_t b) {
    const Fit& fit = fits_[b];
    return fit.has_failed ? kDoubt * (inner ? fit.inner_error : fit.error) : 0.0;
  };
  double values[kBranches];
  double surely = -std::numeric_limits<double>::infinity();
  energy_ = surely;
  for (std::size_t b = 0; b < count; ++b) {
    values[b] = value(b, point);
    surely = std::max(surely, values[b] - doubt(b));
    energy_ = fits_[b].has_failed ? energy_ : std::max(energy_, values[b]);
  }
  for (std::size_t b = 0; b < count; ++b) {
    if (fits_[b].has_failed && !(values[b] + doubt(b) < surely)) {
      pending_ |= 1U << b;
    }
  }
}

std::size_t EnergyBranches::first_pending() const noexcept {
  return static_cast<std::size_t>(__builtin_ctz(pending_));
}

void EnergyBranches::begin_refinement(const DeviceDraws& draws, const Accelerometer& device,
                                      GridWorkspace& workspace) noexcept {
  start_refinement(draws, first_pending(), device, workspace);
}

void EnergyBranches::step(const DeviceDraws& draws, GridWorkspace& workspace) noexcept {
  if (done() || !step_refinement(workspace)) {
    return;
  }
  energy_ = std::max(energy_, refiner_.result().energy);
  pending_ &= pending_ - 1U;
  if (!done()) {
    start_refinement(draws, first_pending(), target_, workspace);
  }
}

}  // namespace emax
