// The uncertainties of a sweep: scatter of the repeats, pooled noise, hum, and the common part.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/silent_channel.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// The uncertainty budget of one point in the manner of ISO 16063-21: relative standard
/// uncertainties of the amplitude, which are also those of the phase in rad, `shared` apart.
struct PointBudget {
  double noise = 0.0;         ///< Of both channels, pooled over all points, or this point's own
                              ///< scatter where that is larger beyond chance.
  double quantisation = 0.0;  ///< Converters' steps: within `noise`, and its least value.
  double hum = 0.0;           ///< Mains seen with the drive at zero, as far as it is near.
  double distortion = 0.0;    ///< What the fit leaves over beyond noise.
  double shared = 0.0;        ///< Amplitude's part of what all points share in their own ways.
};

/// A point with more hum is flagged.
inline constexpr double kMuchHum = 0.01;

/// What is common to all points: relative standard uncertainties.
struct CommonBudget {
  double reference = 0.0;
  double gain = 0.0;
  double mounting = 0.0;
  /// Of the check frequency between start and end of the sweep: rectangular, |change|/sqrt(3).
  double drift = 0.0;
  double total = 0.0;
};

/// The repeats of one frequency: both channels' phasors, turned to one origin of time.
struct Repeats {
  std::array<Complex, kMaxRepeats> reference = {};
  std::array<Complex, kMaxRepeats> device = {};
  std::uint32_t count = 0;
};

/// What the repeats of one point say.
///
/// What both sensors feel alike (drive, shaker) moves both channels together and cancels in the
/// ratio. The scatter of a channel's own noise is therefore that part of its relative deviations
/// d which goes with the deviation of the ratio, e = d_device - d_reference: Re(d conj(e)).
struct PointScatter {
  Complex reference;  ///< Mean phasors in V.
  Complex device;
  double reference_sum = 0.0;     ///< Sum over the repeats of -Re(d_reference conj(e)).
  double device_sum = 0.0;        ///< Sum of Re(d_device conj(e)).
  double ratio_sum = 0.0;         ///< Sum of |e|^2: the two together.
  double largest = 0.0;           ///< Largest |e|.
  double repeat_samples = 0.0;    ///< Of one repeat.
  double reference_rest_v = 0.0;  ///< Residual standard deviation of a sample, root mean square.
  double device_rest_v = 0.0;
  std::uint32_t repeats = 0;
};

/// Means, deviations and their sums. `repeat_samples` and the rests are left to the caller.
PointScatter scatter_of(const Repeats& repeats) noexcept;

/// Standard deviations of a sample of either channel, white noise.
struct ChannelNoise {
  double reference_v = 0.0;
  double device_v = 0.0;
  std::uint32_t dof = 0;  ///< Degrees of freedom of each, both components counted.
};

/// Everything that does not depend on the point.
struct BudgetInputs {
  double sample_rate_hz = 0.0;
  SilentChannel silent_reference;
  SilentChannel silent_device;
  double reference_step_v = 0.0;  ///< Of the converters.
  double device_step_v = 0.0;
};

/// Pools the scatter of all points: sigma^2 = sum(V^2 N/4 s)/sum(R - 1), since each component of a
/// phasor from N samples has variance 2 sigma^2/N. Points where hum adds more than 5 % to the
/// scatter are left out. Never below the steps of the converters; below 30 degrees of freedom not
/// below the noise without drive.
ChannelNoise pooled_noise(Span<const PointScatter> scatter, Span<const double> frequency_hz,
                          const BudgetInputs& inputs) noexcept;

struct PointVerdict {
  PointBudget budget;
  double relative_u = 0.0;        ///< Of the amplitude: the root of the sum of the squares.
  double residual_percent = 0.0;  ///< What the sine leaves over, of the amplitude, worse channel.
  bool scatters = false;          ///< The repeats differ by more than chance, at 0.1 %.
};

/// The budget of one point: u(A)/A = u(phase) = sqrt(2/N) sqrt((s_r/V_r)^2 + (s_a/V_a)^2) for N
/// samples in all, and what comes on top.
PointVerdict point_verdict(const PointScatter& scatter, double frequency_hz,
                           const ChannelNoise& noise, const BudgetInputs& inputs) noexcept;

/// The common part of these settings.
///
/// @param[in] check_change Relative change of the check frequency's ratio over the sweep.
CommonBudget common_budget(const SweepSettings& settings, double check_change) noexcept;

/// What the parameters' uncertainties hold beside the points' own and the common part: what the
/// settings state of skew, clock, crosstalk and linearity; the drift within the sweep; and the
/// images of the held drive, which a reconstruction filter of fourth order at a quarter of the rate
/// of sampling leaves: 1.5e-3 (f/rate)^2 of the amplitude and 1.6e-5 of an interval of skew.
///
/// @param[in] drift      Relative change of the check's ratio beyond its noise.
/// @param[in] factor     V/(m/s^2) of K per device's volt over reference's.
/// @param[in] highest_hz Of the points.
/// @param[in] of_scale   Largest part of full scale that a point used.
SharedEffects shared_effects(const SweepSettings& settings, double sample_rate_hz, double drift,
                             double factor, double highest_hz, double of_scale) noexcept;

/// What the fit leaves of a shared error of the phase, since it takes a turn for a straight step:
/// 1 - cos, of an error that one in a hundred exceeds.
///
/// @returns Relative of the amplitude.
double unfitted_turn(double u_rad) noexcept;

/// What the fit leaves of crosstalk in a point, since it takes it for linear and for a change in
/// phase: its squares, and what the skew between the channels turns.
///
/// @returns Relative of the amplitude, and of the phase in rad.
double unfitted_crosstalk(const SharedEffects& shared, double skew_s,
                          const ResponsePoint& point) noexcept;

/// The levels of a sweep, in V^2 unless it says otherwise.
struct SweepLevels {
  double largest_amplitude = 0.0;  ///< Of the points, in V/(m/s^2).
  double largest_device2 = 0.0;
  double mean_reference2 = 0.0;
  double device_scale2 = 0.0;  ///< Full scales.
  double reference_scale2 = 0.0;
};

/// What the fit leaves of linearity in a point, since it takes it for that of the device's channel
/// at one level at all points, and all else of it for common: what the level is off by, squared, in
/// either channel.
///
/// @returns Relative of the amplitude.
double unfitted_linearity(const SweepSettings& settings, const SweepLevels& levels,
                          const PointScatter& scatter, const ResponsePoint& point) noexcept;

/// Relative standard deviation of each component of one repeat's ratio if the channels' noise and
/// hum are those without drive.
double expected_scatter(const PointScatter& scatter, double frequency_hz,
                        const BudgetInputs& inputs) noexcept;

/// Relative standard uncertainty of the ratio by hum, over so many samples.
double relative_hum(const PointScatter& scatter, double frequency_hz, double samples,
                    const BudgetInputs& inputs) noexcept;

/// @returns What a fit over so many samples leaves over beyond noise, relative to the amplitude; 0
/// within four standard deviations of what noise alone leaves.
double distortion_of(double rest_v, double noise_v, double amplitude_v, double samples) noexcept;

static_assert(std::is_trivially_copyable_v<PointScatter>);

}  // namespace emax::app
