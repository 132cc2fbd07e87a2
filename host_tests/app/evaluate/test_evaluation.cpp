// The job as a whole: the paper's two tables, every refusal, and what must not change a result.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "emax/app/report/report.hpp"

#include "support/evaluations.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::Accelerometer;
using emax::FrequencyResponse;
using emax::Method;
using emax::MonteCarloResult;
using emax::ResponsePoint;
using emax::Span;
using emax::Status;
using emax::WlspFit;
using emax::app::Device;
using emax::app::Evaluation;
using emax::app::EvaluationResults;
using emax::app::EvaluationWorkspace;
using emax::app::GainMode;
using emax::app::Settings;
using emax::app::Stage;
using emax::app::TextWriter;
using emax::test::evaluated;
using emax::test::finish;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::run_on;
using emax::test::shared_workspace;
using emax::test::synthetic_points;
using emax::test::table1;
using emax::test::text_of;

// The best known energies are given to 13 digits.
constexpr double kLastDigit = 1e-12;

Settings paper_settings(double duration_s) {
  Settings settings = quick_settings();
  settings.method = Method::kPaper;
  settings.duration_s = duration_s;
  return settings;
}

Device without_uncertainty() { return {kTable2.estimate, {}}; }

std::string report_of(const EvaluationResults& evaluation) {
  return text_of([&](TextWriter& out) { emax::app::write_report(evaluation, {"x.csv"}, out); });
}

std::string json_of(const EvaluationResults& evaluation) {
  return text_of([&](TextWriter& out) { emax::app::write_json(evaluation, {"x.csv"}, out); });
}

TEST(Evaluation, FitOfTable1) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  ASSERT_EQ(evaluation.status(), Status::kOk);
  ASSERT_EQ(evaluation.stage, Stage::kDone);
  const WlspFit& fit = evaluation.fit.result();
  emax::test::expect_fit_of_table1(fit);
  EXPECT_EQ(evaluation.device.estimate.sensitivity, fit.model.sensitivity);
  EXPECT_EQ(evaluation.device.u.damping, fit.u_damping);
  EXPECT_EQ(evaluation.limit_mps2, fit.model.sensitivity);
  EXPECT_EQ(evaluation.model.filter().gain, fit.model.sensitivity);
  // A standard deviation from 10000 draws scatters by 0.7 %; four times that.
  const emax::WlspDrawsResult draws = evaluation.fit_draws;
  EXPECT_EQ(draws.draws, Evaluation::kFitDraws);
  EXPECT_NEAR(std::sqrt(draws.covariance[0][0]), fit.u_sensitivity, 0.03 * fit.u_sensitivity);
  EXPECT_NEAR(std::sqrt(draws.covariance[1][1]), fit.u_natural_frequency_hz, 0.03 * 2.85);
  EXPECT_NEAR(std::sqrt(draws.covariance[2][2]), fit.u_damping, 0.03 * fit.u_damping);
}

TEST(Evaluation, DrawsOfTheFitAreFarFromThoseOfTheTrials) {
  const Settings settings = quick_settings();
  const EvaluationResults& evaluation = evaluated(table1(), settings);
  emax::WichmannHill generator;
  ASSERT_EQ(generator.seed(settings.generator, settings.seed), Status::kOk);
  generator.jump(std::uint64_t{1} << 60U);
  emax::WlspDraws draws;
  ASSERT_EQ(draws.start(evaluation.fit, Evaluation::kFitDraws, generator), Status::kOk);
  draws.step(evaluation.fit, Evaluation::kFitDraws);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(evaluation.fit_draws.mean[i], draws.result().mean[i]);
  }
}

TEST(Evaluation, SyntheticPointsComeBack) {
  const EvaluationResults& evaluation = evaluated(synthetic_points(0.0), quick_settings());
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_NEAR(evaluation.device.estimate.sensitivity, 1.037, 1e-10);
  EXPECT_NEAR(evaluation.device.estimate.natural_frequency_hz, 4073.0, 4e-7);
  EXPECT_NEAR(evaluation.device.estimate.damping, 0.3182, 1e-10);
}

TEST(Evaluation, ErrorSystemOfTable2) {
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), quick_settings());
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_NEAR(evaluation.peak.value, 17462.4, 0.05);
  EXPECT_NEAR(evaluation.peak.time_s, 51.4e-6, 0.05e-6);
  EXPECT_TRUE(evaluation.settling_time.found);
  EXPECT_NEAR(evaluation.settling_time.time_s, 1.453582e-3, 0.5e-9);
}

TEST(Evaluation, PaperMethodAt2ms) {
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), paper_settings(0.002));
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_NEAR(evaluation.energy_v2s(), 0.00448654991209, 1e-14);
  EXPECT_EQ(evaluation.maximum.cells, 1000U);
  EXPECT_EQ(evaluation.maximum.iterations, 6U);
  EXPECT_TRUE(evaluation.maximum.at_rest);
  ASSERT_GE(evaluation.trace().size(), 7U);
  EXPECT_NEAR(evaluation.trace()[0], 0.00381585783775, 1e-14);
  const double expected_s[] = {0.342e-3, 0.470e-3, 0.574e-3, 1.540e-3};
  const Span<const double> times_s = evaluation.maximum.signal.times_s();
  ASSERT_EQ(times_s.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(times_s[i], expected_s[i], 1e-12);
  }
}

TEST(Evaluation, PaperMethodAt10ms) {
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), paper_settings(0.010));
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_NEAR(evaluation.energy_v2s(), 0.0375854265552, 1e-12);
  EXPECT_EQ(evaluation.maximum.iterations, 30U);
  EXPECT_FALSE(evaluation.maximum.at_rest);
}

TEST(Evaluation, BestMethodAt2ms) {
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), quick_settings());
  ASSERT_EQ(evaluation.status(), Status::kOk);
  // The best known signal has one switch. A search on a grid alone ends in the nearest edge of a
  // cell: the energy falls with the square of the distance, by less than 1e-4 of E.
  const Span<const double> times_s = evaluation.maximum.signal.times_s();
  ASSERT_EQ(times_s.size(), 1U);
  const double cell_s = 0.002 / static_cast<double>(evaluation.maximum.cells);
  EXPECT_LE(std::abs(times_s[0] - emax::test::kBestTimes2ms[0]), 0.5 * cell_s);
  EXPECT_LE(cell_s, 1.0 / (12.0 * 4073.0));
  EXPECT_LT(evaluation.energy_v2s(), (1.0 + kLastDigit) * emax::test::kBestEnergy2ms);
  EXPECT_GT(evaluation.energy_v2s(), (1.0 - 1e-4) * emax::test::kBestEnergy2ms);
  EXPECT_NEAR(evaluation.xi(), evaluation.energy_v2s() / (1.037 * 1.037 * 0.002), 1e-14);
  EXPECT_NEAR(evaluation.rms_error_v(), std::sqrt(evaluation.energy_v2s() / 0.002), 1e-14);
}

TEST(Evaluation, TrendOfTable2) {
  Settings settings = quick_settings();
  settings.trend_count = 5;
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), settings);
  ASSERT_EQ(evaluation.status(), Status::kOk);
  ASSERT_EQ(evaluation.trend_points().size(), 5U);
  EXPECT_EQ(evaluation.trend_points()[0].energy_v2s, evaluation.energy_v2s());
  const double last = evaluation.trend_points()[4].energy_v2s;
  EXPECT_LT(last, (1.0 + kLastDigit) * emax::test::kBestEnergy10ms);
  EXPECT_GT(last, (1.0 - 1e-3) * emax::test::kBestEnergy10ms);
  double sum_t = 0.0;
  double sum_e = 0.0;
  double sum_tt = 0.0;
  double sum_te = 0.0;
  for (const emax::app::TrendPoint& point : evaluation.trend_points()) {
    const double e = point.energy_v2s;
    sum_t += point.duration_s;
    sum_e += e;
    sum_tt += point.duration_s * point.duration_s;
    sum_te += point.duration_s * e;
  }
  const double slope = (5 * sum_te - sum_t * sum_e) / (5 * sum_tt - sum_t * sum_t);
  EXPECT_NEAR(evaluation.trend.slope, slope, 1e-12 * slope);
  EXPECT_NEAR(evaluation.trend.intercept, (sum_e - slope * sum_t) / 5, 1e-14);
}

TEST(Evaluation, MonteCarloStaysBelowTheCorner) {
  Settings settings = quick_settings();
  settings.trials = 200000;
  std::vector<double> store(settings.trials);
  const EvaluationResults& evaluation =
      evaluated(kTable2, settings, Span<double>(store.data(), store.size()));
  ASSERT_EQ(evaluation.status(), Status::kOk);
  ASSERT_TRUE(evaluation.has_monte_carlo);
  const MonteCarloResult result = evaluation.trials.result;
  EXPECT_EQ(result.trials, 200000U);

  // The corner with the largest energy, found in the same way.
  const auto workspace = std::make_unique<emax::GridWorkspace>();
  emax::TrialSettings trial_settings;
  trial_settings.box = kTable2.u;
  trial_settings.search.duration_s = settings.duration_s;
  const auto trials = std::make_unique<emax::EnergyTrials>();
  const auto search = std::make_unique<emax::EnergySearch>();
  const emax::MaximumEnergy& best = evaluation.maximum;
  ASSERT_EQ(trials->start(evaluation.model, best, trial_settings), Status::kOk);
  while (!trials->ready()) {
    trials->prepare(*search, *workspace);
  }
  const double corner = 1.037 * 1.037 * trials->energy_of({1.040, 4067.0, 0.3178}, *workspace);
  // Known to 8 digits; a grid alone costs less than 1e-4 of it.
  EXPECT_LT(corner, 0.00513469925);
  EXPECT_GT(corner, (1.0 - 1e-4) * 0.0051346992);

  // E is nearly linear over the box, and steepest in S: among 2e5 trials some come within 1e-4.
  EXPECT_LT(result.maximum, corner);
  EXPECT_GT(result.maximum, (1.0 - 1e-4) * corner);
  const Accelerometer at = evaluation.device_at_maximum;
  EXPECT_GT(at.sensitivity, 1.040 - 0.02 * 0.006);
  EXPECT_LE(at.sensitivity, 1.040);
  EXPECT_LT(at.natural_frequency_hz, 4073.0);
  EXPECT_LT(at.damping, 0.3182);
  EXPECT_NEAR(result.u, 1.1e-5, 0.05e-5);
  // The box is symmetric and E nearly linear: the mean lies at the estimate, to a tenth of u.
  EXPECT_NEAR(result.mean, evaluation.energy_v2s(), 0.1 * result.u);
  EXPECT_LT(result.symmetric.low, result.mean);
  EXPECT_GT(result.symmetric.high, result.mean);
  EXPECT_LE(result.shortest.high - result.shortest.low,
            result.symmetric.high - result.symmetric.low);
}

TEST(Evaluation, NoUncertaintyNoMonteCarlo) {
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), quick_settings());
  EXPECT_EQ(evaluation.stage, Stage::kDone);
  EXPECT_FALSE(evaluation.has_monte_carlo);
}

TEST(Evaluation, OneUncertaintyIsEnoughForMonteCarlo) {
  Device device = without_uncertainty();
  device.u.natural_frequency_hz = 6.0;
  const EvaluationResults& evaluation = evaluated(device, quick_settings());
  EXPECT_EQ(evaluation.stage, Stage::kDone);
  EXPECT_TRUE(evaluation.has_monte_carlo);
  EXPECT_EQ(evaluation.device_at_maximum.sensitivity, 1.037);
}

TEST(Evaluation, AdaptiveNumberOfTrials) {
  Settings settings = quick_settings();
  settings.adaptive = true;
  const EvaluationResults& evaluation = evaluated(kTable2, settings);
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_TRUE(evaluation.adaptive.stabilised);
  EXPECT_EQ(evaluation.adaptive.trials % 10000, 0U);
  EXPECT_EQ(evaluation.trials.result.trials, evaluation.adaptive.trials);
  // u = 1.1e-5, two digits: half a unit of 1e-6.
  EXPECT_NEAR(evaluation.adaptive.tolerance, 0.5e-6, 1e-12);
}

TEST(Evaluation, GainModes) {
  Settings settings = quick_settings();
  settings.gain_mode = GainMode::kFixed;
  settings.gain = 1.02;
  EXPECT_EQ(evaluated(kTable2, settings).model.filter().gain, 1.02);
  settings.gain_mode = GainMode::kTrack;
  const EvaluationResults& evaluation = evaluated(kTable2, settings);
  EXPECT_EQ(evaluation.model.filter().gain, 1.037);
  // All of k is in proportion to S then, so E is to its square: 2 (0.003/sqrt 3)/1.037 of E from S;
  // f0 and beta add less than a tenth of that in square.
  const double u_from_s = 2.0 * 0.003 / std::sqrt(3.0) / 1.037 * evaluation.energy_v2s();
  EXPECT_NEAR(evaluation.trials.result.u, u_from_s, 0.1 * u_from_s);
}

TEST(Evaluation, LimitScalesTheEnergy) {
  const double energy = evaluated(without_uncertainty(), quick_settings()).energy_v2s();
  Settings settings = quick_settings();
  settings.limit_is_auto = false;
  settings.limit_mps2 = 10.37;
  const EvaluationResults& evaluation = evaluated(without_uncertainty(), settings);
  EXPECT_EQ(evaluation.limit_mps2, 10.37);
  EXPECT_NEAR(evaluation.energy_v2s(), 100.0 * energy, 1e-15);
}

TEST(Evaluation, StoreOrNotIsTheSame) {
  Settings settings = quick_settings();
  settings.adaptive = true;
  EvaluationResults& evaluation = evaluated(kTable2, settings);
  const std::string expected = json_of(evaluation) + report_of(evaluation);
  for (const std::size_t size : {std::size_t{1}, std::size_t{12345}, std::size_t{1000000}}) {
    std::vector<double> store(size, -1.0);
    evaluated(kTable2, settings, Span<double>(store.data(), store.size()));
    EXPECT_EQ(json_of(evaluation) + report_of(evaluation), expected) << size;
  }
  // Lent in the middle of the trials.
  std::vector<double> store(20000, -1.0);
  ASSERT_EQ(run_on(evaluation).start_from_model(kTable2, settings), Status::kOk);
  while (evaluation.stage != Stage::kMonteCarlo) {
    run_on(evaluation).step();
  }
  run_on(evaluation).step();
  run_on(evaluation).lend_trial_store(Span<double>(store.data(), store.size()));
  finish(evaluation);
  EXPECT_EQ(json_of(evaluation) + report_of(evaluation), expected);
}

TEST(Evaluation, HistoryDoesNotMatter) {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  const auto fresh = std::make_unique<EvaluationResults>();
  ASSERT_EQ(run_on(*fresh).start_from_model(kTable2, settings), Status::kOk);
  finish(*fresh);
  const std::string expected = json_of(*fresh) + report_of(*fresh);

  evaluated(table1(), paper_settings(0.002));
  EvaluationResults& evaluation = evaluated(kTable2, settings);
  EXPECT_EQ(json_of(evaluation) + report_of(evaluation), expected);

  // After a job that was left in the middle, and after one that was refused.
  ASSERT_EQ(run_on(evaluation).start_from_points(table1(), emax::app::kDefaultSettings),
            Status::kOk);
  for (int i = 0; i < 150; ++i) {
    run_on(evaluation).step();
  }
  evaluated(kTable2, settings);
  EXPECT_EQ(json_of(evaluation) + report_of(evaluation), expected);
  settings.filter_order = 16;
  EXPECT_EQ(run_on(evaluation).start_from_model(kTable2, settings), Status::kInvalidArgument);
  settings.filter_order = 10;
  evaluated(kTable2, settings);
  EXPECT_EQ(json_of(evaluation) + report_of(evaluation), expected);
}

TEST(Evaluation, CopyGoesOnByItself) {
  const auto original = std::make_unique<EvaluationResults>();
  ASSERT_EQ(run_on(*original).start_from_model(kTable2, quick_settings()), Status::kOk);
  while (original->stage != Stage::kMonteCarlo) {
    run_on(*original).step();
  }
  run_on(*original).step();
  ASSERT_EQ(original->stage, Stage::kMonteCarlo);
  const auto copy = std::make_unique<EvaluationResults>(*original);
  const auto workspace = std::make_unique<EvaluationWorkspace>(shared_workspace());
  finish(*original);
  const std::string expected = json_of(*original);
  *original = EvaluationResults{};
  Evaluation run(*copy, *workspace);
  while (!run.done()) {
    run.step();
  }
  EXPECT_EQ(json_of(*copy), expected);
}

TEST(Evaluation, StagesInOrderInShortSteps) {
  Settings settings = quick_settings();
  settings.adaptive = true;
  settings.trend_count = 2;
  EvaluationResults& evaluation = emax::test::shared_evaluation();
  ASSERT_EQ(run_on(evaluation).start_from_points(table1(), settings), Status::kOk);
  std::vector<Stage> stages;
  std::vector<int> steps;
  while (!evaluation.done()) {
    if (stages.empty() || stages.back() != evaluation.stage) {
      stages.push_back(evaluation.stage);
      steps.push_back(0);
    }
    ++steps.back();
    ASSERT_GE(run_on(evaluation).progress(), 0.0);
    ASSERT_LE(run_on(evaluation).progress(), 1.0);
    run_on(evaluation).step();
  }
  const std::vector<Stage> expected = {
      Stage::kModel,      Stage::kFitDraws, Stage::kEnergy,     Stage::kBound, Stage::kTrend,
      Stage::kPrediction, Stage::kAdaptive, Stage::kMonteCarlo, Stage::kGuard, Stage::kIdeal,
      Stage::kBand,       Stage::kMatched,  Stage::kUncertainty};
  ASSERT_EQ(stages, expected);
  EXPECT_EQ(evaluation.stage, Stage::kDone);
  EXPECT_EQ(run_on(evaluation).progress(), 1.0);
  EXPECT_EQ(steps[1], 2500);  // 10000 draws, 4 a step.
  // No stage is done in one go.
  EXPECT_GT(*std::min_element(steps.begin(), steps.end()), 5);
  run_on(evaluation).step();
  EXPECT_EQ(evaluation.stage, Stage::kDone);
}

TEST(Evaluation, NamesOfStages) {
  EXPECT_STREQ(emax::app::name_of(Stage::kMonteCarlo), "Monte Carlo");
  EXPECT_STREQ(emax::app::name_of(Stage::kAdaptive), "number of trials");
  EXPECT_STREQ(emax::app::name_of(Stage::kGuard), "guard");
  EXPECT_STREQ(emax::app::name_of(Stage::kTrend), "trend");
}

void expect_refused(const Device& device, const Settings& settings, Status status, Stage stage,
                    const std::string& words) {
  EvaluationResults& evaluation = emax::test::shared_evaluation();
  EXPECT_EQ(run_on(evaluation).start_from_model(device, settings), status) << words;
  EXPECT_EQ(evaluation.stage, Stage::kFailed);
  EXPECT_EQ(evaluation.status(), status);
  EXPECT_TRUE(evaluation.done());
  EXPECT_EQ(evaluation.failure.stage, stage) << words;
  const std::string said =
      text_of([&](TextWriter& out) { emax::app::write_failure(evaluation, out); });
  EXPECT_NE(said.find(words), std::string::npos) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  run_on(evaluation).step();
  EXPECT_EQ(evaluation.stage, Stage::kFailed);
}

TEST(Evaluation, RefusesSettings) {
  Settings settings = quick_settings();
  settings.filter_order = 0;
  expect_refused(kTable2, settings, Status::kInvalidArgument, Stage::kIdle, "setting");
  settings = quick_settings();
  settings.trials = 999;
  expect_refused(kTable2, settings, Status::kInvalidArgument, Stage::kIdle, "setting");
}

TEST(Evaluation, RefusesDevices) {
  const auto refused = [](double s, double f0, double beta, Status status, const char* words) {
    expect_refused({{s, f0, beta}, {}}, quick_settings(), status, Stage::kIdle, words);
  };
  refused(1.037, 4073.0, 1.0, Status::kOverdamped, "from 1e-4 to below 1");
  refused(1.037, 4073.0, 0.0, Status::kInvalidArgument, "damping from 1e-4");
  refused(0.0, 4073.0, 0.3, Status::kInvalidArgument, "sensitivity must be above 0");
  refused(-1.0, 4073.0, 0.3, Status::kInvalidArgument, "sensitivity must be above 0");
  refused(1.037, 0.0, 0.3, Status::kInvalidArgument, "natural frequency");
  refused(1.037, std::nan(""), 0.3, Status::kInvalidArgument, "natural frequency");
  refused(1e31, 4073.0, 0.3, Status::kInvalidArgument, "unit");
  refused(1e-31, 4073.0, 0.3, Status::kInvalidArgument, "unit");
}

TEST(Evaluation, RefusesUncertainties) {
  const auto refused = [](double u_s, double u_f0, double u_beta, Stage stage, const char* words) {
    expect_refused({kTable2.estimate, {u_s, u_f0, u_beta}}, quick_settings(),
                   Status::kInvalidArgument, stage, words);
  };
  refused(-0.003, 6.0, 0.0004, Stage::kIdle, "0 or more");
  refused(0.003, std::nan(""), 0.0004, Stage::kIdle, "0 or more");
  refused(0.003, 6.0, HUGE_VAL, Stage::kIdle, "0 or more");
  refused(1.037, 6.0, 0.0004, Stage::kMonteCarlo, "smaller uncertainties");
  refused(0.003, 4073.0, 0.0004, Stage::kMonteCarlo, "smaller uncertainties");
  refused(0.003, 6.0, 0.3182, Stage::kMonteCarlo, "smaller uncertainties");
  refused(0.003, 6.0, 0.7, Stage::kMonteCarlo, "smaller uncertainties");
}

TEST(Evaluation, RefusesTimesThatTakeTooManyCells) {
  // 12 cells per period of 4073 Hz: the 65 536 cells of a PC last for 1.3409 s, and the 8192 of a
  // board for 0.16761 s.
  static_assert(emax::kMaxCells == 65536 || emax::kMaxCells == 8192);
  const bool is_pc = emax::kMaxCells == 65536;
  Settings settings = quick_settings();
  settings.duration_s = is_pc ? 1.341 : 0.1677;
  expect_refused(kTable2, settings, Status::kTooManyCells, Stage::kEnergy,
                 is_pc ? "(T = 1.341 s, at most 1.34 s)" : "(T = 0.1677 s, at most 0.1676 s)");
  EXPECT_EQ(emax::test::shared_evaluation().failure.duration_s, settings.duration_s);
  // What it says is short enough.
  settings.duration_s = is_pc ? 1.34 : 0.1676;
  EXPECT_EQ(run_on(emax::test::shared_evaluation()).start_from_model(kTable2, settings),
            Status::kOk);
  settings = quick_settings();
  settings.trend_count = 3;
  settings.trend_s[2] = 2.0;
  expect_refused(kTable2, settings, Status::kTooManyCells, Stage::kTrend,
                 is_pc ? "(T = 2 s, at most 1.34 s)" : "(T = 2 s, at most 0.1676 s)");
  settings = paper_settings(0.1312);
  expect_refused(kTable2, settings, Status::kTooManyCells, Stage::kEnergy, "longer step");
}

TEST(Evaluation, ATrendOfTooManySwitchesFailsBeforeTheTrials) {
  // Hardly damped, 10 kHz: more than a switch for each 50 us, and no more cells than there may be.
  Settings settings = paper_settings(0.001);
  settings.step_s = 1e-5;
  settings.trend_count = 3;
  settings.trend_s[0] = 0.001;
  settings.trend_s[1] = 0.002;
  settings.trend_s[2] = 6e-5 * static_cast<double>(emax::kMaxSwitches);
  EvaluationResults& results = emax::test::shared_evaluation();
  ASSERT_EQ(run_on(results).start_from_model({{1.0, 10000.0, 0.01}, {0.001, 1.0, 1e-5}}, settings),
            Status::kOk);
  while (!results.done()) {
    ASSERT_NE(results.stage, Stage::kMonteCarlo);
    run_on(results).step();
  }
  EXPECT_EQ(results.status(), Status::kTooManySwitches);
  EXPECT_EQ(results.failure.stage, Stage::kTrend);
}

TEST(Evaluation, RefusesFits) {
  EvaluationResults& evaluation = emax::test::shared_evaluation();
  const auto said = [&] {
    return text_of([&](TextWriter& out) { emax::app::write_failure(evaluation, out); });
  };
  FrequencyResponse points;
  EXPECT_EQ(run_on(evaluation).start_from_points(points, quick_settings()), Status::kTooFewPoints);
  EXPECT_EQ(evaluation.failure.stage, Stage::kFitDraws);

  const FrequencyResponse measured = table1();
  for (ResponsePoint point : measured.points()) {
    point.phase_rad += 3.14159265358979323846;
    ASSERT_EQ(points.add(point), Status::kOk);
  }
  EXPECT_EQ(run_on(evaluation).start_from_points(points, quick_settings()),
            Status::kInvertedPolarity);
  EXPECT_NE(said().find("S = -1.0079"), std::string::npos) << said();

  points.clear();
  for (ResponsePoint point : measured.points()) {
    point.phase_rad = -point.phase_rad;
    ASSERT_EQ(points.add(point), Status::kOk);
  }
  EXPECT_EQ(run_on(evaluation).start_from_points(points, quick_settings()), Status::kNotPhysical);
  EXPECT_NE(said().find("mu2 = -"), std::string::npos) << said();
  EXPECT_EQ(evaluation.stage, Stage::kFailed);
  // The fit is there to be looked at.
  EXPECT_NEAR(evaluation.fit.result().mu[0], 1.0 / 1.00791, 1e-5);
}

FrequencyResponse with_uncertainties_times(double factor) {
  const FrequencyResponse good = synthetic_points(0.0);
  FrequencyResponse points;
  for (ResponsePoint point : good.points()) {
    point.u_amplitude *= factor;
    point.u_phase_rad *= factor;
    EXPECT_EQ(points.add(point), Status::kOk);
  }
  return points;
}

TEST(Evaluation, UncertaintiesOfAPoorFitLeaveTheDampingOpen) {
  // u(beta) of the original points is about 0.001; 200 times that is most of beta itself.
  const FrequencyResponse points = with_uncertainties_times(200.0);
  const EvaluationResults& evaluation = evaluated(points, quick_settings());
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_TRUE(evaluation.is_damping_open());
  EXPECT_FALSE(evaluation.has_monte_carlo);
  ASSERT_TRUE(evaluation.has_cut_range);
  EXPECT_LT(evaluation.cut_low_v2s, evaluation.energy_v2s());
  EXPECT_GT(evaluation.cut_high_v2s, evaluation.energy_v2s());
  EXPECT_TRUE(evaluation.is_of(points));
  EXPECT_TRUE(evaluation.holds(emax::app::Goal::kReport, quick_settings()));
}

TEST(Evaluation, HopelessUncertaintiesDetermineNothing) {
  EvaluationResults& evaluation = emax::test::shared_evaluation();
  EXPECT_EQ(run_on(evaluation).start_from_points(with_uncertainties_times(70.0), quick_settings()),
            Status::kOk);
  EXPECT_EQ(
      run_on(evaluation).start_from_points(with_uncertainties_times(1000.0), quick_settings()),
      Status::kNotIdentifiable);
  EXPECT_EQ(evaluation.failure.stage, Stage::kFitDraws);
}

TEST(Evaluation, PointsOfUnknownPhaseAreKnownAgain) {
  FrequencyResponse points;
  const FrequencyResponse measured = synthetic_points(0.0);
  for (ResponsePoint point : measured.points()) {
    point.phase_rad = 0.0;
    point.u_phase_rad = emax::kUnknownPhase_rad;
    ASSERT_EQ(points.add(point), Status::kOk);
  }
  const EvaluationResults& evaluation = evaluated(points, quick_settings());
  ASSERT_EQ(evaluation.status(), Status::kOk);
  EXPECT_TRUE(evaluation.is_of(points));
  EXPECT_FALSE(evaluation.is_of(measured));
}

}  // namespace
