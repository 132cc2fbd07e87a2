// One trial of the Monte Carlo procedure: the largest energy for a device drawn from its ranges.
#pragma once

#include <cstdint>
#include <type_traits>

#include "emax/energy_search.hpp"
#include "emax/modal_model.hpp"
#include "emax/status.hpp"
#include "emax/wichmann_hill.hpp"

namespace emax {

/// Half of the ranges of paper equation (21) and Fig. 4: each parameter is uniform within estimate
/// +- half-width.
struct ParameterBox {
  double sensitivity = 0.0;  ///< In V/(m/s^2).
  double natural_frequency_hz = 0.0;
  double damping = 0.0;
};

struct TrialSettings {
  ParameterBox box;
  WichmannHill generator;  ///< Seeded: trial 0 takes its next three numbers.
  bool gain_follows =
      false;  ///< The filter's gain is each trial's sensitivity, not the estimate's.
  SearchSettings search;
};

/// The trials of Fig. 5, in any order: trial t draws S, f0 and beta, in that order, from numbers
/// 3t, 3t + 1 and 3t + 2 of the generator, so a result depends neither on the order of the trials
/// nor on how they are shared out.
///
/// With `Method::kBest` each trial refines the signal that is best at the estimate, in continuous
/// time, for its own device. With `Method::kPaper` each trial is a whole run of
/// the fixed point from Phi's first column. 8 KiB beside the workspace.
class EnergyTrials {
 public:
  /// @param[in] at_estimate The model of the estimate, with filter and criterion.
  /// @param[in] best        The search's result at the estimate, with the same search settings.
  /// @returns
  /// * kOk: Ready.
  /// * kOverdamped, kInvalidArgument: A half-width below 0 or not a number, or so large that the
  ///   range leaves what a device may be (S, f0 above 0; damping from 1e-4 to below 1).
  /// * kTooManyCells: As `EnergySearch::start()`.
  /// Nothing has changed unless it is kOk.
  Status start(const ModalModel& at_estimate, const MaximumEnergy& best,
               const TrialSettings& settings) noexcept;

  /// @returns The device of one trial.
  Accelerometer device(std::uint32_t trial) noexcept;

  /// @returns The largest energy of one trial, for a = 1.
  /// One to three Newton steps on the switching times with kBest; a product with Phi for each
  /// iteration with kPaper.
  double energy(std::uint32_t trial, GridWorkspace& workspace) noexcept;

  /// @returns The largest energy of a given device, found as in a trial: of a corner of the box,
  ///   for one.
  double energy_of(const Accelerometer& device, GridWorkspace& workspace) noexcept;

 private:
  ModalModel model_ = {};
  PhiOperator phi_ = {};
  SwitchingSignal best_signal_ = {};
  TrialSettings settings_ = {};
  Accelerometer estimate_ = {};
  WichmannHill generator_ = {};
  std::uint32_t next_trial_ = 0;
  std::size_t cells_ = 0;
};

static_assert(std::is_trivially_copyable_v<EnergyTrials>);

}  // namespace emax
