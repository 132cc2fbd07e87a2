// Full searches for some of the Monte Carlo trials, in case another signal has become the best.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/status.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace emax {

/// Repeats trials by a full search. A trial knows the signals that are best at the estimate and at
/// the corners of the ranges; another one may be better in between, which only a search from new
/// starts shows.
///
///     guard.start(trial_count, trial_of_maximum);
///     while (!guard.done()) {
///       guard.step(trials, search, workspace);
///     }
///
/// Looked at are some trials at equal distances and the one with the largest energy. For trials
/// of Method::kBest; one of Method::kPaper is a full run already. 48 bytes.
class EnergyGuard {
 public:
  static constexpr std::uint32_t kSpread = 8;
  static constexpr std::uint32_t kSearches = kSpread + 1;
  /// Where several figures are guarded, each by this many and its largest.
  static constexpr std::uint32_t kSpreadOfFigure = 4;
  /// A search disagrees if its energy is above the trial's by more than this part of it, a few of
  /// the ninth digit, which is the last one printed, and more than twice the trials' own tolerance.
  static constexpr double kTolerance = 1e-8;

  /// Starts over.
  ///
  /// @param[in] trial_count      The number of trials made, 1 or more.
  /// @param[in] trial_of_maximum Below it.
  /// @param[in] spread           How many trials at equal distances, beside it.
  void start(std::uint32_t trial_count, std::uint32_t trial_of_maximum,
             std::uint32_t spread = kSpread) noexcept;

  /// Does one step of one trial or of its search.
  ///
  /// @param trials    The trials, ready; their order does not matter to their results.
  /// @param search    Used until `done()`.
  /// @param workspace As for the search.
  /// @returns
  /// * kOk: `done()` tells whether it was the last step.
  /// * kTooManySwitches, kTooManyCells: As `EnergySearch`, whose search has failed. It counts as a
  ///   disagreement, and the next step goes on with the next trial.
  Status step(EnergyTrials& trials, EnergySearch& search, GridWorkspace& workspace) noexcept;

  bool done() const noexcept { return made_ == wanted_; }
  /// @returns From 0 to 1, in steps of whole searches.
  double progress() const noexcept;
  std::uint32_t searches() const noexcept { return made_; }
  std::uint32_t disagreements() const noexcept { return disagreements_; }
  /// @returns By how much a search was above its trial at most, as part of the energy; 0 if none
  /// was.
  double largest_excess() const noexcept { return largest_excess_; }

 private:
  enum class Phase : std::uint8_t { kNext, kTrial, kSearch };

  std::uint32_t trial_number() const noexcept;
  Status end_search(Status status) noexcept;
  Status begin_search(EnergyTrials& trials, EnergySearch& search) noexcept;

  double trial_energy_ = 0.0;
  double largest_excess_ = 0.0;
  std::uint32_t trial_count_ = 0;
  std::uint32_t trial_of_maximum_ = 0;
  std::uint32_t wanted_ = 0;
  std::uint32_t made_ = 0;
  std::uint32_t disagreements_ = 0;
  Phase phase_ = Phase::kNext;
};

static_assert(std::is_trivially_copyable_v<EnergyGuard>);

}  // namespace emax
