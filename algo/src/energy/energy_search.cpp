// Many starting signals, each climbing on the grid; the best ends refined in continuous time.
#include "emax/energy/energy_search.hpp"

#include <limits>

#include "emax/base/elementary.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/energy/refinement.hpp"

namespace emax {
namespace {

constexpr double kCellsPerPeriod = 12.0;
/// For the energy difference fast switching can pay, as it takes what the filter would pass away.
constexpr double kFinerForDifference = 4.0;
constexpr std::size_t kMinCells = 24;
constexpr std::size_t kClimbIterations = 200;
/// Pulses turned in one climb; no run has been seen to need as many.
constexpr std::size_t kMaxTurns = 1000;
/// Of the energy: a smaller gain of a pulse is left to the refinement.
constexpr double kSmallestGain = 1e-9;
/// A climb that ends this part below the highest one is not refined: refinement adds no more.
constexpr float kWorthRefining = 0.01F;
/// Kicks that change the time between switches.
constexpr std::size_t kStretches = 8;
/// The longest stretch that another kick changes, as part of all cells, and what it must gain to be
/// refined.
constexpr double kLongestKick = 0.25;
constexpr float kGainOfKick = 2e-6F;
/// Energies that differ by less than this part are of the same signal.
constexpr double kSame = 1e-11;
/// What a step of a refinement costs for each switch, in cells of a product.
constexpr std::size_t kWorkOfRefinement = 96;
/// What the energy of a pulse costs, and how much of that is done at once.
constexpr std::size_t kWorkOfPulse = 12;
constexpr std::size_t kWorkOfPulses = 512;
/// Cells of the tables that are filled at once, and what they cost.
constexpr std::size_t kTableStretch = 256;
constexpr std::size_t kWorkOfTables = 192;
/// What a cell of a product in double precision costs where it is not in hardware.
constexpr std::size_t kSinglesPerDouble = 32;
/// Rounding of more than this part of the energy may have led the search astray.
constexpr double kTrusted = 1e-4;
constexpr std::uint32_t kRandomSeed[] = {1, 2, 3, 4};
/// What each pattern may take of them, whatever the capacity, so that it changes no pattern.
constexpr std::uint64_t kNumbersPerPattern = 8192;

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

constexpr float magnitude(float x) noexcept { return x < 0.0F ? -x : x; }

/// A number that other patterns hardly have, the same for all signs turned (FNV-1a).
std::uint32_t mark(Signs signs) noexcept {
  const std::uint32_t turn = signs.is_positive(0) ? 0 : ~std::uint32_t{0};
  std::uint32_t hash = 2166136261U;
  for (std::size_t cell = 0; cell < signs.size(); cell += Signs::kBits) {
    const std::size_t count = signs.size() - cell;
    const std::uint32_t used =
        count < Signs::kBits ? ~std::uint32_t{0} >> (Signs::kBits - count) : ~std::uint32_t{0};
    hash = (hash ^ ((signs.word(cell / Signs::kBits) ^ turn) & used)) * 16777619U;
    hash ^= hash >> 15;
  }
  return hash;
}

/// The sign of a signal at times most of which follow each other.
class SignAt {
 public:
  explicit SignAt(const SwitchingSignal& signal) noexcept : times_s_(signal.times_s()) {}

  bool is_positive(double time_s) noexcept {
    if (passed_ != 0 && times_s_[passed_ - 1] > time_s) {
      passed_ = 0;
    }
    while (passed_ < times_s_.size() && times_s_[passed_] <= time_s) {
      ++passed_;
    }
    return passed_ % 2 == 0;
  }

 private:
  Span<const double> times_s_;
  std::size_t passed_ = 0;
};

}  // namespace

void clear(MaximumEnergy& maximum) noexcept {
  maximum.energy = 0.0;
  maximum.rounding = 0.0;
  maximum.signal.clear();
  maximum.cells = 0;
  maximum.starts = 0;
  maximum.iterations = 0;
  maximum.at_rest = false;
}

double grid_cell_s(const ModalModel& model) noexcept {
  const bool is_difference = model.criterion() == Criterion::kEnergyDifference;
  const double band_hz = is_difference ? kFinerForDifference * model.filter().band_hz : 0.0;
  const double grid_hz = model.grid_hz();
  return 1.0 / (kCellsPerPeriod * (grid_hz > band_hz ? grid_hz : band_hz));
}

std::size_t grid_cells(const ModalModel& model, double duration_s) noexcept {
  const std::size_t cells = cells_for(duration_s, grid_cell_s(model));
  return cells < kMinCells ? kMinCells : cells;
}

std::size_t search_cells(const ModalModel& model, const SearchSettings& settings) noexcept {
  return settings.method == Method::kPaper ? cells_for(settings.duration_s, settings.step_s)
                                           : grid_cells(model, settings.duration_s);
}

double ascent_shift(const ModalModel& model, double cell_s) noexcept {
  const double gain = model.filter().gain;
  return model.is_square() ? 0.0 : gain * gain * cell_s;
}

void PulseTurn::start() noexcept {
  best_ = {};
  next_ = 0;
  done_ = false;
}

std::size_t PulseTurn::step(const PhiOperator& phi, Signs signs,
                            Span<const double> product) noexcept {
  if (done_) {
    return 0;
  }
  if (next_ == 0) {
    best_.gain = 0.25 * kSmallestGain * abs(dot(signs, product));
  }
  std::size_t work = 0;
  while (next_ < signs.size() && work < kWorkOfPulses) {
    const std::size_t run_end = signs.run_end(next_);
    for (const double sign = signs[next_]; next_ < run_end && work < kWorkOfPulses; ++next_) {
      work += look_at_next(phi, run_end, sign, product);
    }
  }
  if (next_ == signs.size()) {
    turn_best(signs);
  }
  return work;
}

std::size_t PulseTurn::look_at_next(const PhiOperator& phi, std::size_t run_end, double sign,
                                    Span<const double> product) noexcept {
  const std::size_t left = run_end - next_;
  const std::size_t longest = left < PhiOperator::kMaxPulse ? left : PhiOperator::kMaxPulse;
  const double* value = product.from(next_).data();
  std::size_t work = 1;
  double held = 0.0;
  for (std::size_t k = 0; k < longest; ++k) {
    held += sign * value[k];
    if (phi.pulse_limit(k + 1) - held > best_.gain) {
      work += kWorkOfPulse;
      const double gain = phi.pulse(next_, k + 1) - held;
      if (gain > best_.gain) {
        best_ = {next_, k + 1, gain};
      }
    } else if (held > phi.greatest_pulse_limit()) {
      break;
    }
  }
  return work;
}

void PulseTurn::turn_best(Signs signs) noexcept {
  for (std::size_t i = best_.cell; i < best_.cell + best_.width; ++i) {
    signs.turn(i);
  }
  done_ = true;
}

Status EnergySearch::start(const ModalModel& model, const SearchSettings& settings) noexcept {
  if (!(settings.duration_s > 0.0) || !is_finite(settings.duration_s)) {
    return Status::kInvalidArgument;
  }
  const bool paper = settings.method == Method::kPaper;
  if (paper && (!(settings.step_s > 0.0) || !(settings.step_s <= settings.duration_s) ||
                settings.max_iterations == 0 || settings.max_iterations > kMaxIterations)) {
    return Status::kInvalidArgument;
  }
  const std::size_t cells = search_cells(model, settings);
  if (cells > kMaxCells) {
    return Status::kTooManyCells;
  }
  settings_ = settings;
  cells_ = cells;
  clear(result_);
  result_.cells = cells;
  trace_count_ = 0;
  unstorable_energy_ = -std::numeric_limits<double>::infinity();
  climbs_made_ = 0;
  starts_ = model.criterion() == Criterion::kEnergyDifference ? kMaxStarts : kStarts;
  kicks_ = 1 + (starts_ / kStarts) * kKicks;
  climbs_ = paper ? 1 : starts_ + kicks_ + kPolishings;
  tables_filled_ = 0;
  turns_ = 0;
  iterations_ = 0;
  at_rest_ = false;
  modes_ = model.modes().size();
  phase_ = paper ? Phase::kPaperStart : Phase::kStart;
  has_result_ = false;
  is_lost_ = false;
  rounding_ = model.is_square() ? energy_rounding(model, settings.duration_s, 0, 0.0) : 0.0;
  shift_ = paper ? 0.0 : ascent_shift(model, settings.duration_s / static_cast<double>(cells));
  const double f0 = model.device().natural_frequency_hz;
  shortest_half_period_s_ = 0.5 / (f0 > 0.0 ? f0 : model.filter().band_hz);
  rides_first_ =
      f0 > 0.0 && model.device().damping <= kLightDamping &&
      settings.duration_s >= static_cast<double>(kManySwitches) * shortest_half_period_s_;
  best_start_ = 0;
  return look_at_one_sided(model);
}

/// Ends the search if the constant signal is known to be the best one.
Status EnergySearch::look_at_one_sided(const ModalModel& model) noexcept {
  const OneSidedResponse constant = one_sided_response(model, settings_.duration_s);
  if (!constant.holds) {
    return Status::kOk;
  }
  const KnownEnergy& known = constant.energy;
  climbs_ = 0;
  if (!(known.rounding <= kPermittedRounding * known.energy)) {
    return Status::kLostDigits;
  }
  has_result_ = true;
  result_.energy = known.energy;
  result_.rounding = known.rounding;
  result_.at_rest = true;
  // Cannot fail: no times.
  (void)result_.signal.set(Span<const double>(), settings_.duration_s);
  return check_delay(model, known.energy, settings_.duration_s);
}

/// How far the result is known; where the closed form loses digits, by another form.
Status EnergySearch::finish(const ModalModel& model) noexcept {
  result_.rounding =
      energy_rounding(model, settings_.duration_s, result_.signal.count(), result_.energy);
  const double size = abs(result_.energy);
  if (!(result_.rounding <= kTrusted * size)) {
    return Status::kLostDigits;
  }
  if (model.moved_by() > 0.0 || !(result_.rounding <= kPermittedRounding * size)) {
    const EnergyAnswer answer = known_energy(model, result_.signal);
    if (answer.status != Status::kOk) {
      return answer.status;
    }
    result_.energy = answer.known.energy;
    result_.rounding = answer.known.rounding;
  }
  return check_delay(model, result_.energy, settings_.duration_s);
}

double EnergySearch::progress() const noexcept {
  return climbs_ == 0 ? 1.0 : static_cast<double>(climbs_made_) / static_cast<double>(climbs_);
}

Status EnergySearch::step(const ModalModel& model, GridWorkspace& workspace,
                          Span<double> trace) noexcept {
  has_refined_ = false;
  if (done()) {
    return Status::kOk;
  }
  for (std::size_t work = 0; work < kWorkPerStep && !done() && !has_refined_;) {
    if (needs_operator()) {
      PhiOperator phi;
      (void)phi.set(model, settings_.duration_s,
                    cells_);  // `start()` has seen that both are valid.
      while (work < kWorkPerStep && !done() && needs_operator()) {
        work += step_with_operator(phi, model, workspace, trace);
      }
    } else {
      work += step_without_operator(model, workspace);
    }
  }
  // A signal with more switches than the table holds must not be passed over in silence if it beats
  // all others.
  const bool lost = !has_result_ || unstorable_energy_ > result_.energy;
  if (!done()) {
    return Status::kOk;
  }
  if (is_lost_) {
    return Status::kLostDigits;
  }
  return lost ? Status::kTooManySwitches : finish(model);
}

/// @returns What it has cost, in cells of a product.
std::size_t EnergySearch::step_with_operator(const PhiOperator& phi, const ModalModel& model,
                                             GridWorkspace& workspace,
                                             Span<double> trace) noexcept {
  switch (phase_) {
    case Phase::kPaperStart:
      workspace.share_nothing();
      ++result_.starts;
      signs_of_column(phi, 0, workspace.signs(cells_), workspace.product(cells_));
      run_fixed_point();
      return cells_;
    case Phase::kTables:
      return fill_tables(phi, model, workspace);
    case Phase::kClimb:
      fixed_point_.step(phi, workspace.signs(cells_), workspace.best_signs(cells_),
                        workspace.product(cells_), trace);
      if (fixed_point_.done()) {
        end_fixed_point(trace.size());
      }
      return cells_;
    case Phase::kTurn:
      return step_turn(phi, model, workspace);
    case Phase::kStart:
    case Phase::kGridClimb:
    case Phase::kRefine:
      break;
  }
  return 0;
}

/// Whether the phase computes with Phi in double precision.
bool EnergySearch::needs_operator() const noexcept {
  return phase_ != Phase::kStart && phase_ != Phase::kGridClimb && phase_ != Phase::kRefine;
}

std::size_t EnergySearch::step_without_operator(const ModalModel& model,
                                                GridWorkspace& workspace) noexcept {
  if (phase_ == Phase::kStart) {
    begin_climb(workspace);
    return cells_ / 4;
  }
  return phase_ == Phase::kGridClimb ? step_grid_climb(workspace)
                                     : step_refinement(model, workspace);
}

/// A stretch of a climb, of about a hundredth of what a step may cost.
std::size_t EnergySearch::step_grid_climb(GridWorkspace& workspace) noexcept {
  std::size_t work = 0;
  while (!grid_climb_.done() && work < kSinglesPerDouble * 8) {
    work +=
        grid_climb_.step(float_phi_, table(workspace), pulses(workspace), workspace.signs(cells_),
                         workspace.best_signs(cells_), product(workspace));
  }
  if (grid_climb_.done()) {
    end_grid_climb(workspace);
  }
  return work / kSinglesPerDouble + 1;
}

std::size_t EnergySearch::step_refinement(const ModalModel& model,
                                          GridWorkspace& workspace) noexcept {
  refiner_.step(model, workspace.signal(), workspace.refinement());
  const std::size_t work = kWorkOfRefinement * (workspace.signal().count() + 1);
  if (refiner_.done()) {
    end_refinement(workspace.signal());
  }
  return work;
}

/// The tables lie at the end of the workspace, where they outlive refinements of signals with not
/// too many switches: that of `FloatPhi::add_stretch()`, and before it the energies of pulses if
/// there is room for them.
Span<float> EnergySearch::table(GridWorkspace& workspace) const noexcept {
  const Span<float> all = workspace.singles();
  return all.from(all.size() - cells_);
}

Span<float> EnergySearch::pulses(GridWorkspace& workspace) const noexcept {
  const Span<float> all = workspace.singles();
  const std::size_t size = FloatPhi::kMaxPulse * cells_;
  const bool is_room = size + 2 * cells_ <= all.size() / 4 * 3;
  return is_room ? all.from(all.size() - cells_ - size).first(size) : Span<float>();
}

Span<float> EnergySearch::product(GridWorkspace& workspace) const noexcept {
  return workspace.singles().first(cells_);
}

std::size_t EnergySearch::fill_tables(const PhiOperator& phi, const ModalModel& model,
                                      GridWorkspace& workspace) noexcept {
  if (tables_filled_ == 0) {
    float_phi_.set(model, phi);
  }
  const std::size_t left = cells_ - tables_filled_;
  const std::size_t end = tables_filled_ + (left < kTableStretch ? left : kTableStretch);
  float_phi_.fill_table(phi, tables_filled_, end, table(workspace));
  const Span<float> energies = pulses(workspace);
  for (std::size_t cell = tables_filled_; cell < end && !energies.empty(); ++cell) {
    float_phi_.fill_pulses(cell,
                           energies.from(FloatPhi::kMaxPulse * cell).first(FloatPhi::kMaxPulse));
  }
  tables_filled_ = end;
  if (end == cells_) {
    phase_ = Phase::kStart;
  }
  return kWorkOfTables;
}

/// The signs of a column of Phi.
void EnergySearch::set_to_column(std::size_t cell, GridWorkspace& workspace) const noexcept {
  const Span<float> column = product(workspace);
  for (float& value : column) {
    value = 0.0F;
  }
  FloatPhi::End at_end;
  float_phi_.add_stretch(cell, cell + 1, 1.0F, table(workspace), column, at_end);
  float_phi_.add_end(at_end, column);
  const Signs signs = workspace.signs(cells_);
  for (std::size_t i = 0; i < cells_; ++i) {
    signs.set(i, !(column[i] < 0.0F));
  }
}

void EnergySearch::set_to_half_periods(double half_period_s, Signs signs) const noexcept {
  const double cell_s = settings_.duration_s / static_cast<double>(cells_);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const double half = 0.5 * floor((static_cast<double>(i) + 0.5) * cell_s / half_period_s);
    signs.set(i, half == floor(half));
  }
}

/// The start of the climb that comes next.
void EnergySearch::set_start(GridWorkspace& workspace) noexcept {
  const Signs signs = workspace.signs(cells_);
  std::size_t index = climbs_made_;
  if (rides_first_ && index <= 1 + kColumnStarts) {
    index = index == 0 ? 1 + kColumnStarts : index - 1;
  }
  if (index == 0) {
    for (std::size_t i = 0; i < signs.size(); ++i) {
      signs.set(i, true);
    }
    return;
  }
  index -= 1;
  if (index < kColumnStarts) {
    set_to_column(index * cells_ / kColumnStarts, workspace);
    return;
  }
  index -= kColumnStarts;
  if (index < kHalfPeriods) {
    // Half-periods in equal ratios from the shortest to T.
    const double part = static_cast<double>(index) / (kHalfPeriods - 1.0);
    set_to_half_periods(
        shortest_half_period_s_ * exp(part * log(settings_.duration_s / shortest_half_period_s_)),
        signs);
    return;
  }
  index -= kHalfPeriods;
  WichmannHill random;
  (void)random.seed(Generator::k2006, Span<const std::uint32_t>(kRandomSeed));
  random.jump(index * kNumbersPerPattern);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    signs.set(i, !(random.next() < 0.5));
  }
}

/// The best signal on the cells of the grid: each takes the sign in its middle.
void EnergySearch::set_to_result(Signs signs) const noexcept {
  const double cell_s = settings_.duration_s / static_cast<double>(cells_);
  SignAt result(result_.signal);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    signs.set(i, result.is_positive((static_cast<double>(i) + 0.5) * cell_s));
  }
}

/// The best signal with the time between its switches changed, so that one or two more or fewer fit
/// in: from 0 on, or from T back. Where it has to go on, it repeats itself.
void EnergySearch::set_to_stretched_result(std::size_t number, Signs signs) const noexcept {
  constexpr double kMore[] = {1.0, -1.0, 2.0, -2.0};
  const auto count = static_cast<double>(result_.signal.count());
  const double factor = (count + kMore[number % 4]) / count;
  const double duration_s = settings_.duration_s;
  const double cell_s = duration_s / static_cast<double>(cells_);
  const double repeat_s = 2.0 * duration_s / (count + 1.0);
  SignAt result(result_.signal);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const double time_s = (static_cast<double>(i) + 0.5) * cell_s;
    double of_result_s = 0.0;
    if (number < 4) {
      of_result_s = factor * time_s;
      of_result_s -= of_result_s > duration_s ? repeat_s : 0.0;
    } else {
      of_result_s = duration_s - factor * (duration_s - time_s);
      of_result_s += of_result_s < 0.0 ? repeat_s : 0.0;
    }
    signs.set(i, result.is_positive(of_result_s));
  }
}

/// The start of a climb near the best signal. The first time it is that signal itself: that climb
/// says what the others have to beat. Then its switches are stretched, then parts of it are turned
/// or get random signs.
void EnergySearch::set_to_kick(Signs signs) const noexcept {
  const std::size_t number = climbs_made_ - starts_;
  if (number != 0 && number <= kStretches && result_.signal.count() > 2) {
    set_to_stretched_result(number - 1, signs);
    return;
  }
  set_to_result(signs);
  if (number == 0) {
    return;
  }
  WichmannHill random;
  (void)random.seed(Generator::k2006, Span<const std::uint32_t>(kRandomSeed));
  random.jump((kMaxStarts + number) * kNumbersPerPattern);
  const auto cells = static_cast<double>(cells_);
  const double part = random.next();
  const double width = floor(kLongestKick * part * part * cells) + 1.0;
  const auto begin = static_cast<std::size_t>(floor((cells - width) * random.next()));
  const std::size_t end = begin + static_cast<std::size_t>(width);
  for (std::size_t i = begin; i < end; ++i) {
    if (number % 2 != 0) {
      signs.turn(i);
    } else {
      signs.set(i, !(random.next() < 0.5));
    }
  }
}

void EnergySearch::begin_climb(GridWorkspace& workspace) noexcept {
  turns_ = 0;
  if (is_polishing()) {
    set_to_result(workspace.signs(cells_));
    run_fixed_point();
    return;
  }
  if (tables_filled_ != cells_) {
    workspace.share_nothing();
    phase_ = Phase::kTables;
    return;
  }
  if (is_start()) {
    ++result_.starts;
    set_start(workspace);
  } else {
    set_to_kick(workspace.signs(cells_));
  }
  grid_climb_.start(static_cast<float>(shift_ / float_phi_.scale()));
  phase_ = Phase::kGridClimb;
}

void EnergySearch::run_fixed_point() noexcept {
  const bool paper = settings_.method == Method::kPaper;
  fixed_point_.start(paper ? settings_.max_iterations : kClimbIterations, shift_);
  phase_ = Phase::kClimb;
}

/// @param[in] room Of the trace.
void EnergySearch::end_fixed_point(std::size_t room) noexcept {
  const FixedPointResult& run = fixed_point_.result();
  trace_count_ = run.iterations + 1 < room ? run.iterations + 1 : room;
  climb_energy_ = run.energy;
  end_if_lost();
  if (turns_ == 0) {
    iterations_ = run.iterations;
    at_rest_ = run.at_rest;
  }
  pulse_turn_.start();
  phase_ = Phase::kTurn;
}

/// Turns a pulse and lets the fixed point run again, or ends the climb if none gains any more.
std::size_t EnergySearch::step_turn(const PhiOperator& phi, const ModalModel& model,
                                    GridWorkspace& workspace) noexcept {
  if (settings_.method == Method::kPaper || turns_ == kMaxTurns) {
    end_climb(model, workspace);
    return 0;
  }
  const std::size_t work =
      pulse_turn_.step(phi, workspace.signs(cells_), workspace.product(cells_));
  if (!pulse_turn_.done()) {
    return work;
  }
  if (pulse_turn_.turned()) {
    ++turns_;
    run_fixed_point();
  } else {
    end_climb(model, workspace);
  }
  return work;
}

/// A first climb that sees nothing but rounding ends the search: no later one finds thousands of
/// times as much.
void EnergySearch::end_if_lost() noexcept {
  if (rounding_ > 0.0 && !(climb_energy_ > rounding_)) {
    is_lost_ = true;
    climbs_made_ = climbs_;
  }
}

void EnergySearch::end_grid_climb(GridWorkspace& workspace) noexcept {
  end_ = {static_cast<float>(grid_climb_.energy()), mark(workspace.signs(cells_))};
  climb_energy_ = float_phi_.scale() * grid_climb_.energy();
  iterations_ = grid_climb_.iterations();
  at_rest_ = grid_climb_.at_rest();
  end_if_lost();
  if (is_lost_) {
    return;
  }
  SwitchingSignal& candidate = workspace.signal();
  if (candidate.set_signs(workspace.signs(cells_), settings_.duration_s) != Status::kOk) {
    unstorable_energy_ = climb_energy_ > unstorable_energy_ ? climb_energy_ : unstorable_energy_;
  } else if (is_worth_refining()) {
    const std::size_t used = 2 * refinement_scratch(modes_, candidate.count());
    const std::size_t kept = cells_ + pulses(workspace).size();
    tables_filled_ = used + kept <= workspace.singles().size() ? tables_filled_ : 0;
    refiner_.start(candidate);
    phase_ = Phase::kRefine;
    return;
  }
  next_climb();
}

void EnergySearch::end_climb(const ModalModel& model, GridWorkspace& workspace) noexcept {
  SwitchingSignal& candidate = workspace.signal();
  if (candidate.set_signs(workspace.signs(cells_), settings_.duration_s) != Status::kOk) {
    unstorable_energy_ = climb_energy_ > unstorable_energy_ ? climb_energy_ : unstorable_energy_;
  } else if (settings_.method == Method::kPaper) {
    take(candidate, energy(model, candidate));
  } else {
    refiner_.start(candidate);
    phase_ = Phase::kRefine;
    return;
  }
  next_climb();
}

void EnergySearch::end_refinement(const SwitchingSignal& refined) noexcept {
  has_refined_ = true;
  const double before = result_.energy;
  take(refined, refiner_.result().energy);
  if (result_.energy > before + kSame * abs(before)) {
    best_start_ = climbs_made_;
  }
  // The grid has nothing more to offer.
  if (is_polishing() && !(result_.energy > before + kSame * abs(before))) {
    climbs_made_ = climbs_ - 1;
  }
  next_climb();
}

/// Whether further starts would add nothing to a signal that rides on the resonance.
bool EnergySearch::is_enough() const noexcept {
  return rides_first_ && climbs_made_ >= best_start_ + kEnoughStarts &&
         result_.signal.count() >= kManySwitches;
}

void EnergySearch::next_climb() noexcept {
  if (is_start()) {
    ends_[climbs_made_] = end_;
    climbs_made_ = is_enough() ? starts_ - 1 : climbs_made_;
  } else if (!is_polishing() && (climbs_made_ == starts_ || end_.energy > energy_to_beat_)) {
    energy_to_beat_ = end_.energy;
  }
  ++climbs_made_;
  // Nothing to polish.
  if (climbs_made_ == starts_ && !has_result_) {
    climbs_made_ = climbs_;
  }
  phase_ = Phase::kStart;
}

/// Whether the end of this climb is near the highest so far, and not that of an earlier climb.
bool EnergySearch::is_worth_refining() const noexcept {
  if (!is_start()) {
    return climbs_made_ != starts_ &&
           end_.energy > energy_to_beat_ + kGainOfKick * magnitude(energy_to_beat_);
  }
  float highest = end_.energy;
  for (const End& end : Span<const End>(ends_).first(climbs_made_)) {
    if (end.pattern == end_.pattern && end.energy == end_.energy) {
      return false;
    }
    highest = end.energy > highest ? end.energy : highest;
  }
  return !has_result_ || end_.energy >= highest - kWorthRefining * magnitude(highest);
}

/// Makes a signal the result if it is better.
void EnergySearch::take(const SwitchingSignal& signal, double energy) noexcept {
  if (has_result_ && !(energy > result_.energy)) {
    return;
  }
  has_result_ = true;
  result_.energy = energy;
  result_.signal = signal;
  if (is_start()) {
    result_.iterations = iterations_;
    result_.at_rest = at_rest_;
  }
}

}  // namespace emax
