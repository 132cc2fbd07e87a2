// From the repeats of all points to the budget of each.
#include "emax/app/measure/sweep_budget.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::app {
namespace {

constexpr double kSqrt3 = 1.7320508075688772;
constexpr double kSqrt12 = 3.4641016151377544;
constexpr double kPercentPerStandard = 200.0;  // Expanded with k = 2, in percent.
constexpr double kHumShare = 0.05;
constexpr std::uint32_t kFewDof = 30;
constexpr double kNormalQuantile = 3.0902323061678132;  // 0.1 % lie beyond.

[[gnu::noinline]] double larger(double a, double b) noexcept { return a > b ? a : b; }
// Out of line, for its size.
[[gnu::noinline]] double length(double a, double b) noexcept { return sqrt(a * a + b * b); }

[[gnu::noinline]] Complex deviation(const Complex& value, const Complex& mean) noexcept {
  return (value - mean) / mean;
}

// Re(a conj(b)).
[[gnu::noinline]] double projected(const Complex& a, const Complex& b) noexcept {
  return a.re * b.re + a.im * b.im;
}

// The value of chi-square over its degrees of freedom that chance exceeds once in 1000 (Wilson,
// Hilferty 1931).
double chi_square_limit(double dof) noexcept {
  const double v = 2.0 / (9.0 * dof);
  const double root = 1.0 - v + kNormalQuantile * sqrt(v);
  return root * root * root;
}

// Variance of a component of the ratio, relative, of a fit over so many samples.
[[gnu::noinline]] double ratio_variance(const PointScatter& p, double reference_v, double device_v,
                                        double samples) noexcept {
  return 2.0 / samples *
         (reference_v * reference_v / norm(p.reference) + device_v * device_v / norm(p.device));
}

// The standard deviation of a converter's rounding error that noise does not turn into noise: the
// mean error over normal noise of standard deviation s is a sine over a step, of (step/pi)
// exp(-2 (pi s/step)^2), for the first and largest of its harmonics.
[[gnu::noinline]] double rounding_v(double step_v, double pooled_v) noexcept {
  const double noise2 = pooled_v * pooled_v - step_v * step_v / 12.0;
  const double steps2 = noise2 > 0.0 ? noise2 / (step_v * step_v) : 0.0;
  return step_v > 0.0 ? step_v / kSqrt12 * exp(-2.0 * kPi * kPi * steps2) : 0.0;
}

/// Places of the period that a repeat of whole periods looks at: its samples over what both numbers
/// have in common.
double different_samples(double repeat_samples, double periods_per_sample) noexcept {
  auto samples = static_cast<std::uint32_t>(repeat_samples);
  auto periods = static_cast<std::uint32_t>(floor(repeat_samples * periods_per_sample + 0.5));
  while (periods > 0) {
    const std::uint32_t rest = samples % periods;
    samples = periods;
    periods = rest;
  }
  return repeat_samples / static_cast<double>(samples);
}

}  // namespace

double relative_hum(const PointScatter& scatter, double frequency_hz, double samples,
                    const BudgetInputs& inputs) noexcept {
  const double duration_s = samples / inputs.sample_rate_hz;
  return length(
      inputs.silent_reference.hum_in_fit_v(frequency_hz, duration_s) /
          sqrt(norm(scatter.reference)),
      inputs.silent_device.hum_in_fit_v(frequency_hz, duration_s) / sqrt(norm(scatter.device)));
}

PointScatter scatter_of(const Repeats& repeats) noexcept {
  PointScatter p;
  p.repeats = repeats.count;
  const double share = 1.0 / static_cast<double>(repeats.count);
  for (std::uint32_t k = 0; k < repeats.count; ++k) {
    p.reference = p.reference + share * repeats.reference[k];
    p.device = p.device + share * repeats.device[k];
  }
  for (std::uint32_t k = 0; k < repeats.count; ++k) {
    const Complex r = deviation(repeats.reference[k], p.reference);
    const Complex a = deviation(repeats.device[k], p.device);
    const Complex e = a - r;
    p.reference_sum -= projected(r, e);
    p.device_sum += projected(a, e);
    p.ratio_sum += norm(e);
    p.largest = larger(p.largest, length(e.re, e.im));
  }
  return p;
}

ChannelNoise pooled_noise(Span<const PointScatter> scatter, Span<const double> frequency_hz,
                          const BudgetInputs& inputs) noexcept {
  double reference = 0.0;
  double device = 0.0;
  double degrees = 0.0;
  for (std::size_t i = 0; i < scatter.size(); ++i) {
    const PointScatter& p = scatter[i];
    const double hum = relative_hum(p, frequency_hz[i], p.repeat_samples, inputs);
    const double noise = ratio_variance(p, inputs.silent_reference.noise_v,
                                        inputs.silent_device.noise_v, p.repeat_samples);
    if (hum * hum > kHumShare * noise) {
      continue;
    }
    reference += 0.25 * norm(p.reference) * p.repeat_samples * p.reference_sum;
    device += 0.25 * norm(p.device) * p.repeat_samples * p.device_sum;
    degrees += static_cast<double>(p.repeats - 1);
  }
  ChannelNoise noise;
  noise.dof = static_cast<std::uint32_t>(2.0 * degrees);
  if (degrees > 0.0) {
    noise.reference_v = sqrt(larger(reference / degrees, 0.0));
    noise.device_v = sqrt(larger(device / degrees, 0.0));
  }
  if (noise.dof < kFewDof) {
    noise.reference_v = larger(noise.reference_v, inputs.silent_reference.noise_v);
    noise.device_v = larger(noise.device_v, inputs.silent_device.noise_v);
  }
  noise.reference_v = larger(noise.reference_v, inputs.reference_step_v / kSqrt12);
  noise.device_v = larger(noise.device_v, inputs.device_step_v / kSqrt12);
  return noise;
}

PointVerdict point_verdict(const PointScatter& scatter, double frequency_hz,
                           const ChannelNoise& noise, const BudgetInputs& inputs) noexcept {
  PointVerdict verdict;
  PointBudget& budget = verdict.budget;
  const double samples = scatter.repeat_samples * static_cast<double>(scatter.repeats);
  const double pooled = ratio_variance(scatter, noise.reference_v, noise.device_v, samples);
  const double dof = 2.0 * static_cast<double>(scatter.repeats - 1);
  const double own = scatter.ratio_sum / dof / static_cast<double>(scatter.repeats);
  const double hum_in_repeats = relative_hum(scatter, frequency_hz, scatter.repeat_samples, inputs);
  const double explained =
      pooled + hum_in_repeats * hum_in_repeats / static_cast<double>(scatter.repeats);
  verdict.scatters = own > explained * chi_square_limit(dof);
  budget.noise = sqrt(verdict.scatters ? own : pooled);
  // Samples at the same place of the period are rounded alike: they take no part in the mean, nor
  // do repeats, and only noise makes the steps of a converter small.
  const double different =
      different_samples(scatter.repeat_samples, frequency_hz / inputs.sample_rate_hz);
  budget.quantisation =
      sqrt(ratio_variance(scatter, rounding_v(inputs.reference_step_v, noise.reference_v),
                          rounding_v(inputs.device_step_v, noise.device_v), different));
  budget.hum = relative_hum(scatter, frequency_hz, samples, inputs);
  const double reference_v = sqrt(norm(scatter.reference));
  const double device_v = sqrt(norm(scatter.device));
  const double distortion =
      length(distortion_of(scatter.reference_rest_v, noise.reference_v, reference_v, samples),
             distortion_of(scatter.device_rest_v, noise.device_v, device_v, samples));
  // Harmonics only get into a fit of whole periods through the half frame at most by which a
  // repeat misses them.
  budget.distortion = distortion * 0.5 / scatter.repeat_samples / kSqrt3;
  verdict.relative_u =
      length(length(length(budget.noise, budget.quantisation), budget.hum), budget.distortion);
  verdict.residual_percent =
      100.0 * larger(scatter.reference_rest_v / reference_v, scatter.device_rest_v / device_v);
  return verdict;
}

CommonBudget common_budget(const SweepSettings& settings, double check_change) noexcept {
  CommonBudget common;
  common.reference = settings.reference.expanded_percent / kPercentPerStandard;
  common.gain = length(length(settings.reference_gain_expanded_percent,
                              settings.device_gain_expanded_percent),
                       settings.ratio_expanded_percent) /
                kPercentPerStandard;
  common.mounting = settings.mounting_expanded_percent / kPercentPerStandard;
  common.drift = abs(check_change) / kSqrt3;
  common.total =
      length(length(common.reference, common.gain), length(common.mounting, common.drift));
  return common;
}

SharedEffects shared_effects(const SweepSettings& settings, double sample_rate_hz, double drift,
                             double factor, double highest_hz, double of_scale) noexcept {
  constexpr double kPpmPerStandard = 2e6;
  constexpr double kImageSkew = 1.6e-5;
  constexpr double kImages = 1.5e-3;
  const double share = highest_hz / sample_rate_hz;
  const double crosstalk = settings.crosstalk_expanded_percent / kPercentPerStandard;
  SharedEffects shared;
  shared.skew_s = length(0.5 * settings.skew_expanded_s, kImageSkew / sample_rate_hz);
  shared.clock = settings.clock_expanded_ppm / kPpmPerStandard;
  shared.drift = drift;
  shared.corner_hz = settings.repeat_s > 0.0
                         ? static_cast<double>(settings.cycles) / settings.repeat_s
                         : highest_hz;
  shared.images = kImages * share * share;
  shared.leak = crosstalk * factor;
  shared.leak_back = crosstalk / factor;
  shared.linearity =
      settings.linearity_expanded_percent / kPercentPerStandard * of_scale * of_scale;
  return shared;
}

double unfitted_crosstalk(const SharedEffects& shared, double skew_s,
                          const ResponsePoint& point) noexcept {
  constexpr double kSquares = 10.0;  // Of 2.6 u, once in a hundred, with those of the fit.
  constexpr double kTurnedU = 2.0;   // Of that many u.
  const double leak = shared.leak / point.amplitude;
  const double back = shared.leak_back * point.amplitude;
  // What leaks is sampled at the time of its own channel, or of the other's.
  const double turned = kTwoPi * point.frequency_hz * abs(skew_s);
  return kSquares * (leak * leak + back * back) + kTurnedU * turned * (leak + back);
}

double unfitted_turn(double u_rad) noexcept {
  constexpr double kSeldom2 = 6.6;  // Of 2.6 u, once in a hundred.
  return 0.5 * kSeldom2 * u_rad * u_rad;
}

double unfitted_linearity(const SweepSettings& settings, const SweepLevels& levels,
                          const PointScatter& scatter, const ResponsePoint& point) noexcept {
  constexpr double kSeldom = 3.0;  // Of that many u, of both channels.
  const double linearity = settings.linearity_expanded_percent / kPercentPerStandard;
  const double of_largest = point.amplitude / levels.largest_amplitude;
  return kSeldom * linearity *
         (abs(norm(scatter.device) - of_largest * of_largest * levels.largest_device2) /
              levels.device_scale2 +
          abs(norm(scatter.reference) - levels.mean_reference2) / levels.reference_scale2);
}

double expected_scatter(const PointScatter& scatter, double frequency_hz,
                        const BudgetInputs& inputs) noexcept {
  const double samples = scatter.repeat_samples;
  return length(sqrt(ratio_variance(scatter, inputs.silent_reference.noise_v,
                                    inputs.silent_device.noise_v, samples)),
                relative_hum(scatter, frequency_hz, samples, inputs));
}

double distortion_of(double rest_v, double noise_v, double amplitude_v, double samples) noexcept {
  const double by_noise = noise_v * noise_v * (1.0 + 4.0 * sqrt(2.0 / samples));
  const double squares = rest_v * rest_v - by_noise;
  return squares > 0.0 ? sqrt(squares) / amplitude_v : 0.0;
}

}  // namespace emax::app
