// The figures beside the maximum energy, against values found outside this code.
#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "emax/app/evaluate/evaluation_results.hpp"

#include "support/evaluations.hpp"
#include "support/paper_device.hpp"

namespace {

using emax::Status;
using emax::app::Device;
using emax::app::EvaluationResults;
using emax::app::Settings;
using emax::test::evaluated;
using emax::test::quick_settings;

const Device kPaper = {{1.037, 4073.0, 0.3182}, {0.003, 6.0, 0.0004}};

TEST(EvaluationFigures, OfTheSensorOfThePaper) {
  const EvaluationResults& results = evaluated(kPaper, quick_settings());
  ASSERT_TRUE(results.band.exists());
  ASSERT_TRUE(results.matched.exists());
  ASSERT_TRUE(results.ideal.exists());
  // Nine digits are given: half a unit of the last.
  EXPECT_NEAR(results.band.energy_v2s, 7.66114200e-6, 0.5e-14);
  EXPECT_NEAR(results.matched.energy_v2s, 3.30567639e-7, 0.5e-15);
  EXPECT_NEAR(results.ideal.energy_v2s, 5.080404e-3, 0.5e-9);
  EXPECT_NEAR(results.percent_of(results.band.energy_v2s), 5.755, 5e-4);
  EXPECT_NEAR(results.percent_of(results.matched.energy_v2s), 1.196, 5e-4);
  EXPECT_NEAR(results.percent_of(results.ideal.energy_v2s), 148.21, 5e-3);
  EXPECT_GT(results.band.bound_v2s, results.band.energy_v2s);
  ASSERT_EQ(results.band.times_s().size(), 1U);
  EXPECT_NEAR(results.band.times_s()[0], 0.639919e-3, 0.5e-9);
  EXPECT_DOUBLE_EQ(results.matched.delay_s, 0.3182 / (3.14159265358979324 * 4073.0));
}

TEST(EvaluationFigures, TellSensorsApart) {
  const EvaluationResults& results = evaluated({{1.0, 8e3, 0.7}, {}}, quick_settings());
  EXPECT_NEAR(results.percent_of(results.band.energy_v2s), 6.007, 5e-4);
  EXPECT_NEAR(results.percent_of(results.matched.energy_v2s), 0.0176, 5e-5);
  EXPECT_FALSE(results.uncertainty.is_done) << "there are no uncertainties";
  EXPECT_FALSE(results.band.uncertainty.is_done);
}

TEST(EvaluationFigures, ADelayThatLeavesTooMuchOpenIsRefusedAndTheRestStays) {
  Settings settings = quick_settings();
  settings.filter_order = 4;
  const EvaluationResults& results = evaluated({{1.037, 2e3, 0.7}, {}}, settings);
  EXPECT_EQ(results.status(), Status::kOk);
  EXPECT_TRUE(results.band.exists());
  EXPECT_EQ(results.matched.status, Status::kDelayNotResolved);
}

TEST(EvaluationFigures, UncertaintyIsThatOfNormalParameters) {
  Settings settings = quick_settings();
  settings.trials = 20000;
  const EvaluationResults& results = evaluated(kPaper, settings);
  ASSERT_TRUE(results.uncertainty.exists());
  // E is nearly linear in the parameters, and a uniform box has a third of the variance; both are
  // known to 0.5 % (20000 trials).
  EXPECT_NEAR(results.uncertainty.u_v2s / results.trials.result.u, std::sqrt(3.0), 0.03);
  EXPECT_FALSE(results.band.uncertainty.has_relative);
  // In band S is held. rms is near to linear in beta/f0: u is what its differences say.
  Device moved = kPaper;
  const double at_estimate = results.percent_of(results.band.energy_v2s);
  const double u_percent = results.band.uncertainty.u_percent;
  const double low = results.percent_of(results.band.uncertainty.symmetric.low);
  moved.estimate.natural_frequency_hz += 6.0;
  moved.u = {};
  const EvaluationResults& higher = evaluated(moved, settings);
  const double of_f0 = higher.percent_of(higher.band.energy_v2s) - at_estimate;
  moved = {{1.037, 4073.0, 0.3182 + 0.0004}, {}};
  const EvaluationResults& damped = evaluated(moved, settings);
  const double of_beta = damped.percent_of(damped.band.energy_v2s) - at_estimate;
  EXPECT_NEAR(u_percent, std::hypot(of_f0, of_beta), 0.03 * u_percent);
  EXPECT_NEAR(low, at_estimate - 1.96 * u_percent, 0.1 * u_percent);
}

// With a gain that is a number an error of S is one in band, and each trial has an S of its own to
// be in percent of. The figure falls with S here, so that the ends of its interval are what a
// sensor with an S at the ends of the interval of S has.
TEST(EvaluationFigures, PercentagesAreOfEachTrialsOwnSensitivity) {
  Settings settings = quick_settings();
  settings.trials = 20000;
  settings.gain_mode = emax::app::GainMode::kFixed;
  settings.gain = 1.1;
  constexpr double kU = 0.003;
  constexpr double kEnd = 1.96;
  const auto percent = [&](double sensitivity) {
    const EvaluationResults& results = evaluated({{sensitivity, 4073.0, 0.3182}, {}}, settings);
    return results.percent_of(results.matched.energy_v2s);
  };
  const double low = percent(1.037 + kEnd * kU);
  const double high = percent(1.037 - kEnd * kU);
  const Device device = {{1.037, 4073.0, 0.3182}, {kU, 0.0, 0.0}};
  const EvaluationResults& results = evaluated(device, settings);
  const emax::app::EnergyUncertainty known = results.matched.uncertainty;
  ASSERT_TRUE(known.exists());
  // Of 20000 trials an end is uncertain by 0.019 u (the square root of 0.025 * 0.975 / 20000 over
  // the density there, 0.058/u); u is a quarter of the interval.
  const double tolerance = 3.0 * 0.019 * 0.25 * (high - low);
  EXPECT_NEAR(results.percent_of(known.symmetric_of_percent().low), low, tolerance);
  EXPECT_NEAR(results.percent_of(known.symmetric_of_percent().high), high, tolerance);
  EXPECT_LE(results.percent_of(known.shortest_of_percent().high) -
                results.percent_of(known.shortest_of_percent().low),
            high - low + 2.0 * tolerance);
  EXPECT_NEAR(4.0 * known.u_percent, high - low, 0.04 * (high - low));  // 1.96 for 2, and 0.7 %.
  // The root of E alone has less, about S/G of it: where S is larger, so is what it is in percent
  // of.
  EXPECT_LT(results.percent_of(known.symmetric.high) - results.percent_of(known.symmetric.low),
            0.97 * (high - low));
}

TEST(EvaluationFigures, RelativeIntervalsAreTheSameFromAStore) {
  // Polynomials hold over so little of f0 and beta.
  const Device device = {{1.037, 4073.0, 0.3182}, {0.003, 0.6, 0.00004}};
  Settings settings = quick_settings();
  settings.gain_mode = emax::app::GainMode::kFixed;
  settings.gain = 1.1;
  const emax::app::EnergyUncertainty plain = evaluated(device, settings).matched.uncertainty;
  ASSERT_TRUE(plain.has_relative);
  static std::array<double, 1000> store;
  const EvaluationResults& stored = evaluated(device, settings, emax::Span<double>(store));
  EXPECT_EQ(stored.matched.uncertainty.relative_symmetric.low, plain.relative_symmetric.low);
  EXPECT_EQ(stored.matched.uncertainty.relative_shortest.high, plain.relative_shortest.high);
  // Where the trials of the procedure are the normal ones, they are the figure's, too.
  settings.criterion = emax::Criterion::kInBandError;
  settings.distribution = emax::Distribution::kNormal;
  const EvaluationResults& once = evaluated(device, settings);
  ASSERT_TRUE(once.uncertainty.has_relative);
  // Polynomials hold to 1e-10 of E, or to 1e-6 of u.
  EXPECT_NEAR(once.uncertainty.relative_symmetric.low / plain.relative_symmetric.low, 1.0, 1e-6);
  EXPECT_EQ(once.uncertainty.guard.searches, 9U);
}

TEST(EvaluationFigures, DefaultTrendLeavesOutWhatHasNoRoom) {
  const EvaluationResults& results =
      evaluated({{0.0102, 55000.0, 0.01}, {}}, emax::app::kDefaultSettings);
  EXPECT_EQ(results.status(), Status::kOk);
  EXPECT_NEAR(results.energy_v2s(), 3.44175215e-8, 0.5e-16);
  EXPECT_EQ(results.trend_looked_at, 5U);
  // Two switches in each of 550 periods at most. A board has room for those of 2 ms alone, and one
  // length is no trend.
  constexpr bool kHasRoom = emax::kMaxSwitches >= 2048;
  EXPECT_EQ(results.trend_count, kHasRoom ? 5U : 0U);
  Settings asked = emax::app::kDefaultSettings;
  asked.trend_s = {0.002, 1.0};
  asked.trend_count = 2;
  EXPECT_EQ(evaluated({{0.0102, 55000.0, 0.01}, {}}, asked).status(), Status::kTooManyCells);
  if (!kHasRoom) {
    return;
  }
  // 2200 switches in 10 ms.
  EvaluationResults& longer = emax::test::shared_evaluation();
  ASSERT_EQ(
      emax::test::run_on(longer).start_from_model(
          {{0.0102, 110000.0, 0.005}, {}}, emax::app::kDefaultSettings, emax::app::Goal::kTrend),
      Status::kOk);
  emax::test::finish(longer);
  EXPECT_EQ(longer.status(), Status::kOk);
  EXPECT_EQ(longer.trend_left_out, std::uint32_t{1} << 4U);
  EXPECT_EQ(longer.trend_count, 4U);
}

TEST(EvaluationFigures, DefaultTrendTakesNoMinutes) {
  // 12 cells in each of 500 periods per ms: 12000 at 2 ms, and 24000 to 60000 for the others, which
  // a PC has room for.
  if (emax::kMaxCells < 65536) {
    return;
  }
  EvaluationResults& results = emax::test::shared_evaluation();
  emax::app::Evaluation run = emax::test::run_on(results);
  ASSERT_EQ(run.start_from_model({{1.0, 500000.0, 0.7}, {}}, emax::app::kDefaultSettings,
                                 emax::app::Goal::kTrend),
            Status::kOk);
  while (!run.done() && results.stage != emax::app::Stage::kTrend) {
    run.step();
  }
  // Looks at each length in one step, but for that of the energy.
  for (int i = 0; i < 10 && !run.done(); ++i) {
    run.step();
  }
  EXPECT_TRUE(run.done());
  EXPECT_EQ(results.status(), Status::kOk);
  EXPECT_EQ(results.trend_left_out, 0x1EU);
  EXPECT_EQ(results.trend_count, 0U);
}

TEST(EvaluationFigures, GuardsEachUncertainty) {
  Settings settings = quick_settings();
  const EvaluationResults& results = evaluated(kPaper, settings);
  ASSERT_EQ(results.status(), Status::kOk);
  EXPECT_EQ(results.guard.searches, 9U);
  for (const emax::app::EnergyUncertainty* known :
       {&results.uncertainty, &results.band.uncertainty, &results.matched.uncertainty}) {
    ASSERT_TRUE(known->exists());
    EXPECT_EQ(known->guard.searches, 5U);
    EXPECT_EQ(known->guard.disagreements, 0U);
    // Polynomials hold to 1e-10 of E, or to 1e-6 of u.
    EXPECT_LT(known->guard.largest_excess, 1e-8F);
  }
  // The trials over the box are the normal ones: made once, and guarded as these.
  settings.distribution = emax::Distribution::kNormal;
  const emax::app::EnergyUncertainty normal = results.uncertainty;
  const EvaluationResults& once = evaluated(kPaper, settings);
  ASSERT_TRUE(once.uncertainty.exists());
  EXPECT_EQ(once.uncertainty.u_v2s, normal.u_v2s);
  EXPECT_EQ(once.uncertainty.u_percent, normal.u_percent);
  EXPECT_EQ(once.uncertainty.guard.searches, 9U);
  settings.method = emax::Method::kPaper;
  settings.distribution = emax::Distribution::kBox;
  settings.step_s = 2e-5;
  const EvaluationResults& paper = evaluated(kPaper, settings);
  ASSERT_TRUE(paper.uncertainty.exists());
  EXPECT_EQ(paper.uncertainty.guard.searches, 0U) << "its trials are full runs";
  EXPECT_EQ(paper.band.uncertainty.guard.searches, 5U);
}

}  // namespace
