// The largest energy that a signal within +-a and a time T can have at the output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/energy/float_phi.hpp"
#include "emax/energy/grid_climb.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/energy/refinement.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// How the largest energy is looked for.
enum class Method : std::uint8_t {
  kBest,   ///< Many starts climb by the fixed point and by pulses; the best are refined.
  kPaper,  ///< The paper's procedure to the letter: the fixed point from Phi's first column.
};

struct SearchSettings {
  Method method = Method::kBest;
  double duration_s = 0.0;         ///< T.
  double step_s = 0.0;             ///< The paper's quantization step; used by kPaper only.
  std::size_t max_iterations = 0;  ///< The paper's J, 1 to kMaxIterations; used by kPaper only.
};

/// What a search ends with. Energies are for a = 1, in (V/(m/s^2))^2 s.
struct MaximumEnergy {
  double energy = 0.0;
  double rounding = 0.0;  ///< By how much rounding may have moved the energy: at most 1e-9 of it.
  SwitchingSignal signal = {};
  std::size_t cells = 0;       ///< Of the grid that was searched.
  std::size_t starts = 0;      ///< Starting signals tried.
  std::size_t iterations = 0;  ///< Of the fixed point, from the start that led here.
  bool at_rest = false;        ///< That fixed point came to rest.
};

/// Makes it as before a search; nothing of its 2 KiB passes over the stack.
void clear(MaximumEnergy& maximum) noexcept;

/// The widest cell of the grid of `Method::kBest`, in s: 1/(12 f) with f the larger of f0 and fc,
/// so that the resonance is seen. For the energy difference 4 fc counts instead of fc: there, fast
/// switching takes away what the filter would pass.
double grid_cell_s(const ModalModel& model) noexcept;

/// The number of cells of that grid, at least 24.
///
/// @returns kMaxCells + 1 if it takes more than kMaxCells.
std::size_t grid_cells(const ModalModel& model, double duration_s) noexcept;

/// The number of cells that a search with these settings lays out.
///
/// @returns kMaxCells + 1 if it takes more than kMaxCells.
std::size_t search_cells(const ModalModel& model, const SearchSettings& settings) noexcept;

/// Turns the signs of one stretch of cells, up to PhiOperator::kMaxPulse of equal sign, if that
/// gains energy, in short steps.
///
///     turn.start();
///     while (!turn.done()) {
///       turn.step(phi, signs, product);
///     }
///
/// Turning the cells i to j of sign c changes the energy by 4 (their pulse's energy - c sum of
/// (Phi x)). The stretch that gains most is taken; a pulse's energy is computed where its limit
/// allows it to be that one. Stretches that hold more than any pulse's limit are not made longer:
/// at rest they only hold more. Gains below 1e-9 of the energy are left to the refinement.
class PulseTurn {
 public:
  void start() noexcept;

  /// Looks at some stretches; with the last ones, turns the best.
  ///
  /// @param[in,out] signs   The pattern.
  /// @param[in]     product Phi times the pattern; no longer so if a stretch has been turned.
  /// @returns What it has cost, in cells of a product.
  std::size_t step(const PhiOperator& phi, Signs signs, Span<const double> product) noexcept;

  bool done() const noexcept { return done_; }
  /// @returns With `done()`, whether a stretch was turned.
  bool turned() const noexcept { return best_.width != 0; }

 private:
  /// A stretch of cells, and a quarter of what turning it adds to the energy.
  struct Pulse {
    std::size_t cell = 0;
    std::size_t width = 0;
    double gain = 0.0;
  };

  /// Looks at the stretches that begin at the next cell. @returns What it has cost.
  std::size_t look_at_next(const PhiOperator& phi, std::size_t run_end, double sign,
                           Span<const double> product) noexcept;
  void turn_best(Signs signs) noexcept;

  Pulse best_ = {};
  std::size_t next_ = 0;  // The cell whose pulses come next.
  bool done_ = true;
};

static_assert(std::is_trivially_copyable_v<PulseTurn>);

/// Searches in short steps, so that nothing else has to wait for it.
///
///     search.start(model, settings);
///     while (!search.done()) {
///       search.step(model, workspace);
///     }
///
/// kBest tries, always in this order: the constant signal, 4 columns of Phi, 4 periodic signals
/// with half-periods from that of the resonance up to T, and 20 patterns of seeded random signs; 49
/// for the energy difference, which has more local maxima. (Random signs are the best starts: the
/// first steps of the fixed point leave in them what the error system passes most.) From each, the
/// fixed point runs until it rests; then the pulse that gains most is turned and the fixed point
/// runs again, until no pulse gains (`GridClimb`, in single precision). A pulse inside a run of
/// equal signs is a new pair of switches, one that fills a run takes a pair away, and one at the
/// end of a run moves a switch. A climb that ends within 1 % of the highest one so far is refined
/// in continuous time, in `double`.
///
/// Where a resonance of light damping swings 50 times and more within T, its periodic signal is
/// tried first. If the best signal then has kManySwitches, the starts are over once kEnoughStarts
/// in a row have added nothing (`MaximumEnergy::starts` says how many were made).
///
/// Then 12 climbs, or 24, begin near the best signal: with its switches stretched so that one or
/// two more or fewer fit in, or with a part of it turned or random. At last the best one goes back
/// to the grid, which may have gains to offer again now that its switches have moved, up to 4
/// times, in `double` (`FixedPoint`, `PulseTurn`). Of equals the first one wins, so the result is
/// the same on every target. 4.2 KiB beside the workspace.
///
/// Where k has one sign on all of [0, T], which a short T makes sure of, the constant signal has
/// the greatest energy (`OneSidedResponse`), and the search is done at its start.
///
/// Effort: one climb takes 10 to 40 updates of the product where few switches are best, and up to
/// 250 where it is a hundred switches; an update costs some 7 instructions per cell and stretch
/// that has turned and 8 per cell and mode, and looking for a pulse some 30 per cell.
class EnergySearch {
 public:
  static constexpr std::size_t kColumnStarts = 4;
  static constexpr std::size_t kHalfPeriods = 4;
  static constexpr std::size_t kRandomStarts = 20;
  static constexpr std::size_t kStarts = 1 + kColumnStarts + kHalfPeriods + kRandomStarts;
  /// For the energy difference.
  static constexpr std::size_t kMaxStarts = 2 * kStarts;
  /// Climbs from the best signal with a stretch turned or made random; as many more for the energy
  /// difference.
  static constexpr std::size_t kKicks = 12;
  /// Where the damping is at most this and the best signal switches at least so often, it rides on
  /// the resonance: then the resonant start is the first one, and the starts are over as soon as so
  /// many in a row add nothing.
  static constexpr double kLightDamping = 0.05;
  static constexpr std::size_t kManySwitches = 100;
  static constexpr std::size_t kEnoughStarts = 4;
  static constexpr std::size_t kPolishings = 4;

  /// Lays out the grid. Model and settings must stay as they are until the search is done, and
  /// nobody else must work in the workspace meanwhile.
  ///
  /// @returns
  /// * kOk: Ready to `step()`.
  /// * kInvalidArgument: Duration or step not above 0 or not a number, step larger than the
  ///   duration, or no iteration or more than kMaxIterations.
  /// * kTooManyCells: The grid would need more than kMaxCells cells: shorten T, or for kPaper take
  ///   a longer step.
  /// * kLostDigits: As for `step()`.
  Status start(const ModalModel& model, const SearchSettings& settings) noexcept;

  /// Makes products with Phi, looks for pulses and refines, until it has done as much as
  /// kWorkPerStep cells of products are.
  ///
  /// @param[out] trace E_0, E_1, ... of the fixed point, for a = 1, as far as it has room; may be
  ///   empty. The same memory in each step. At the end the whole run of kPaper, or the last one of
  ///   kBest.
  /// @returns
  /// * kOk: `done()` tells whether it was the last step.
  /// * kTooManySwitches: With the last step: the best signal has more than kMaxSwitches switches.
  ///   `result()` is then the best of those that have fewer, which is not the maximum: shorten T.
  /// * kLostDigits: With the last step: rounding is more than 1e-9 of the energy in every form, or
  ///   so much that the search has not seen what it did.
  /// * kDelayNotResolved: With the last step: the delay leaves open more than 1 % of the root mean
  ///   square of the error.
  Status step(const ModalModel& model, GridWorkspace& workspace, Span<double> trace = {}) noexcept;

  bool done() const noexcept { return climbs_made_ == climbs_; }
  /// @returns From 0 to 1.
  double progress() const noexcept;
  /// @returns The best so far; with `done()`, the result.
  const MaximumEnergy& result() const noexcept { return result_; }

  /// @returns Whether the last step has ended a refinement; the workspace's signal is then refined,
  ///   and this is its energy. A step ends where a refinement does.
  bool has_refined() const noexcept { return has_refined_; }
  double refined_energy() const noexcept { return refiner_.result().energy; }

  /// The number of energies in the trace.
  std::size_t trace_count() const noexcept { return trace_count_; }

  /// In cells of products in double precision: at the end of a step one product more may have been
  /// made.
  static constexpr std::size_t kWorkPerStep = 640;

 private:
  enum class Phase : std::uint8_t {
    kPaperStart,
    kStart,
    kTables,
    kGridClimb,
    kClimb,
    kTurn,
    kRefine
  };

  /// What a start has climbed to, divided by the scale of the FloatPhi; equal ones are of the same
  /// pattern.
  struct End {
    float energy;
    std::uint32_t pattern;
  };

  std::size_t step_with_operator(const PhiOperator& phi, const ModalModel& model,
                                 GridWorkspace& workspace, Span<double> trace) noexcept;
  std::size_t step_without_operator(const ModalModel& model, GridWorkspace& workspace) noexcept;
  bool needs_operator() const noexcept;
  std::size_t step_grid_climb(GridWorkspace& workspace) noexcept;
  std::size_t step_refinement(const ModalModel& model, GridWorkspace& workspace) noexcept;
  std::size_t fill_tables(const PhiOperator& phi, const ModalModel& model,
                          GridWorkspace& workspace) noexcept;
  Span<float> table(GridWorkspace& workspace) const noexcept;
  Span<float> pulses(GridWorkspace& workspace) const noexcept;
  Span<float> product(GridWorkspace& workspace) const noexcept;
  void begin_climb(GridWorkspace& workspace) noexcept;
  void set_start(GridWorkspace& workspace) noexcept;
  void set_to_column(std::size_t cell, GridWorkspace& workspace) const noexcept;
  void set_to_half_periods(double half_period_s, Signs signs) const noexcept;
  void set_to_result(Signs signs) const noexcept;
  void set_to_stretched_result(std::size_t number, Signs signs) const noexcept;
  void set_to_kick(Signs signs) const noexcept;
  void run_fixed_point() noexcept;
  void end_fixed_point(std::size_t room) noexcept;
  std::size_t step_turn(const PhiOperator& phi, const ModalModel& model,
                        GridWorkspace& workspace) noexcept;
  void end_grid_climb(GridWorkspace& workspace) noexcept;
  void end_climb(const ModalModel& model, GridWorkspace& workspace) noexcept;
  void end_refinement(const SwitchingSignal& refined) noexcept;
  void next_climb() noexcept;
  bool is_worth_refining() const noexcept;
  void take(const SwitchingSignal& signal, double energy) noexcept;
  bool is_start() const noexcept { return climbs_made_ < starts_; }
  bool is_enough() const noexcept;
  bool is_polishing() const noexcept { return climbs_made_ >= starts_ + kicks_; }
  Status look_at_one_sided(const ModalModel& model) noexcept;
  Status finish(const ModalModel& model) noexcept;
  void end_if_lost() noexcept;

  MaximumEnergy result_ = {};
  SearchSettings settings_ = {};
  FloatPhi float_phi_ = {};
  GridClimb grid_climb_ = {};
  FixedPoint fixed_point_ = {};
  PulseTurn pulse_turn_ = {};
  Refiner refiner_ = {};
  End ends_[kMaxStarts] = {};
  End end_ = {};                 // Of this climb
  float energy_to_beat_ = 0.0F;  // By a kick: that of the best pattern
  double climb_energy_ = 0.0;
  double shift_ = 0.0;
  double shortest_half_period_s_ = 0.0;
  double unstorable_energy_ = 0.0;
  double rounding_ = 0.0;  // Of any energy; a square below it is nothing but rounding.
  std::size_t trace_count_ = 0;
  std::size_t climbs_made_ = 0;
  std::size_t climbs_ = 0;
  std::size_t starts_ = 0;
  std::size_t kicks_ = 0;
  std::size_t best_start_ = 0;  // That led to the best signal
  bool rides_first_ = false;    // The first start is the resonant one.
  std::size_t cells_ = 0;
  std::size_t tables_filled_ = 0;  // In cells
  std::size_t modes_ = 0;
  std::size_t iterations_ = 0;  // Of the first fixed point of this climb.
  std::size_t turns_ = 0;
  Phase phase_ = Phase::kStart;
  bool at_rest_ = false;
  bool has_result_ = false;
  bool has_refined_ = false;
  bool is_lost_ = false;  // In rounding.
};

static_assert(std::is_trivially_copyable_v<EnergySearch>);

/// The shift c with which the fixed point climbs for either criterion: 0 for the integral-square
/// error, and for the energy difference the filter's gain squared times the width of a cell, which
/// no eigenvalue of the filter's part of Phi exceeds because the filter nowhere amplifies more than
/// its gain.
double ascent_shift(const ModalModel& model, double cell_s) noexcept;

}  // namespace emax
