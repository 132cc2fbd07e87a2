// What every report has in common, whatever it says.
#pragma once

#include <gtest/gtest.h>
#include <sstream>
#include <string>

namespace emax::test {

inline bool says(const std::string& report, const std::string& words) {
  return report.find(words) != std::string::npos;
}

/// Plain ASCII in lines of at most 100 characters without blanks at their ends, and no number that
/// is none.
inline void expect_well_formed(const std::string& report) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 100U) << line;
    EXPECT_TRUE(line.empty() || line.back() != ' ') << "'" << line << "'";
    for (const char character : line) {
      EXPECT_TRUE(character >= ' ' && character <= '~') << line;
    }
  }
  EXPECT_EQ(report.back(), '\n');
  EXPECT_FALSE(says(report, " nan"));
  EXPECT_FALSE(says(report, " inf"));
}

}  // namespace emax::test
