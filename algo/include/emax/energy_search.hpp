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

/// The number of cells up to which Phi is stored; beyond, it is applied without storing it.
inline constexpr std::size_t kPhiCells = 128;

/// Memory for signals: what every search and every trial needs while it runs, and nothing
/// afterwards. 83 KiB. Phi of kPhiCells cells and a product of kMaxCells cells are never needed
/// together and share their place.
class GridWorkspace {
 public:
  Span<double> packed_phi() noexcept { return Span<double>(numbers_); }
  /// Phi x for the stored Phi, which has at most kPhiCells cells, or for the operator.
  Span<double> product(std::size_t cells, bool phi_is_stored) noexcept {
    return phi_is_stored ? Span<double>(small_product_).first(cells)
                         : Span<double>(numbers_).first(cells);
  }
  /// For a refinement, when neither Phi nor a product is needed any more.
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
  double small_product_[kPhiCells] = {};
  std::int8_t signs_[kMaxCells] = {};
  std::int8_t best_signs_[kMaxCells] = {};
};

static_assert(std::is_trivially_copyable_v<GridWorkspace>);

/// How the largest energy is looked for.
enum class Method : std::uint8_t {
  kBest,   ///< Many starts climb by the fixed point and by single cells; the best are refined.
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

/// Searches in steps of one starting signal, so that nothing else has to wait for it.
///
///     search.start(model, settings, workspace);
///     while (!search.done()) {
///       search.step(model, workspace);
///     }
///
/// kBest tries, always in this order: the constant signal, 32 columns of Phi, periodic signals with
/// 24 half-periods from that of the resonance up to T and 4 phases each, and 8 patterns of seeded
/// random signs. From each, the fixed point runs until it rests and then single cells are turned,
/// the most profitable one first, until no cell gains. The four best signals are then refined in
/// continuous time, and the one with the largest energy wins; the first of them on ties, so the
/// result is the same on every target. 11 KiB beside the workspace.
class EnergySearch {
 public:
  static constexpr std::size_t kColumnStarts = 32;
  static constexpr std::size_t kHalfPeriods = 24;
  static constexpr std::size_t kPhases = 4;
  static constexpr std::size_t kRandomStarts = 8;
  static constexpr std::size_t kStarts = 1 + kColumnStarts + kHalfPeriods * kPhases + kRandomStarts;
  static constexpr std::size_t kCandidates = 4;

  /// Lays out the grid, and fills Phi if it is to be stored. Model, settings and workspace must
  /// stay as they are until the search is done; the workspace holds Phi in between.
  ///
  /// @returns
  /// * kOk: Ready to `step()`.
  /// * kInvalidArgument: Duration or step not above 0 or not a number, step larger than the
  ///   duration, or no iteration or more than kMaxIterations.
  /// * kTooManyCells: The grid would need more than kMaxCells cells: shorten T, or for kPaper take
  ///   a longer step.
  Status start(const ModalModel& model, const SearchSettings& settings,
               GridWorkspace& workspace) noexcept;

  /// Tries the next starting signal, or refines the next of the best ones.
  ///
  /// @returns
  /// * kOk: Tried; `done()` tells whether it was the last.
  /// * kTooManySwitches: With the last start: the best signal has more than kMaxSwitches switches.
  ///   `result()` is then the best of those that have fewer, which is not the maximum: shorten T.
  Status step(const ModalModel& model, GridWorkspace& workspace) noexcept;

  bool done() const noexcept { return next_step_ == step_count_; }
  /// @returns From 0 to 1.
  double progress() const noexcept;
  /// @returns The best so far; with `done()`, the result.
  const MaximumEnergy& result() const noexcept { return result_; }

  /// E_0, E_1, ... of the fixed point, for a = 1: the whole run of kPaper, or that of the last
  /// start of kBest; the first kTraceLength of them.
  Span<const double> trace() const noexcept { return Span<const double>(trace_, trace_count_); }
  static constexpr std::size_t kTraceLength = 64;

 private:
  struct Candidate {
    double energy = 0.0;
    SwitchingSignal signal;
    std::size_t iterations = 0;
    bool at_rest = false;
  };

  bool phi_is_stored() const noexcept { return cells_ <= kPhiCells; }
  void set_start(std::size_t index, Span<std::int8_t> signs) noexcept;
  template <typename Phi>
  void try_start(const Phi& phi, const ModalModel& model, GridWorkspace& workspace) noexcept;
  void keep(const Candidate& candidate) noexcept;
  void refine_candidate(std::size_t index, const ModalModel& model,
                        GridWorkspace& workspace) noexcept;
  void take(const Candidate& candidate) noexcept;

  MaximumEnergy result_ = {};
  SearchSettings settings_ = {};
  PhiOperator operator_ = {};
  Candidate candidates_[kCandidates] = {};
  double trace_[kTraceLength] = {};
  double shift_ = 0.0;
  double shortest_half_period_s_ = 0.0;
  double unstorable_energy_ = 0.0;
  std::size_t candidate_count_ = 0;
  std::size_t trace_count_ = 0;
  std::size_t next_step_ = 0;
  std::size_t start_count_ = 0;
  std::size_t step_count_ = 0;
  std::size_t cells_ = 0;
};

static_assert(std::is_trivially_copyable_v<EnergySearch>);

/// Turns the sign of single cells, the most profitable one first, until none gains.
///
/// Turning cell i changes the energy by 4 (Phi_ii - x_i (Phi x)_i). Gains below 1e-13 of the energy
/// are rounding and end the climb, as do 16 turns per cell, which no run has been seen to need.
///
/// @tparam Phi PhiMatrix or PhiOperator.
/// @param[in,out] signs   The pattern.
/// @param[in,out] product Phi times the pattern, kept up to date.
/// @returns The number of cells turned.
template <typename Phi>
std::size_t turn_single_cells(const Phi& phi, Span<std::int8_t> signs,
                              Span<double> product) noexcept;

/// The shift c with which the fixed point climbs for either criterion: 0 for the integral-square
/// error, and for the energy difference the filter's gain squared times the width of a cell, which
/// no eigenvalue of the filter's part of Phi exceeds because the filter nowhere amplifies more than
/// its gain.
double ascent_shift(const ModalModel& model, double cell_s) noexcept;

}  // namespace emax
