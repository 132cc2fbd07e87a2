// One trial of the Monte Carlo procedure: the largest energy for a device drawn from its ranges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/status.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/nearby_energy.hpp"
#include "emax/model/modal_model.hpp"

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
/// to 1e-10 of it, trials use it and cost one exact energy (`NearbyEnergy`); the times are off by
/// third-order terms, which at a maximum cost their square. Otherwise, and for the rare draw
/// outside the corners, a trial is a refinement. With `Method::kPaper` each trial is a whole run of
/// the fixed point from Phi's first column.
///
/// With a gain that follows, the whole error system scales with S: the trial is done at the
/// estimate's S and multiplied by the square of their ratio.
///
///     trials.start(at_estimate, best, settings);
///     while (!trials.ready()) {
///       trials.prepare(best, workspace);
///     }
///     const double energy = trials.energy(0, best, workspace);
///
/// 9.0 KiB beside the workspace and the signal that is best at the estimate, which must stay as
/// they are.
class EnergyTrials {
 public:
  /// A signal with more switches than this is refined in each trial.
  static constexpr std::size_t kMaxPredicted = 64;
  /// A normal draw reaches no farther from the estimate than this many standard deviations: it is
  /// shortened to that, which happens to one in 10^7.
  static constexpr double kMaxDeviations = 6.0;

  /// @param[in] at_estimate The model of the estimate, with filter and criterion.
  /// @param[in] best        The search's result at the estimate, with the same search settings.
  /// @returns
  /// * kOk: `prepare()` until `ready()`.
  /// * kOverdamped, kInvalidArgument: A half-width below 0 or not a number, a covariance that is
  ///   not symmetric and positive semidefinite, or a range (for the normal distribution, six
  ///   standard deviations) that leaves what a device may be (S, f0 above 0; damping from 1e-4 to
  ///   below 1).
  /// * kTooManyCells: kPaper, and more cells than there is room for beside a store:
  ///   GridWorkspace::kMaxTrialCells.
  /// Nothing has changed unless it is kOk.
  Status start(const ModalModel& at_estimate, const MaximumEnergy& best,
               const TrialSettings& settings) noexcept;

  /// A step of one of at most 17 refinements, with all of which the quadratic is laid and looked
  /// at.
  void prepare(const MaximumEnergy& best, GridWorkspace& workspace) noexcept;
  bool ready() const noexcept { return ready_; }

  /// @returns The device of one trial.
  Accelerometer device(std::uint32_t trial) noexcept;

  /// Begins the trial of a device; one that predicts is then done already.
  void begin(const Accelerometer& device, const MaximumEnergy& best,
             GridWorkspace& workspace) noexcept;
  /// A step of its refinement, or one product with Phi of the paper's method.
  void step(GridWorkspace& workspace) noexcept;
  bool done() const noexcept { return done_; }
  /// @returns With `done()`, the largest energy of the device, for a = 1.
  double energy() const noexcept { return scale_ * energy_; }
  /// What that energy has been multiplied by.
  double scale() const noexcept { return scale_; }
  /// @returns What `begin()` or a `step()` costs at most, in cells of a product.
  std::size_t work(const MaximumEnergy& best) const noexcept;

  /// @returns The largest energy of one trial, for a = 1, all its steps at once.
  double energy(std::uint32_t trial, const MaximumEnergy& best, GridWorkspace& workspace) noexcept;

  /// @returns The largest energy of a given device, found as in a trial: of a corner of the box,
  ///   for one.
  double energy_of(const Accelerometer& device, const MaximumEnergy& best,
                   GridWorkspace& workspace) noexcept;

  /// The model of the device last computed; at the estimate's sensitivity if the gain follows.
  const ModalModel& model() const noexcept { return model_; }
  /// What an energy of `model()` is multiplied by to be that of the device: 1 unless the gain
  /// follows.
  double scale_of(const Accelerometer& device) const noexcept;

  const SearchSettings& search_settings() const noexcept { return search_; }
  /// @returns With `ready()`, whether trials predict their switching times.
  bool predicts() const noexcept { return predicts_; }

 private:
  static constexpr std::size_t kTerms = 9;  // Linear, squares, products.
  // Both ends of each axis, the positive ends of each two axes together, the corners.
  static constexpr std::size_t kEnds = 6;
  static constexpr std::size_t kNodes = 9;
  static constexpr std::size_t kPlaces = 17;

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
  bool predict(const double (&part)[3], const SwitchingSignal& best,
               SwitchingSignal& signal) const noexcept;
  static Place place_number(std::size_t index) noexcept;
  bool take_place(const Place& place, const SwitchingSignal& best,
                  SwitchingSignal& refined) noexcept;
  void take_node(const SwitchingSignal& best, const SwitchingSignal& refined) noexcept;

  ModalModel model_ = {};
  NearbyEnergy nearby_ = {};
  double terms_[kTerms][kMaxPredicted] = {};
  SearchSettings search_ = {};
  ParameterBox box_ = {};
  Refiner refiner_ = {};
  FixedPoint fixed_point_ = {};
  Accelerometer estimate_ = {};
  double factor_[3][3] = {};  // Lower triangle: a deviation of 1 of each independent unit.
  double range_ = 0.0;        // In these units, the part within which times are predicted.
  double energy_ = 0.0;       // Of the trial that is done.
  double scale_ = 0.0;
  WichmannHill first_generator_ = {};
  WichmannHill generator_ = {};
  std::uint32_t next_trial_ = 0;
  std::size_t cells_ = 0;
  std::size_t places_ = 0;  // Prepared.
  Distribution distribution_ = {};
  bool gain_follows_ = false;
  bool refining_ = false;
  bool ready_ = false;
  bool predicts_ = false;
  bool done_ = false;
};

static_assert(std::is_trivially_copyable_v<EnergyTrials>);

}  // namespace emax
