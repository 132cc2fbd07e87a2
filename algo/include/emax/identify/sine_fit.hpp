// Three-parameter sine approximation at a known frequency, one sample at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {

/// y = cosine_v cos(wt) + sine_v sin(wt) + offset_v, with t = 0 at the first sample.
struct SineFitResult {
  Status status = Status::kTooFewPoints;
  double cosine_v = 0.0;
  double sine_v = 0.0;
  double offset_v = 0.0;
  double amplitude_v = 0.0;     ///< sqrt(cosine^2 + sine^2).
  double phase_rad = 0.0;       ///< Sine reference: y = amplitude sin(wt + phase) + offset.
  double residual_std_v = 0.0;  ///< Of a sample: sqrt(sum of squares/(samples - 3)).
  std::uint64_t samples = 0;

  /// @returns P of y = Re(P e^(jwt)) + offset. The ratio of two channels' P is a complex response.
  constexpr Complex phasor() const noexcept { return {cosine_v, -sine_v}; }
};

/// Fits y = A cos(wt) + B sin(wt) + C by least squares (ISO 16063-21; IEEE 1057), without storing
/// samples: 152 bytes for any number of them. The result does not depend on how the samples are cut
/// into blocks, bit for bit.
///
/// Sine and cosine come from a rotation per sample, set anew from `sincos()` every 64 samples, so
/// that its error stays below 1e-14 however long the record. One sample costs 12 multiplications.
///
/// Sums are taken about the first sample, and from the end of the first period on about the fit of
/// that period, so that neither a large offset nor a large amplitude costs digits of the rest: the
/// residual is good down to 1e-8 of the amplitude. A record of N samples with white noise of
/// standard deviation s has u(A) = u(B) = s sqrt(2/N), so u(amplitude) = s sqrt(2/N) and u(phase) =
/// s sqrt(2/N)/amplitude.
class SineFit {
 public:
  /// Starts a new fit.
  ///
  /// @param[in] frequency_hz   0 < frequency < sample_rate / 2.
  /// @param[in] sample_rate_hz Greater than 0.
  /// @returns
  /// * kOk: Ready for `add()`.
  /// * kInvalidArgument: A rate outside its range, or not a number. The running fit is kept.
  Status start(double frequency_hz, double sample_rate_hz) noexcept;

  /// Takes the next samples, in volts, in the order of time. Ignored before a `start()`.
  void add(Span<const double> samples_v) noexcept;

  /// @returns The fit of all samples since `start()`, for about 100 multiplications; `add()` may go
  /// on after it. The status is
  /// * kOk
  /// * kTooFewPoints: Below one period, or fewer than 4 samples. The other values are zero.
  /// * kNotIdentifiable: The samples do not determine the sine (next to half the sample rate), or
  ///   are not finite. The other values are zero.
  SineFitResult result() const noexcept;

 private:
  struct Coefficients {
    double cosine = 0.0;
    double sine = 0.0;
    double offset = 0.0;
  };

  void add_sample(double sample_v) noexcept;
  void anchor() noexcept;
  void rebase() noexcept;
  bool solve(Coefficients& change) const noexcept;
  bool is_period_complete() const noexcept;

  double frequency_hz_ = 0.0;
  double sample_rate_hz_ = 0.0;
  double step_cosine_ = 0.0;
  double step_sine_ = 0.0;
  double cosine_ = 0.0;
  double sine_ = 0.0;
  Coefficients base_;  // What is subtracted from each sample before it is summed.
  double sum_cosine_ = 0.0;
  double sum_sine_ = 0.0;
  double sum_cosine2_ = 0.0;
  double sum_cosine_sine_ = 0.0;
  double sum_rest_ = 0.0;
  double sum_rest_cosine_ = 0.0;
  double sum_rest_sine_ = 0.0;
  double sum_rest2_ = 0.0;
  std::uint64_t samples_ = 0;
  bool is_rebased_ = false;
};

static_assert(std::is_trivially_copyable_v<SineFit>);
static_assert(sizeof(SineFit) <= 160);

}  // namespace emax
