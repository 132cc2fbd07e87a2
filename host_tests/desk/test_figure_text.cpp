// Figures in as many digits as their uncertainty justifies.
#include <gtest/gtest.h>

#include "desk/compare/figure_text.hpp"

namespace emax::desk {
namespace {

constexpr FigureKind kPercent = FigureKind::kMatched;
constexpr FigureKind kEnergy = FigureKind::kEnergy;

TEST(NumberText, EndsWhereItsUncertaintyHasTwoDigits) {
  EXPECT_EQ(number_text(1.19634, 0.0083, kPercent), "1.1963");
  EXPECT_EQ(number_text(0.0083, 0.0083, kPercent), "0.0083");
  EXPECT_EQ(number_text(148.7049, 0.41, kPercent), "148.70");
  EXPECT_EQ(number_text(0.000591234, 0.000012, kPercent), "0.000591");
  EXPECT_EQ(number_text(5.115251e-3, 2.3e-5, kEnergy), "5.115e-03");
  EXPECT_EQ(number_text(2.3e-5, 2.3e-5, kEnergy), "2.3e-05");
  EXPECT_EQ(number_text(-5.115251e-3, 2.3e-5, kEnergy), "-5.115e-03");
}

TEST(NumberText, HasFourDigitsWithoutUncertainty) {
  EXPECT_EQ(number_text(1.19634, 0.0, kPercent), "1.196");
  EXPECT_EQ(number_text(0.0, 0.0, kPercent), "0.000");
  EXPECT_EQ(number_text(1.23456e-7, 0.0, kPercent), "1.235e-07");
  EXPECT_EQ(number_text(5.115251e-3, 0.0, kEnergy), "5.115e-03");
}

TEST(NumberText, OfLessThanItsUncertaintyStillIsANumber) {
  EXPECT_EQ(number_text(0.002, 0.5, kPercent), "0.0020");
  EXPECT_EQ(number_text(0.02, 0.05, kPercent), "0.020");
  EXPECT_EQ(number_text(0.0001385, 0.015, kPercent), "0.00014");
}

TEST(RangeText, IsRoundedOutwardsToTwoDigitsOfTheFarEnd) {
  EXPECT_EQ(range_text(0.0000112, 0.02391), "0 to 0.024");
  EXPECT_EQ(range_text(0.01199, 0.0200001), "0.011 to 0.021");
  EXPECT_EQ(range_text(0.5, 1.5), "0.5 to 1.5");
  EXPECT_EQ(range_text(3.0, 250.0), "0 to 2.5e+02");
  EXPECT_EQ(range_text(2.14e-11, 3.01e-10), "2.0e-11 to 3.1e-10");
}

TEST(IntervalText, StandsInThePlaceOfUWhereTheFigureIsAtItsEnd) {
  Figure figure;
  figure.exists = figure.has_interval = figure.has_uncertainty = true;
  figure.value = 0.0001385;
  figure.expanded = 0.0147;
  figure.low = 0.0000112;
  figure.high = 0.02391;
  figure.is_one_sided = true;
  EXPECT_EQ(value_text(figure, kPercent), "0.0001385");
  EXPECT_EQ(interval_text(figure, kPercent), "0 to 0.024");
  figure.is_one_sided = false;
  EXPECT_EQ(value_text(figure, kPercent), "0.00014");
}

TEST(BoundText, IsNeverBelowTheBound) {
  Figure figure;
  EXPECT_EQ(bound_text(figure, kPercent), "-");
  figure.has_bound = true;
  figure.bound = 1.19601;
  EXPECT_EQ(bound_text(figure, kPercent), "1.197");
  figure.bound = 9.99901;
  EXPECT_EQ(bound_text(figure, kPercent), "10.00");
  EXPECT_EQ(bound_text(figure, kEnergy), "1.000e+01");
}

TEST(PaperText, HasHalfTheRelativeUncertaintyOfTheEnergy) {
  Result result;
  result.duration_s = 0.002;
  result.sensitivity = 2.0;
  result.limit_mps2 = 0.5;
  Figure& energy = result.figure(kEnergy);
  // The root of E/T is 1.5 V, 150 % of 1 V; U(E) of 1 % is 0.75 %.
  energy.value = 0.0045;
  EXPECT_EQ(paper_text(result), "150.0");
  energy.expanded = 0.000045;
  EXPECT_EQ(paper_text(result), "150.00");
  energy.value = -0.0045;
  EXPECT_EQ(paper_text(result), "-");
}

}  // namespace
}  // namespace emax::desk
