// A proven upper bound on the energy of any signal within its limits, of whatever shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/bound/dissipation_trial.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/float_phi.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// Decides for a d(t) > 0, constant on each of many equal steps of [0, T], whether
///
///     E(x) <= integral of d x^2 over [0, T]
///
/// for every x that is linear on each step, with jumps between steps, and says by how much d must
/// grow so that this holds for every x whatever. With |x| <= a the right side is at most a^2 times
/// the integral of d: a bound of the energy of any shape of signal, whoever proposed d and however.
///
/// From T back to 0 it carries a form V of the modes' outputs w: the most by which the energy still
/// to come can exceed the integral of d x^2 still to come. V is 0 at T; one step back it is the
/// maximum over the step's x of [energy in the step - integral of d x^2 in the step + V of the w at
/// its end], finite exactly if a 2 by 2 matrix is positive definite. If it is so in all steps, then
/// E - integral of d x^2 <= V(0) = 0. This is the Riccati equation -P' = A'P + PA + C'C + PBB'P/d,
/// without a truncation error for such x. A form that is larger than V only makes the check
/// stricter, so each step adds more to V than its own rounding.
///
/// What x has beyond linear steps, v, has neither mean nor slope on any step. So v = Q'' with Q and
/// Q' zero at all edges of steps, |Q| <= (tau/4.73)^2 |v| (a clamped beam of length tau), and
/// |Kv| = |(s^2 K) Q| <= kappa |v|, where kappa is (tau/4.73)^2 max |s^2 K|, of sensor and filter
/// apart or by the sizes of k and its derivatives, whichever is less. Only kappa^2 counts, which
/// falls with tau^4. See `completed()`.
///
/// Why this and not its neighbours: a Runge-Kutta step of the Riccati equation comes with no proof;
/// its exact flow over a cell takes an exponential of twice as many rows as states for each d, tens
/// of times the work; and a factorisation of diag(d) - Phi on the grid leaves a kappa of first
/// order in tau, which takes fifty times as many cells.
///
/// 3.6 KiB. Nothing is stored for each step.
class DissipationCheck {
 public:
  /// Lays out `steps` equal steps; `restart()` is included.
  ///
  /// @returns
  /// * kOk: Ready for `step_back()`.
  /// * kInvalidArgument: Duration not above 0 or not finite, or no step.
  Status start(const ModalModel& model, double duration_s, std::size_t steps) noexcept;

  /// Back to T.
  void restart() noexcept;

  /// Takes d of the next step, from the last one to the first, in (V/(m/s^2))^2.
  ///
  /// @returns False if d is rejected: there is a signal that is 0 before this step and beats it, or
  ///   rounding hides that there is none, or d is not a number. Then only `restart()` helps.
  /// About 62 m (m + 1) multiplications and additions with m modes.
  bool step_back(double d) noexcept;

  /// What bounds the energy of every |x| <= 1 once all steps have passed, from the integral of d
  /// and its least value. For the integral-square error the integral times 1 + kappa^2/least, as
  /// |K(u + v)|^2 <= (1 + c) |Ku|^2 + (1 + 1/c) |Kv|^2. For the energy difference the integral plus
  /// T g^2/(least - kappa^2), kappa being that of the sensor: the mixed terms of u and v are at
  /// most 2 g |u| |v| with g = max |Ka| kappa_a + max |Kf| kappa_f. On top, 1e-10 T (max |Ka| + max
  /// |Kf|)^2 for the rounding of poles, residues and the integral.
  ///
  /// @returns Infinity if the least value of d is too small for the length of the steps.
  double completed(double integral, double least) const noexcept;

 private:
  friend class DissipationTrial;
  static constexpr std::size_t kPairs = kMaxModes * (kMaxModes + 1) / 2;

  void fill_inputs(const ModalModel& model) noexcept;
  void fill_limits(const ModalModel& model) noexcept;
  void fill_rows(Complex (&row)[2][kMaxModes]) noexcept;

  // Of one step, for the inputs 1 and sqrt(3) (2 s/tau - 1), each with a mean square of 1.
  Complex decay_[kMaxModes] = {};          // e^(p tau)
  Complex input_[2][kMaxModes] = {};       // what the input leaves in the outputs of the modes
  Complex cross_[2][kMaxModes] = {};       // energy of the input's output with each mode's
  double input_energy_[2][2] = {};         // energies of the inputs' outputs
  Complex step_energy_[kPairs] = {};       // energy within the step of modes i <= j,
  Complex conj_step_energy_[kPairs] = {};  // V = 1/2 Re sum [G_ij w_i w_j + H_ij w_i conj w_j]
  Complex form_[kPairs] = {};              // G, H of what is still to come
  Complex conj_form_[kPairs] = {};
  double input_size_ = 0.0;  // sum of input
  double largest_ = 0.0;     // of the elements of G and H
  double step_s_ = 0.0;
  double duration_s_ = 0.0;
  double remainder_ = 0.0;        // kappa
  double mixed_remainder_ = 0.0;  // g
  double model_rounding_ = 0.0;
  std::size_t count_ = 0;
  Criterion criterion_ = {};
};

static_assert(std::is_trivially_copyable_v<DissipationCheck>);

/// The bound: proposes d(t), then proves it.
///
///     Status status = bound.start(model, duration_s, workspace);
///     while (status == Status::kOk && !bound.done()) {
///       status = bound.step(model, workspace);
///     }
///
/// The proposal is the dual of the semidefinite relaxation on a grid: 64 times, unit vectors v_i <-
/// normalised sum_j Phi_ij v_j, then d_i = |sum_j Phi_ij v_j| (the mixing method), in single
/// precision, and linear in between. The grid has 4 cells for each of the search, as far as 1024
/// go; a T of more than 1024 cells of the search takes the proposal of a T with 1024, with its
/// middle stretched, or of one with 2048 at half the resolution if the sensor rings for long. The
/// proposal may be as wrong as it likes, as only what passes `DissipationCheck` is reported: it is
/// raised until it passes. How much it must be raised is found by bisection with
/// `DissipationTrial`, in single precision too; a little more than that mostly passes the check at
/// once. (With 7 modes or more, and where the sensor's pole is next to one of the filter's, the
/// check bisects too.) 392 steps for the paper's device at T = 2
/// ms, 1956 at 10 ms; with more than 1024 cells of the search 2 for each; 4 times that for order 1.
///
/// 6.8 KiB beside the workspace, in which nobody else must work meanwhile.
class EnergyBound {
 public:
  /// Model and workspace must stay as they are until the bound is done. All criteria, all orders.
  /// Where k has one sign on [0, T] the bound is the energy of the constant signal, and done.
  ///
  /// @returns
  /// * kOk: Ready to `step()`.
  /// * kInvalidArgument: Duration not above 0 or not finite, or an ideal sensor that passes its
  ///   input at once.
  /// * kTooManyCells: As `EnergySearch::start()`: shorten T.
  Status start(const ModalModel& model, double duration_s, GridWorkspace& workspace) noexcept;

  /// @returns
  /// * kOk: A part of the work is done: one vector or its product with Phi, or 16 steps of a check.
  /// * kNotProven: With the last step: no multiple of d passed, and there is no bound.
  Status step(const ModalModel& model, GridWorkspace& workspace) noexcept;

  bool done() const noexcept { return phase_ == Phase::kDone; }
  /// @returns From 0 to 1.
  double progress() const noexcept;

  /// @returns With `done()`, the bound for a = 1, in (V/(m/s^2))^2 s; else, and without a proof,
  ///   infinity. With a delay of the reference, for the true delay (`true_bound()`).
  double bound() const noexcept { return bound_; }

  /// The number of steps of the check, and the d of each that has passed, in (V/(m/s^2))^2; the
  /// workspace must be as the last step left it. For a second opinion.
  std::size_t steps() const noexcept { return steps_; }
  double multiplier(std::size_t step, GridWorkspace& workspace) const noexcept;

 private:
  enum class Phase : std::uint8_t { kDone, kFirstVectors, kProposal, kTrial, kCheck };

  double resolved_time(const ModalModel& model, double duration_s, std::size_t grid) const noexcept;
  void begin_proposal(const ModalModel& model, GridWorkspace& workspace) noexcept;
  void begin_lifts(double first) noexcept;
  bool next_lift() noexcept;
  void fill_vector(GridWorkspace& workspace) noexcept;
  void sweep(GridWorkspace& workspace) noexcept;
  void take_directions(Span<float> vectors, Span<float> products) const noexcept;
  void take_proposal(GridWorkspace& workspace) noexcept;
  double shape(std::size_t step, Span<const float> d) const noexcept;
  double lifted(double d, double lift) const noexcept;
  void try_steps(Span<const float> d) noexcept;
  void check_steps(Span<const float> d) noexcept;
  void next_trial(bool passed) noexcept;
  void next_check(bool passed) noexcept;

  DissipationCheck check_ = {};
  DissipationTrial trial_ = {};
  FloatPhi phi_ = {};
  float shift_ = 0.0F;  // Of the proposal, in units of `phi_`
  double bound_ = 0.0;
  double duration_s_ = 0.0;
  double proposal_s_ = 0.0;  // T, or as much of it as the grid of the proposal can resolve
  double least_ = 0.0;       // of the proposal
  double mean_ = 0.0;        // of the proposal
  // By how much d is raised, as part of its mean, or if negative lowered, as part of itself:
  double lift_ = 0.0;    // on trial
  double passed_ = 0.0;  // the least that has passed, infinity before
  double failed_ = 0.0;  // the greatest that has not, minus infinity before
  double guess_ = 0.0;   // what has passed the trial
  double raise_ = 0.0;   // on top of it
  std::size_t cells_ = 0;
  std::size_t steps_ = 0;
  std::size_t count_of_modes_ = 0;
  std::size_t sweeps_ = 0;
  std::size_t vector_ = 0;  // Whose product comes next.
  std::size_t trials_ = 0;
  std::size_t checks_ = 0;
  std::size_t steps_left_ = 0;
  bool cancels_ = false;  // The modes do, beyond single precision.
  Phase phase_ = Phase::kDone;
};

static_assert(std::is_trivially_copyable_v<EnergyBound>);

}  // namespace emax
