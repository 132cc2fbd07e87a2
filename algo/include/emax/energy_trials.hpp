// One trial of the Monte Carlo procedure: the largest energy for a device drawn from its ranges.
#pragma once

#include <cstddef>
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

/// What the parameters of the trials are drawn from.
enum class Distribution : std::uint8_t {
  kBox,     ///< Each uniform within its range, paper equation (21); three numbers per trial.
  kNormal,  ///< Jointly normal with a given covariance; four numbers per trial.
};

struct TrialSettings {
  Distribution distribution = Distribution::kBox;
  ParameterBox box;              ///< kBox only.
  double covariance[3][3] = {};  ///< kNormal only: of S, f0 and beta, as the fit gives it.
  WichmannHill generator;        ///< Seeded: trial 0 takes its next numbers.
  bool gain_follows =
      false;  ///< The filter's gain is each trial's sensitivity, not the estimate's.
  SearchSettings search;
};

/// The trials of Fig. 5, in any order: with the box, trial t draws S, f0 and beta, in that order,
/// from numbers 3t, 3t + 1 and 3t + 2 of the generator; with the normal distribution numbers 4t to
/// 4t + 3 make two pairs by Box and Muller, of which the first three are taken, times the
/// covariance's Cholesky factor. So a result depends neither on the order of the trials nor on how
/// they are shared out.
///
/// With `Method::kBest` each trial takes the signal that is best at the estimate to where it is
/// best for its own device. Its switching times are smooth functions of the parameters: `start()`
/// refines them at ten devices spread over the range and lays a full quadratic through them. Then
/// it refines at the eight corners. Where the quadratic reaches the refined energy at every corner
/// to 1e-10 of it, trials use it and cost one exact energy; the times are off by third-order terms,
/// which at a maximum cost their square. Otherwise, and for the rare draw outside the corners, a
/// trial is a refinement. With `Method::kPaper` each trial is a whole run of the fixed point from
/// Phi's first column.
///
/// With a gain that follows, the whole error system scales with S: the trial is done at the
/// estimate's S and multiplied by the square of their ratio. 16 KiB beside the workspace.
class EnergyTrials {
 public:
  /// A signal with more switches than this is refined in each trial.
  static constexpr std::size_t kMaxPredicted = 64;
  /// A normal draw reaches no farther from the estimate than this many standard deviations: it is
  /// shortened to that, which happens to one in 10^7.
  static constexpr double kMaxDeviations = 6.0;

  /// @param[in] at_estimate The model of the estimate, with filter and criterion.
  /// @param[in] best        The search's result at the estimate, with the same search settings.
  /// @param     workspace   Used while this call runs.
  /// @returns
  /// * kOk: Ready.
  /// * kOverdamped, kInvalidArgument: A half-width below 0 or not a number, a covariance that is
  ///   not symmetric and positive semidefinite, or a range (for the normal distribution, six
  ///   standard deviations) that leaves what a device may be (S, f0 above 0; damping from 1e-4 to
  ///   below 1).
  /// * kTooManyCells: As `EnergySearch::start()`.
  /// Nothing has changed unless it is kOk. At most 17 refinements.
  Status start(const ModalModel& at_estimate, const MaximumEnergy& best,
               const TrialSettings& settings, GridWorkspace& workspace) noexcept;

  /// @returns The device of one trial.
  Accelerometer device(std::uint32_t trial) noexcept;

  /// @returns The largest energy of one trial, for a = 1.
  double energy(std::uint32_t trial, GridWorkspace& workspace) noexcept;

  /// @returns The largest energy of a given device, found as in a trial: of a corner of the box,
  ///   for one.
  double energy_of(const Accelerometer& device, GridWorkspace& workspace) noexcept;

  /// The model of the device last computed; at the estimate's sensitivity if the gain follows.
  const ModalModel& model() const noexcept { return model_; }
  /// What an energy of `model()` is multiplied by to be that of the device: 1 unless the gain
  /// follows.
  double scale_of(const Accelerometer& device) const noexcept;

  const SearchSettings& search_settings() const noexcept { return settings_.search; }
  /// @returns Whether trials predict their switching times.
  bool predicts() const noexcept { return predicts_; }

 private:
  static constexpr std::size_t kTerms = 9;  // Linear, squares, products.

  /// Deviations of S, f0 and beta in units that make them independent, as parts of the range.
  struct Place {
    double part[3] = {};
    bool inside = false;
  };

  static Status factor_of(const TrialSettings& settings, double (&factor)[3][3]) noexcept;
  static Status check_range(const Accelerometer& estimate, Distribution distribution,
                            const double (&factor)[3][3]) noexcept;
  Accelerometer normal_device() noexcept;
  Accelerometer device_at(const double (&z)[3]) const noexcept;
  Place place_of(const Accelerometer& device) const noexcept;
  void set_model(const Accelerometer& device) noexcept;
  bool predict(const double (&part)[3]) noexcept;
  bool refine_at(const double (&part)[3], GridWorkspace& workspace) noexcept;
  bool lay_quadratic(GridWorkspace& workspace) noexcept;
  bool holds_at_corners(GridWorkspace& workspace) noexcept;
  double best_energy(const Accelerometer& device, GridWorkspace& workspace) noexcept;
  double paper_energy(GridWorkspace& workspace) noexcept;

  ModalModel model_ = {};
  PhiOperator phi_ = {};
  SwitchingSignal best_signal_ = {};
  SwitchingSignal signal_ = {};
  double terms_[kTerms][kMaxPredicted] = {};
  TrialSettings settings_ = {};
  Accelerometer estimate_ = {};
  double factor_[3][3] = {};  // Lower triangle: a deviation of 1 of each independent unit.
  double range_ = 0.0;        // In these units, the part within which times are predicted.
  WichmannHill generator_ = {};
  std::uint32_t next_trial_ = 0;
  std::size_t cells_ = 0;
  bool predicts_ = false;
};

static_assert(std::is_trivially_copyable_v<EnergyTrials>);

}  // namespace emax
