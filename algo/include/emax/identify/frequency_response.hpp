// Measured points of a frequency response with their uncertainties, in a fixed table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/base/wichmann_hill.hpp"

namespace emax {

/// One point of K(j 2 pi f) with standard uncertainties.
///
/// Tables such as the paper's Table 1 print expanded uncertainties: halve them (k = 2) first.
struct ResponsePoint {
  double frequency_hz = 0.0;
  double amplitude = 0.0;    ///< |K| in V/(m/s^2).
  double phase_rad = 0.0;    ///< Of K; negative for a lag.
  double u_amplitude = 0.0;  ///< Standard uncertainty in V/(m/s^2).
  double u_phase_rad = 0.0;  ///< Standard uncertainty in rad.
};

/// The standard uncertainty of a phase that was not measured, for tables of magnitudes alone.
inline constexpr double kUnknownPhase_rad = 1e6;

/// @returns Whether the phase says anything: its standard uncertainty is below pi/sqrt(3), that of
/// an angle which may be any.
constexpr bool is_phase_known(const ResponsePoint& point) noexcept {
  return point.u_phase_rad < 1.8137993642342178;
}

/// @returns
/// * kOk: All five numbers finite, frequency, amplitude and both uncertainties above 0.
/// * kInvalidArgument: A number that is not finite, or a frequency or amplitude of zero or less.
/// * kUncertaintyNotPositive: An uncertainty of zero or less.
Status validate(const ResponsePoint& point) noexcept;

/// Standard uncertainties of effects that every point feels in its own way, by one cause each.
///
/// No scatter between points shows them, and the model takes most of each for a change of its
/// parameters. The fit does not weight with them: it carries each to the parameters and adds that
/// to their covariance.
struct SharedEffects {
  double skew_s = 0.0;     ///< Of the device's channel: a phase of w skew.
  double clock = 0.0;      ///< Of all frequencies, relative.
  double drift = 0.0;      ///< Of the amplitude from the first point to the last, relative.
  double corner_hz = 0.0;  ///< Below it a point takes longer, as 1/f: for the time of the drift.
  double images = 0.0;     ///< Of the amplitude at the highest frequency, relative, as f^2.
  double leak = 0.0;       ///< Reference seen in the device's channel: of K, in V/(m/s^2).
  double leak_back = 0.0;  ///< Device seen in the reference's: of 1/K, in (m/s^2)/V.
  double linearity = 0.0;  ///< Of the largest amplitude A, relative, as A^2.

  /// @returns Whether chi-square has sizes of leak, linearity and skew among its unknowns: see
  /// `Wlsp`. A skew below a nanosecond turns the phase by less than a sweep sees.
  constexpr bool is_explained() const noexcept {
    constexpr double kLittle_s = 1e-9;
    return leak + leak_back + linearity > 0.0 || skew_s > kLittle_s;
  }
};

/// @returns The time that a point takes, where those above the corner take 1.
constexpr double time_of(double frequency_hz, double corner_hz) noexcept {
  return frequency_hz < corner_hz ? corner_hz / frequency_hz : 1.0;
}

/// @returns What drift, images and skew, each of the size of its uncertainty, change at a point:
/// relative amplitude (re) and phase in rad (im).
///
/// @param[in] place      In the time of the sweep, from 0 to 1.
/// @param[in] of_highest Frequency over the highest one.
Complex shared_at(const SharedEffects& shared, double frequency_hz, double place,
                  double of_highest) noexcept;

/// Up to kMaxPoints points in ascending order of frequency, one effect that is common to all of
/// them, and those that are shared in other ways. 3144 bytes.
///
/// The uncertainties of a point are those of its own effects, independent of every other point. An
/// effect that moves all amplitudes together (the reference's sensitivity, the gains, the mounting)
/// is not part of them, because no mean over the points makes it smaller. The table keeps it as one
/// relative standard uncertainty per point, all of one sign, and the fit takes it as one vector.
class FrequencyResponse {
 public:
  /// Appends a point, without a common part.
  ///
  /// @returns
  /// * kOk: Appended.
  /// * kInvalidArgument, kUncertaintyNotPositive: As `validate()`.
  /// * kNotAscending: A frequency not above the last one.
  /// * kTooManyPoints: The table is full.
  Status add(const ResponsePoint& point) noexcept;

  /// Sets the relative standard uncertainty of the amplitude that all points added so far have in
  /// common: 0.0025 for a reference known to 0.5 % (k = 2).
  ///
  /// @returns
  /// * kOk
  /// * kInvalidArgument: Negative, 1 or more, or not a number.
  Status set_common(double relative_u) noexcept;

  /// The same with one value per point, for a reference whose uncertainty depends on frequency.
  ///
  /// @returns As above, and kInvalidArgument for a number of values other than `size()`.
  Status set_common(Span<const double> relative_u) noexcept;

  /// Sets the phase of a point whose phase is unknown to that of a model.
  ///
  /// @param[in] index Below `size()`; a point whose phase is known stays as it is.
  void set_unknown_phase(std::size_t index, double phase_rad) noexcept {
    if (!is_phase_known(points_[index])) {
      points_[index].phase_rad = phase_rad;
    }
  }

  /// @returns kOk, or kInvalidArgument for one that is negative or not a number.
  Status set_shared(const SharedEffects& shared) noexcept;
  const SharedEffects& shared() const noexcept { return shared_; }

  void clear() noexcept {
    count_ = 0;
    shared_ = SharedEffects();
  }

  Span<const ResponsePoint> points() const noexcept {
    return Span<const ResponsePoint>(points_, count_);
  }
  /// The common relative standard uncertainties, one per point; zeros unless set.
  Span<const double> common() const noexcept { return Span<const double>(common_, count_); }
  bool has_common() const noexcept;
  /// @returns The number of points whose phase is known.
  std::size_t known_phases() const noexcept;
  std::size_t size() const noexcept { return count_; }

 private:
  ResponsePoint points_[kMaxPoints] = {};
  double common_[kMaxPoints] = {};
  std::size_t count_ = 0;
  SharedEffects shared_;
};

static_assert(std::is_trivially_copyable_v<FrequencyResponse>);

/// The covariance matrix of the real and imaginary part of a complex number.
struct ComplexCovariance {
  double re_re = 0.0;
  double re_im = 0.0;
  double im_im = 0.0;
};

/// The lower triangular factor L of a covariance matrix, C = L L^T.
struct ComplexCholesky {
  double re_re = 0.0;
  double im_re = 0.0;
  double im_im = 0.0;
};

/// @returns 1/K of the point, (1/A) e^(-j phase), in (m/s^2)/V.
Complex inverse_response(const ResponsePoint& point) noexcept;

/// The covariance of 1/K by the law of propagation: C = J diag(u_A^2, u_phase^2) J^T with
/// J = [[-cos(phase)/A^2, -sin(phase)/A], [sin(phase)/A^2, -cos(phase)/A]].
///
/// @returns C in ((m/s^2)/V)^2. The point must be valid.
ComplexCovariance inverse_covariance(const ResponsePoint& point) noexcept;

/// @returns The factor of `inverse_covariance()`, from J without forming C: no digits are lost even
/// where one uncertainty is many orders smaller than the other.
ComplexCholesky inverse_cholesky(const ResponsePoint& point) noexcept;

struct DrawnCovariance {
  Status status = Status::kInvalidArgument;
  ComplexCovariance covariance;  ///< In ((m/s^2)/V)^2; zero unless the status is kOk.
  Complex mean;                  ///< Of the draws of 1/K.
};

/// The same covariance by Monte Carlo, as the paper has it: amplitude and phase are drawn from
/// normal distributions of their standard uncertainties and 1/K is formed from each draw.
///
/// Takes two uniform numbers per draw (amplitude from the first normal number of the pair, phase
/// from the second). It differs from the formula by the curvature of 1/A, of relative size
/// (u_A/A)^2, and by the scatter of the draws, of relative standard deviation sqrt(2/draws).
///
/// @param[in]     draws     3 or more.
/// @param[in,out] generator A seeded generator; the draws take the next 2 `draws` numbers.
/// @returns
/// * kOk
/// * kInvalidArgument: Fewer than 3 draws, or a point that is not valid.
/// * kNotPhysical: A drawn amplitude was zero or less: the uncertainty is too large for 1/A to have
/// a variance.
DrawnCovariance inverse_covariance_by_draws(const ResponsePoint& point, std::uint32_t draws,
                                            WichmannHill& generator) noexcept;

}  // namespace emax
