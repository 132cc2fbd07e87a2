// The paper's Table 1, as all tests read it.
#pragma once

#include <array>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"

namespace emax::test {

/// The file as it is.
inline std::string table1_text() {
  std::ifstream file(EMAX_TEST_DATA_DIR "/djb_a1800v.csv");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The 42 lines below its header.
inline std::vector<std::string> table1_lines() {
  std::istringstream text(table1_text());
  std::vector<std::string> lines;
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    lines.push_back(line);
  }
  EXPECT_EQ(lines.size(), 42U);
  return lines;
}

/// Its numbers, as the C library reads them: Hz, V/(m/s^2), degrees, and the expanded uncertainties
/// (k = 2) of the last two.
inline std::vector<std::array<double, 5>> table1_numbers() {
  std::vector<std::array<double, 5>> rows;
  for (const std::string& line : table1_lines()) {
    std::array<double, 5> row = {};
    EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &row[0], &row[1], &row[2], &row[3],
                          &row[4]),
              5)
        << line;
    rows.push_back(row);
  }
  return rows;
}

/// Its points, in radians and with standard uncertainties.
inline FrequencyResponse table1() {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  FrequencyResponse response;
  for (const std::array<double, 5>& row : table1_numbers()) {
    const Status status =
        response.add({row[0], row[1], row[2] * kDegree, 0.5 * row[3], row[4] * (0.5 * kDegree)});
    EXPECT_EQ(status, Status::kOk) << row[0];
  }
  return response;
}

/// A fit of it outside this code, to half a unit of the last digit given.
inline void expect_fit_of_table1(const WlspFit& fit) {
  EXPECT_NEAR(fit.model.sensitivity, 1.00791, 0.5e-5);
  EXPECT_NEAR(fit.model.natural_frequency_hz, 4057.25, 0.5e-2);
  EXPECT_NEAR(fit.model.damping, 0.24618, 0.5e-5);
  EXPECT_NEAR(fit.u_sensitivity, 0.00113, 0.5e-5);
  EXPECT_NEAR(fit.u_natural_frequency_hz, 2.85, 0.5e-2);
  EXPECT_NEAR(fit.u_damping, 0.00088, 0.5e-5);
  EXPECT_NEAR(fit.chi2, 8595.0, 0.5);
  EXPECT_EQ(fit.dof, 81U);
}

}  // namespace emax::test
