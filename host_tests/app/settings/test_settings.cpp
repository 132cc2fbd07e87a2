// Every setting at the ends of its range and just beyond them.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "emax/app/settings/settings.hpp"

namespace {

using emax::Generator;
using emax::Method;
using emax::app::check;
using emax::app::GainMode;
using emax::app::Settings;
using emax::app::SettingsError;

using Change = std::function<void(Settings&)>;

SettingsError check_with(const Change& change) {
  Settings settings = emax::app::kDefaultSettings;
  change(settings);
  return check(settings);
}

void expect_accepted(const char* what, const Change& change) {
  const SettingsError error = check_with(change);
  EXPECT_EQ(error.setting, nullptr) << what << ": " << error.setting << " " << error.expectation;
}

/// The error names the option, and the words name the range.
void expect_refused(const char* option, const char* words, const Change& change) {
  const SettingsError error = check_with(change);
  ASSERT_NE(error.setting, nullptr) << option;
  ASSERT_NE(error.expectation, nullptr) << option;
  EXPECT_STREQ(error.setting, option);
  EXPECT_NE(std::string(error.expectation).find(words), std::string::npos)
      << option << ": " << error.expectation;
}

const double kNan = std::nan("");
const double kInfinity = std::numeric_limits<double>::infinity();

TEST(Settings, DefaultsAreAccepted) {
  const SettingsError error = check(emax::app::kDefaultSettings);
  EXPECT_EQ(error.setting, nullptr);
  EXPECT_EQ(error.expectation, nullptr);
}

TEST(Settings, Order) {
  expect_accepted("1", [](Settings& s) { s.filter_order = 1; });
  expect_accepted("15", [](Settings& s) { s.filter_order = 15; });
  for (const int order : {-1, 0, 16, std::numeric_limits<int>::max()}) {
    expect_refused("order", "1 to 15", [order](Settings& s) { s.filter_order = order; });
  }
}

TEST(Settings, Cutoff) {
  expect_accepted("1 mHz", [](Settings& s) { s.cutoff_hz = 1e-3; });
  expect_accepted("1 GHz", [](Settings& s) { s.cutoff_hz = 1e9; });
  for (const double cutoff : {-1000.0, 0.0, 0.99e-3, 1.01e9, kNan, kInfinity}) {
    expect_refused("cutoff", "Hz", [cutoff](Settings& s) { s.cutoff_hz = cutoff; });
  }
}

TEST(Settings, Gain) {
  const auto fixed = [](double gain) {
    return [gain](Settings& s) {
      s.gain_mode = GainMode::kFixed;
      s.gain = gain;
    };
  };
  expect_accepted("0", fixed(0.0));
  expect_accepted("1e9", fixed(1e9));
  for (const double gain : {-1e-9, 1.01e9, kNan, kInfinity}) {
    expect_refused("gain", "V/(m/s^2)", fixed(gain));
  }
  expect_accepted("not used", [](Settings& s) { s.gain = -1.0; });
}

TEST(Settings, Time) {
  expect_accepted("1000 s", [](Settings& s) { s.duration_s = 1000.0; });
  expect_accepted("tiny", [](Settings& s) { s.duration_s = 1e-9; });
  for (const double time : {-0.002, 0.0, 1000.1, kNan, kInfinity}) {
    expect_refused("time", "at most 1000 s", [time](Settings& s) { s.duration_s = time; });
  }
}

TEST(Settings, Limit) {
  const auto given = [](double limit) {
    return [limit](Settings& s) {
      s.limit_is_auto = false;
      s.limit_mps2 = limit;
    };
  };
  expect_accepted("9.81", given(9.81));
  for (const double limit : {-1.0, 0.0, 1.01e9, kNan, kInfinity}) {
    expect_refused("limit", "m/s^2", given(limit));
  }
  expect_accepted("not used", [](Settings& s) { s.limit_mps2 = -1.0; });
}

TEST(Settings, Step) {
  for (const double step : {-2e-6, 0.0, kNan, kInfinity}) {
    expect_refused("step", "more than 0", [step](Settings& s) { s.step_s = step; });
  }
  expect_refused("step", "T", [](Settings& s) {
    s.method = Method::kPaper;
    s.step_s = 0.0021;
  });
  expect_accepted("as long as T", [](Settings& s) {
    s.method = Method::kPaper;
    s.step_s = 0.002;
  });
  expect_accepted("not used by best", [](Settings& s) { s.step_s = 0.1; });
  expect_refused("trend", "step", [](Settings& s) {
    s.method = Method::kPaper;
    s.duration_s = 0.01;
    s.step_s = 0.003;
  });
}

TEST(Settings, Iterations) {
  expect_accepted("1", [](Settings& s) { s.iterations = 1; });
  expect_accepted("1000", [](Settings& s) { s.iterations = 1000; });
  for (const std::uint32_t iterations : {0U, 1001U, 4294967295U}) {
    expect_refused("iterations", "1 to 1000",
                   [iterations](Settings& s) { s.iterations = iterations; });
  }
}

TEST(Settings, Trials) {
  expect_accepted("1000", [](Settings& s) { s.trials = 1000; });
  expect_accepted("1e9", [](Settings& s) { s.trials = 1000000000; });
  for (const std::uint32_t trials : {0U, 999U, 1000000001U}) {
    expect_refused("trials", "1000", [trials](Settings& s) { s.trials = trials; });
  }
}

TEST(Settings, Probability) {
  expect_accepted("0.5", [](Settings& s) { s.probability = 0.5; });
  expect_accepted("0.999", [](Settings& s) { s.probability = 0.999; });
  for (const double p : {-0.1, 0.0, 1.0, 95.0, kNan, kInfinity}) {
    expect_refused("probability", "less than 1", [p](Settings& s) { s.probability = p; });
  }
}

TEST(Settings, ProbabilityAndTrialsTogether) {
  // q = pM, rounded: 999 of 1000 is an interval, 1000 of 1000 is none; nor is 0 of 1000.
  expect_accepted("999", [](Settings& s) {
    s.trials = 1000;
    s.probability = 0.9994;
  });
  expect_refused("trials", "more", [](Settings& s) {
    s.trials = 1000;
    s.probability = 0.9996;
  });
  expect_refused("probability", "larger", [](Settings& s) {
    s.trials = 1000;
    s.probability = 0.0004;
  });
  const auto adaptive = [](double p) {
    return [p](Settings& s) {
      s.adaptive = true;
      s.probability = p;
    };
  };
  expect_accepted("0.99999", adaptive(0.99999));
  expect_refused("probability", "0.99999", adaptive(0.999999));
  expect_refused("probability", "larger", adaptive(0.00004));
}

TEST(Settings, SeedOf2006) {
  constexpr std::uint32_t kModuli[] = {2147483579, 2147483543, 2147483423, 2147483123};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto with = [i](std::uint32_t seed) {
      return [i, seed](Settings& s) { s.seed[i] = seed; };
    };
    expect_accepted("1", with(1));
    expect_accepted("m - 1", with(kModuli[i] - 1));
    expect_refused("seed", "from 1 to", with(0));
    expect_refused("seed", "from 1 to", with(kModuli[i]));
  }
}

TEST(Settings, SeedOf1982) {
  const auto with = [](std::uint32_t seed) {
    return [seed](Settings& s) {
      s.generator = Generator::k1982;
      s.seed[1] = seed;
    };
  };
  expect_accepted("beyond the moduli", with(4294967295U));
  expect_refused("seed", "from 1 to", with(0));
}

TEST(Settings, Trend) {
  expect_accepted("none", [](Settings& s) { s.trend_count = 0; });
  expect_accepted("two", [](Settings& s) { s.trend_count = 2; });
  expect_accepted("sixteen", [](Settings& s) {
    s.trend_count = 16;
    for (std::size_t i = 0; i < 16; ++i) {
      s.trend_s[i] = 0.001 * static_cast<double>(i + 1);
    }
  });
  expect_refused("trend", "2 to 16", [](Settings& s) { s.trend_count = 1; });
  expect_refused("trend", "2 to 16", [](Settings& s) { s.trend_count = 17; });
  for (const double time : {0.004, 0.003, -1.0, 0.0, 1000.1, kNan, kInfinity}) {
    expect_refused("trend", "each more than the one before",
                   [time](Settings& s) { s.trend_s[2] = time; });
  }
  expect_refused("trend", "more than 0", [](Settings& s) { s.trend_s[0] = 0.0; });
}

}  // namespace
