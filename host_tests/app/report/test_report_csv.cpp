// The five tables: their columns, and numbers that other programs would find in them.
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "emax/app/report/report.hpp"

#include "support/evaluations.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::app::Device;
using emax::app::EvaluationResults;
using emax::app::Settings;
using emax::app::TextWriter;
using emax::test::evaluated;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::table1;
using emax::test::text_of;

struct Table {
  std::string header;
  std::vector<std::vector<double>> rows;
  std::vector<std::vector<std::string>> cells;
};

Table table_of(void (*write)(const EvaluationResults&, TextWriter&) noexcept,
               const EvaluationResults& evaluation) {
  std::istringstream text(text_of([&](TextWriter& out) { write(evaluation, out); }));
  Table table;
  std::getline(text, table.header);
  for (std::string line; std::getline(text, line);) {
    std::vector<double> numbers;
    std::vector<std::string> cells;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      char* end = nullptr;
      numbers.push_back(std::strtod(field.c_str(), &end));
      EXPECT_EQ(*end, '\0') << line;
      cells.push_back(field);
    }
    table.rows.push_back(numbers);
    table.cells.push_back(cells);
  }
  return table;
}

void write_points(const EvaluationResults& results, TextWriter& out) noexcept {
  emax::app::write_frequency_response_csv(results, nullptr, out);
}

void expect_columns(const Table& table, std::size_t columns) {
  for (const std::vector<double>& row : table.rows) {
    ASSERT_EQ(row.size(), columns);
  }
}

TEST(ReportCsv, FrequencyResponse) {
  const EvaluationResults& evaluation = evaluated(table1(), quick_settings());
  const Table table = table_of(write_points, evaluation);
  EXPECT_EQ(table.header,
            "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,model_amplitude,model_phase_deg,"
            "residual_re,residual_im");
  ASSERT_EQ(table.rows.size(), 42U);
  expect_columns(table, 9);
  // The measured columns are those of the table that was read.
  const auto measured = emax::test::table1_numbers();
  double chi2 = 0.0;
  for (std::size_t n = 0; n < table.rows.size(); ++n) {
    const std::vector<double>& row = table.rows[n];
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(row[i], measured[n][i]) << n;
    }
    const std::complex<double> ratio(0.0, row[0] / 4057.25);
    const std::complex<double> model = 1.00791 / (ratio * ratio + 2.0 * 0.24618 * ratio + 1.0);
    EXPECT_NEAR(row[5], std::abs(model), 1e-4);  // Parameters rounded to 1e-5.
    EXPECT_NEAR(row[6], std::arg(model) * 180.0 / 3.14159265358979323846, 1e-3);
    chi2 += row[7] * row[7] + row[8] * row[8];
  }
  EXPECT_NEAR(chi2, 8595.0, 0.5);
}

TEST(ReportCsv, NoPointsNoFrequencyResponse) {
  const Table table = table_of(write_points, evaluated(kTable2, quick_settings()));
  EXPECT_EQ(table.header.substr(0, 5), "f_hz,");
  EXPECT_TRUE(table.rows.empty());
}

TEST(ReportCsv, ImpulseResponse) {
  const EvaluationResults& evaluation = evaluated({kTable2.estimate, {}}, quick_settings());
  const Table table = table_of(emax::app::write_impulse_response_csv, evaluation);
  EXPECT_EQ(table.header, "t_s,k,ka,kf");
  ASSERT_EQ(table.rows.size(), 1001U);
  expect_columns(table, 4);
  EXPECT_EQ(table.rows.back()[0], 0.002);
  // Rows are 2 us apart.
  const double expected[][2] = {{10, 6199.1624},    {50, 17451.1509},    {100, 8133.60891},
                                {500, -259.559968}, {1000, -1744.33268}, {2000, 424.175752}};
  for (const auto& point : expected) {
    const std::vector<double>& row = table.rows[static_cast<std::size_t>(point[0] / 2)];
    EXPECT_NEAR(row[0], point[0] * 1e-6, 1e-15);
    // Nine digits are given.
    EXPECT_NEAR(row[1], point[1], 1e-8 * std::abs(point[1]));
    EXPECT_NEAR(row[2] - row[3], row[1], 1e-8);
  }
}

TEST(ReportCsv, ImpulseResponseGoesOnUntilItSettles) {
  Settings settings = quick_settings();
  settings.duration_s = 0.001;
  const Table table =
      table_of(emax::app::write_impulse_response_csv, evaluated({kTable2.estimate, {}}, settings));
  EXPECT_NEAR(table.rows.back()[0], 1.453582e-3, 0.5e-9);
}

void expect_signal(const EvaluationResults& evaluation, std::size_t switches) {
  const Table table = table_of(emax::app::write_signal_csv, evaluation);
  EXPECT_EQ(table.header, "t_s,x_mps2,y_v");
  expect_columns(table, 3);
  const double limit = evaluation.limit_mps2;
  double integral = 0.0;
  double largest = 0.0;
  std::size_t changes = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::vector<double>& row = table.rows[i];
    ASSERT_EQ(std::abs(row[1]), limit);
    largest = std::fmax(largest, std::abs(row[2]));
    if (i == 0) {
      continue;
    }
    const std::vector<double>& before = table.rows[i - 1];
    ASSERT_GE(row[0], before[0]);
    if (row[1] != before[1]) {
      ++changes;
      EXPECT_EQ(row[0], before[0]);
      EXPECT_EQ(row[2], before[2]);
    } else {
      ASSERT_GT(row[0], before[0]);
    }
    integral += 0.5 * (row[0] - before[0]) * (row[2] * row[2] + before[2] * before[2]);
  }
  EXPECT_EQ(changes, switches);
  EXPECT_EQ(table.rows.front()[0], 0.0);
  EXPECT_EQ(table.rows.front()[1], limit);
  EXPECT_EQ(table.rows.front()[2], 0.0);
  EXPECT_EQ(table.rows.back()[0], evaluation.settings.duration_s);
  // Trapezoids of 1/250 period or less: (2 pi/250)^2/6 = 1e-4 at most, and E holds lower ones too.
  EXPECT_NEAR(integral, evaluation.energy_v2s(), 1e-4 * integral);
  EXPECT_GT(largest, 0.0);
}

TEST(ReportCsv, SignalOnGridPoints) {
  // The switches of the paper's method at 2 us fall on rows at 1 us: two rows for each, no third.
  Settings settings = quick_settings();
  settings.method = emax::Method::kPaper;
  const EvaluationResults& evaluation = evaluated({kTable2.estimate, {}}, settings);
  expect_signal(evaluation, 4);
}

TEST(ReportCsv, SignalBetweenGridPoints) {
  Settings settings = quick_settings();
  settings.limit_is_auto = false;
  settings.limit_mps2 = 9.81;
  expect_signal(evaluated({kTable2.estimate, {}}, settings), 1);
}

TEST(ReportCsv, SignalHasRowsForEachOscillation) {
  // 204 periods of the resonance; or 160 of the cutoff, where that is faster.
  for (const double cutoff_hz : {1000.0, 8000.0}) {
    Settings settings = quick_settings();
    settings.method = emax::Method::kPaper;
    settings.iterations = 1;
    settings.step_s = 2e-5;
    settings.duration_s = cutoff_hz > 4073.0 ? 0.02 : 0.05;
    settings.cutoff_hz = cutoff_hz;
    const Table table =
        table_of(emax::app::write_signal_csv, evaluated({kTable2.estimate, {}}, settings));
    EXPECT_EQ(table.rows.back()[0], settings.duration_s);
    const double period_s = 1.0 / std::fmax(4073.0, cutoff_hz);
    for (std::size_t i = 1; i < table.rows.size(); ++i) {
      ASSERT_LT(table.rows[i][0] - table.rows[i - 1][0], period_s / 19.0) << i;
    }
  }
}

TEST(ReportCsv, Trend) {
  Settings settings = quick_settings();
  settings.trend_count = 3;
  const EvaluationResults& evaluation = evaluated({kTable2.estimate, {}}, settings);
  const Table table = table_of(emax::app::write_trend_csv, evaluation);
  EXPECT_EQ(table.header, "T_s,E,fit");
  ASSERT_EQ(table.rows.size(), 3U);
  expect_columns(table, 3);
  EXPECT_EQ(table.rows[0][0], 0.002);
  EXPECT_EQ(table.rows[0][1], evaluation.energy_v2s());
  // Residuals of a regression line add up to nothing.
  double sum = 0.0;
  for (const std::vector<double>& row : table.rows) {
    sum += row[1] - row[2];
  }
  EXPECT_NEAR(sum, 0.0, 1e-15);
  EXPECT_TRUE(
      table_of(emax::app::write_trend_csv, evaluated(kTable2, quick_settings())).rows.empty());
}

TEST(ReportCsv, Histogram) {
  Settings settings = quick_settings();
  settings.trials = 5000;
  const EvaluationResults& evaluation = evaluated(kTable2, settings);
  const Table table = table_of(emax::app::write_histogram_csv, evaluation);
  EXPECT_EQ(table.header, "E_low,E_high,count");
  ASSERT_EQ(table.rows.size(), 64U);
  expect_columns(table, 3);
  const emax::MonteCarloResult result = evaluation.trials.result;
  EXPECT_EQ(table.rows.front()[0], result.minimum);
  EXPECT_EQ(table.rows.back()[1], result.maximum);
  double sum = 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_LT(table.rows[i][0], table.rows[i][1]);
    EXPECT_TRUE(i == 0 || table.cells[i][0] == table.cells[i - 1][1]);
    sum += table.rows[i][2];
    moment += table.rows[i][2] * 0.5 * (table.rows[i][0] + table.rows[i][1]);
  }
  EXPECT_EQ(sum, 5000.0);
  EXPECT_NEAR(moment / sum, result.mean, (result.maximum - result.minimum) / 64);
  EXPECT_TRUE(
      table_of(emax::app::write_histogram_csv, evaluated({kTable2.estimate, {}}, quick_settings()))
          .rows.empty());
}

TEST(ReportCsv, HistogramOfEqualEnergies) {
  // Beyond double: the smallest uncertainty there is moves no trial.
  Device device = {kTable2.estimate, {}};
  device.u.sensitivity = 1e-300;
  const EvaluationResults& evaluation = evaluated(device, quick_settings());
  ASSERT_TRUE(evaluation.has_monte_carlo);
  const Table table = table_of(emax::app::write_histogram_csv, evaluation);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0][0], table.rows[0][1]);
  EXPECT_EQ(table.rows[0][2], 1000.0);
}

}  // namespace
