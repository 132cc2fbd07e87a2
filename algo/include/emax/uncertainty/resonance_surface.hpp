// The largest energy of a sensor whose best signal rides on its resonance, as a smooth function.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/uncertainty/device_draws.hpp"
#include "emax/uncertainty/energy_branches.hpp"

namespace emax {

/// ln E*(f0, beta) as one polynomial over the ranges of the draws, for lightly damped sensors.
///
/// With a hundred switches and more no single signal stays a maximum all over the ranges, so that
/// `EnergyBranches` has no polynomials to lay through it. The largest energy itself is smooth: a
/// square wave at the resonance, refined from two phases (`resonant_energy()`), ends in the best
/// signal of each device. At Chebyshev nodes of f0 and of ln(beta + 1/(w0 T)) the logarithm of that
/// energy, and the power of S that it follows, become a polynomial.
///
/// Its misfit is measured at draws: at kChecks of them against that energy, and at kFullChecks of
/// those against a whole search too, whichever is larger. It is accepted up to kAccepted of the
/// standard deviation of E over the draws, tries a higher degree from kGood on, and else has
/// failed. Where the higher degree is not accepted and the first one was, the first one stays: what
/// is not smooth in the energies themselves no degree follows. What lies outside the nodes is
/// refined.
///
/// Cost: 64 refinements for 8 nodes of the damping and 4 of f0, 12 checks of two refinements, and 2
/// searches; then some 150 ns on a PC for each draw. 2.5 KiB.
class ResonanceSurface {
 public:
  static constexpr std::size_t kChecks = 12;
  static constexpr std::size_t kFullChecks = 2;
  static constexpr double kGood = 0.02;
  static constexpr double kAccepted = 0.1;

  /// Starts over. @param[in] duration_s T. @param[in] best_energy Of the search at the estimate.
  void start(const DeviceDraws& draws, double duration_s, double best_energy) noexcept;

  /// Computes the energy at a node or a check.
  ///
  /// @param[in] draws    Its trials are checked.
  /// @param     branches Whose model is set to devices.
  void step(const DeviceDraws& draws, EnergyBranches& branches, EnergySearch& search,
            GridWorkspace& workspace) noexcept;
  bool is_done() const noexcept { return phase_ == Phase::kDone || phase_ == Phase::kFailed; }
  bool has_failed() const noexcept { return phase_ == Phase::kFailed; }
  double progress() const noexcept;

  /// @returns With `is_done()` and unless it has failed, whether the nodes reach this device.
  bool reaches(const Accelerometer& device) const noexcept;
  /// @returns The energy of a device that it reaches, for a = 1.
  double energy(const Accelerometer& device) const noexcept;

  /// @returns The largest misfit found, as part of the energy.
  double tolerance() const noexcept { return misfit_; }
  /// @returns The same as part of the standard deviation of E over the draws.
  double rough_part() const noexcept { return rough_part_; }

 private:
  enum class Phase : std::uint8_t { kDone, kFailed, kEstimate, kNodes, kChecks };

  static constexpr std::size_t kMostNodes = 12;  // On an axis.

  struct Axis {
    double middle = 0.0;
    double half = 0.0;
    std::size_t nodes = 1;

    double value(double point) const noexcept { return middle + half * point; }
    double point(double value) const noexcept { return half > 0.0 ? (value - middle) / half : 0.0; }
    bool reaches(double point) const noexcept;
  };

  void lay_out(const DeviceDraws& draws, double duration_s) noexcept;
  void begin_nodes(std::size_t more) noexcept;
  void take_nodes_away(std::size_t nodes) noexcept;
  void end_nodes() noexcept;
  double frequency_point(const Accelerometer& device) const noexcept;
  double damping_point(const Accelerometer& device) const noexcept;
  void step_node(EnergyBranches& branches, GridWorkspace& workspace) noexcept;
  void step_check(const DeviceDraws& draws, EnergyBranches& branches, EnergySearch& search,
                  GridWorkspace& workspace) noexcept;
  void end_checks(const DeviceDraws& draws) noexcept;
  double deviation(DeviceDraws draws) const noexcept;

  Accelerometer estimate_ = {};
  Axis frequency_ = {};
  Axis damping_ = {};  // Of ln(beta + knee).
  double knee_ = 0.0;
  double duration_s_ = 0.0;
  double best_energy_ = 0.0;
  double misfit_ = 0.0;
  double largest_error_ = 0.0;
  double rough_part_ = 0.0;
  double first_misfit_ = 0.0;  // Of the first degree, where a higher one has been tried.
  double first_rough_part_ = 0.0;
  // Of T_i(f0) T_j(beta), j running first: of ln E at the estimate's S, and of d ln E/d ln S.
  double logarithm_[kMostNodes * kMostNodes] = {};
  double power_[kMostNodes * kMostNodes] = {};
  std::size_t point_ = 0;  // The node or check that comes next.
  bool is_box_ = false;
  bool is_raised_ = false;
  bool is_lowered_ = false;  // Back to the first degree.
  Phase phase_ = Phase::kFailed;
};

static_assert(std::is_trivially_copyable_v<ResonanceSurface>);

/// The energy of a square wave with the period of the resonance, refined for the model's device:
/// the larger of two, whose last switches are a quarter and three quarters of half a period before
/// T. The workspace's signal is then the better one.
///
/// @returns The energy for a = 1; not above 0 where the wave has more than kMaxSwitches switches.
double resonant_energy(const ModalModel& model, double duration_s,
                       GridWorkspace& workspace) noexcept;

}  // namespace emax
