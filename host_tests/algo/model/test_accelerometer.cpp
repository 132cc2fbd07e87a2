// The accelerometer against its transfer function evaluated in complex arithmetic, and textbook
// values.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <limits>

#include "emax/base/complex_exp.hpp"
#include "emax/model/accelerometer.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using Wide = std::complex<long double>;
constexpr long double kPiWide = 3.14159265358979323846L;

Wide transfer_function(const Accelerometer& device, double frequency_hz) {
  const long double w0 = 2 * kPiWide * device.natural_frequency_hz;
  const Wide s(0, 2 * kPiWide * frequency_hz);
  return static_cast<long double>(device.sensitivity) * w0 * w0 /
         (s * s + 2 * static_cast<long double>(device.damping) * w0 * s + w0 * w0);
}

TEST(Accelerometer, ResponsesAreThoseOfTheTransferFunction) {
  for (const double damping : {1e-4, 0.01, 0.3182, 0.7, 0.999}) {
    const Accelerometer device = {1.037, 4073.0, damping};
    for (double f_hz = 1.0; f_hz < 1e5; f_hz *= 1.37) {
      const Wide k = transfer_function(device, f_hz);
      // The denominator 1 - (f/f0)^2 loses digits near the resonance, by 1/(2 damping) at most.
      const double tolerance = 1e-15 * (4.0 + 1.0 / damping);
      EXPECT_NEAR(amplitude(device, f_hz) / static_cast<double>(std::abs(k)), 1.0, tolerance);
      EXPECT_NEAR(phase_rad(device, f_hz), static_cast<double>(std::arg(k)), tolerance);
    }
  }
}

TEST(Accelerometer, TextbookValues) {
  const Accelerometer device = test::kPaperDevice;
  const double f0 = device.natural_frequency_hz;
  EXPECT_EQ(amplitude(device, 0.0), device.sensitivity);
  EXPECT_NEAR(amplitude(device, f0), device.sensitivity / (2.0 * device.damping), 1e-15);
  EXPECT_NEAR(phase_rad(device, f0), -std::acos(0.0), 1e-15);
}

TEST(Accelerometer, PhaseGoesOnPastTheResonanceWhereThePrintedArctanJumps) {
  const Accelerometer device = test::kPaperDevice;
  double last = phase_rad(device, 1.0);
  for (double f_hz = 2.0; f_hz < 20000.0; f_hz += 1.0) {
    const double now = phase_rad(device, f_hz);
    ASSERT_LT(now, last) << f_hz;
    last = now;
  }
  EXPECT_GT(last, -std::acos(-1.0));
  EXPECT_LT(last, -3.0);
}

TEST(Accelerometer, ModeIsTheDampedSine) {
  for (const double damping : {1e-4, 0.3182, 0.9999}) {
    const Accelerometer device = {2.5, 1234.5, damping};
    const double w0 = 2.0 * std::acos(-1.0) * device.natural_frequency_hz;
    const double wd = w0 * std::sqrt(1.0 - damping * damping);
    const Mode mode = mode_of(device);
    for (double t_s = 0.0; t_s < 0.01; t_s += 1.7e-4) {
      const double expected =
          device.sensitivity * w0 * w0 / wd * std::exp(-damping * w0 * t_s) * std::sin(wd * t_s);
      // Up to 12 rounded radians per millisecond enter the sine, at the scale of the peak.
      EXPECT_NEAR(real_of_product(mode.residue, exp(t_s * mode.pole)), expected,
                  1e-12 * device.sensitivity * w0 * w0 / wd);
    }
  }
}

TEST(Accelerometer, SaysWhatItDoesNotTake) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(validate(Accelerometer{1.0, 1.0, 0.5}), Status::kOk);
  EXPECT_EQ(validate(Accelerometer{1.0, 1.0, 1e-4}), Status::kOk);
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    EXPECT_EQ(validate(Accelerometer{bad, 1.0, 0.5}), Status::kInvalidArgument);
    EXPECT_EQ(validate(Accelerometer{1.0, bad, 0.5}), Status::kInvalidArgument);
  }
  for (const double bad : {0.0, -1.0, 0.99e-4, nan}) {
    EXPECT_EQ(validate(Accelerometer{1.0, 1.0, bad}), Status::kInvalidArgument);
  }
  for (const double bad : {1.0, 1.5, infinity}) {
    EXPECT_EQ(validate(Accelerometer{1.0, 1.0, bad}), Status::kOverdamped);
  }
}

}  // namespace
}  // namespace emax
