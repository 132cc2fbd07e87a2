// The largest absolute error that a signal within +-a and a time T can make at the output.
#pragma once

#include <type_traits>

#include "emax/modal_model.hpp"
#include "emax/status.hpp"
#include "emax/switching_signal.hpp"

namespace emax {

/// The largest |y(t)| for any signal within +-1 on [0, T], and a signal that reaches it at T.
struct AbsoluteError {
  Status status = Status::kOk;
  double value = 0.0;           ///< In V/(m/s^2): times a in V.
  SwitchingSignal signal = {};  ///< x(t) = sgn k(T - t) or its negative.
};

/// The integral of |k| from 0 to T, by the step response between the zeros of k.
///
/// |y(t)| = |integral of k(t - v) x(v)| is largest if x has the sign of k(t - v) throughout, and at
/// t = T. k is sampled 64 times per period of its fastest mode; zeros between two samples of equal
/// sign go unnoticed, which changes the value by less than its rounding wherever modes are of
/// comparable size. 2 KiB for the result; one exponential per mode and sample.
///
/// @param[in] duration_s T, above 0.
/// @returns
/// * kOk: Value and signal.
/// * kInvalidArgument: A duration not above 0 or not finite, or of more than 2^20 samples.
/// * kTooManySwitches: k has more zeros than a signal has switches; the value is right, the signal
///   empty.
AbsoluteError largest_absolute_error(const ModalModel& model, double duration_s) noexcept;

static_assert(std::is_trivially_copyable_v<AbsoluteError>);

}  // namespace emax
