// A signal that is +a or -a and changes sign at given times: its exact energy at the output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// x(t) of unit size on [0, T] that starts at +1 and changes sign at each switching time.
///
/// The energy is the same for -x, so the sign at the start is a convention. 2 KiB.
class SwitchingSignal {
 public:
  /// Takes switching times in seconds, strictly ascending inside (0, `duration_s`).
  ///
  /// @returns
  /// * kOk: Taken.
  /// * kInvalidArgument: Duration not above 0, or a time outside (0, duration) or not a number.
  /// * kNotAscending: A time not later than the one before.
  /// * kTooManySwitches: More than kMaxSwitches times.
  Status set(Span<const double> times_s, double duration_s) noexcept;

  /// No switches, and a duration of 0.
  void clear() noexcept {
    count_ = 0;
    duration_s_ = 0.0;
  }

  /// Takes the pattern of signs of equal cells that fill [0, `duration_s`]; a pattern
  /// that starts negative is taken with all signs turned.
  ///
  /// @returns kOk, or kTooManySwitches and nothing has changed.
  Status set_signs(Signs signs, double duration_s) noexcept;

  Span<const double> times_s() const noexcept { return Span<const double>(times_s_, count_); }
  std::size_t count() const noexcept { return count_; }
  double duration_s() const noexcept { return duration_s_; }

  /// @returns +1 or -1, the value just after `time_s`; 0 outside [0, duration].
  double value(double time_s) const noexcept;

 private:
  double times_s_[kMaxSwitches] = {};
  double duration_s_ = 0.0;
  std::uint16_t count_ = 0;
};

static_assert(std::is_trivially_copyable_v<SwitchingSignal>);

/// The energy at the output for the signal with a = 1, in (V/(m/s^2))^2 s, by closed form: paper
/// equations (15), (20) (or (13) for the criterion of the energy difference). Times a^2 it is E.
///
/// No sampling: the error is that of rounding, about 1e-14 of the energy of the larger of the two
/// outputs. One complex exponential and two complex products per mode and switch, and one product
/// with the Gramian at the end.
double energy(const ModalModel& model, const SwitchingSignal& signal) noexcept;

/// The same for switching times that are as those of a signal.
double energy(const ModalModel& model, Span<const double> times_s, double duration_s) noexcept;

/// The output y(t) for the signal with a = 1, in V/(m/s^2), at one time inside [0, duration]; paper
/// equation (8).
double error_output(const ModalModel& model, const SwitchingSignal& signal, double time_s) noexcept;

}  // namespace emax
