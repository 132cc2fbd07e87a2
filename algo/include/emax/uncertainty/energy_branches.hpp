// The largest energy as a function of the device: several signals, each with a polynomial.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/energy/refinement.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/uncertainty/branch_pool.hpp"
#include "emax/uncertainty/cube_polynomial.hpp"
#include "emax/uncertainty/damping_scale.hpp"
#include "emax/uncertainty/device_draws.hpp"

namespace emax {

/// What was found out about the signals that may be the worst within the ranges of the parameters.
struct BranchNotes {
  std::uint8_t branches = 0;    ///< Kept.
  std::uint8_t predicted = 0;   ///< Of them with a polynomial that passed its check.
  std::uint8_t degree = 0;      ///< Of the polynomials; 0 if there are none.
  std::uint8_t unsearched = 0;  ///< Places where the search failed: too many cells or switches.
  std::uint8_t pieces = 0;      ///< Parts of the ranges with branches of their own; 0 if not cut.
  std::uint8_t pieces_predicted = 0;  ///< Of them, where all branches have polynomials.
  bool is_crowded = false;            ///< A signal that might matter found no room.
  /// Trials by polynomials that are not accurate to 1e-6 of u(E), and what those may be off by as
  /// part of u(E).
  std::uint32_t rough_trials = 0;
  float rough_part = 0.0F;
};

/// The largest energy E*(S, f0, beta) of a figure within the ranges of its parameters.
///
/// A signal that is refined for its device has an energy that is smooth in S, f0 and beta: a
/// branch. The largest energy is the largest over branches, and which one that is may change within
/// the ranges. So `prepare()` searches at the estimate and at the corners of the ranges, and keeps
/// each distinct signal that comes within 1 % of the best there (`BranchPool`). For the normal
/// distribution the corners are those at 4 standard deviations from the estimate. Each branch that
/// may be the largest is refined at Chebyshev nodes of the ranges, for the normal distribution up
/// to 4 standard deviations along each axis, and becomes a polynomial of degree 4, or else 5 or 6.
/// It is held against refinements at the corners and at 30 places inside: to 1e-10 of the energy,
/// or to 1e-6 of its standard deviation if that is more; what is accepted beyond that, most of it
/// with many switches, is counted (`BranchNotes::rough_part`). Where the damping varies by much of
/// itself, the polynomials are in its logarithm (`DampingScale`). A branch whose polynomial fails
/// is refined wherever it may be the largest, and so are all of them outside the nodes.
///
/// Nothing here knows the criterion: it is the model's. Several figures can share `DeviceDraws`.
///
/// Memory with the default capacities: 10.7 KiB, of which the model has 2.4 (one is live at a
/// time), the signals 4.8 (8 of up to 256 switches), the polynomials 2.2 (8 of degree 4, 5 of 5, 3
/// of degree 6). Cost: 9 searches, then for each branch 125 to 343 refinements and 38 more; after
/// that, one multiplication and one addition for each of 35 to 84 terms.
class EnergyBranches {
 public:
  static constexpr std::size_t kFirstDegree = 4;

  /// Starts over with the signal that is best at the estimate as the only branch.
  ///
  /// @param[in] at_estimate  With filter and criterion.
  /// @param[in] best         The search's result there.
  /// @param[in] search       Its settings, of Method::kBest.
  /// @param[in] gain_follows The filter's gain is the device's sensitivity: energies here are then
  ///   those at the estimate's S.
  void start(const ModalModel& at_estimate, const MaximumEnergy& best, const DeviceDraws& draws,
             const SearchSettings& search, bool gain_follows) noexcept;

  /// Says that pieces will follow where a polynomial fails, so that no degree is tried in vain.
  void expect_pieces() noexcept { has_pieces_ = true; }

  /// Does a step of a search or of a refinement.
  ///
  /// @param[in] draws     The same in each call, as `workspace`.
  /// @param     search    Nobody else's until `is_ready()`.
  /// @param     workspace As for a search: what is in it is lost.
  void prepare(const DeviceDraws& draws, EnergySearch& search, GridWorkspace& workspace) noexcept;
  bool is_ready() const noexcept { return phase_ == Phase::kReady; }

  /// Starts over with a part of the ranges: the signals are those of the whole, refined in the
  /// middle and at corners of the part; each that is another one there begins a branch of its own.
  /// No searches.
  ///
  /// Polynomials of degree 4 only: where they fail, smaller pieces do better.
  ///
  /// @param[in] whole  `is_ready()`, with polynomials; it may be a piece itself.
  /// @param[in] middle Of the part, as a point of the whole's cube, and `half` its half-widths.
  void start_piece(const EnergyBranches& whole, const CubePoint& middle,
                   const CubePoint& half) noexcept;
  /// A step of a refinement. @param[in] whole The same in each call, as the others.
  void prepare_piece(const EnergyBranches& whole, const DeviceDraws& draws,
                     GridWorkspace& workspace) noexcept;

  /// Ends the preparation with what is known of a surface in place of polynomials: energies are not
  /// to be asked for here.
  void stand_for_surface(double tolerance, double rough_part) noexcept;

  /// @returns From 0 to 1, of the preparation.
  double progress() const noexcept;
  BranchNotes notes() const noexcept;

  /// Begins with the device at a place: asks the polynomials. Unless `done()` then, some branches
  /// must be refined by `begin_refinement()` and `step()`; before `is_ready()` all of them.
  void begin(const DeviceDraws::Place& place) noexcept;
  /// Begins with a device whose place is not known: all branches must be refined.
  void begin() noexcept;
  /// Begins to refine what the polynomials have left open.
  void begin_refinement(const DeviceDraws& draws, const Accelerometer& device,
                        GridWorkspace& workspace) noexcept;
  /// A step of a refinement.
  void step(const DeviceDraws& draws, GridWorkspace& workspace) noexcept;
  bool done() const noexcept { return pending_ == 0; }
  /// @returns With `done()`, the largest energy over branches, for a = 1.
  double energy() const noexcept { return energy_; }

  /// @returns What a polynomial may be off by, as part of the energy.
  double tolerance() const noexcept { return tolerance_; }
  /// @returns What the polynomials that are not accurate but count as predicted may be off by, as
  ///   part of the standard deviation of their energies over the draws; 0 if there are none.
  double rough_part() const noexcept { return rough_part_; }
  /// What refinements for polynomials cost: their number times that of switches.
  std::size_t work_of_fit(std::size_t degree) const noexcept;
  /// The number of switches of the branch that has most.
  std::size_t most_switches() const noexcept;
  /// True if the polynomials reach as far as this place.
  bool is_within_reach(const DeviceDraws::Place& place) const noexcept;
  CubePoint to_point(const DeviceDraws::Place& place) const noexcept;
  /// The share of the draws that are within `half` of a point of an axis, nearly.
  double share_of_draws(std::size_t axis, double middle, double half) const noexcept;
  /// The axis of f0 or damping along which the polynomials need their high powers most.
  std::size_t roughest_axis() const noexcept;
  /// The axes of the cube along which the device changes.
  const std::array<bool, 3>& axes() const noexcept { return axes_; }
  /// True if no place within reach takes a refinement.
  bool is_predicted() const noexcept { return notes().predicted == pool_.count(); }

  /// With `is_ready()`: true if all polynomials hold to 1e-10 of the energy or 1e-6 of its standard
  /// deviation; those that are off by up to 1e-4 of it, or more with many switches
  /// (`rough_part()`), count as predicted only.
  bool is_accurate() const noexcept { return is_accurate_; }

  /// The model with the device last set.
  const ModalModel& model() const noexcept { return model_; }
  /// @param[in] device One that exists.
  void set_device(const Accelerometer& device) noexcept;

 private:
  // At each place: known branches, then the search. Then what is missing at places, nodes, checks.
  // A piece begins with the seeds that the whole's signals are.
  enum class Phase : std::uint8_t { kReady, kKnown, kSearch, kSeeds, kMissing, kNodes, kChecks };

  static constexpr std::size_t kBranches = BranchPool::kCapacity;
  static constexpr std::size_t kPlaces = BranchPool::kPlaces;
  static constexpr std::size_t kCorners = kPlaces - 1;
  static constexpr std::size_t kChecks = kCorners + 30;
  static constexpr std::size_t kChecksOfPiece = kCorners + 12;
  static constexpr std::size_t kCoefficients = 280;  // 8 of degree 4, 5 of 5, 3 of 6.

  /// What is known of a branch's polynomial.
  struct Fit {
    double error = 0.0;          // The largest found,
    double inner_error = 0.0;    // and that in the middle.
    double nearest = 0.0;        // To the best of all, at nodes and checks,
    double nearest_other = 0.0;  // and where it is another signal than that.
    bool has_failed = false;
  };

  double share_between(double low, double high) const noexcept;
  CubePoint corner(std::size_t index) const noexcept;
  DeviceDraws::Place place_at(std::size_t index) const noexcept;
  CubePoint check_at(std::size_t index) const noexcept;
  DeviceDraws::Place from_point(const CubePoint& point) const noexcept;
  bool is_whole() const noexcept { return !is_piece_; }
  bool is_corner(std::size_t index) const noexcept;
  void next_place() noexcept;
  std::size_t legs_between(const Accelerometer& from, const Accelerometer& to) const noexcept;
  void start_refinement(const DeviceDraws& draws, std::size_t branch, const Accelerometer& device,
                        GridWorkspace& workspace) noexcept;
  void begin_legs(const Accelerometer& home, const Accelerometer& device,
                  GridWorkspace& workspace) noexcept;
  void begin_leg(GridWorkspace& workspace) noexcept;
  bool step_refinement(GridWorkspace& workspace) noexcept;
  bool refine_at(const DeviceDraws& draws, const DeviceDraws::Place& place,
                 GridWorkspace& workspace) noexcept;
  void step_known(const DeviceDraws& draws, EnergySearch& search,
                  GridWorkspace& workspace) noexcept;
  void step_search(EnergySearch& search, GridWorkspace& workspace) noexcept;
  void step_seeds(const EnergyBranches& whole, const DeviceDraws& draws,
                  GridWorkspace& workspace) noexcept;
  void next_place_of_seeds() noexcept;
  void step_missing(const DeviceDraws& draws, GridWorkspace& workspace) noexcept;
  void step_nodes(const DeviceDraws& draws, GridWorkspace& workspace) noexcept;
  void step_checks(const DeviceDraws& draws, GridWorkspace& workspace) noexcept;
  void end_places() noexcept;
  void begin_fit(std::size_t degree) noexcept;
  void end_fit() noexcept;
  void end_checks() noexcept;
  bool can_raise_degree() const noexcept;
  CubeNodes nodes() const noexcept;
  CubeNodes nodes_of(std::size_t degree) const noexcept;
  double accepted_at_last() const noexcept;
  std::size_t checks() const noexcept { return is_piece_ ? kChecksOfPiece : kChecks; }
  void compare_branches() noexcept;
  std::uint32_t needed() const noexcept;
  void remove(std::size_t branch) noexcept;
  void drop_low() noexcept;
  void accept(double part) noexcept;
  double deviation_of(std::size_t branch) const noexcept;
  double accepted_error(std::size_t branch, double part) const noexcept;
  double value(std::size_t branch, const CubePoint& point) const noexcept;
  void predict(const CubePoint& point) noexcept;
  std::size_t first_pending() const noexcept;

  Span<double> coefficients(std::size_t branch) noexcept {
    return Span<double>(coefficients_).from(branch * terms_).first(terms_);
  }
  Span<const double> coefficients(std::size_t branch) const noexcept {
    return Span<const double>(coefficients_).from(branch * terms_).first(terms_);
  }

  ModalModel model_ = {};
  BranchPool pool_ = {};
  double coefficients_[kCoefficients] = {};
  double energies_[kBranches] = {};  // At the point that is worked on.
  Fit fits_[kBranches] = {};
  // Which sets of branches, a bit each, have been the best together: a bit for each set.
  std::uint32_t best_sets_[(std::size_t{1} << kBranches) / 32] = {};
  Refiner refiner_ = {};
  SearchSettings search_ = {};
  Accelerometer estimate_ = {};
  Accelerometer home_ = {};  // A refinement goes from here to the target.
  Accelerometer target_ = {};
  double origin_ = 0.0;  // Polynomials are fitted to differences from this.
  double tolerance_ = 0.0;
  double rough_part_ = 0.0;
  DampingScale scale_ = {};
  // Polynomials hold up to `reach_` from the middle along each axis, in coordinates of the scale.
  DeviceDraws::Place middle_ = {};
  DeviceDraws::Place reach_ = {};
  DeviceDraws::Place inverse_reach_ = {};
  double corner_ = 0.0;  // The part of the reach along each axis where searches are made.
  double energy_ = 0.0;
  std::size_t degree_ = 0;  // 0 without polynomials.
  std::size_t terms_ = 0;
  std::size_t point_ = 0;  // The place, node or check that is worked on.
  std::size_t branch_ = 0;
  std::size_t leg_ = 0;
  std::size_t legs_ = 0;
  std::uint8_t unsearched_ = 0;
  std::uint32_t pending_ = 0;  // Branches to be refined, a bit each.
  std::array<bool, 3> axes_ = {};
  bool gain_follows_ = false;
  bool is_normal_ = false;
  bool is_unit_ = false;  // A place is a point of the cube.
  bool is_piece_ = false;
  bool is_accurate_ = false;
  bool has_pieces_ = false;
  bool is_refining_ = false;
  Phase phase_ = Phase::kReady;
};

static_assert(std::is_trivially_copyable_v<EnergyBranches>);

}  // namespace emax
