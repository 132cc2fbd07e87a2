// What the report says, when it warns, and that it says the same again.
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <sstream>
#include <string>

#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"

#include "support/evaluations.hpp"
#include "support/report_text.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::Criterion;
using emax::FrequencyResponse;
using emax::Method;
using emax::ResponsePoint;
using emax::app::EvaluationResults;
using emax::app::GainMode;
using emax::app::reduced_chi_square_limit;
using emax::app::ReportContext;
using emax::app::ReportPart;
using emax::app::ReportSection;
using emax::app::Settings;
using emax::app::TextWriter;
using emax::app::Warning;
using emax::test::evaluated;
using emax::test::expect_well_formed;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::says;
using emax::test::synthetic_points;
using emax::test::table1;
using emax::test::text_of;

std::string report_of(const EvaluationResults& evaluation, const ReportContext& context = {}) {
  return text_of([&](TextWriter& out) { emax::app::write_report(evaluation, context, out); });
}

/// The line that begins with these words, without blanks at its start.
std::string line_with(const std::string& report, const std::string& start) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string::npos && line.compare(first, start.size(), start) == 0) {
      return line.substr(first);
    }
  }
  return "no line with " + start;
}

TEST(Report, Table1) {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  const std::string report = report_of(evaluated(table1(), settings), {"djb.csv"});
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "measured points: djb.csv"));
  EXPECT_TRUE(says(report, "42 points from 30 Hz to 6000 Hz"));
  EXPECT_TRUE(says(line_with(report, "S  "), "1.00791 ")) << line_with(report, "S  ");
  EXPECT_TRUE(says(line_with(report, "S  "), " 0.00113 "));
  EXPECT_TRUE(says(line_with(report, "f0  "), " 4057.25 "));
  EXPECT_TRUE(says(line_with(report, "f0  "), " 2.85 "));
  EXPECT_TRUE(says(line_with(report, "beta  "), " 0.246180 "));
  EXPECT_TRUE(says(report, "8595.4 with 81 degrees of freedom, chi2/dof = 106.1"));
  EXPECT_TRUE(says(report, "WARNING: chi2/dof = 106.1 is above 1.40"));
  EXPECT_TRUE(says(report, "Birge ratio of 10.3"));
  EXPECT_TRUE(says(report, "Correlation               r(S,f0) = "));
  EXPECT_TRUE(says(report, "of 42 points"));
  EXPECT_TRUE(says(report, "the 10 largest"));
}

TEST(Report, Table2) {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  const std::string report = report_of(evaluated(kTable2, settings));
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "parameters as given"));
  EXPECT_TRUE(says(report, "S = 1.037 V/(m/s^2), standard u = 0.003\n"));
  EXPECT_FALSE(says(report, "\nFIT"));
  EXPECT_FALSE(says(report, "chi2"));
  EXPECT_TRUE(says(line_with(report, "Peak of k"), "17462.4 V/(m/s) at 51.40 us"));
  EXPECT_TRUE(says(line_with(report, "5 % settling"), "1.453582 ms"));
  double energy = 0.0;
  ASSERT_EQ(std::sscanf(line_with(report, "E  ").c_str(), "E %lf V^2 s", &energy), 1);
  EXPECT_NEAR(energy, emax::test::kBestEnergy2ms, 0.5e-11);
  EXPECT_TRUE(says(line_with(report, "Signal"), "1 switch, at (ms)"));
  // The relaxation's bound is 0.00586; the gap is that over 0.00511525.
  double bound = 0.0;
  ASSERT_EQ(std::sscanf(line_with(report, "Upper bound").c_str(), "Upper bound %lf V^2 s: proven",
                        &bound),
            1);
  EXPECT_GT(bound, emax::test::kBestEnergy2ms);
  EXPECT_LE(bound, 0.00586);
  EXPECT_TRUE(says(line_with(report, "Gap"), " % of E"));
  // sqrt(5.115e-3/2e-3) = 1.5992; over 1.037^2 = 1.07537 that is 148.7 %.
  EXPECT_TRUE(says(line_with(report, "rms error"), " V = 148.7 % of S a"));
  EXPECT_TRUE(says(report, "WARNING: fewer trials than rule (3)"));
  EXPECT_TRUE(says(line_with(report, "Trials"), "1000; rule (3), 1e4/(1 - p), asks for 200000"));
  EXPECT_TRUE(says(report, "TREND"));
  EXPECT_TRUE(says(line_with(report, "Random"), "123456789,345678901,567890123,789012345"));
}

TEST(Report, EnoughTrialsGiveNoWarning) {
  Settings settings = quick_settings();
  settings.probability = 0.5;
  settings.trials = 20000;  // 1e4/(1 - 0.5)
  EXPECT_FALSE(says(report_of(evaluated(kTable2, settings)), "WARNING"));
  settings.trials = 19999;
  EXPECT_TRUE(says(report_of(evaluated(kTable2, settings)), "WARNING"));
}

TEST(Report, TwiceTheSame) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  const std::string first = report_of(evaluation, {"djb.csv"});
  EXPECT_EQ(report_of(evaluation, {"djb.csv"}), first);
}

/// Enough trials for rule (3), so that all warnings are about the fit.
std::string fit_report(const FrequencyResponse& points) {
  Settings settings = quick_settings();
  settings.probability = 0.5;
  settings.trials = 20000;
  const std::string report = report_of(evaluated(points, settings));
  expect_well_formed(report);
  return report;
}

TEST(Report, NoWarningWithoutNoise) {
  const std::string report = fit_report(synthetic_points(0.0));
  EXPECT_FALSE(says(report, "WARNING"));
  EXPECT_TRUE(says(report, "These may be too large"));
  EXPECT_TRUE(says(line_with(report, "Large residuals"), "0 of 40 points"));
}

TEST(Report, NoWarningWithNoiseOfTheStatedSize) {
  const std::string report = fit_report(synthetic_points(1.0));
  EXPECT_FALSE(says(report, "WARNING"));
  EXPECT_FALSE(says(report, "too large"));
}

TEST(Report, WarningWithTwiceTheStatedNoise) {
  const std::string report = fit_report(synthetic_points(2.0));
  EXPECT_TRUE(says(report, "WARNING: chi2/dof"));
}

TEST(Report, NamesThePointThatIsOff) {
  const FrequencyResponse good = synthetic_points(0.5);
  FrequencyResponse points;
  for (ResponsePoint point : good.points()) {
    if (point.frequency_hz == 1500.0) {
      point.amplitude += 20.0 * point.u_amplitude;
    }
    ASSERT_EQ(points.add(point), emax::Status::kOk);
  }
  const std::string report = fit_report(points);
  EXPECT_TRUE(says(line_with(report, "Large residuals"), "1 of 40 points"))
      << line_with(report, "Large residuals");
  EXPECT_TRUE(says(report, "imaginary\n"));
  const std::string line = line_with(report, "1500 ");
  double frequency = 0.0;
  double re = 0.0;
  double im = 0.0;
  ASSERT_EQ(std::sscanf(line.c_str(), "%lf %lf %lf", &frequency, &re, &im), 3) << line;
  // 20 standard uncertainties, less what the fit gives in to it and the noise of the point.
  EXPECT_NEAR(std::hypot(re, im), 20.0, 3.0);
}

TEST(Report, LimitOfChiSquare) {
  // 99 % points of chi-square from tables, over dof; Wilson and Hilferty is good to 0.3 % there.
  EXPECT_NEAR(reduced_chi_square_limit(3), 11.345 / 3, 0.01);
  EXPECT_NEAR(reduced_chi_square_limit(30), 50.892 / 30, 0.002);
  EXPECT_NEAR(reduced_chi_square_limit(80), 112.329 / 80, 0.001);
  EXPECT_EQ(reduced_chi_square_limit(0), 0.0);
}

TEST(Report, PaperMethod) {
  Settings settings = quick_settings();
  settings.method = Method::kPaper;
  std::string report = report_of(evaluated(kTable2, settings));
  expect_well_formed(report);
  EXPECT_TRUE(says(line_with(report, "E  "), "4.48654991e-03 V^2 s"));
  EXPECT_TRUE(says(line_with(report, "Method"), "step 2 us, J = 30"));
  EXPECT_TRUE(says(report, "1000 cells of 2 us, at rest after 6 iterations"));
  EXPECT_TRUE(says(line_with(report, "E_0"), "3.81585784e-03"));
  EXPECT_TRUE(says(line_with(report, "0.342000"), "0.470000   0.574000   1.540000"));
  settings.iterations = 3;
  report = report_of(evaluated(kTable2, settings));
  EXPECT_TRUE(says(report, "not yet at rest after 3 iterations"));
}

TEST(Report, ShortTimeIsNoted) {
  Settings settings = quick_settings();
  EXPECT_FALSE(
      says(report_of(evaluated(kTable2, settings)), "T is shorter than the settling time,"));
  settings.duration_s = 0.001;
  EXPECT_TRUE(says(report_of(evaluated(kTable2, settings)), "T is shorter"));
}

TEST(Report, TheTimeAdvisedIsEnough) {
  Settings settings = quick_settings();
  settings.duration_s = 0.0005;  // The settling time is 1.453582 ms.
  EXPECT_TRUE(
      says(report_of(evaluated({kTable2.estimate, {}}, settings)), "give a T of 1.46 ms or more"));
  settings.duration_s = 0.00146;
  const std::string report = report_of(evaluated({kTable2.estimate, {}}, settings));
  EXPECT_FALSE(says(report.substr(0, report.find("MAXIMUM ENERGY")), "settling time, so"));
}

TEST(Report, AdvisesNoTimeThatCannotBeSearched) {
  // Hardly damped, it rings for 3/(beta 2 pi f0) = 1.17 s; a signal that follows it switches every
  // 1/(2 f0), and 8 of the switches are kept for its ends.
  static_assert(emax::kMaxSwitches == 2048 || emax::kMaxSwitches == 256);
  const EvaluationResults& results = evaluated({{1.0, 4073.0, 1e-4}, {}}, quick_settings());
  const std::string report = report_of(results);
  EXPECT_TRUE(says(report, emax::kMaxSwitches == 2048 ? "as long: there is room for 250 ms."
                                                      : "as long: there is room for 30.4 ms."));
  EXPECT_FALSE(says(report.substr(0, report.find("MAXIMUM ENERGY")), "give a T of"));
  EXPECT_EQ(emax::app::least_time_s(Warning::kShortTime, results), 0.0);
  EXPECT_TRUE(says(words_of(Warning::kShortTime, results), "no T that can be searched"));
}

TEST(Report, SaysWhichSettlingTimeIsMeant) {
  Settings settings = quick_settings();
  settings.duration_s = 0.0005;
  const EvaluationResults& results = evaluated({kTable2.estimate, {}}, settings);
  const std::string report = report_of(results);
  EXPECT_TRUE(says(line_with(report, "5 % settling time"), "1.453582 ms"));
  EXPECT_TRUE(says(line_with(report, "5 % settling, in band"), "4.18"));
  EXPECT_TRUE(says(report, "T is much shorter than the settling time, so"));
  EXPECT_TRUE(says(report, "T is much shorter than the settling time in band, so"));
  EXPECT_FALSE(says(words_of(Warning::kShortTime, results), "in-band"));
  EXPECT_TRUE(says(words_of(Warning::kShortInBand, results), "in-band"));
}

/// Found, U and bound of a row of the figures.
struct Columns {
  double found = -1.0;
  double expanded = -1.0;
  double bound = -1.0;
};

Columns columns_of(const std::string& report, const std::string& name) {
  Columns columns;
  const std::string line = line_with(report, name);
  EXPECT_EQ(std::sscanf(line.c_str() + name.size(), "%lf %lf %lf", &columns.found,
                        &columns.expanded, &columns.bound),
            3)
      << line;
  EXPECT_FALSE(says(line, " -0")) << line;
  return columns;
}

TEST(Report, FiguresOfAnySizeKeepTheirColumns) {
  (void)evaluated(kTable2, quick_settings());
  EvaluationResults& results = emax::test::shared_evaluation();
  const double unit = results.percent_of(1.0);
  const std::string name = "In band, constant delay taken out";
  for (const double percent : {50.0, 1.0, 1e-4, 1e-8, 1e-10, 1e-12, 1e-15, 0.0}) {
    results.matched.energy_v2s = (percent / unit) * (percent / unit);
    results.matched.bound_v2s = 1.0404 * results.matched.energy_v2s;
    results.matched.uncertainty.u_percent = 0.005 * percent + 1e-30;
    results.matched.uncertainty.shortest = {0.98 * results.matched.energy_v2s,
                                            1.02 * results.matched.energy_v2s};
    const Columns columns = columns_of(report_of(results), name);
    EXPECT_NEAR(columns.found, percent, 1e-3 * percent) << percent;
    EXPECT_NEAR(columns.expanded, 0.01 * percent, 0.06 * 0.01 * percent + 3e-30) << percent;
    EXPECT_GE(columns.bound, 1.02 * percent * (1.0 - 1e-12)) << percent;
    EXPECT_LE(columns.bound, 1.023 * percent) << percent;
  }
}

TEST(Report, GuardThatDisagreesSaysByHowMuchOrThatItHasFailed) {
  (void)evaluated(kTable2, quick_settings());
  EvaluationResults& results = emax::test::shared_evaluation();
  results.guard.disagreements = 1;
  results.guard.largest_excess = 0.0123F;
  std::string report = report_of(results);
  EXPECT_TRUE(says(report, "found up to 1.23 % more energy"));
  EXPECT_FALSE(says(report, "smaller uncertainties"));
  results.guard.largest_excess = 0.0F;
  report = report_of(results);
  EXPECT_FALSE(says(report, "0 % more energy"));
  EXPECT_TRUE(says(report, "in these trials the search has failed"));
}

TEST(Report, AnIntervalStandsInThePlaceOfUAtTheEndOfADistribution) {
  (void)evaluated(kTable2, quick_settings());
  EvaluationResults& results = emax::test::shared_evaluation();
  const double unit = results.percent_of(1.0);
  const auto energy = [unit](double percent) { return (percent / unit) * (percent / unit); };
  results.matched.energy_v2s = energy(0.0001385);
  results.matched.uncertainty.u_percent = 0.0073;
  results.matched.uncertainty.shortest = {energy(0.0002), energy(0.0239)};
  std::string report = report_of(results);
  EXPECT_TRUE(
      says(line_with(report, "In band, constant delay taken out"), "0.0001385        0 to 0.024 "));
  EXPECT_TRUE(says(report, "+-U says too little"));
  // As far below the figure as above it.
  results.matched.energy_v2s = energy(0.0120);
  results.matched.uncertainty.u_percent = 0.0059;
  report = report_of(results);
  EXPECT_TRUE(
      says(line_with(report, "In band, constant delay taken out"), "0.012             0.012 "));
  EXPECT_FALSE(says(report, "+-U says too little"));
}

TEST(Report, InBandNamesItsDelayAndWhatItsUncertaintyIsOf) {
  Settings settings = quick_settings();
  settings.criterion = Criterion::kInBandError;
  std::string report = report_of(evaluated(kTable2, settings));
  expect_well_formed(report);
  // 0.3182/(pi 4073 Hz) = 24.868 us.
  EXPECT_TRUE(says(report, "the reference delayed by 24.868 us\n"));
  EXPECT_TRUE(says(report, "k of the in-band error"));
  EXPECT_FALSE(says(report, "sensor minus filter"));
  EXPECT_FALSE(says(report, "the paper prints"));
  EXPECT_FALSE(says(report, "The paper's figure"));
  EXPECT_FALSE(says(report, "ideal sensor, K = S"));  // It has none.
  EXPECT_TRUE(says(report, "the gain follows S: an error of S is one of gain, and left out"));
  settings.delay_choice = emax::app::DelayChoice::kNone;
  EXPECT_TRUE(says(report_of(evaluated({kTable2.estimate, {}}, settings)),
                   "the reference delayed by 0 us\n"));
  settings.delay_choice = emax::app::DelayChoice::kGiven;
  settings.delay_s = 20e-6;
  report = report_of(evaluated({kTable2.estimate, {}}, settings));
  EXPECT_TRUE(says(report, "the reference delayed by 20 us, as given\n"));
}

TEST(Report, AnIdealSensorHasAnErrorInBandOfAnotherGain) {
  Settings settings = quick_settings();
  settings.criterion = Criterion::kInBandError;
  settings.gain_mode = GainMode::kFixed;
  settings.gain = 1.0;
  const EvaluationResults& results = evaluated({kTable2.estimate, {}}, settings);
  // 0.037 of what the filter passes. A constant signal at rest gives 100 (1.037 - 1)/1.037 %, and
  // what reverses once is below twice that.
  ASSERT_TRUE(results.ideal.exists());
  const double settled = 100.0 * 0.037 / 1.037;
  EXPECT_GT(results.percent_of(results.ideal.energy_v2s), 0.5 * settled);
  EXPECT_LT(results.percent_of(results.ideal.energy_v2s), 2.0 * settled);
  const std::string report = report_of(results);
  EXPECT_TRUE(says(report, "0 for an ideal sensor\n  with S = G"));
  EXPECT_TRUE(says(report, "The first of an ideal sensor, K = S"));
}

TEST(Report, ASensorThatIsTheFilterHasNoError) {
  Settings settings = quick_settings();
  settings.filter_order = 2;
  for (const Criterion criterion :
       {Criterion::kIntegralSquareError, Criterion::kEnergyDifference}) {
    settings.criterion = criterion;
    const std::string report =
        report_of(evaluated({{0.1, 1000.0, 0.7071067811865476}, {}}, settings));
    expect_well_formed(report);
    EXPECT_TRUE(says(report, "The sensor is the filter, so the error is 0 for every signal."));
    EXPECT_FALSE(says(report, "best signal found"));
    EXPECT_FALSE(says(report, "beyond 0 ms"));
    EXPECT_FALSE(says(report, "-0.0"));
  }
}

TEST(Report, TrialsThatAreTooRoughAreAWarning) {
  using emax::app::holds;
  using emax::app::Warning;
  Settings settings = quick_settings();
  settings.probability = 0.5;
  settings.trials = 20000;
  (void)evaluated(kTable2, settings);
  EvaluationResults& results = emax::test::shared_evaluation();
  EXPECT_FALSE(holds(Warning::kRough, results, {}));
  emax::app::EnergyUncertainty* const all[] = {&results.uncertainty, &results.band.uncertainty,
                                               &results.matched.uncertainty};
  for (emax::app::EnergyUncertainty* known : all) {
    known->rough_trials = 7;
    known->rough_part = 0.004F;
    EXPECT_FALSE(holds(Warning::kRough, results, {}));
    EXPECT_TRUE(says(report_of(results), "7 trials, off by up to 0.4 % of u(E)\n"));
    EXPECT_FALSE(says(report_of(results), "WARNING"));
    known->rough_part = 0.2F;
    EXPECT_TRUE(holds(Warning::kRough, results, {}));
    EXPECT_TRUE(says(report_of(results), "WARNING: u(E) may be off in its second digit"));
    known->rough_trials = 0;
  }
  results.trials.branches.rough_trials = 7;
  results.trials.branches.rough_part = 0.2F;
  EXPECT_TRUE(holds(Warning::kRough, results, {}));
  EXPECT_TRUE(says(report_of(results), "WARNING: u(E) may be off in its second digit"));
}

// 95 % of 7500 trials: the standard deviation of their share is sqrt(0.95 0.05/7500) = 0.25 %.
TEST(Report, FewerTrialsThanAskedForAreSaidToBe) {
  Settings settings = quick_settings();
  settings.probability = 0.95;
  settings.trials = 20000;
  (void)evaluated(kTable2, settings);
  EvaluationResults& results = emax::test::shared_evaluation();
  EXPECT_FALSE(says(report_of(results), "take a refinement"));
  emax::app::EnergyUncertainty* const all[] = {&results.uncertainty, &results.band.uncertainty,
                                               &results.matched.uncertainty};
  for (emax::app::EnergyUncertainty* known : all) {
    const std::uint32_t made = known->trials;
    known->trials = 7500;
    EXPECT_TRUE(says(report_of(results),
                     "7500, as many take a refinement; 95 % is within 0.5 % (k = 2)\n"));
    known->trials = made;
  }
}

TEST(Report, ALineThatDescribesNothingIsNoted) {
  Settings settings = quick_settings();
  settings.trend_count = 3;
  EXPECT_FALSE(says(report_of(evaluated(kTable2, settings)), "not linear"));
  // While a device with hardly any damping builds up its oscillation, E grows as the cube of T.
  emax::app::Device ringing = kTable2;
  ringing.estimate.damping = 0.001;
  ringing.u.damping = 1e-6;
  const std::string report = report_of(evaluated(ringing, settings));
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "Note: E is not linear in T here"));
  // A line that falls is one, too: nearly all the energy difference is that of the filter.
  settings.criterion = Criterion::kEnergyDifference;
  settings.method = Method::kPaper;
  settings.gain_mode = GainMode::kFixed;
  settings.gain = 10.0;
  settings.step_s = 0.001;
  settings.cutoff_hz = 10000.0;
  settings.filter_order = 1;
  const std::string falling = report_of(evaluated({kTable2.estimate, {}}, settings));
  EXPECT_TRUE(says(line_with(falling, "Correlation"), " -0.99")) << falling;
  EXPECT_FALSE(says(falling, "not linear"));
}

TEST(Report, OtherSettings) {
  Settings settings = quick_settings();
  settings.criterion = Criterion::kEnergyDifference;
  settings.gain_mode = GainMode::kTrack;
  settings.limit_is_auto = false;
  settings.limit_mps2 = 9.81;
  settings.generator = emax::Generator::k1982;
  settings.adaptive = true;
  const std::string report = report_of(evaluated(kTable2, settings));
  expect_well_formed(report);
  EXPECT_TRUE(says(line_with(report, "Criterion"), "energy difference"));
  EXPECT_TRUE(says(report, "\n  sqrt(E/T)  "));  // No error, so no rms error.
  EXPECT_TRUE(says(report, "The energy difference, sqrt(E/T)"));
  EXPECT_FALSE(says(report, "The paper's figure"));
  EXPECT_TRUE(says(report, "one between the limits may have more"));
  EXPECT_TRUE(says(line_with(report, "Filter gain"), "in each trial that trial's S"));
  EXPECT_TRUE(says(line_with(report, "Limit a"), "9.81 m/s^2, as given"));
  EXPECT_TRUE(says(report, "1982, seed 123456789,345678901,567890123\n"));
  EXPECT_TRUE(says(line_with(report, "Adaptive"), "stable after"));
  EXPECT_TRUE(says(report, "Not asked for"));
  settings.adaptive = false;
  const std::string without = report_of(evaluated({kTable2.estimate, {}}, settings));
  EXPECT_TRUE(says(without, "Not run: all uncertainties are zero"));
}

TEST(Report, Labels) {
  const EvaluationResults& evaluation = evaluated(kTable2, quick_settings());
  EXPECT_FALSE(says(report_of(evaluation), "LABELS"));
  ReportContext context;
  context.labels.device = "DJB\nA/1800/V";
  context.labels.date = "2024-05-01";
  const std::string note(10000, 'x');
  context.labels.note = note.c_str();
  const std::string report = report_of(evaluation, context);
  EXPECT_TRUE(says(report, "\nLABELS (as given)\n  Device                    DJB A/1800/V\n"));
  EXPECT_EQ(line_with(report, "Date"), "Date                      2024-05-01");
  EXPECT_FALSE(says(report, "Operator"));
  EXPECT_FALSE(says(report, "Serial"));
  EXPECT_EQ(line_with(report, "Note"),
            "Note                      " + std::string(emax::app::kLabelShown, 'x') + " ...");
}

TEST(Report, UnitsOfGravity) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  EXPECT_FALSE(says(report_of(evaluation), " g)"));
  ReportContext context;
  context.in_g = true;
  const std::string report = report_of(evaluation, context);
  // Table 1's S is 1.00791 (weighted least squares, by NumPy); times 9.80665 m/s^2 per g, and over.
  EXPECT_TRUE(says(line_with(report, "Limit a"), " m/s^2 (0.10277"));
  EXPECT_TRUE(says(line_with(report, "Limit a"), " g), the number of S"));
  EXPECT_TRUE(says(line_with(report, "Filter gain"), " V/(m/s^2) (9.884"));
  EXPECT_TRUE(says(report, "V/(m/s^2)\n  S                   9.884"));
  EXPECT_TRUE(says(line_with(report, "xi"), " (V/g)^2)"));
}

/// Writes down what begins where, and the words between.
class Marks final : public emax::app::ReportMarkup {
 public:
  explicit Marks(emax::test::StringSink& sink) : sink_(sink) {}
  void begin(ReportSection section, const char* heading) noexcept override {
    put("\n[section " + std::to_string(static_cast<int>(section)) + " " +
        (heading != nullptr ? heading : "") + "]");
  }
  void begin(ReportPart part, const char* name) noexcept override {
    put("[" + std::to_string(static_cast<int>(part)) + (name != nullptr ? name : "") + "]");
    tables_ += part == ReportPart::kTable ? 1 : 0;
    cells_ += part == ReportPart::kCell ? 1 : 0;
    warnings_ += part == ReportPart::kWarning ? 1 : 0;
  }
  void quote(const char* text) noexcept override { put(std::string("{") + text + "}"); }
  int tables() const { return tables_; }
  int cells() const { return cells_; }
  int warnings() const { return warnings_; }

 private:
  void put(const std::string& text) {
    sink_.write(emax::Span<const char>(text.data(), text.size()));
  }

  emax::test::StringSink& sink_;
  int tables_ = 0;
  int cells_ = 0;
  int warnings_ = 0;
};

TEST(Report, MarksOfSomebodyElse) {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  const EvaluationResults& evaluation = evaluated(table1(), settings);
  ReportContext context;
  context.source_name = "<a>.csv";
  context.labels.device = "a\nb";
  emax::test::StringSink sink;
  TextWriter out(sink);
  Marks marks(sink);
  emax::app::write_report(evaluation, context, out, &marks);
  const std::string& report = sink.text();
  EXPECT_TRUE(says(report, "[0Device]{a\nb}"));  // As it was given.
  EXPECT_TRUE(says(report, "measured points: {<a>.csv}"));
  EXPECT_TRUE(says(report, "[section 6 FIT]"));
  // Figures, parameters, large residuals, trend: 4, 6, 3 and 3 columns; 4, 3, 10 and 2 lines and
  // their heads.
  EXPECT_EQ(marks.tables(), 4);
  EXPECT_EQ(marks.cells(), 4 * 5 + 6 * 4 + 3 * 11 + 3 * 3);
  EXPECT_EQ(marks.warnings(), 2);  // The fit, and few trials.
}

TEST(Report, EnergyDifferenceBelowZeroHasNoRms) {
  const EvaluationResults& evaluation =
      evaluated({kTable2.estimate, {}}, emax::test::settings_below_zero());
  ASSERT_LT(evaluation.energy_v2s(), 0.0);
  const std::string report = report_of(evaluation);
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "none, the energy difference is negative"));
}

}  // namespace
