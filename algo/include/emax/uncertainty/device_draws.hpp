// The devices of the Monte Carlo trials, drawn from the ranges of their parameters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/status.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/model/accelerometer.hpp"

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

struct DrawSettings {
  Distribution distribution = Distribution::kBox;
  ParameterBox box;              ///< kBox only.
  double covariance[3][3] = {};  ///< kNormal only: of S, f0 and beta, as the fit gives it.
  WichmannHill generator;        ///< Seeded: trial 0 takes its next numbers.
};

/// Draws devices in any order: with the box, trial t draws S, f0 and beta, in that order, from
/// numbers 3t, 3t + 1 and 3t + 2 of the generator; with the normal distribution numbers 4t to 4t +
/// 3 make two pairs by Box and Muller, of which the first three are taken, times the covariance's
/// Cholesky factor. So a result depends neither on the order of the trials nor on how they are
/// shared out.
///
/// A normal draw that is no device (S or f0 not above 0, damping below its least or 1 and more) is
/// drawn again: redraw r of trial t takes the same numbers of the generator jumped ahead by r 2^64.
///
/// A draw is known by its place: where it lies in units that make the parameters independent, half
/// ranges for the box and standard deviations for the normal distribution.
class DeviceDraws {
 public:
  using Place = std::array<double, 3>;

  /// A trial that has been drawn again as often as this has no device.
  static constexpr std::uint32_t kMaxRedraws = 64;

  /// Starts over, before trial 0.
  ///
  /// @returns
  /// * kOk: Ready.
  /// * kOverdamped, kInvalidArgument: A half-width below 0 or not a number, a box that leaves what
  ///   a device may be, or a covariance that is not symmetric and positive semidefinite. Nothing
  ///   has changed.
  Status start(const Accelerometer& estimate, const DrawSettings& settings) noexcept;

  /// Draws the device of a trial.
  ///
  /// @returns False after kMaxRedraws redraws without a device; the place is then the estimate's.
  bool draw(std::uint32_t trial) noexcept;

  /// Of the trial last drawn.
  const Place& place() const noexcept { return place_; }
  Accelerometer device() const noexcept;
  double sensitivity() const noexcept { return parameter(0); }

  /// @returns Whether the trial last drawn came for the first time, after all trials before it.
  bool is_first_time() const noexcept { return is_first_time_; }
  /// @returns How often trials were drawn again, each trial counted the first time that it comes
  ///   after all trials before it: so later passes over the trials change nothing.
  std::uint32_t redraws() const noexcept { return redraws_; }

  /// Makes a copy for trials from `first` on count its own: see `join()`.
  void start_share(std::uint32_t first) noexcept;
  /// Takes over what a share has counted that begins where the count of this one ends.
  void join(const DeviceDraws& share) noexcept;

  const Accelerometer& estimate() const noexcept { return estimate_; }
  Distribution distribution() const noexcept { return distribution_; }
  /// The device at a place, which may be none.
  Accelerometer device_at(const Place& place) const noexcept;
  /// The place of a device; a parameter without an uncertainty leaves its unit at 0.
  Place place_of(const Accelerometer& device) const noexcept;
  /// The farthest that all devices with all units within +- it are devices: at least 1 for the
  /// box, 0 or more for the normal distribution, at most `most`.
  double reach(double most) const noexcept;
  /// The same, whatever the damping becomes.
  double reach_without_damping(double most) const noexcept;
  /// What each unit of a place moves the damping by.
  Place units_of_damping() const noexcept { return {factor_[2][0], factor_[2][1], factor_[2][2]}; }
  /// How far S, f0 or damping (0, 1, 2) goes: the half range of a box, else a standard deviation.
  double spread(std::size_t parameter) const noexcept;
  /// Whether a unit moves a parameter; S is left out where a gain that follows takes it out.
  bool moves(std::size_t unit, bool without_sensitivity) const noexcept;

 private:
  Status set_box(const ParameterBox& box) noexcept;
  Status set_covariance(const double (&covariance)[3][3]) noexcept;
  double parameter(std::size_t index) const noexcept;
  double row_sum(std::size_t parameter) const noexcept;
  double reach_of(std::size_t parameters, double most) const noexcept;
  void draw_box() noexcept;
  void draw_normal(WichmannHill& generator) noexcept;
  bool draw_again(std::uint32_t trial) noexcept;
  std::uint64_t numbers_per_trial() const noexcept {
    return distribution_ == Distribution::kBox ? 3U : 4U;
  }

  Accelerometer estimate_ = {};
  double factor_[3][3] = {};  // Lower triangle: what a unit of each place moves the parameters by.
  Place place_ = {};
  Place uniform_ = {};  // kBox: the numbers themselves.
  double safe_ = 0.0;   // Places with all units within this need no look at the device.
  WichmannHill first_generator_ = {};
  WichmannHill generator_ = {};
  std::uint32_t next_trial_ = 0;
  std::uint32_t counted_ = 0;
  std::uint32_t counts_from_ = 0;
  std::uint32_t redraws_ = 0;
  bool is_first_time_ = false;
  Distribution distribution_ = {};
};

static_assert(std::is_trivially_copyable_v<DeviceDraws>);

}  // namespace emax
