// The switching times of a signal moved to where they make its energy largest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The first doubles of their scratch, as many as `refine()` and `energy_gradient()` touch.
constexpr std::size_t refinement_scratch(std::size_t modes, std::size_t switches) noexcept {
  return 6 * kMaxSwitches + 2 * modes * (switches + 1);
}

/// The number of doubles that `refine()` and `energy_gradient()` work in, whatever the signal.
inline constexpr std::size_t kRefinementScratch = refinement_scratch(kMaxModes, kMaxSwitches);

class EnergyShape;

/// How a refinement ended.
struct Refinement {
  double energy = 0.0;    ///< Of the refined signal, for a = 1; where the closed form loses digits,
                          ///< that of `known_energy()`.
  std::size_t steps = 0;  ///< Newton steps taken.
  std::size_t dropped = 0;  ///< Switches that met in pairs or left [0, T].
};

/// dE/dt_j of every switch, for a = 1: 2 (x(t_j-) - x(t_j+)) (Phi x)(t_j), by closed form.
///
/// One forward and one backward recursion over the switches: `PhiOperator` in continuous time.
///
/// @param[out] gradient One number per switch, in (V/(m/s^2))^2.
/// @param      scratch  kRefinementScratch doubles.
/// @returns The energy of the signal.
double energy_gradient(const ModalModel& model, const SwitchingSignal& signal,
                       Span<double> gradient, Span<double> scratch) noexcept;

/// Moves the switching times by Newton's method until their gradient is that of rounding, in short
/// steps.
///
///     refiner.start(signal);
///     while (!refiner.done()) {
///       refiner.step(model, signal, scratch);
///     }
///
/// The curvature d2E/(dt_i dt_j) = 8 c_i c_j Phi(t_i, t_j), plus 4 c_i (Phi x)'(t_i) for i = j, c_i
/// being the sign before switch i, is never stored: a step is found by conjugate gradients, each of
/// which costs two recursions over the switches. Where the energy is not concave the step follows
/// the gradient. A step that would lower the energy is shortened; two switches that meet are
/// dropped, and so is one that reaches 0 or T. The energy never falls by more than rounding. (The
/// energy difference has flat ridges, on which it may stop before the gradient is that of
/// rounding.) At most 200 Newton steps; from the grid of a search, 2 to 6.
class Refiner {
 public:
  void start(const SwitchingSignal& signal) noexcept;

  /// One evaluation of the gradient, or a stretch of the conjugate gradients, or one try of a step.
  ///
  /// @param[in]     model   The same in each step, as `signal` and `scratch`.
  /// @param[in,out] signal  Refined in place.
  /// @param         scratch kRefinementScratch doubles.
  void step(const ModalModel& model, SwitchingSignal& signal, Span<double> scratch) noexcept;

  bool done() const noexcept { return phase_ == Phase::kDone; }
  /// @returns With `done()`, how it ended.
  const Refinement& result() const noexcept { return result_; }

 private:
  enum class Phase : std::uint8_t { kDone, kGradient, kSolve, kTry };

  void take_gradient(const ModalModel& model, SwitchingSignal& signal, EnergyShape& shape) noexcept;
  void begin_step(EnergyShape& shape, bool is_scaled) noexcept;
  void solve(const SwitchingSignal& signal, EnergyShape& shape) noexcept;
  void try_step(const ModalModel& model, SwitchingSignal& signal, EnergyShape& shape) noexcept;
  void end(const ModalModel& model, SwitchingSignal& signal) noexcept;

  Refinement result_ = {};
  double norm2_ = 0.0;   // Of what is left of the gradient.
  double enough_ = 0.0;  // The step is found when it is not above this.
  double multiple_ = 0.0;
  std::size_t first_count_ = 0;
  std::size_t iterations_ = 0;  // Of the conjugate gradients.
  std::size_t tries_left_ = 0;
  bool begun_ = false;
  bool is_scaled_ = false;  // The step is by the diagonal.
  bool last_ = false;       // The step promises no more than rounding.
  Phase phase_ = Phase::kDone;
};

static_assert(std::is_trivially_copyable_v<Refiner>);

/// A whole run of `Refiner`.
Refinement refine(const ModalModel& model, SwitchingSignal& signal, Span<double> scratch) noexcept;

}  // namespace emax
