// Many starting signals, each climbing on the grid; the best ends refined in continuous time.
#include "emax/energy_search.hpp"

#include <limits>

#include "emax/elementary.hpp"
#include "emax/refinement.hpp"
#include "emax/wichmann_hill.hpp"

namespace emax {
namespace {

constexpr double kCellsPerPeriod = 12.0;
constexpr std::size_t kMinCells = 24;
constexpr std::size_t kClimbIterations = 200;
/// Pulses turned in one climb; no run has been seen to need as many.
constexpr std::size_t kMaxTurns = 1000;
/// Of the energy: a smaller gain of a pulse is left to the refinement.
constexpr double kSmallestGain = 1e-9;
/// A climb that ends this part below the highest one is not refined: refinement adds no more.
constexpr double kWorthRefining = 0.01;
/// Energies that differ by less than this part are of the same signal.
constexpr double kSame = 1e-11;
constexpr std::uint32_t kRandomSeed[] = {1, 2, 3, 4};

/// The number of cells of at most `cell_s`; a quotient within rounding of a whole number is that
/// number.
std::size_t cells_for(double duration_s, double cell_s) noexcept {
  const double cells = duration_s / cell_s;
  if (!(cells <= static_cast<double>(kMaxCells))) {
    return kMaxCells + 1;
  }
  const double whole = floor(cells);
  return static_cast<std::size_t>(whole) + (cells - whole > 1e-9 * cells ? 1u : 0u);
}

/// A stretch of cells, and a quarter of what turning it adds to the energy.
struct Pulse {
  std::size_t cell = 0;
  std::size_t width = 0;
  double gain = 0.0;
};

/// Hands over every stretch of up to kMaxPulse cells of equal sign, with that sign times the sum of
/// the product over it.
template <typename Visit>
void visit_pulses(Span<const std::int8_t> signs, Span<const double> product,
                  const Visit& visit) noexcept {
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const std::int8_t sign = signs[i];
    const std::size_t left = signs.size() - i;
    const std::size_t longest = left < PhiOperator::kMaxPulse ? left : PhiOperator::kMaxPulse;
    double held = 0.0;
    for (std::size_t k = 0; k < longest && signs[i + k] == sign; ++k) {
      held += sign > 0 ? product[i + k] : -product[i + k];
      visit(i, k + 1, held);
    }
  }
}

}  // namespace

std::size_t grid_cells(const ModalModel& model, double duration_s) noexcept {
  const double f0 = model.device().natural_frequency_hz;
  const double fc = model.filter().cutoff_hz;
  const std::size_t cells = cells_for(duration_s, 1.0 / (kCellsPerPeriod * (f0 > fc ? f0 : fc)));
  return cells < kMinCells ? kMinCells : cells;
}

double ascent_shift(const ModalModel& model, double cell_s) noexcept {
  const double gain = model.filter().gain;
  return model.criterion() == Criterion::kEnergyDifference ? gain * gain * cell_s : 0.0;
}

bool turn_best_pulse(const PhiOperator& phi, Span<std::int8_t> signs,
                     Span<const double> product) noexcept {
  const double smallest_gain = 0.25 * kSmallestGain * abs(dot(signs, product));
  Pulse promised;
  promised.gain = smallest_gain;
  visit_pulses(signs, product, [&](std::size_t cell, std::size_t width, double held) {
    const double gain = phi.pulse_limit(width) - held;
    if (gain > promised.gain) {
      promised = {cell, width, gain};
    }
  });
  if (promised.width == 0) {
    return false;
  }
  Pulse best = promised;
  best.gain += phi.pulse(best.cell, best.width) - phi.pulse_limit(best.width);
  if (!(best.gain > smallest_gain)) {
    // Near T a pulse may have much less energy than its limit.
    best = {0, 0, smallest_gain};
    visit_pulses(signs, product, [&](std::size_t cell, std::size_t width, double held) {
      if (!(phi.pulse_limit(width) - held > best.gain)) {
        return;
      }
      const double gain = phi.pulse(cell, width) - held;
      if (gain > best.gain) {
        best = {cell, width, gain};
      }
    });
  }
  for (std::size_t i = best.cell; i < best.cell + best.width; ++i) {
    signs[i] = static_cast<std::int8_t>(-signs[i]);
  }
  return best.width != 0;
}

Status EnergySearch::start(const ModalModel& model, const SearchSettings& settings,
                           GridWorkspace& /*workspace*/) noexcept {
  if (!(settings.duration_s > 0.0) || !is_finite(settings.duration_s)) {
    return Status::kInvalidArgument;
  }
  const bool paper = settings.method == Method::kPaper;
  if (paper && (!(settings.step_s > 0.0) || !(settings.step_s <= settings.duration_s) ||
                settings.max_iterations == 0 || settings.max_iterations > kMaxIterations)) {
    return Status::kInvalidArgument;
  }
  const std::size_t cells = paper ? cells_for(settings.duration_s, settings.step_s)
                                  : grid_cells(model, settings.duration_s);
  const Status status = operator_.set(model, settings.duration_s, cells);
  if (status != Status::kOk) {
    return status;
  }
  settings_ = settings;
  cells_ = cells;
  result_ = MaximumEnergy{};
  result_.cells = cells;
  trace_count_ = 0;
  unstorable_energy_ = -std::numeric_limits<double>::infinity();
  climbs_made_ = 0;
  climbs_ = paper ? 1 : kStarts + kPolishings;
  climbing_ = false;
  has_result_ = false;
  shift_ = paper ? 0.0 : ascent_shift(model, settings.duration_s / static_cast<double>(cells));
  shortest_half_period_s_ = 0.5 / model.device().natural_frequency_hz;
  return Status::kOk;
}

double EnergySearch::progress() const noexcept {
  return climbs_ == 0 ? 1.0 : static_cast<double>(climbs_made_) / static_cast<double>(climbs_);
}

Status EnergySearch::step(const ModalModel& model, GridWorkspace& workspace) noexcept {
  if (done()) {
    return Status::kOk;
  }
  if (climb(workspace)) {
    return Status::kOk;
  }
  end_climb(model, workspace);
  // A signal with more switches than the table holds must not be passed over in silence if it beats
  // all others.
  const bool lost = !has_result_ || unstorable_energy_ > result_.energy;
  return done() && lost ? Status::kTooManySwitches : Status::kOk;
}

/// The start of the climb that comes next.
void EnergySearch::set_start(Span<std::int8_t> signs, Span<double> product) noexcept {
  std::size_t index = climbs_made_;
  if (settings_.method == Method::kPaper) {
    signs_of_column(operator_, 0, signs, product);
    return;
  }
  if (index == 0) {
    for (std::int8_t& sign : signs) {
      sign = 1;
    }
    return;
  }
  index -= 1;
  if (index < kColumnStarts) {
    signs_of_column(operator_, index * cells_ / kColumnStarts, signs, product);
    return;
  }
  index -= kColumnStarts;
  if (index < kHalfPeriods) {
    // Half-periods in equal ratios from the shortest to T.
    const double part = static_cast<double>(index) / (kHalfPeriods - 1.0);
    const double half_period_s =
        shortest_half_period_s_ * exp(part * log(settings_.duration_s / shortest_half_period_s_));
    const double cell_s = settings_.duration_s / static_cast<double>(cells_);
    for (std::size_t i = 0; i < signs.size(); ++i) {
      const double half = 0.5 * floor((static_cast<double>(i) + 0.5) * cell_s / half_period_s);
      signs[i] = half == floor(half) ? std::int8_t{1} : std::int8_t{-1};
    }
    return;
  }
  index -= kHalfPeriods;
  WichmannHill random;
  (void)random.seed(Generator::k2006, Span<const std::uint32_t>(kRandomSeed));
  random.jump(static_cast<std::uint64_t>(index) * kMaxCells);
  for (std::int8_t& sign : signs) {
    sign = random.next() < 0.5 ? std::int8_t{-1} : std::int8_t{1};
  }
}

/// The best signal on the cells of the grid: each takes the sign in its middle.
void EnergySearch::set_to_result(Span<std::int8_t> signs) const noexcept {
  const Span<const double> times_s = result_.signal.times_s();
  const double cell_s = settings_.duration_s / static_cast<double>(cells_);
  std::size_t passed = 0;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    while (passed < times_s.size() && times_s[passed] <= (static_cast<double>(i) + 0.5) * cell_s) {
      ++passed;
    }
    signs[i] = passed % 2 == 0 ? std::int8_t{1} : std::int8_t{-1};
  }
}

/// Starts a climb, or goes on with it. @returns False if no pulse gains any more.
bool EnergySearch::climb(GridWorkspace& workspace) noexcept {
  const Span<std::int8_t> signs = workspace.signs(cells_);
  const Span<double> product = workspace.product(cells_);
  const bool paper = settings_.method == Method::kPaper;
  const bool first = !climbing_;
  if (first) {
    turns_ = 0;
    if (climbs_made_ < kStarts) {
      ++result_.starts;
      set_start(signs, product);
    } else {
      set_to_result(signs);
    }
  } else if (paper || turns_ == kMaxTurns || !turn_best_pulse(operator_, signs, product)) {
    climbing_ = false;
    return false;
  } else {
    ++turns_;
  }
  const FixedPointResult fixed_point =
      run_fixed_point(operator_, paper ? settings_.max_iterations : kClimbIterations, shift_, signs,
                      workspace.best_signs(cells_), product, Span<double>(trace_));
  trace_count_ =
      fixed_point.iterations + 1 < kTraceLength ? fixed_point.iterations + 1 : kTraceLength;
  climb_energy_ = fixed_point.energy;
  if (first) {
    iterations_ = fixed_point.iterations;
    at_rest_ = fixed_point.at_rest;
  }
  climbing_ = true;
  return true;
}

void EnergySearch::end_climb(const ModalModel& model, GridWorkspace& workspace) noexcept {
  const bool paper = settings_.method == Method::kPaper;
  const bool polishing = climbs_made_ >= kStarts;
  const bool storable =
      candidate_.set_signs(workspace.signs(cells_), settings_.duration_s) == Status::kOk;
  if (!storable) {
    unstorable_energy_ = climb_energy_ > unstorable_energy_ ? climb_energy_ : unstorable_energy_;
  } else if (paper) {
    take(energy(model, candidate_));
  } else if (polishing || is_worth_refining(climb_energy_)) {
    const double before = result_.energy;
    take(refine(model, candidate_, workspace.refinement()).energy);
    // The grid has nothing more to offer.
    if (polishing && !(result_.energy > before + kSame * abs(before))) {
      climbs_made_ = climbs_ - 1;
    }
  }
  if (!polishing) {
    ends_[climbs_made_] = climb_energy_;
  }
  ++climbs_made_;
  // Nothing to polish.
  if (climbs_made_ == kStarts && !has_result_) {
    climbs_made_ = climbs_;
  }
}

/// Whether the end of a climb is near the highest so far, and not that of an earlier climb.
bool EnergySearch::is_worth_refining(double energy) const noexcept {
  double highest = energy;
  for (const double end : Span<const double>(ends_).first(climbs_made_)) {
    if (abs(energy - end) <= kSame * abs(energy)) {
      return false;
    }
    highest = end > highest ? end : highest;
  }
  return !has_result_ || energy >= highest - kWorthRefining * abs(highest);
}

/// Makes the candidate the result if it is better.
void EnergySearch::take(double energy) noexcept {
  if (has_result_ && !(energy > result_.energy)) {
    return;
  }
  has_result_ = true;
  result_.energy = energy;
  result_.signal = candidate_;
  if (climbs_made_ < kStarts) {
    result_.iterations = iterations_;
    result_.at_rest = at_rest_;
  }
}

}  // namespace emax
