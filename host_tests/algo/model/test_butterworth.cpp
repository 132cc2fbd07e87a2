// Partial fractions of the filter against the product of paper equation (6), for every order.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <limits>

#include "emax/model/butterworth.hpp"

namespace emax {
namespace {

using Wide = std::complex<long double>;
constexpr long double kPiWide = 3.14159265358979323846L;

/// Paper equation (6) as printed.
Wide product_form(const Butterworth& filter, double frequency_hz) {
  Wide denominator = 1;
  for (int i = 1; i <= filter.order; ++i) {
    const long double angle = (2 * i + filter.order - 1) * kPiWide / (2 * filter.order);
    denominator *= Wide(0, static_cast<long double>(frequency_hz) / filter.cutoff_hz) -
                   Wide(std::cos(angle), std::sin(angle));
  }
  return static_cast<long double>(filter.gain) / denominator;
}

/// The Laplace transform of Re sum r e^(pt) at j 2 pi f.
Wide sum_form(const ReferenceFilter& modes, double frequency_hz) {
  Wide sum = 0;
  const Wide s(0, 2 * kPiWide * frequency_hz);
  for (std::size_t i = 0; i < modes.count; ++i) {
    const Wide p(modes.modes[i].pole.re, modes.modes[i].pole.im);
    const Wide r(modes.modes[i].residue.re, modes.modes[i].residue.im);
    sum += 0.5L * (r / (s - p) + std::conj(r) / (s - std::conj(p)));
  }
  return sum;
}

class EveryOrder : public testing::TestWithParam<int> {};

TEST_P(EveryOrder, PartialFractionsAreTheProduct) {
  const Butterworth filter = {GetParam(), 1000.0, 1.037};
  const ReferenceFilter modes = butterworth(filter);
  EXPECT_EQ(modes.count, static_cast<std::size_t>((filter.order + 1) / 2));
  for (double f_hz = 0.0; f_hz < 3000.0; f_hz += 37.0) {
    // The residues alternate and reach 60 times the gain at order 15, so rounding shows at 1e-14
    // times that.
    const Wide difference = sum_form(modes, f_hz) - product_form(filter, f_hz);
    EXPECT_LT(static_cast<double>(std::abs(difference)), 1e-12) << f_hz;
  }
}

TEST_P(EveryOrder, IsMinus3dBAtTheCutoffAndMonotone) {
  const Butterworth filter = {GetParam(), 800.0, 2.0};
  EXPECT_EQ(amplitude(filter, 0.0), 2.0);
  EXPECT_NEAR(amplitude(filter, 800.0), std::sqrt(2.0), 1e-15);
  double last = 2.0;
  for (double f_hz = 10.0; f_hz < 3000.0; f_hz += 10.0) {
    EXPECT_NEAR(amplitude(filter, f_hz), static_cast<double>(std::abs(product_form(filter, f_hz))),
                1e-13);
    EXPECT_LE(amplitude(filter, f_hz), last);
    last = amplitude(filter, f_hz);
  }
}

TEST_P(EveryOrder, PolesAreStableAndTheResponseStartsAtZero) {
  const Butterworth filter = {GetParam(), 1000.0, 1.0};
  const ReferenceFilter modes = butterworth(filter);
  const double wc = 2.0 * std::acos(-1.0) * 1000.0;
  double at_zero = 0.0;
  for (std::size_t i = 0; i < modes.count; ++i) {
    EXPECT_LT(modes.modes[i].pole.re, 0.0);
    EXPECT_GE(modes.modes[i].pole.im, 0.0);
    EXPECT_NEAR(std::sqrt(norm(modes.modes[i].pole)), wc, 1e-12 * wc);
    at_zero += modes.modes[i].residue.re;
  }
  // Order 1 starts at g wc; every higher order starts at 0, as the numerator's degree is two or
  // more below.
  EXPECT_NEAR(at_zero, filter.order == 1 ? wc : 0.0, 1e-11 * wc);
}

INSTANTIATE_TEST_SUITE_P(Order, EveryOrder, testing::Range(1, kMaxFilterOrder + 1));

TEST(Butterworth, SaysWhatItDoesNotTake) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate(Butterworth{1, 1000.0, 0.0}), Status::kOk);
  EXPECT_EQ(validate(Butterworth{0, 1000.0, 1.0}), Status::kInvalidOrder);
  EXPECT_EQ(validate(Butterworth{16, 1000.0, 1.0}), Status::kInvalidOrder);
  for (const double bad : {0.0, -1.0, nan, 1e10}) {
    EXPECT_EQ(validate(Butterworth{1, bad, 1.0}), Status::kInvalidArgument);
  }
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(validate(Butterworth{1, 1000.0, bad}), Status::kInvalidArgument);
  }
}

}  // namespace
}  // namespace emax
