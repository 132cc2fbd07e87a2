// The largest energy that a signal within +-a and a time T can have at the output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/fixed_point.hpp"
#include "emax/modal_model.hpp"
#include "emax/phi_buffer.hpp"
#include "emax/phi_operator.hpp"
#include "emax/refinement.hpp"
#include "emax/span.hpp"
#include "emax/status.hpp"
#include "emax/switching_signal.hpp"

namespace emax {

/// The workspace has room for the packed triangle of Phi with this many cells.
inline constexpr std::size_t kPhiCells = 128;

/// Memory for signals: what every search and every trial needs while it runs, and nothing
/// afterwards. 81 KiB. The product, a refinement and a bound are never needed together and share
/// their place.
class GridWorkspace {
 public:
  /// For a bound, in place of a product.
  Span<double> numbers() noexcept { return Span<double>(numbers_); }
  /// Phi x, one number per cell.
  Span<double> product(std::size_t cells) noexcept { return Span<double>(numbers_).first(cells); }
  /// For a refinement, when the product is not needed any more.
  Span<double> refinement() noexcept { return Span<double>(numbers_).first(kRefinementScratch); }
  Span<std::int8_t> signs(std::size_t cells) noexcept {
    return Span<std::int8_t>(signs_).first(cells);
  }
  Span<std::int8_t> best_signs(std::size_t cells) noexcept {
    return Span<std::int8_t>(best_signs_).first(cells);
  }

 private:
  static_assert(packed_size(kPhiCells) >= kMaxCells);
  static_assert(packed_size(kPhiCells) >= kRefinementScratch);
  double numbers_[packed_size(kPhiCells)] = {};
  std::int8_t signs_[kMaxCells] = {};
  std::int8_t best_signs_[kMaxCells] = {};
};

static_assert(std::is_trivially_copyable_v<GridWorkspace>);

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
  SwitchingSignal signal = {};
  std::size_t cells = 0;       ///< Of the grid that was searched.
  std::size_t starts = 0;      ///< Starting signals tried.
  std::size_t iterations = 0;  ///< Of the fixed point, from the start that led here.
  bool at_rest = false;        ///< That fixed point came to rest.
};

/// The number of cells of the grid of `Method::kBest`: cells of at most 1/(12 f) with f the larger
/// of f0 and fc, so that the resonance is seen, and at least 24 of them.
///
/// @returns kMaxCells + 1 if it takes more than kMaxCells.
std::size_t grid_cells(const ModalModel& model, double duration_s) noexcept;

/// Searches in short steps, so that nothing else has to wait for it.
///
///     search.start(model, settings, workspace);
///     while (!search.done()) {
///       search.step(model, workspace);
///     }
///
/// kBest tries, always in this order: the constant signal, 4 columns of Phi, 4 periodic signals
/// with half-periods from that of the resonance up to T, and 20 patterns of seeded random signs.
/// (Random signs are the best starts: the first steps of the fixed point leave in them what the
/// error system passes most.) From each, the fixed point runs until it rests; then the pulse that
/// gains most is turned (`turn_best_pulse()`) and the fixed point runs again, until no pulse gains.
/// A pulse inside a run of equal signs is a new pair of switches, one that fills a run takes a pair
/// away, and one at the end of a run moves a switch. A climb that ends within 1 % of the highest
/// one so far is refined in continuous time. At last the best one goes back to the grid, which may
/// have gains to offer again now that its switches have moved, up to 4 times. Of equals the first
/// one wins, so the result is the same on every target. 8 KiB beside the workspace.
///
/// Effort: at most kStarts + kPolishings climbs. One climb takes 10 to 40 products with Phi where
/// few switches are best, and up to 250 where it is a hundred switches; a product costs 40 to 50
/// instructions per cell and mode, and looking for a pulse another 60 per cell.
class EnergySearch {
 public:
  static constexpr std::size_t kColumnStarts = 4;
  static constexpr std::size_t kHalfPeriods = 4;
  static constexpr std::size_t kRandomStarts = 20;
  static constexpr std::size_t kStarts = 1 + kColumnStarts + kHalfPeriods + kRandomStarts;
  static constexpr std::size_t kPolishings = 4;

  /// Lays out the grid. Model, settings and workspace must stay as they are until the search is
  /// done; the workspace holds a signal in between.
  ///
  /// @returns
  /// * kOk: Ready to `step()`.
  /// * kInvalidArgument: Duration or step not above 0 or not a number, step larger than the
  ///   duration, or no iteration or more than kMaxIterations.
  /// * kTooManyCells: The grid would need more than kMaxCells cells: shorten T, or for kPaper take
  ///   a longer step.
  Status start(const ModalModel& model, const SearchSettings& settings,
               GridWorkspace& workspace) noexcept;

  /// Takes a starting signal to where the fixed point rests, or turns one pulse and lets the fixed
  /// point run again, or refines what a climb has ended on.
  ///
  /// @returns
  /// * kOk: `done()` tells whether it was the last step.
  /// * kTooManySwitches: With the last step: the best signal has more than kMaxSwitches switches.
  ///   `result()` is then the best of those that have fewer, which is not the maximum: shorten T.
  Status step(const ModalModel& model, GridWorkspace& workspace) noexcept;

  bool done() const noexcept { return climbs_made_ == climbs_; }
  /// @returns From 0 to 1.
  double progress() const noexcept;
  /// @returns The best so far; with `done()`, the result.
  const MaximumEnergy& result() const noexcept { return result_; }

  /// E_0, E_1, ... of the fixed point, for a = 1: the whole run of kPaper, or the last one of
  /// kBest; the first kTraceLength of them.
  Span<const double> trace() const noexcept { return Span<const double>(trace_, trace_count_); }
  static constexpr std::size_t kTraceLength = 64;

 private:
  void set_start(Span<std::int8_t> signs, Span<double> product) noexcept;
  void set_to_result(Span<std::int8_t> signs) const noexcept;
  bool climb(GridWorkspace& workspace) noexcept;
  void end_climb(const ModalModel& model, GridWorkspace& workspace) noexcept;
  bool is_worth_refining(double energy) const noexcept;
  void take(double energy) noexcept;

  MaximumEnergy result_ = {};
  SearchSettings settings_ = {};
  PhiOperator operator_ = {};
  SwitchingSignal candidate_ = {};
  double trace_[kTraceLength] = {};
  double ends_[kStarts] = {};  // What each start has climbed to.
  double shift_ = 0.0;
  double shortest_half_period_s_ = 0.0;
  double unstorable_energy_ = 0.0;
  double climb_energy_ = 0.0;
  std::size_t trace_count_ = 0;
  std::size_t climbs_made_ = 0;
  std::size_t climbs_ = 0;
  std::size_t cells_ = 0;
  std::size_t iterations_ = 0;  // Of the first fixed point of this climb.
  std::size_t turns_ = 0;
  bool at_rest_ = false;
  bool climbing_ = false;
  bool has_result_ = false;
};

static_assert(std::is_trivially_copyable_v<EnergySearch>);

/// Turns the signs of one stretch of cells, up to PhiOperator::kMaxPulse of equal sign, if that
/// gains energy.
///
/// Turning the cells i to j of sign c changes the energy by 4 (their pulse's energy - c sum of
/// (Phi x)). The stretch with the largest gain is taken when the pulses' energies are set to their
/// limits, which are exact far from T; if that one does not gain, the one with the largest gain.
/// Gains below 1e-9 of the energy are left to the refinement. kMaxPulse sums per cell.
///
/// @param[in,out] signs   The pattern.
/// @param[in]     product Phi times the pattern; no longer so if a stretch has been turned.
/// @returns Whether a stretch was turned.
bool turn_best_pulse(const PhiOperator& phi, Span<std::int8_t> signs,
                     Span<const double> product) noexcept;

/// The shift c with which the fixed point climbs for either criterion: 0 for the integral-square
/// error, and for the energy difference the filter's gain squared times the width of a cell, which
/// no eigenvalue of the filter's part of Phi exceeds because the filter nowhere amplifies more than
/// its gain.
double ascent_shift(const ModalModel& model, double cell_s) noexcept;

}  // namespace emax
