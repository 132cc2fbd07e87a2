// Parts of the job asked for one by one: the same digits in any order, and what is kept.
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "emax/app/report/report.hpp"

#include "support/evaluations.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::Method;
using emax::Status;
using emax::app::Device;
using emax::app::EvaluationResults;
using emax::app::EvaluationWorkspace;
using emax::app::Goal;
using emax::app::Settings;
using emax::app::Stage;
using emax::app::TextWriter;
using emax::test::finish;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::run_on;
using emax::test::shared_workspace;
using emax::test::synthetic_points;
using emax::test::text_of;

Settings with_trend() {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  return settings;
}

/// Everything that an evaluation has to say.
std::string words_of(const EvaluationResults& evaluation) {
  return text_of([&](TextWriter& out) {
    emax::app::write_report(evaluation, {"x.csv"}, out);
    emax::app::write_json(evaluation, {"x.csv"}, out);
    emax::app::write_histogram_csv(evaluation, out);
    emax::app::write_trend_csv(evaluation, out);
    emax::app::write_signal_csv(evaluation, out);
  });
}

std::string one_run(const Settings& settings) {
  const auto evaluation = std::make_unique<EvaluationResults>();
  EXPECT_EQ(run_on(*evaluation).start_from_points(synthetic_points(1.0), settings), Status::kOk);
  finish(*evaluation);
  EXPECT_EQ(evaluation->status(), Status::kOk);
  return words_of(*evaluation);
}

/// Other contents of the memory between runs, as when it is lent to somebody else.
void overwrite_workspace() {
  shared_workspace().~EvaluationWorkspace();
  auto* const bytes = reinterpret_cast<unsigned char*>(&shared_workspace());
  for (std::size_t i = 0; i < sizeof(EvaluationWorkspace); ++i) {
    bytes[i] = static_cast<unsigned char>(37 * i + 11);
  }
  new (&shared_workspace()) EvaluationWorkspace();
}

void pursue(EvaluationResults& evaluation, const Settings& settings, Goal goal) {
  overwrite_workspace();
  ASSERT_EQ(run_on(evaluation).pursue(settings, goal), Status::kOk);
  finish(evaluation);
  ASSERT_EQ(evaluation.stage, Stage::kDone);
}

TEST(Goals, AnyOrderGivesTheDigitsOfOneRun) {
  const Settings settings = with_trend();
  const std::string expected = one_run(settings);
  const Goal orders[][4] = {{Goal::kModel, Goal::kEnergy, Goal::kMonteCarlo, Goal::kTrend},
                            {Goal::kTrend, Goal::kMonteCarlo, Goal::kEnergy, Goal::kModel},
                            {Goal::kMonteCarlo, Goal::kTrend, Goal::kMonteCarlo, Goal::kEnergy},
                            {Goal::kEnergy, Goal::kEnergy, Goal::kTrend, Goal::kMonteCarlo}};
  for (const auto& order : orders) {
    const auto evaluation = std::make_unique<EvaluationResults>();
    ASSERT_EQ(run_on(*evaluation).start_from_points(synthetic_points(1.0), settings, order[0]),
              Status::kOk);
    finish(*evaluation);
    for (const Goal goal : {order[1], order[2], order[3], Goal::kReport}) {
      pursue(*evaluation, settings, goal);
    }
    EXPECT_EQ(words_of(*evaluation), expected);
  }
}

TEST(Goals, DoNoMoreThanTheyAsk) {
  const Settings settings = with_trend();
  const auto evaluation = std::make_unique<EvaluationResults>();
  const auto has = [&](bool draws, bool energy, bool trials, bool trend) {
    EXPECT_TRUE(evaluation->has_model);
    EXPECT_TRUE(evaluation->has_fit());
    EXPECT_EQ(evaluation->has_fit_draws, draws);
    EXPECT_EQ(evaluation->has_energy, energy);
    EXPECT_EQ(evaluation->has_bound, energy);
    EXPECT_EQ(evaluation->has_monte_carlo, trials);
    EXPECT_EQ(evaluation->has_trend, trend);
  };
  ASSERT_EQ(run_on(*evaluation).start_from_points(synthetic_points(1.0), settings, Goal::kModel),
            Status::kOk);
  EXPECT_FALSE(evaluation->has_model);
  finish(*evaluation);
  EXPECT_NEAR(evaluation->peak.value, 17462.4, 1e-2 * 17462.4);
  has(false, false, false, false);
  pursue(*evaluation, settings, Goal::kEnergy);
  has(false, true, false, false);
  pursue(*evaluation, settings, Goal::kTrend);
  has(false, true, false, true);
  pursue(*evaluation, settings, Goal::kMonteCarlo);
  has(false, true, true, true);
  pursue(*evaluation, settings, Goal::kReport);
  has(true, true, true, true);
  // All there: done at once.
  ASSERT_EQ(run_on(*evaluation).pursue(settings, Goal::kReport), Status::kOk);
  EXPECT_EQ(evaluation->stage, Stage::kDone);
}

TEST(Goals, OtherTrialsOrTimesAreComputedAnewAndTheRestIsKept) {
  Settings settings = with_trend();
  const auto evaluation = std::make_unique<EvaluationResults>();
  ASSERT_EQ(run_on(*evaluation).start_from_points(synthetic_points(1.0), settings), Status::kOk);
  finish(*evaluation);
  settings.seed[0] += 1;
  settings.probability = 0.9;
  settings.trend_s[1] = 0.003;
  ASSERT_EQ(run_on(*evaluation).pursue(settings, Goal::kReport), Status::kOk);
  EXPECT_TRUE(evaluation->has_energy);
  EXPECT_EQ(evaluation->stage, Stage::kFitDraws);
  finish(*evaluation);
  EXPECT_EQ(words_of(*evaluation), one_run(settings));
  // What other settings have made is dropped even where it is not asked for.
  settings.trials = 2000;
  pursue(*evaluation, settings, Goal::kTrend);
  EXPECT_FALSE(evaluation->has_monte_carlo);
  EXPECT_TRUE(evaluation->has_fit_draws);
  EXPECT_TRUE(evaluation->has_trend);
}

TEST(Goals, ARefusalLeavesTheResults) {
  Settings settings = with_trend();
  const auto evaluation = std::make_unique<EvaluationResults>();
  EXPECT_EQ(run_on(*evaluation).pursue(settings, Goal::kEnergy), Status::kInvalidArgument);
  EXPECT_NE(evaluation->failure.reason, nullptr);
  ASSERT_EQ(run_on(*evaluation).start_from_points(synthetic_points(1.0), settings), Status::kOk);
  finish(*evaluation);
  const std::string expected = words_of(*evaluation);
  const auto refused = [&](const Settings& other, Status status) {
    EXPECT_EQ(run_on(*evaluation).pursue(other, Goal::kReport), status);
    EXPECT_EQ(evaluation->failure.status, status);
    EXPECT_NE(evaluation->failure.reason, nullptr);
    EXPECT_EQ(evaluation->stage, Stage::kDone);
    EXPECT_EQ(words_of(*evaluation), expected);
  };
  Settings other = settings;
  other.duration_s = 0.003;
  refused(other, Status::kInvalidArgument);
  other = settings;
  other.criterion = emax::Criterion::kEnergyDifference;
  refused(other, Status::kInvalidArgument);
  other = settings;
  other.trials = 999;
  refused(other, Status::kInvalidArgument);
  other = settings;
  other.trend_s[1] = 2.0;
  refused(other, Status::kTooManyCells);
  // What no goal asks for does not matter.
  ASSERT_EQ(run_on(*evaluation).pursue(other, Goal::kMonteCarlo), Status::kOk);
  EXPECT_EQ(evaluation->failure.status, Status::kOk);
}

TEST(Goals, StopKeepsWhatIsComplete) {
  const Settings settings = with_trend();
  const std::string expected = one_run(settings);
  const auto evaluation = std::make_unique<EvaluationResults>();
  run_on(*evaluation).stop();
  EXPECT_EQ(evaluation->stage, Stage::kIdle);
  for (const Stage stage :
       {Stage::kModel, Stage::kFitDraws, Stage::kEnergy, Stage::kBound, Stage::kTrend,
        Stage::kPrediction, Stage::kMonteCarlo, Stage::kGuard, Stage::kUncertainty}) {
    ASSERT_EQ(run_on(*evaluation).start_from_points(synthetic_points(1.0), settings), Status::kOk);
    while (evaluation->stage != stage) {
      run_on(*evaluation).step();
    }
    run_on(*evaluation).step();
    run_on(*evaluation).stop();
    EXPECT_TRUE(evaluation->done());
    EXPECT_EQ(evaluation->status(), Status::kOk);
    EXPECT_EQ(evaluation->has_fit_draws, stage > Stage::kFitDraws);
    EXPECT_EQ(evaluation->has_energy, stage > Stage::kEnergy);
    EXPECT_EQ(evaluation->has_bound, stage > Stage::kBound);
    EXPECT_EQ(evaluation->has_monte_carlo, stage > Stage::kGuard);
    EXPECT_EQ(evaluation->has_trend, stage > Stage::kTrend);
    EXPECT_EQ(evaluation->trend_points().empty(), stage <= Stage::kTrend);
    pursue(*evaluation, settings, Goal::kReport);
    EXPECT_EQ(words_of(*evaluation), expected) << static_cast<int>(stage);
  }
}

TEST(Goals, TrialsOfThePaperHaveRoomForFewerCells) {
  Settings settings = quick_settings();
  settings.method = Method::kPaper;
  settings.iterations = 1;
  // 2 numbers for each of 9 modes between the switches, and 6 for each of them.
  const auto room = static_cast<double>(6 * emax::kMaxSwitches + 2 * 9 * (emax::kMaxSwitches + 1));
  settings.duration_s = 6162 * 2e-6;
  const auto evaluation = std::make_unique<EvaluationResults>();
  EXPECT_EQ(run_on(*evaluation).start_from_model(kTable2, settings), Status::kOk);
  finish(*evaluation);
  EXPECT_TRUE(evaluation->has_monte_carlo);
  settings.duration_s = room * 2e-6;
  EXPECT_EQ(run_on(*evaluation).start_from_model(kTable2, settings), Status::kOk);
  settings.duration_s = (room + 1.0) * 2e-6;
  EXPECT_EQ(run_on(*evaluation).start_from_model(kTable2, settings), Status::kTooManyCells);
  EXPECT_EQ(evaluation->failure.stage, Stage::kMonteCarlo);
  EXPECT_EQ(run_on(*evaluation).start_from_model(kTable2, settings, Goal::kTrend), Status::kOk);
  EXPECT_EQ(run_on(*evaluation).start_from_model(Device{kTable2.estimate, {}}, settings),
            Status::kOk);
}

}  // namespace
