// What report, JSON and tables say of a measurement: one that has gone well, one that a fault has
// ended, and points whose uncertainties have a part in common.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "emax/app/points/points_reader.hpp"
#include "emax/app/points/reference_uncertainty.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/sim/sim_bench.hpp"

#include "app/sweep_run.hpp"
#include "support/evaluations.hpp"
#include "support/json_reader.hpp"
#include "support/report_text.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::FrequencyResponse;
using emax::Status;
using emax::app::EvaluationResults;
using emax::app::Measurement;
using emax::app::SimulatedBench;
using emax::app::SweepPoint;
using emax::app::SweepResults;
using emax::app::SweepSettings;
using emax::app::TextWriter;
using emax::sim::BenchSettings;
using emax::sim::FaultKind;
using emax::test::evaluated;
using emax::test::expect_well_formed;
using emax::test::JsonReader;
using emax::test::quick_settings;
using emax::test::says;
using emax::test::SweepRun;
using emax::test::text_of;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
const SimulatedBench kSimulated = {1, {1.037, 4073.0, 0.3182}};

struct FinishedRun : SweepRun {
  explicit FinishedRun(const BenchSettings& settings,
                       const SweepSettings& wanted = emax::app::default_sweep_settings())
      : SweepRun(settings) {
    to_end(wanted);
  }
};

/// The default measurement; made once.
const SweepRun& good_run() {
  static const FinishedRun run{BenchSettings()};
  EXPECT_EQ(run.sweep.status, Status::kOk);
  return run;
}

BenchSettings bench_with(FaultKind fault, std::uint64_t at_frame) {
  BenchSettings settings;
  settings.fault = {fault, at_frame};
  return settings;
}

Measurement measurement_of(const SweepRun& run) {
  return {run.sweep, run.bench.format(), &kSimulated};
}

const EvaluationResults& evaluated(const SweepResults& sweep) {
  FrequencyResponse points;
  EXPECT_EQ(sweep.copy_to(points), Status::kOk);
  return emax::test::evaluated(points, quick_settings());
}

std::string report_of(const SweepRun& run) {
  const EvaluationResults& evaluation = evaluated(run.sweep);
  const Measurement measurement = measurement_of(run);
  return text_of([&](TextWriter& out) {
    emax::app::write_report(evaluation, {nullptr, &measurement}, out);
  });
}

std::string fault_report_of(const SweepRun& run, const EvaluationResults* refused = nullptr) {
  const Measurement measurement = measurement_of(run);
  return text_of([&](TextWriter& out) {
    emax::app::write_measurement({nullptr, &measurement}, refused, out);
  });
}

JsonReader fault_json_of(const SweepRun& run, const EvaluationResults* refused = nullptr) {
  const Measurement measurement = measurement_of(run);
  return JsonReader(text_of([&](TextWriter& out) {
    emax::app::write_measurement_json({nullptr, &measurement}, refused, out);
  }));
}

/// The lines of the budget: those with ten numbers, perhaps after a star.
std::vector<std::vector<double>> budget_of(const std::string& report) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line.substr(line.compare(0, 2, " *") == 0 ? 2 : 0));
    std::vector<double> row;
    for (double value = 0.0; fields >> value;) {
      row.push_back(value);
    }
    if (fields.eof() && row.size() == 10) {
      rows.push_back(row);
    }
  }
  return rows;
}

double root_sum(double a, double b) { return std::sqrt(a * a + b * b); }

void expect_budget(const std::string& report, const SweepResults& sweep) {
  const std::vector<std::vector<double>> rows = budget_of(report);
  ASSERT_EQ(rows.size(), sweep.points().size());
  const emax::app::CommonBudget& common = sweep.common;
  const double shared = std::sqrt(common.reference * common.reference + common.gain * common.gain +
                                  common.mounting * common.mounting + common.drift * common.drift);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SweepPoint& point = sweep.points()[i];
    const double u = point.point.u_amplitude / point.point.amplitude;
    // To half a unit of the last digit given, and rounding.
    EXPECT_EQ(rows[i][0], point.point.frequency_hz);
    EXPECT_NEAR(rows[i][1], point.point.amplitude, 0.501e-5);
    EXPECT_NEAR(rows[i][2], point.point.phase_rad / kDegree, 0.501e-3);
    EXPECT_NEAR(rows[i][3], 100.0 * point.budget.noise, 0.501e-4);
    EXPECT_NEAR(rows[i][4], 100.0 * point.budget.quantisation, 0.501e-4);
    EXPECT_NEAR(rows[i][5], 100.0 * point.budget.hum, 0.501e-4);
    EXPECT_NEAR(rows[i][6], 100.0 * point.budget.distortion, 0.501e-4);
    EXPECT_NEAR(rows[i][7], 100.0 * point.budget.shared, 0.501e-4);
    EXPECT_NEAR(rows[i][8], 200.0 * root_sum(u, shared), 0.501e-4);
    EXPECT_NEAR(rows[i][9], 2.0 * point.point.u_phase_rad / kDegree, 0.501e-4);
  }
}

TEST(Measurement, Report) {
  const std::string report = report_of(good_run());
  expect_well_formed(report);
  expect_budget(report, good_run().sweep);
  for (const char* words :
       {"measured on the simulated bench", "42 points from 30 Hz to 6000 Hz", "simulated, seed 1",
        "1 m/s^2 peak, never above 20 m/s^2", "never above 5 V and 100000 V/s",
        "0.1 V/(m/s^2), U = 0.5 %", "gain 10 (reference, U = 0 %) and 1 (device, U = 0.1 %)",
        "1.25 us", "42 of 42", "Flagged                   none", "at 160 Hz ", " % drift",
        "reference 0.2500 %, gains 0.0500 %, mounting 0.1000 %, drift 0.", "ISO 16063-21",
        "S = 1.037 V/(m/s^2), f0 = 4073 Hz, beta = 0.3182",
        "both with the part that is common to all points",
        "of every amplitude (standard u), one effect for all points"}) {
    EXPECT_TRUE(says(report, words)) << words;
  }
  EXPECT_LT(report.find("WHAT WAS PUT IN"), report.find("MEASUREMENT ("));
  EXPECT_LT(report.find("MEASUREMENT ("), report.find("\nFIT"));
  EXPECT_FALSE(says(report, "FAULT"));
}

// Crosstalk of 0.5 % and a clock to 1000 ppm, as the fit takes them, are in U of each point. The
// expected parts are by hand: crosstalk u = 0.25 % of either channel's voltage, so 0.0025 g/A of K
// and 0.0025 A/g of 1/K for the gain g = 10/1 * 0.1 of reference over device; the clock moves A by
// u dlnA/dlnf.
TEST(Measurement, BudgetHoldsCrosstalkAndClock) {
  SweepSettings settings = emax::app::default_sweep_settings();
  const auto expanded_at = [](const SweepSettings& wanted, double frequency_hz,
                              std::size_t column) {
    const FinishedRun run(BenchSettings(), wanted);
    for (const std::vector<double>& row : budget_of(report_of(run))) {
      if (row[0] == frequency_hz) {
        return row[column];
      }
    }
    return 0.0;
  };
  constexpr std::size_t kU = 8;
  constexpr std::size_t kUOfPhase = 9;
  const double plain = expanded_at(settings, 30.0, kU);
  settings.crosstalk_expanded_percent = 0.5;
  // At 30 Hz the device is real, K = 1.036 and g = 1: both parts are 0.5 % there.
  EXPECT_NEAR(expanded_at(settings, 30.0, kU), std::sqrt(plain * plain + 0.5 * 0.5 * 2.0), 0.002);
  // At 4 kHz K lags by a right angle nearly: 0.5 % (1.655 and 1/1.655) of a radian, and no more.
  const double turned = 0.5e-2 * std::hypot(1.655, 1.0 / 1.655) / kDegree;
  EXPECT_NEAR(expanded_at(settings, 4000.0, kUOfPhase), turned, 0.01 * turned);
  settings.crosstalk_expanded_percent = 0.0;
  settings.clock_expanded_ppm = 1000.0;
  // dphi/dlnf at the resonance is -1/beta: 1e-3/0.3182 rad.
  EXPECT_NEAR(expanded_at(settings, 4000.0, kUOfPhase), 1e-3 / 0.3182 / kDegree, 0.005);
}

TEST(Measurement, EstimatesAgainstTruth) {
  const std::string report = report_of(good_run());
  const std::size_t at = report.find("the estimates are off by");
  ASSERT_NE(at, std::string::npos);
  double off[3] = {};
  ASSERT_EQ(std::sscanf(report.c_str() + at, "the estimates are off by %lf, %lf and %lf u", &off[0],
                        &off[1], &off[2]),
            3);
  const emax::WlspFit& fit = emax::test::shared_evaluation().fit.result();
  EXPECT_NEAR(off[0], (fit.model.sensitivity - 1.037) / fit.u_sensitivity, 0.0051);
  EXPECT_NEAR(off[1], (fit.model.natural_frequency_hz - 4073.0) / fit.u_natural_frequency_hz,
              0.0051);
  EXPECT_NEAR(off[2], (fit.model.damping - 0.3182) / fit.u_damping, 0.0051);
}

TEST(Measurement, RealBenchHasNoTruth) {
  const SweepRun& run = good_run();
  const EvaluationResults& evaluation = evaluated(run.sweep);
  const Measurement real = {run.sweep, run.bench.format(), nullptr};
  const std::string report = text_of([&](TextWriter& out) {
    emax::app::write_report(evaluation, {nullptr, &real}, out);
  });
  expect_well_formed(report);
  EXPECT_FALSE(says(report, "simulated"));
  EXPECT_FALSE(says(report, "Truth"));
  const JsonReader json(text_of([&](TextWriter& out) {
    emax::app::write_json(evaluation, {nullptr, &real}, out);
  }));
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("bench.seed"), "null");
  EXPECT_EQ(json.at("bench.truth"), "null");
}

TEST(Measurement, Json) {
  const SweepRun& run = good_run();
  const EvaluationResults& evaluation = evaluated(run.sweep);
  const Measurement measurement = measurement_of(run);
  const JsonReader json(text_of([&](TextWriter& out) {
    emax::app::write_json(evaluation, {nullptr, &measurement}, out);
  }));
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("model.source"), "bench");
  EXPECT_EQ(json.at("model.name"), "null");
  EXPECT_EQ(json.at("bench.seed"), "1");
  EXPECT_EQ(json.at("bench.truth.S"), "1.037");
  EXPECT_EQ(json.at("bench.fault"), "null");
  EXPECT_EQ(json.at("bench.points"), "42");
  EXPECT_EQ(json.at("bench.frequencies"), "42");
  EXPECT_EQ(json.at("bench.sample_rate"), "100000");
  EXPECT_EQ(json.at("bench.level"), "1");
  EXPECT_EQ(json.at("bench.acceleration_limit"), "20");
  EXPECT_EQ(json.at("bench.drive_limit"), "5");
  EXPECT_EQ(json.at("bench.slew"), "100000");
  EXPECT_EQ(json.at("bench.reference_percent"), "0.5");
  EXPECT_EQ(json.at("bench.check.frequency"), "160");
  const double before = json.number("bench.check.before");
  const double after = json.number("bench.check.after");
  EXPECT_NEAR(json.number("bench.drift_percent"), 100.0 * (after - before) / before, 1e-9);
  // Rectangular: half the width over the root of 3.
  EXPECT_NEAR(json.number("bench.common.drift"),
              std::fabs(after - before) / before / std::sqrt(3.0), 1e-12);
  EXPECT_EQ(json.at("bench.common.reference"), "0.0025");
  EXPECT_EQ(json.number("bench.common_percent"), 200.0 * run.sweep.common.total);
  EXPECT_EQ(json.number("model.common_percent"), json.number("bench.common_percent"));
  EXPECT_EQ(json.at("bench.flagged[]"), "0");
  EXPECT_EQ(json.at("bench.budget[]"), "42");
  EXPECT_EQ(json.at("bench.budget[41][0]"), "6000");
  EXPECT_EQ(json.number("bench.budget[41][1]"), run.sweep.points()[41].budget.noise);
  EXPECT_EQ(json.number("bench.budget[41][5]"), run.sweep.points()[41].point.u_phase_rad);
  EXPECT_EQ(json.number("bench.budget[41][6]"), run.sweep.points()[41].budget.shared);
  EXPECT_EQ(json.number("bench.shared.drift"), run.sweep.shared.drift);
}

FrequencyResponse table_of(const std::string& text) {
  emax::app::PointsReader reader;
  reader.start();
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    reader.add_line(emax::Span<const char>(line.data(), line.size()));
  }
  EXPECT_EQ(reader.finish().problem, nullptr) << reader.error().line << reader.error().problem;
  return reader.points();
}

TEST(Measurement, TableCanBeReadBack) {
  const SweepResults& sweep = good_run().sweep;
  const EvaluationResults& evaluation = evaluated(sweep);
  const emax::WlspFit fit = evaluation.fit.result();
  FrequencyResponse points = table_of(text_of(
      [&](TextWriter& out) { emax::app::write_frequency_response_csv(evaluation, &sweep, out); }));
  ASSERT_EQ(points.size(), 42U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const emax::ResponsePoint& measured = sweep.points()[i].point;
    const double total = root_sum(measured.u_amplitude, sweep.common.total * measured.amplitude);
    EXPECT_NEAR(points.points()[i].u_amplitude, total, 1e-14 * total);
  }
  ASSERT_EQ(emax::app::remove_common(points, 200.0 * sweep.common.total).status, Status::kOk);
  // The part of its own is a thirtieth of the total, so 15 digits leave 12 of it.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const emax::ResponsePoint& measured = sweep.points()[i].point;
    EXPECT_NEAR(points.points()[i].u_amplitude, measured.u_amplitude, 1e-10 * measured.u_amplitude);
  }
  const emax::WlspFit again = emax::test::evaluated(points, quick_settings()).fit.result();
  EXPECT_NEAR(again.model.sensitivity, fit.model.sensitivity, 1e-10);
  EXPECT_NEAR(again.model.natural_frequency_hz, fit.model.natural_frequency_hz, 1e-7);
  EXPECT_NEAR(again.model.damping, fit.model.damping, 1e-10);
  // What the parameters share in other ways has no column in a table.
  FrequencyResponse own;
  ASSERT_EQ(sweep.copy_to(own), Status::kOk);
  ASSERT_EQ(own.set_shared({}), Status::kOk);
  const emax::WlspFit without = emax::test::evaluated(own, quick_settings()).fit.result();
  EXPECT_NEAR(again.u_sensitivity, without.u_sensitivity, 1e-10);
  EXPECT_LE(without.u_sensitivity, fit.u_sensitivity);
  EXPECT_NEAR(again.chi2, fit.chi2, 1e-6);
}

TEST(Measurement, FaultKeepsThePointsBeforeIt) {
  const FinishedRun run(bench_with(FaultKind::kUnpluggedDevice, 400000));
  const std::size_t count = run.sweep.points().size();
  ASSERT_GT(count, 5U);
  ASSERT_LT(count, 42U);
  const std::string report = fault_report_of(run);
  expect_well_formed(report);
  expect_budget(report, run.sweep);
  EXPECT_TRUE(says(report, "NOT COMPLETE"));
  EXPECT_TRUE(says(report, "no device                 at "));
  EXPECT_TRUE(says(report, "carries no signal beyond its"));
  EXPECT_TRUE(says(report, "not measured after"));
  EXPECT_TRUE(says(report, "drift not known"));
  EXPECT_TRUE(says(report, std::to_string(count) + " of 42"));
  EXPECT_FALSE(says(report, "MAXIMUM ENERGY"));

  const JsonReader json = fault_json_of(run);
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("bench.fault.name"), "no device");
  EXPECT_EQ(json.number("bench.fault.frequency"), run.sweep.failed_frequency_hz);
  EXPECT_EQ(json.at("bench.fault.advice"), emax::explain(Status::kNoDevice));
  EXPECT_EQ(json.at("bench.points"), std::to_string(count));
  EXPECT_EQ(json.at("bench.budget[]"), std::to_string(count));
  EXPECT_EQ(json.at("bench.drift_percent"), "null");
  EXPECT_EQ(json.at("bench.check.after"), "null");
  for (const char* part : {"model", "filter", "energy", "monte_carlo", "trend"}) {
    EXPECT_EQ(json.at(part), "null");
  }

  const std::string text = text_of(
      [&](TextWriter& out) { emax::app::write_measured_points_csv(measurement_of(run), out); });
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,u_common,level_mps2");
  const FrequencyResponse points = table_of(text);
  ASSERT_EQ(points.size(), count);
  EXPECT_EQ(points.points()[3].amplitude, run.sweep.points()[3].point.amplitude);
}

TEST(Measurement, FaultBeforeTheFirstFrequency) {
  const FinishedRun run(bench_with(FaultKind::kLateBlock, 100));
  const std::string report = fault_report_of(run);
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "late block                before the first frequency"));
  EXPECT_TRUE(says(report, "0 of 42"));
  EXPECT_TRUE(says(report, "not measured\n"));
  EXPECT_TRUE(budget_of(report).empty());
  const JsonReader json = fault_json_of(run);
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("bench.fault.frequency"), "null");
  EXPECT_EQ(json.at("bench.budget[]"), "0");
}

TEST(Measurement, PointsThatGiveNoDevice) {
  // A sweep that works does not lead there: other points stand for its own.
  const FrequencyResponse upright = emax::test::synthetic_points(0.0);
  FrequencyResponse points;
  for (emax::ResponsePoint point : upright.points()) {
    point.phase_rad += 180.0 * kDegree;
    ASSERT_EQ(points.add(point), Status::kOk);
  }
  const EvaluationResults& refused = emax::test::evaluated(points, quick_settings());
  ASSERT_EQ(refused.status(), Status::kInvertedPolarity);
  const std::string report = fault_report_of(good_run(), &refused);
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "identification            the points lead to no result"));
  EXPECT_TRUE(says(report, "The sensitivity comes out negative"));
  const JsonReader json = fault_json_of(good_run(), &refused);
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("bench.fault.name"), "identification");
  EXPECT_EQ(json.at("bench.fault.advice"), emax::explain(Status::kInvertedPolarity));
}

TEST(Measurement, DistortedPointsAreNamed) {
  BenchSettings settings;
  settings.second_harmonic = 0.08;
  const FinishedRun run(settings);
  ASSERT_EQ(run.sweep.status, Status::kOk);
  std::size_t flagged = 0;
  for (const SweepPoint& point : run.sweep.points()) {
    flagged += point.flagged ? 1U : 0U;
  }
  ASSERT_GT(flagged, 0U);
  ASSERT_LT(flagged, 42U);
  const std::string report = report_of(run);
  expect_well_formed(report);
  expect_budget(report, run.sweep);
  std::size_t named = 0;
  std::size_t stars = 0;
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    named += says(line, " Hz: distorted, the sine leaves ") ? 1U : 0U;
    named += says(line, " Hz: the repeats differ by more than chance") ? 1U : 0U;
    stars += line.compare(0, 2, " *") == 0 ? 1U : 0U;
  }
  EXPECT_EQ(named, flagged);
  EXPECT_EQ(stars, flagged);
  const JsonReader json = fault_json_of(run);
  EXPECT_EQ(json.at("bench.flagged[]"), std::to_string(flagged));
}

/// The section on the measurement of this run, and results.json, of any evaluation.
std::pair<std::string, std::string> texts_of(const SweepRun& run) {
  static const EvaluationResults& evaluation = evaluated(good_run().sweep);
  const Measurement measurement = measurement_of(run);
  const emax::app::ReportContext context = {nullptr, &measurement};
  return {text_of([&](TextWriter& out) { emax::app::write_report(evaluation, context, out); }),
          text_of([&](TextWriter& out) { emax::app::write_json(evaluation, context, out); })};
}

TEST(Measurement, WhatContradictsIsSaid) {
  constexpr const char* kSheet = "off its data sheet: check gains and reference";
  constexpr const char* kChange = "a gain was switched, or a cable or mounting is loose";
  constexpr const char* kEnded = "a fault has ended the sweep";
  const auto warns = [](const SweepRun& run, const char* words) {
    const auto [report, json] = texts_of(run);
    EXPECT_EQ(says(report, words), says(json, words));
    return says(json, words);
  };
  for (const char* words : {kSheet, kChange, kEnded, "Level reached"}) {
    EXPECT_FALSE(warns(good_run(), words));
  }
  SweepSettings settings = emax::app::default_sweep_settings();
  for (const double factor : {0.5, 2.0}) {
    settings.expected_sensitivity = factor * 1.037;
    EXPECT_TRUE(warns(FinishedRun(BenchSettings(), settings), kSheet));
  }
  // A device whose resonance makes much of the check frequency is on its data sheet.
  BenchSettings low;
  low.device.natural_frequency_hz = 250.0;
  settings = emax::app::default_sweep_settings();
  const FinishedRun near_check(low, settings);
  const emax::Complex check = near_check.sweep.check_before;
  EXPECT_GT(std::hypot(check.re, check.im), 1.2 * settings.expected_sensitivity);
  EXPECT_FALSE(warns(near_check, kSheet));
  EXPECT_TRUE(warns(FinishedRun(bench_with(FaultKind::kGainStep, 300000)), kChange));
  EXPECT_TRUE(warns(FinishedRun(bench_with(FaultKind::kUnpluggedDevice, 500000)), kEnded));
}

// Where hum of 50 mV meets 1 V at 50 Hz it is named, there and nowhere else.
TEST(Measurement, HumAtAFrequencyIsNamed) {
  BenchSettings bench;
  bench.hum_v = 0.05;
  bench.hum_hz = 50.0;
  SweepSettings settings = emax::app::default_sweep_settings();
  settings.frequency_hz = {50.0, 200.0, 1000.0, 2500.0, 4000.0};
  settings.frequency_count = 5;
  const auto [report, json] = texts_of(FinishedRun(bench, settings));
  constexpr const char* kHum = " Hz: leave it out, hum of the mains is in it, u ";
  EXPECT_TRUE(says(report, std::string("  50") + kHum));
  EXPECT_EQ(report.find(kHum), report.rfind(kHum));
  EXPECT_EQ(JsonReader(json).at("bench.flagged[0]"), "50");
}

TEST(Measurement, LevelThatIsNotReachedIsSaid) {
  SweepSettings settings = emax::app::default_sweep_settings();
  settings.level_mps2 = 19.0;
  const FinishedRun run(BenchSettings(), settings);
  const auto [report, text] = texts_of(run);
  const std::size_t at = report.find("Level reached ");
  ASSERT_NE(at, std::string::npos);
  // Half of 10 V over the device's 1.75 V/(m/s^2) at its resonance.
  double least = 0.0;
  ASSERT_EQ(std::sscanf(report.c_str() + at, "Level reached less at 42 points, down to %lf m/s^2",
                        &least),
            1);
  EXPECT_NEAR(least, 5.0 / 1.75, 0.3);
  const JsonReader json(text);
  EXPECT_EQ(json.number("bench.budget[41][7]"), run.sweep.points()[41].acceleration_mps2);
}

TEST(Measurement, EachFaultHasItsName) {
  std::set<std::string> names;
  const Status faults[] = {
      Status::kLostBlock,       Status::kLateBlock,        Status::kHardwareFault,
      Status::kSaturated,       Status::kStuckChannel,     Status::kNoReference,
      Status::kNoDevice,        Status::kWeakSignal,       Status::kLevelNotReached,
      Status::kSwappedChannels, Status::kInvertedPolarity, Status::kDistorted,
      Status::kDcDrift,         Status::kStopped,          Status::kHum,
      Status::kFewSteps};
  for (const Status fault : faults) {
    names.insert(emax::app::name_of_fault(fault));
  }
  EXPECT_EQ(names.size(), sizeof faults / sizeof faults[0]);
  EXPECT_EQ(names.count(emax::app::name_of_fault(Status::kDriveLimit)), 0U);
}

TEST(Measurement, CommonPartOfAPointsTable) {
  FrequencyResponse points = emax::test::table1();
  ASSERT_EQ(emax::app::remove_common(points, 0.5).status, Status::kOk);
  const EvaluationResults& evaluation = emax::test::evaluated(points, quick_settings());
  const std::string report =
      text_of([&](TextWriter& out) { emax::app::write_report(evaluation, {"t.csv"}, out); });
  expect_well_formed(report);
  EXPECT_TRUE(says(report, "0.2500 % of every amplitude"));
  // Weighted least squares with the full covariance matrix, by NumPy.
  const emax::WlspFit& fit = evaluation.fit.result();
  EXPECT_NEAR(fit.model.sensitivity, 1.00645, 0.5e-5);
  EXPECT_NEAR(fit.u_sensitivity, 0.00270, 0.5e-5);
  EXPECT_NEAR(fit.chi2, 8911.7, 0.05);
  // The draws have it too.
  EXPECT_NEAR(std::sqrt(evaluation.fit_draws.covariance[0][0]), fit.u_sensitivity,
              0.03 * fit.u_sensitivity);
  const JsonReader json(
      text_of([&](TextWriter& out) { emax::app::write_json(evaluation, {"t.csv"}, out); }));
  ASSERT_TRUE(json.valid());
  EXPECT_NEAR(json.number("model.common_percent"), 0.5, 1e-15);
  EXPECT_EQ(json.at("bench"), "null");
  // The table comes out as it went in: totals.
  const FrequencyResponse again = table_of(text_of(
      [&](TextWriter& out) { emax::app::write_frequency_response_csv(evaluation, nullptr, out); }));
  const FrequencyResponse before = emax::test::table1();
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(again.points()[i].u_amplitude, before.points()[i].u_amplitude);
  }
}

}  // namespace
