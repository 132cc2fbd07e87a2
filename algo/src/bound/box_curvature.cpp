// Second derivatives of the sensor's impulse response by f0 and by beta, from above.
#include "emax/bound/box_curvature.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr double kMargin = 1.01;
constexpr std::size_t kMesh = 16384;

/// The root of the mean over v up to U of the square of an integral up to v.
class RootMeanSquare {
 public:
  explicit RootMeanSquare(double step) noexcept : step_(step) {}

  /// Takes the next value, at 0, one step, two steps, ...
  void add(double value) noexcept {
    integral_ += 0.5 * step_ * (last_ + value);
    sum_ += integral_ * integral_;
    last_ = value;
  }

  double result(std::size_t count) const noexcept {
    return sqrt(sum_ / static_cast<double>(count));
  }

 private:
  double step_;
  double last_ = 0.0;
  double integral_ = 0.0;
  double sum_ = 0.0;
};

}  // namespace

CurvatureTerms curvature_terms(const DeviceRange& range, double sensitivity, double duration_s,
                               double filter_integral) noexcept {
  const double low = range.low_damping;
  const double high = range.high_damping;
  const double square_low = (1.0 - low) * (1.0 + low);     // kappa^2 at both ends.
  const double square_high = (1.0 - high) * (1.0 + high);  // The smaller one.
  const double root = sqrt(square_high);
  const double end = kTwoPi * range.high_hz * duration_s;
  const double step = end / static_cast<double>(kMesh);
  const double at_start = high * high / (square_high * square_high);
  const double slope = (1.0 + high * high) / (square_high * square_high);
  RootMeanSquare of_frequency(step);
  RootMeanSquare of_damping(step);
  for (std::size_t i = 0; i <= kMesh; ++i) {
    const double u = step * static_cast<double>(i);
    const double decay = exp(-low * u) / root;
    of_frequency.add(u * sqrt(4.0 - 4.0 * low * u + u * u) * decay);
    const double first = u * u / square_high - 2.0 * u * low / square_low + at_start;
    const double second = sqrt(slope * slope + u * u / (square_high * square_high * square_high));
    of_damping.add((first + second) * decay);
  }
  const double size = kMargin * sensitivity * sqrt(duration_s) * filter_integral;
  const double relative_width = (range.high_hz - range.low_hz) / range.low_hz;
  const double width = high - low;
  CurvatureTerms terms;
  terms.frequency = 0.25 * relative_width * relative_width * size * of_frequency.result(kMesh + 1);
  terms.damping = 0.25 * width * width * size * of_damping.result(kMesh + 1);
  return terms;
}

double filter_integral(const ReferenceFilter& filter, double duration_s) noexcept {
  const double step_s = duration_s / static_cast<double>(kMesh);
  double sum = 0.0;
  for (std::size_t i = 0; i < kMesh; ++i) {
    double value = 0.0;
    const double time_s = (static_cast<double>(i) + 0.5) * step_s;
    for (const Mode& mode : filter.terms()) {
      value += real_of_product(mode.residue, exp(time_s * mode.pole));
    }
    sum += abs(value);
  }
  return kMargin * step_s * sum / filter.gain;
}

double box_bound(double corners, double terms, double more) noexcept {
  const double root = 0.5 * (terms + sqrt(terms * terms + 4.0 * (corners + more)));
  return root * root - more;
}

}  // namespace emax
