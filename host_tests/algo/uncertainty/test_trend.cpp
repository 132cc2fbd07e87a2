// The regression line against numbers worked out by hand.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "emax/uncertainty/trend.hpp"

namespace emax {
namespace {

TEST(Trend, TwoPointsOfThePaper) {
  const double time_s[] = {0.002, 0.010};
  const double energy[] = {5.862e-3, 34.115e-3};
  const Trend trend = linear_trend(time_s, energy);
  ASSERT_EQ(trend.status, Status::kOk);
  EXPECT_EQ(trend.points, 2U);
  EXPECT_NEAR(trend.slope, 3.531625, 1e-14);  // (34.115 - 5.862)/8
  EXPECT_NEAR(trend.intercept, -1.20125e-3, 1e-17);
  EXPECT_NEAR(trend.correlation, 1.0, 1e-15);
  EXPECT_EQ(trend.residual_std, 0.0);
}

TEST(Trend, FivePointsByHand) {
  // Means 3 and 4; sums of squares 10, 6, 6: slope 0.6, intercept 2.2, r = 0.6 sqrt(10/6), squared
  // residuals 2.4.
  const double time_s[] = {1.0, 2.0, 3.0, 4.0, 5.0};
  const double energy[] = {2.0, 4.0, 5.0, 4.0, 5.0};
  const Trend trend = linear_trend(time_s, energy);
  ASSERT_EQ(trend.status, Status::kOk);
  EXPECT_NEAR(trend.slope, 0.6, 1e-15);
  EXPECT_NEAR(trend.intercept, 2.2, 1e-15);
  EXPECT_NEAR(trend.correlation, 0.6 * std::sqrt(10.0 / 6.0), 1e-15);
  EXPECT_NEAR(trend.residual_std, std::sqrt(2.4 / 3.0), 1e-15);
}

TEST(Trend, OrderDoesNotMatter) {
  const double time_s[] = {5.0, 1.0, 4.0, 2.0, 3.0};
  const double energy[] = {5.0, 2.0, 4.0, 4.0, 5.0};
  const Trend trend = linear_trend(time_s, energy);
  EXPECT_NEAR(trend.slope, 0.6, 1e-15);
  EXPECT_NEAR(trend.intercept, 2.2, 1e-15);
}

TEST(Trend, FarFromTheOriginNothingCancels) {
  // The centred sums are exact: 1e9 + 1, 1e9 + 2 ... are whole numbers.
  const double time_s[] = {1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0, 1e9 + 4.0, 1e9 + 5.0};
  const double energy[] = {1e9 + 2.0, 1e9 + 4.0, 1e9 + 5.0, 1e9 + 4.0, 1e9 + 5.0};
  const Trend trend = linear_trend(time_s, energy);
  EXPECT_NEAR(trend.slope, 0.6, 1e-15);
  EXPECT_NEAR(trend.residual_std, std::sqrt(2.4 / 3.0), 1e-15);
}

TEST(Trend, Level) {
  const double time_s[] = {1.0, 2.0, 4.0};
  const double energy[] = {0.1, 0.1, 0.1};
  const Trend trend = linear_trend(time_s, energy);
  ASSERT_EQ(trend.status, Status::kOk);
  EXPECT_NEAR(trend.slope, 0.0, 1e-16);
  EXPECT_NEAR(trend.intercept, 0.1, 1e-16);
  EXPECT_EQ(trend.correlation, 0.0);
}

TEST(Trend, Falling) {
  const double time_s[] = {0.0, 1.0, 2.0};
  const double energy[] = {4.0, 2.0, 0.0};
  EXPECT_NEAR(linear_trend(time_s, energy).correlation, -1.0, 1e-15);
  EXPECT_GE(linear_trend(time_s, energy).correlation, -1.0);
}

// Rounding alone would put some of these a digit above 1.
TEST(Trend, ExactLinesHaveACorrelationOfAtMostOne) {
  for (int i = 1; i < 400; ++i) {
    const double slope = 0.37 * i;
    const double time_s[] = {0.1, 0.2, 0.3 + 0.01 * i, 0.7 + 0.03 * i};
    double rising[4];
    double falling[4];
    for (int k = 0; k < 4; ++k) {
      rising[k] = slope * time_s[k];
      falling[k] = -slope * time_s[k];
    }
    EXPECT_LE(linear_trend(time_s, rising).correlation, 1.0) << i;
    EXPECT_NEAR(linear_trend(time_s, rising).correlation, 1.0, 1e-15) << i;
    EXPECT_GE(linear_trend(time_s, falling).correlation, -1.0) << i;
    EXPECT_NEAR(linear_trend(time_s, falling).correlation, -1.0, 1e-15) << i;
  }
}

// Finite numbers of which the line or its scatter is not.
TEST(Trend, NumbersOutOfTheRangeOfDouble) {
  const double near_zero_s[] = {0.0, 1.0, 2.0};
  const double squares_too_large[] = {0.0, 1e200, 2e200};
  EXPECT_EQ(linear_trend(near_zero_s, squares_too_large).status, Status::kInvalidArgument);
  const double far_away_s[] = {1e10, 1e10 + 1.0, 1e10 + 2.0};
  const double steep[] = {0.0, 1e300, 2e300};
  EXPECT_EQ(linear_trend(far_away_s, steep).status, Status::kInvalidArgument);
}

TEST(Trend, BadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const double two[] = {1.0, 2.0};
  const double three[] = {1.0, 2.0, 3.0};
  const double same[] = {2.0, 2.0, 2.0};
  const double not_a_number[] = {1.0, nan, 3.0};
  const double infinite[] = {1.0, 2.0, infinity};
  const double huge[] = {-1e308, 1e308, 1e308};
  EXPECT_EQ(linear_trend({}, {}).status, Status::kTooFewPoints);
  EXPECT_EQ(linear_trend(Span<const double>(two, 1), Span<const double>(two, 1)).status,
            Status::kTooFewPoints);
  EXPECT_EQ(linear_trend(two, three).status, Status::kInvalidArgument);
  EXPECT_EQ(linear_trend(three, not_a_number).status, Status::kInvalidArgument);
  EXPECT_EQ(linear_trend(infinite, three).status, Status::kInvalidArgument);
  EXPECT_EQ(linear_trend(three, huge).status, Status::kInvalidArgument);
  EXPECT_EQ(linear_trend(huge, three).status, Status::kInvalidArgument);
  EXPECT_EQ(linear_trend(same, three).status, Status::kNotIdentifiable);
  EXPECT_EQ(linear_trend(same, three).slope, 0.0);
}

}  // namespace
}  // namespace emax
