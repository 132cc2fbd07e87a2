// Energies that know how far rounding may have moved them, and what a delay leaves open.
#pragma once

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/cascade_response.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The part of an energy that rounding may change in its answer.
inline constexpr double kPermittedRounding = 1e-9;

/// How far rounding may move `energy()` of a signal with so many switches: half units in the last
/// place of all that it sums. Two products for each two modes.
///
/// @param[in] energy The answer.
double energy_rounding(const ModalModel& model, double duration_s, std::size_t switches,
                       double energy) noexcept;

/// An answer, or why there is none.
struct EnergyAnswer {
  /// * kOk: `known` is within 1e-9.
  /// * kLostDigits: Rounding is more than 1e-9 of the energy in every form.
  Status status = Status::kOk;
  KnownEnergy known = {};
};

/// The energy of a signal by the form that keeps its digits: the closed form of `energy()`, and
/// where that loses more than 1e-9 of it, the differential equations of `CascadeResponse`.
EnergyAnswer known_energy(const ModalModel& model, const SwitchingSignal& signal) noexcept;

/// By how much the true root mean square of y may differ from that of the continued filter, for a =
/// 1, in V/(m/s^2): delay_error() G; 0 without a delay.
double delay_tolerance(const ModalModel& model) noexcept;

/// @returns A bound for the true delay and the sensor itself from one for the modes, both for a =
/// 1:
///   (sqrt(bound) + (delay_tolerance() + moved_by()) sqrt(T))^2. (The filter passes no more than
///   its input; ||k * x|| is at most the integral of |k| times ||x||.)
double true_bound(const ModalModel& model, double bound, double duration_s) noexcept;

/// @returns kDelayNotResolved if the tolerance is more than 1 % of the root mean square, else kOk.
Status check_delay(const ModalModel& model, double energy, double duration_s) noexcept;

/// @returns With feedthrough, the energy for a = 1 that ever faster switching tends to: D^2 T. The
///   greatest energy is no less, and not always reached. Without feedthrough 0.
double fast_switching_limit(const ModalModel& model, double duration_s) noexcept;

}  // namespace emax
