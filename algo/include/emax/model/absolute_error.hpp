// The largest absolute error that a signal within +-a and a time T can make at the output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The largest |y(t)| for any signal within +-1 on [0, T]: the integral of |k| from 0 to T, by the
/// step response between the zeros of k.
///
///     Status status = error.start(model, duration_s);
///     while (!error.done()) {
///       error.step(model, zeros_s);
///     }
///
/// |y(t)| = |integral of k(t - v) x(v)| is largest if x has the sign of k(t - v) throughout, and at
/// t = T: the signal x(t) = sgn k(T - t) switches where T - t is a zero. k is sampled 64 times per
/// period of its fastest mode; zeros between two samples of equal sign go unnoticed, which changes
/// the value by less than its rounding wherever modes are of comparable size. One exponential per
/// mode and sample, 64 more where k changes sign. Where k has one sign the value is |s(T)| of
/// `OneSidedResponse`. What an ideal sensor passes at once is counted in.
class AbsoluteError {
 public:
  /// @param[in] duration_s T, above 0.
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: A duration not above 0 or not finite, or of more than 2^20 samples. It is
  ///   done then, with a value of 0.
  Status start(const ModalModel& model, double duration_s) noexcept;

  /// Looks at the next 24 samples.
  ///
  /// @param[in]  model   The same in each step.
  /// @param[out] zeros_s The zeros of k, ascending, as far as there is room; may be empty.
  void step(const ModalModel& model, Span<double> zeros_s = {}) noexcept;

  bool done() const noexcept { return !running_; }
  /// @returns With `done()`, in V/(m/s^2): times a in V.
  double value() const noexcept { return value_; }
  /// @returns With `done()`, by how much rounding may have moved the value.
  double rounding() const noexcept { return rounding_; }
  /// @returns With `done()`: kLostDigits if rounding is more than 1e-9 of the value, else kOk.
  Status status() const noexcept {
    return rounding_ <= 1e-9 * value_ ? Status::kOk : Status::kLostDigits;
  }
  /// @returns How many zeros there are, also if not all had room.
  std::size_t zeros() const noexcept { return zeros_; }

 private:
  void take_zero(const ModalModel& model, double zero_s, Span<double> zeros_s) noexcept;

  double duration_s_ = 0.0;
  double samples_ = 0.0;
  double value_ = 0.0;
  double rounding_ = 0.0;
  double last_step_ = 0.0;  // The step response at the last zero.
  double last_s_ = 0.0;     // The last sample.
  std::uint32_t next_ = 0;  // The sample that comes next.
  std::size_t zeros_ = 0;
  bool positive_ = false;  // The sign at the last sample.
  bool running_ = false;
};

static_assert(std::is_trivially_copyable_v<AbsoluteError>);

}  // namespace emax
