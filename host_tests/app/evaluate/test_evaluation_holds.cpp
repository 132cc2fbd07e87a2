// For which settings and devices results hold: just those that would give the same words again.
#include <gtest/gtest.h>
#include <memory>
#include <ostream>
#include <string>

#include "emax/app/report/report.hpp"

#include "support/evaluations.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::Criterion;
using emax::Distribution;
using emax::FrequencyResponse;
using emax::Generator;
using emax::Method;
using emax::ResponsePoint;
using emax::Status;
using emax::app::Device;
using emax::app::EvaluationResults;
using emax::app::GainMode;
using emax::app::Goal;
using emax::app::Settings;
using emax::app::TextWriter;
using emax::test::finish;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::run_on;
using emax::test::synthetic_points;
using emax::test::text_of;

constexpr Goal kGoals[] = {Goal::kModel, Goal::kEnergy,      Goal::kMonteCarlo, Goal::kTrend,
                           Goal::kBand,  Goal::kUncertainty, Goal::kReport};

Settings with_trend() {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  return settings;
}

/// Everything that an evaluation has to say.
std::string words_of(const EvaluationResults& results) {
  return text_of([&](TextWriter& out) {
    emax::app::write_report(results, {"x.csv"}, out);
    emax::app::write_json(results, {"x.csv"}, out);
    emax::app::write_histogram_csv(results, out);
  });
}

void run(EvaluationResults& results, const Settings& settings, Goal goal = Goal::kReport) {
  ASSERT_EQ(run_on(results).start_from_points(synthetic_points(1.0), settings, goal), Status::kOk);
  finish(results);
  ASSERT_EQ(results.status(), Status::kOk);
}

/// Of one run with `with_trend()`, made once.
const EvaluationResults& unchanged_results() {
  static const std::unique_ptr<EvaluationResults> results = [] {
    auto made = std::make_unique<EvaluationResults>();
    run(*made, with_trend());
    return made;
  }();
  return *results;
}

struct Change {
  const char* name;
  void (*apply)(Settings& settings);
  bool energy;  ///< Energy and all that follows from it are others.
  bool trials;
  bool trend;

  friend void PrintTo(const Change& change, std::ostream* out) { *out << change.name; }
};

const Change kChanges[] = {
    {"order", [](Settings& s) { s.filter_order = 9; }, true, true, true},
    {"cutoff", [](Settings& s) { s.cutoff_hz = 900.0; }, true, true, true},
    {"gain_mode", [](Settings& s) { s.gain_mode = GainMode::kTrack; }, true, true, true},
    {"unused_gain", [](Settings& s) { s.gain = 1.5; }, false, false, false},
    {"time", [](Settings& s) { s.duration_s = 0.0021; }, true, true, true},
    {"limit", [](Settings& s) { s.limit_is_auto = false, s.limit_mps2 = 2.0; }, true, true, true},
    {"unused_limit", [](Settings& s) { s.limit_mps2 = 2.0; }, false, false, false},
    {"criterion", [](Settings& s) { s.criterion = Criterion::kEnergyDifference; }, true, true,
     true},
    {"reference_delay",
     [](Settings& s) { s.delay_choice = emax::app::DelayChoice::kGiven, s.delay_s = 2e-5; }, true,
     true, true},
    {"unused_reference_delay", [](Settings& s) { s.delay_s = 1e-6; }, false, false, false},
    {"method", [](Settings& s) { s.method = Method::kPaper; }, true, true, true},
    {"unused_step", [](Settings& s) { s.step_s = 3e-6; }, false, false, false},
    {"unused_iterations", [](Settings& s) { s.iterations = 20; }, false, false, false},
    {"trials", [](Settings& s) { s.trials = 1001; }, false, true, false},
    {"adaptive", [](Settings& s) { s.adaptive = true; }, false, true, false},
    {"probability", [](Settings& s) { s.probability = 0.9; }, false, true, false},
    {"distribution", [](Settings& s) { s.distribution = Distribution::kNormal; }, false, true,
     false},
    {"birge", [](Settings& s) { s.birge = true; }, false, true, false},
    {"seed", [](Settings& s) { s.seed[3] += 1; }, false, true, false},
    {"generator", [](Settings& s) { s.generator = Generator::k1982; }, false, true, false},
    {"trend_time", [](Settings& s) { s.trend_s[1] = 0.003; }, false, false, true},
    {"trend_count", [](Settings& s) { s.trend_count = 3; }, false, false, true},
    {"unused_trend_time", [](Settings& s) { s.trend_s[2] = 0.005; }, false, false, false},
};

class EvaluationHolds : public testing::TestWithParam<Change> {};

INSTANTIATE_TEST_SUITE_P(After, EvaluationHolds, testing::ValuesIn(kChanges),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(EvaluationHolds, WhatComesOutTheSame) {
  const Change& change = GetParam();
  const Settings settings = with_trend();
  Settings changed = settings;
  change.apply(changed);
  const EvaluationResults& results = unchanged_results();
  const bool is_report_same = !change.energy && !change.trials && !change.trend;
  EXPECT_EQ(results.holds(Goal::kModel, changed), !change.energy);
  EXPECT_EQ(results.holds(Goal::kEnergy, changed), !change.energy);
  EXPECT_EQ(results.holds(Goal::kMonteCarlo, changed), !change.trials);
  EXPECT_EQ(results.holds(Goal::kTrend, changed), !change.trend);
  EXPECT_EQ(results.holds(Goal::kReport, changed), is_report_same);
  EXPECT_EQ(results.holds_energy_of(changed), !change.energy);
  // The words of a run with these settings are the judge.
  const auto fresh = std::make_unique<EvaluationResults>();
  run(*fresh, changed);
  EXPECT_EQ(words_of(*fresh) == words_of(results), is_report_same);
  for (const Goal goal : kGoals) {
    EXPECT_TRUE(results.holds(goal, settings)) << "they are what they were";
    EXPECT_TRUE(fresh->holds(goal, changed));
  }
}

TEST(EvaluationHoldsGoals, OnlyThoseThatAreComplete) {
  const Settings settings = with_trend();
  const auto results = std::make_unique<EvaluationResults>();
  const auto expect_held = [&](bool model, bool energy, bool trials, bool trend, bool report) {
    EXPECT_EQ(results->holds(Goal::kModel, settings), model);
    EXPECT_EQ(results->holds(Goal::kEnergy, settings), energy);
    EXPECT_EQ(results->holds(Goal::kMonteCarlo, settings), trials);
    EXPECT_EQ(results->holds(Goal::kTrend, settings), trend);
    EXPECT_EQ(results->holds(Goal::kReport, settings), report);
  };
  expect_held(false, false, false, false, false);
  run(*results, settings, Goal::kModel);
  expect_held(true, false, false, false, false);
  ASSERT_EQ(run_on(*results).pursue(settings, Goal::kTrend), Status::kOk);
  while (!results->has_energy) {
    run_on(*results).step();
  }
  expect_held(true, false, false, false, false);  // Its bound is missing.
  finish(*results);
  expect_held(true, true, false, true, false);
  ASSERT_EQ(run_on(*results).pursue(settings, Goal::kMonteCarlo), Status::kOk);
  finish(*results);
  expect_held(true, true, true, true, false);  // The draws of the fit are missing.
  ASSERT_EQ(run_on(*results).pursue(settings, Goal::kReport), Status::kOk);
  finish(*results);
  expect_held(true, true, true, true, true);
  results->clear();
  expect_held(false, false, false, false, false);
}

TEST(EvaluationHoldsGoals, AReportNeedsNeitherTrialsNorTrendWhereThereAreNone) {
  const Settings settings = quick_settings();  // No trend.
  const auto results = std::make_unique<EvaluationResults>();
  const Device exact = {kTable2.estimate, {}};
  ASSERT_EQ(run_on(*results).start_from_model(exact, settings), Status::kOk);
  finish(*results);
  EXPECT_TRUE(results->holds(Goal::kReport, settings));
  EXPECT_FALSE(results->holds(Goal::kMonteCarlo, settings));
  EXPECT_FALSE(results->holds(Goal::kTrend, settings));
  Settings with = settings;
  with.trend_count = 2;
  EXPECT_FALSE(results->holds(Goal::kReport, with));
}

TEST(EvaluationHoldsGoals, NothingAfterARefusal) {
  Settings settings = quick_settings();
  const auto results = std::make_unique<EvaluationResults>();
  run(*results, settings, Goal::kEnergy);
  settings.duration_s = 2.0;  // Too many cells.
  EXPECT_EQ(run_on(*results).start_from_points(synthetic_points(1.0), settings),
            Status::kTooManyCells);
  for (const Goal goal : kGoals) {
    EXPECT_FALSE(results->holds(goal, settings));
  }
  EXPECT_FALSE(results->is_of(synthetic_points(1.0)));
}

TEST(EvaluationIsOf, ItsDeviceAndNoOther) {
  const auto results = std::make_unique<EvaluationResults>();
  EXPECT_FALSE(results->is_of(Device{}));
  ASSERT_EQ(run_on(*results).start_from_model(kTable2, quick_settings(), Goal::kModel),
            Status::kOk);
  EXPECT_TRUE(results->is_of(kTable2));
  EXPECT_FALSE(results->is_of(FrequencyResponse()));
  Device other = kTable2;
  double* const numbers[] = {&other.estimate.sensitivity,   &other.estimate.natural_frequency_hz,
                             &other.estimate.damping,       &other.u.sensitivity,
                             &other.u.natural_frequency_hz, &other.u.damping};
  for (double* number : numbers) {
    const double before = *number;
    *number *= 1.0 + 1e-15;
    EXPECT_FALSE(results->is_of(other));
    *number = before;
  }
  EXPECT_TRUE(results->is_of(other));
}

TEST(EvaluationIsOf, ItsPointsAndNoOthers) {
  const FrequencyResponse points = synthetic_points(1.0);
  const auto results = std::make_unique<EvaluationResults>();
  ASSERT_EQ(run_on(*results).start_from_points(points, quick_settings(), Goal::kModel),
            Status::kOk);
  EXPECT_TRUE(results->is_of(points));
  EXPECT_FALSE(results->is_of(results->device)) << "a device given by its parameters has no fit";
  FrequencyResponse other = points;
  ASSERT_EQ(other.set_common(0.002), Status::kOk);
  EXPECT_FALSE(results->is_of(other));
  double ResponsePoint::*const members[] = {&ResponsePoint::frequency_hz, &ResponsePoint::amplitude,
                                            &ResponsePoint::phase_rad, &ResponsePoint::u_amplitude,
                                            &ResponsePoint::u_phase_rad};
  for (double ResponsePoint::*member : members) {
    other.clear();
    for (ResponsePoint point : points.points()) {
      point.*member *= other.size() + 1 == points.size() ? 1.0 + 1e-15 : 1.0;
      ASSERT_EQ(other.add(point), Status::kOk);
    }
    EXPECT_FALSE(results->is_of(other)) << "of the last point";
  }
  other.clear();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    ASSERT_EQ(other.add(points.points()[i]), Status::kOk);
  }
  EXPECT_FALSE(results->is_of(other)) << "one less";
}

}  // namespace
