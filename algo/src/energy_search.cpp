// Many starting signals, each climbing to a maximum on the grid.
#include "emax/energy_search.hpp"

#include <limits>

#include "emax/elementary.hpp"
#include "emax/wichmann_hill.hpp"

namespace emax {
namespace {

constexpr double kCellsPerPeriod = 12.0;
constexpr std::size_t kMinCells = 24;
constexpr std::size_t kClimbIterations = 200;
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

template <typename Phi>
std::size_t most_profitable_cell(const Phi& phi, Span<const std::int8_t> signs,
                                 Span<const double> product, double* gain) noexcept {
  const double limit = phi.diagonal_limit();
  std::size_t best = signs.size();
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const double held = signs[i] > 0 ? product[i] : -product[i];
    if (!(limit - held > *gain)) {
      continue;
    }
    const double cell_gain = phi.diagonal(i) - held;
    if (cell_gain > *gain) {
      *gain = cell_gain;
      best = i;
    }
  }
  return best;
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

template <typename Phi>
std::size_t turn_single_cells(const Phi& phi, Span<std::int8_t> signs,
                              Span<double> product) noexcept {
  const std::size_t max_turns = 16 * signs.size();
  const double smallest_gain = 0.25e-13 * abs(dot(signs, product));
  std::size_t turns = 0;
  while (turns < max_turns) {
    double gain = smallest_gain;
    const std::size_t cell = most_profitable_cell(phi, signs, product, &gain);
    if (cell == signs.size()) {
      break;
    }
    phi.add_column(cell, -2.0 * signs[cell], product);
    signs[cell] = static_cast<std::int8_t>(-signs[cell]);
    ++turns;
  }
  return turns;
}

Status EnergySearch::start(const ModalModel& model, const SearchSettings& settings,
                           GridWorkspace& workspace) noexcept {
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
  candidate_count_ = 0;
  trace_count_ = 0;
  unstorable_energy_ = -std::numeric_limits<double>::infinity();
  next_step_ = 0;
  start_count_ = paper ? 1 : kStarts;
  step_count_ = paper ? 1 : kStarts + kCandidates;
  shift_ = paper ? 0.0 : ascent_shift(model, settings.duration_s / static_cast<double>(cells));
  shortest_half_period_s_ = 0.5 / model.device().natural_frequency_hz;
  if (phi_is_stored()) {
    return fill_phi(model, settings.duration_s, cells, workspace.packed_phi());
  }
  return Status::kOk;
}

double EnergySearch::progress() const noexcept {
  return step_count_ == 0 ? 1.0
                          : static_cast<double>(next_step_) / static_cast<double>(step_count_);
}

Status EnergySearch::step(const ModalModel& model, GridWorkspace& workspace) noexcept {
  if (done()) {
    return Status::kOk;
  }
  const std::size_t step = next_step_++;
  if (step >= start_count_) {
    refine_candidate(step - start_count_, model, workspace);
  } else if (phi_is_stored()) {
    try_start(PhiMatrix(workspace.packed_phi(), cells_), model, workspace);
  } else {
    try_start(operator_, model, workspace);
  }
  // A signal with more switches than the table holds must not be passed over in silence if it beats
  // all others.
  const bool lost = candidate_count_ == 0 || unstorable_energy_ > result_.energy;
  return done() && lost ? Status::kTooManySwitches : Status::kOk;
}

void EnergySearch::set_start(std::size_t index, Span<std::int8_t> signs) noexcept {
  if (index == 0) {
    for (std::int8_t& sign : signs) {
      sign = 1;
    }
    return;
  }
  index -= 1 + kColumnStarts;
  if (index < kHalfPeriods * kPhases) {
    // Half-periods in equal ratios from the shortest to T; the phase delays the first switch.
    const std::size_t step = index / kPhases;
    const double part = static_cast<double>(step) / (kHalfPeriods - 1.0);
    const double half_period_s =
        shortest_half_period_s_ * exp(part * log(settings_.duration_s / shortest_half_period_s_));
    const double phase = static_cast<double>(index % kPhases) / static_cast<double>(kPhases);
    const double cell_s = settings_.duration_s / static_cast<double>(cells_);
    for (std::size_t i = 0; i < signs.size(); ++i) {
      const double position = (static_cast<double>(i) + 0.5) * cell_s / half_period_s + phase;
      const double half = 0.5 * floor(position);
      signs[i] = half == floor(half) ? std::int8_t{1} : std::int8_t{-1};
    }
    return;
  }
  index -= kHalfPeriods * kPhases;
  WichmannHill random;
  (void)random.seed(Generator::k2006, Span<const std::uint32_t>(kRandomSeed));
  random.jump(static_cast<std::uint64_t>(index) * kMaxCells);
  for (std::int8_t& sign : signs) {
    sign = random.next() < 0.5 ? std::int8_t{-1} : std::int8_t{1};
  }
}

template <typename Phi>
void EnergySearch::try_start(const Phi& phi, const ModalModel& model,
                             GridWorkspace& workspace) noexcept {
  const Span<std::int8_t> signs = workspace.signs(cells_);
  const Span<double> product = workspace.product(cells_, phi_is_stored());
  const bool paper = settings_.method == Method::kPaper;
  const std::size_t index = result_.starts++;
  if (paper) {
    signs_of_column(phi, 0, signs, product);
  } else if (index >= 1 && index <= kColumnStarts) {
    signs_of_column(phi, (index - 1) * cells_ / kColumnStarts, signs, product);
  } else {
    set_start(index, signs);
  }
  const FixedPointResult fixed_point =
      run_fixed_point(phi, paper ? settings_.max_iterations : kClimbIterations, shift_, signs,
                      workspace.best_signs(cells_), product, Span<double>(trace_));
  trace_count_ =
      fixed_point.iterations + 1 < kTraceLength ? fixed_point.iterations + 1 : kTraceLength;
  if (!paper) {
    turn_single_cells(phi, signs, product);
  }
  Candidate candidate{};
  candidate.iterations = fixed_point.iterations;
  candidate.at_rest = fixed_point.at_rest;
  if (candidate.signal.set_signs(signs, settings_.duration_s) == Status::kOk) {
    candidate.energy = energy(model, candidate.signal);
    keep(candidate);
  } else {
    const double found = dot(signs, product);
    unstorable_energy_ = found > unstorable_energy_ ? found : unstorable_energy_;
  }
}

void EnergySearch::take(const Candidate& candidate) noexcept {
  result_.energy = candidate.energy;
  result_.signal = candidate.signal;
  result_.iterations = candidate.iterations;
  result_.at_rest = candidate.at_rest;
}

/// Keeps the best candidates in descending order; one with the energy of another is the same
/// signal.
void EnergySearch::keep(const Candidate& candidate) noexcept {
  constexpr double kSame = 1e-10;
  std::size_t place = candidate_count_;
  for (std::size_t i = 0; i < candidate_count_; ++i) {
    if (abs(candidate.energy - candidates_[i].energy) <= kSame * abs(candidate.energy)) {
      return;
    }
    if (candidate.energy > candidates_[i].energy && place == candidate_count_) {
      place = i;
    }
  }
  if (place == kCandidates) {
    return;
  }
  candidate_count_ += candidate_count_ < kCandidates ? 1 : 0;
  for (std::size_t i = candidate_count_ - 1; i > place; --i) {
    candidates_[i] = candidates_[i - 1];
  }
  candidates_[place] = candidate;
  if (place == 0) {
    take(candidate);
  }
}

void EnergySearch::refine_candidate(std::size_t index, const ModalModel& model,
                                    GridWorkspace& workspace) noexcept {
  if (index >= candidate_count_) {
    return;
  }
  Candidate& candidate = candidates_[index];
  candidate.energy = refine(model, candidate.signal, workspace.refinement()).energy;
  if (index == 0 || candidate.energy > result_.energy) {
    take(candidate);
  }
}

template std::size_t turn_single_cells(const PhiMatrix&, Span<std::int8_t>, Span<double>) noexcept;
template std::size_t turn_single_cells(const PhiOperator&, Span<std::int8_t>,
                                       Span<double>) noexcept;

}  // namespace emax
