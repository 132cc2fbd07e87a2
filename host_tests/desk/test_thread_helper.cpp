// Trials and draws in threads: the bits of one core.
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "emax/app/report/report.hpp"

#include "desk/trials/shares.hpp"
#include "desk/trials/thread_helper.hpp"
#include "support/evaluations.hpp"
#include "support/string_sink.hpp"

namespace emax {
namespace {

using app::Device;
using app::EvaluationResults;
using app::Settings;

constexpr std::size_t kThreads[] = {1, 2, 3, 7};

std::string json_of(const EvaluationResults& evaluation) {
  return test::text_of([&](app::TextWriter& out) { app::write_json(evaluation, {}, out); });
}

/// The results with room for the trials' values: on one core, or with a helper.
std::string run(const Device& device, const Settings& settings, app::EvaluationHelper* helper,
                app::Goal goal = app::Goal::kMonteCarlo, std::size_t room = 400000) {
  EvaluationResults& results = test::shared_evaluation();
  app::Evaluation run = test::run_on(results);
  EXPECT_EQ(run.start_from_model(device, settings, goal), Status::kOk);
  std::vector<double> store(room, -1.0);
  std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);
  run.lend_trial_store(Span<double>(store.data(), store.size()));
  run.lend_trial_pieces(TrialPieces({pieces.data(), pieces.size()}));
  run.lend_helper(helper);
  test::finish(results);
  return json_of(results);
}

void expect_same_with_any_threads(const Device& device, const Settings& settings,
                                  app::Goal goal = app::Goal::kMonteCarlo) {
  const std::string expected = run(device, settings, nullptr, goal);
  EXPECT_EQ(test::shared_evaluation().status(), Status::kOk);
  for (const std::size_t threads : kThreads) {
    desk::ThreadHelper helper(threads);
    EXPECT_EQ(run(device, settings, &helper, goal), expected) << threads;
  }
}

TEST(ThreadHelper, BoxAndItsUncertaintyAreThoseOfOneCore) {
  Settings settings = test::quick_settings();
  settings.trials = 20000;
  expect_same_with_any_threads(test::kTable2, settings, app::Goal::kReport);
}

TEST(ThreadHelper, AStoreThatIsTooSmallMakesNoDifference) {
  Settings settings = test::quick_settings();
  settings.trials = 3000;
  const std::string expected = run(test::kTable2, settings, nullptr);
  for (const std::size_t room : {std::size_t{0}, std::size_t{1}, std::size_t{1234}}) {
    desk::ThreadHelper helper(3);
    EXPECT_EQ(run(test::kTable2, settings, &helper, app::Goal::kMonteCarlo, room), expected)
        << room;
  }
}

TEST(ThreadHelper, AdaptiveTrialsAreThoseOfOneCore) {
  Settings settings = test::quick_settings();
  settings.adaptive = true;
  settings.gain_mode = app::GainMode::kTrack;
  expect_same_with_any_threads(test::kTable2, settings);
}

TEST(ThreadHelper, RedrawnTrialsAreCountedOnce) {
  Settings settings = test::quick_settings();
  settings.distribution = Distribution::kNormal;
  settings.trials = 3000;
  // One draw in six is beyond the least damping.
  expect_same_with_any_threads({{1.0, 4000.0, 0.05}, {0.001, 5.0, 0.05}}, settings);
  EXPECT_GT(test::shared_evaluation().trials.redraws, 300u);
}

TEST(ThreadHelper, PartsOfTheRangesAreThoseOfOneCore) {
  Settings settings = test::quick_settings();
  settings.trials = 2000;
  settings.duration_s = 3e-3;
  expect_same_with_any_threads({{1.0, 4000.0, 0.02}, {0.01, 80.0, 0.002}}, settings);
  EXPECT_GT(test::shared_evaluation().trials.branches.pieces, 0u);
}

TEST(ThreadHelper, ThePapersProcedureIsThatOfOneCore) {
  Settings settings = test::quick_settings();
  settings.method = Method::kPaper;
  for (const app::GainMode mode : {app::GainMode::kAuto, app::GainMode::kTrack}) {
    settings.gain_mode = mode;
    expect_same_with_any_threads(test::kTable2, settings);
  }
}

TEST(ThreadHelper, DrawsOfTheFitAreThoseOfOneCore) {
  for (const bool has_common : {false, true}) {
    FrequencyResponse points = test::synthetic_points(1.0);
    if (has_common) {
      ASSERT_EQ(points.set_common(0.003), Status::kOk);
    }
    Wlsp fit;
    ASSERT_EQ(fit.fit(points), Status::kOk);
    WichmannHill generator;
    const std::uint32_t seeds[] = {1, 2, 3, 4};
    ASSERT_EQ(generator.seed(Generator::k2006, Span<const std::uint32_t>(seeds)), Status::kOk);
    WlspDraws expected;
    ASSERT_EQ(expected.start(fit, 1000, generator), Status::kOk);
    expected.step(fit, 100);
    for (const std::size_t threads : kThreads) {
      WlspDraws draws = expected;
      desk::ThreadHelper(threads).make_fit_draws(draws, fit);
      WlspDraws one = expected;
      one.step(fit, 900);
      EXPECT_TRUE(draws.done());
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(draws.result().mean[i], one.result().mean[i]) << threads;
        for (std::size_t j = 0; j < 3; ++j) {
          EXPECT_EQ(draws.result().covariance[i][j], one.result().covariance[i][j]) << threads;
        }
      }
    }
  }
}

TEST(Shares, EachThingIsInOneShare) {
  for (const std::size_t threads : {1u, 2u, 3u, 7u, 64u}) {
    for (const std::size_t count : {0u, 1u, 6u, 100u}) {
      std::vector<int> times(count, 0);
      std::vector<int> indices(threads, 0);
      desk::share_out(threads, count, [&](const desk::Share& share) {
        ++indices[share.index];
        for (std::size_t i = share.begin; i < share.begin + share.size; ++i) {
          ++times[i];
        }
      });
      EXPECT_EQ(times, std::vector<int>(count, 1));
      for (const int of_share : indices) {
        EXPECT_LE(of_share, 1);
      }
    }
  }
}

}  // namespace
}  // namespace emax
