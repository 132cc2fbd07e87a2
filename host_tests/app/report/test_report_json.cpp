// results.json: valid whatever is in it, and the same numbers as the evaluation.
#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "emax/app/report/report.hpp"

#include "support/evaluations.hpp"
#include "support/json_reader.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::Criterion;
using emax::Method;
using emax::MonteCarloResult;
using emax::app::EvaluationResults;
using emax::app::GainMode;
using emax::app::Settings;
using emax::app::TextWriter;
using emax::test::evaluated;
using emax::test::JsonReader;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::table1;
using emax::test::text_of;

JsonReader json_of(const EvaluationResults& evaluation, const char* name = nullptr) {
  return JsonReader(
      text_of([&](TextWriter& out) { emax::app::write_json(evaluation, {name}, out); }));
}

TEST(JsonReader, SeesWhatIsWrong) {
  EXPECT_TRUE(JsonReader(R"({"a": [1, -2.5e-05, null], "b": {}})").valid());
  for (const char* text : {"", "{", "{}}", R"({"a" 1})", R"({"a": 01})", R"({"a": nan})", "[1,]",
                           R"({"a": 1, "a": 2})", "[1 2]", R"(["\x"])", "[.5]", "[5.]"}) {
    EXPECT_FALSE(JsonReader(text).valid()) << text;
  }
}

TEST(ReportJson, Table2) {
  Settings settings = quick_settings();
  settings.trend_count = 2;
  const EvaluationResults& evaluation = evaluated(kTable2, settings);
  const JsonReader json = json_of(evaluation);
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("version"), "0.1.0");
  EXPECT_EQ(json.at("model.S"), "1.037");
  EXPECT_EQ(json.at("model.f0"), "4073");
  EXPECT_EQ(json.at("model.beta"), "0.3182");
  EXPECT_EQ(json.at("model.uS"), "0.003");
  EXPECT_EQ(json.at("model.uf0"), "6");
  EXPECT_EQ(json.at("model.ubeta"), "0.0004");
  EXPECT_EQ(json.at("model.covariance[]"), "3");
  EXPECT_EQ(json.number("model.covariance[0][0]"), 0.003 * 0.003);
  EXPECT_EQ(json.number("model.covariance[1][1]"), 36.0);
  EXPECT_EQ(json.number("model.covariance[2][2]"), 0.0004 * 0.0004);
  EXPECT_EQ(json.at("model.covariance[0][2]"), "0");
  EXPECT_EQ(json.at("model.chi2"), "null");
  EXPECT_EQ(json.at("model.dof"), "null");
  EXPECT_EQ(json.at("model.source"), "model");
  EXPECT_EQ(json.at("model.name"), "null");
  EXPECT_EQ(json.at("filter.order"), "10");
  EXPECT_EQ(json.at("filter.cutoff"), "1000");
  EXPECT_EQ(json.at("filter.gain"), "1.037");
  EXPECT_NEAR(json.number("impulse_response.peak"), 17462.4, 0.05);
  EXPECT_NEAR(json.number("impulse_response.peak_time_s"), 51.4e-6, 0.05e-6);
  EXPECT_NEAR(json.number("impulse_response.settling_time_s"), 1.453582e-3, 0.5e-9);
  EXPECT_EQ(json.at("energy.criterion"), "ise");
  EXPECT_EQ(json.at("energy.method"), "best");
  EXPECT_EQ(json.at("energy.T"), "0.002");
  EXPECT_EQ(json.at("energy.a"), "1.037");
  EXPECT_EQ(json.number("energy.E"), evaluation.energy_v2s());
  EXPECT_EQ(json.number("energy.xi"), evaluation.xi());
  EXPECT_EQ(json.number("energy.rms"), evaluation.rms_error_v());
  // Above the largest energy known, and no worse than the relaxation has been seen to get.
  EXPECT_GT(json.number("energy.bound"), 0.005115251359876);
  EXPECT_LE(json.number("energy.bound"), 0.00586);
  // a times the integral of |k|; five digits are known.
  EXPECT_NEAR(json.number("energy.absolute_error"), 3.7149, 0.5e-4);
  EXPECT_EQ(json.at("energy.switch_times[]"), "1");
  EXPECT_EQ(json.number("energy.switch_times[0]"), evaluation.maximum.signal.times_s()[0]);
  const MonteCarloResult result = evaluation.trials.result;
  EXPECT_EQ(json.at("monte_carlo.trials"), "1000");
  EXPECT_EQ(json.at("monte_carlo.probability"), "0.95");
  EXPECT_EQ(json.at("monte_carlo.seed[]"), "4");
  EXPECT_EQ(json.at("monte_carlo.seed[3]"), "789012345");
  EXPECT_EQ(json.number("monte_carlo.E_max"), result.maximum);
  EXPECT_EQ(json.number("monte_carlo.at.S"), evaluation.device_at_maximum.sensitivity);
  EXPECT_EQ(json.number("monte_carlo.at.f0"), evaluation.device_at_maximum.natural_frequency_hz);
  EXPECT_EQ(json.number("monte_carlo.at.beta"), evaluation.device_at_maximum.damping);
  EXPECT_EQ(json.at("monte_carlo.trial"), std::to_string(result.trial_of_maximum));
  EXPECT_EQ(json.number("monte_carlo.mean"), result.mean);
  EXPECT_EQ(json.number("monte_carlo.u"), result.u);
  EXPECT_EQ(json.number("monte_carlo.interval[0]"), result.symmetric.low);
  EXPECT_EQ(json.number("monte_carlo.interval[1]"), result.symmetric.high);
  EXPECT_EQ(json.number("monte_carlo.shortest[0]"), result.shortest.low);
  EXPECT_EQ(json.number("monte_carlo.shortest[1]"), result.shortest.high);
  EXPECT_EQ(json.at("monte_carlo.disagreements"), "0");
  EXPECT_EQ(json.at("trend.points[]"), "2");
  EXPECT_EQ(json.at("trend.points[1][0]"), "0.004");
  // Two points: the line goes through both.
  const double slope =
      (json.number("trend.points[1][1]") - json.number("trend.points[0][1]")) / 0.002;
  EXPECT_NEAR(json.number("trend.slope"), slope, 1e-12 * slope);
  EXPECT_NEAR(json.number("trend.intercept"), json.number("trend.points[0][1]") - 0.002 * slope,
              1e-15);
}

TEST(ReportJson, Table1) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  const JsonReader json = json_of(evaluation, "djb.csv");
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("model.source"), "points");
  EXPECT_EQ(json.at("model.name"), "djb.csv");
  EXPECT_NEAR(json.number("model.chi2"), 8595.0, 0.5);
  EXPECT_EQ(json.at("model.dof"), "81");
  EXPECT_NEAR(std::sqrt(json.number("model.covariance[1][1]")), 2.85, 0.5e-2);
  EXPECT_EQ(json.number("model.covariance[1][2]"), json.number("model.covariance[2][1]"));
  EXPECT_EQ(json.at("trend"), "null");
}

TEST(ReportJson, NoMonteCarloAndNoSwitch) {
  Settings settings = quick_settings();
  settings.method = Method::kPaper;
  settings.step_s = 0.002;
  const JsonReader json = json_of(evaluated({kTable2.estimate, {}}, settings));
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("monte_carlo"), "null");
  EXPECT_EQ(json.at("energy.method"), "paper");
  EXPECT_EQ(json.at("energy.switch_times[]"), "0");
  // One cell is x = +a.
  EXPECT_NEAR(json.number("energy.E"), 0.00110693771864, 1e-14);
}

TEST(ReportJson, EnergyDifferenceBelowZero) {
  const JsonReader json =
      json_of(evaluated({kTable2.estimate, {}}, emax::test::settings_below_zero()));
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("energy.criterion"), "difference");
  EXPECT_LT(json.number("energy.E"), 0.0);
  EXPECT_EQ(json.at("energy.rms"), "null");
}

TEST(ReportJson, NamesThatNeedEscaping) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  for (const std::string name : {"a\"b\\c\".csv", "tab\tline\nend\x1f\x7f", "", "/x/{}[],:"}) {
    const JsonReader json = json_of(evaluation, name.c_str());
    EXPECT_TRUE(json.valid()) << name;
    EXPECT_EQ(json.at("model.name"), name);
  }
}

TEST(ReportJson, LabelsOnlyWhereThereAreAny) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  EXPECT_EQ(json_of(evaluation).at("labels.device"), "nothing at labels.device");
  emax::app::ReportContext context;
  context.labels.serial = "17";
  context.labels.operated_by = "\"J. Doe\"\\\n";
  const JsonReader json(
      text_of([&](TextWriter& out) { emax::app::write_json(evaluation, context, out); }));
  ASSERT_TRUE(json.valid());
  EXPECT_EQ(json.at("labels.device"), "null");
  EXPECT_EQ(json.at("labels.serial"), "17");
  EXPECT_EQ(json.at("labels.operator"), "\"J. Doe\"\\\n");
  EXPECT_EQ(json.at("labels.date"), "null");
  EXPECT_EQ(json.at("labels.note"), "null");
}

TEST(ReportJson, LabelsAreCharacters) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  emax::app::ReportContext context;
  context.labels.note = "\xC3\xA9 \xE2\x82\xAC \xF0\x9D\x84\x9E \xFF";
  const std::string json =
      text_of([&](TextWriter& out) { emax::app::write_json(evaluation, context, out); });
  ASSERT_TRUE(JsonReader(json).valid());
  // The example of RFC 8259, section 7, for what takes a surrogate pair is U+1D11E.
  EXPECT_NE(json.find(R"("note": "\u00e9 \u20ac \ud834\udd1e \ufffd")"), std::string::npos);
  // Names of files, too.
  context.source_name = "\xC3\xA9\xFF.csv";
  const std::string named =
      text_of([&](TextWriter& out) { emax::app::write_json(evaluation, context, out); });
  EXPECT_NE(named.find(R"("name": "\u00e9\ufffd.csv")"), std::string::npos);
}

}  // namespace
