// The engine against sorting, against the examples of JCGM 101 clause 9, and the adaptive rule
// against its own text.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "emax/base/distributions.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/uncertainty/monte_carlo.hpp"

namespace {

using emax::AdaptiveResult;
using emax::AdaptiveTrials;
using emax::MonteCarlo;
using emax::MonteCarloResult;
using emax::MonteCarloStore;
using emax::Span;
using emax::Status;
using emax::WichmannHill;

constexpr std::array<std::uint32_t, 4> kSeeds = {123456789, 345678901, 567890123, 789012345};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Draws {
 public:
  explicit Draws(std::uint64_t offset = 0) {
    EXPECT_EQ(generator_.seed(emax::Generator::k2006, kSeeds), Status::kOk);
    generator_.jump(offset);
  }
  double uniform() { return generator_.next(); }
  double normal() {
    const double u1 = generator_.next();
    const double u2 = generator_.next();
    return emax::box_muller(u1, u2).first;
  }

 private:
  WichmannHill generator_;
};

template <typename Function>
std::vector<double> values_of(std::size_t count, Function draw) {
  Draws draws;
  std::vector<double> values(count);
  for (double& value : values) {
    value = draw(draws);
  }
  return values;
}

/// The procedure with its memory.
struct Engine {
  Status start(std::uint32_t trials, double probability) {
    return procedure.start(trials, probability, store);
  }
  void add(double value) { procedure.add(value, store); }
  bool done() const { return procedure.done(); }
  double progress() const { return procedure.progress(); }
  std::uint32_t pass() const { return procedure.pass(); }
  std::uint32_t next_trial() const { return procedure.next_trial(); }
  MonteCarloResult result() const { return procedure.result(); }
  Span<const std::uint32_t> histogram() const { return procedure.histogram(store); }

  MonteCarlo procedure{};
  MonteCarloStore store{};
};

MonteCarloResult run(Engine& engine, const std::vector<double>& values, double probability) {
  EXPECT_EQ(engine.start(static_cast<std::uint32_t>(values.size()), probability), Status::kOk);
  double progress = 0.0;
  while (!engine.done()) {
    EXPECT_GE(engine.progress(), progress);
    progress = engine.progress();
    engine.add(values[engine.next_trial()]);
  }
  EXPECT_EQ(engine.progress(), 1.0);
  return engine.result();
}

struct Case {
  std::string name;
  std::vector<double> values;
  bool smooth;
};

std::vector<Case> cases(std::size_t count) {
  const auto make = [count](const char* name, auto draw, bool smooth) {
    return Case{name + std::string(" ") + std::to_string(count), values_of(count, draw), smooth};
  };
  std::vector<Case> all;
  all.push_back(make(
      "normal", [](Draws& d) { return d.normal(); }, true));
  all.push_back(make(
      "far", [](Draws& d) { return 5e-3 + 1e-9 * d.normal(); }, true));
  all.push_back(make(
      "uniform", [](Draws& d) { return d.uniform(); }, true));
  all.push_back(make(
      "exponential", [](Draws& d) { return -std::log(1.0 - d.uniform()); }, true));
  all.push_back(make(
      "falling", [](Draws& d) { return std::log(1.0 - d.uniform()); }, true));
  all.push_back(make(
      "arcsine", [](Draws& d) { return std::sin(6.28 * d.uniform()); }, true));
  all.push_back(make(
      "cauchy", [](Draws& d) { return std::tan(3.14159 * (d.uniform() - 0.5)); }, false));
  all.push_back(make(
      "huge range", [](Draws& d) { return std::exp(60.0 * d.normal()); }, false));
  all.push_back(make(
      "both signs",
      [](Draws& d) {
        const double z = d.normal();
        return z * std::exp(30.0 * d.normal());
      },
      false));
  all.push_back(make(
      "lattice", [](Draws& d) { return std::floor(10.0 * d.uniform()) / 7.0; }, false));
  all.push_back(make(
      "two points", [](Draws& d) { return d.uniform() < 0.3 ? -1.5 : 2.5; }, false));
  all.push_back(make(
      "rare point", [](Draws& d) { return d.uniform() < 0.001 ? -1.5 : 2.5; }, false));
  all.push_back(make(
      "constant", [](Draws&) { return 0.1; }, false));
  all.push_back(make(
      "zeros", [](Draws& d) { return d.uniform() < 0.5 ? -0.0 : 0.0; }, false));
  all.push_back(make(
      "signed zeros",
      [](Draws& d) {
        const double u = d.uniform();
        return u < 0.45 ? -0.0 : (u < 0.9 ? 0.0 : (u < 0.99 ? -1.0 : 1.0));
      },
      false));
  all.push_back(make(
      "zeros at the low end",
      [](Draws& d) {
        const double u = d.uniform();
        return u < 0.45 ? -0.0 : (u < 0.9 ? 0.0 : 1.0);
      },
      false));
  all.push_back(make(
      "half tied",
      [](Draws& d) {
        const double z = d.normal();
        return z < 0.0 ? 0.0 : z;
      },
      false));
  all.push_back(make(
      "denormal", [](Draws& d) { return 5e-324 * std::floor(1e5 * d.uniform()); }, false));
  Case outlier = make(
      "outlier", [](Draws& d) { return d.normal(); }, false);
  outlier.values[count / 3] = 1e145;
  all.push_back(outlier);
  Case rising = make(
      "rising", [](Draws&) { return 0.0; }, true);
  for (std::size_t i = 0; i < count; ++i) {
    rising.values[i] = static_cast<double>(i);
  }
  all.push_back(rising);
  return all;
}

std::size_t covered(std::size_t trials, std::size_t percent) {
  // JCGM 101 7.7.2 in whole numbers: pM, or the integer part of pM + 1/2.
  return (2 * percent * trials + 100) / 200;
}

void check(const Case& c, std::size_t percent) {
  SCOPED_TRACE(c.name + " p " + std::to_string(percent));
  static Engine engine;
  const MonteCarloResult result = run(engine, c.values, static_cast<double>(percent) / 100.0);
  ASSERT_EQ(result.status, Status::kOk);

  std::vector<double> sorted = c.values;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t trials = sorted.size();
  const std::size_t q = covered(trials, percent);
  const std::size_t r = (trials - q + 1) / 2;
  EXPECT_EQ(result.symmetric.low, sorted[r - 1]);
  EXPECT_EQ(result.symmetric.high, sorted[r + q - 1]);

  EXPECT_EQ(result.trials, trials);
  EXPECT_EQ(result.minimum, sorted.front());
  EXPECT_EQ(result.maximum, sorted.back());
  const auto first_maximum = std::max_element(c.values.begin(), c.values.end());
  const auto first_minimum = std::min_element(c.values.begin(), c.values.end());
  EXPECT_EQ(result.trial_of_maximum, first_maximum - c.values.begin());
  EXPECT_EQ(result.trial_of_minimum, first_minimum - c.values.begin());

  // Two passes in long double about the first value.
  const auto origin = static_cast<long double>(c.values[0]);
  long double sum = 0.0L;
  for (const double value : c.values) {
    sum += static_cast<long double>(value) - origin;
  }
  const long double mean = sum / static_cast<long double>(trials);
  long double squares = 0.0L;
  for (const double value : c.values) {
    const long double deviation = static_cast<long double>(value) - origin - mean;
    squares += deviation * deviation;
  }
  const long double u = std::sqrt(squares / static_cast<long double>(trials - 1));
  // Welford's recursion rounds a few times per trial, by parts in 2^53 of the spread, to and fro:
  // 1e-16 times the root of 2e5, with room for the worst order of trials. The smallest denormal can
  // round a whole unit each time.
  const auto spread = static_cast<double>(u);
  EXPECT_NEAR(
      result.mean, static_cast<double>(origin + mean),
      1e-11 * spread + 2e-16 * std::fabs(result.mean) + 5e-324 * static_cast<double>(trials));
  EXPECT_NEAR(result.u, spread, 1e-11 * spread + 1e-150);

  // The shortest one: both ends are order statistics q apart, and no other such pair is shorter by
  // more than a bin.
  double shortest = kInfinity;
  bool is_member = false;
  for (std::size_t s = 0; s + q < trials; ++s) {
    shortest = std::min(shortest, sorted[s + q] - sorted[s]);
    is_member =
        is_member || (sorted[s] == result.shortest.low && sorted[s + q] == result.shortest.high);
  }
  EXPECT_TRUE(is_member);
  const double bin = (sorted.back() - sorted.front()) / static_cast<double>(MonteCarlo::kBins);
  const double length = result.shortest.high - result.shortest.low;
  EXPECT_GE(length, shortest);
  EXPECT_LE(length, shortest + bin * (1.0 + 1e-12));
  if (c.smooth && trials > 100000) {
    // Spread evenly, the values tell the place inside a half bin to well within half of it.
    EXPECT_LE(length, shortest + 0.25 * bin);
  }

  std::vector<std::uint32_t> bins(MonteCarlo::kBins);
  for (const double value : sorted) {
    const double position =
        bin > 0.0 ? (value - sorted.front()) / (sorted.back() - sorted.front()) : 0.0;
    const auto index = static_cast<std::size_t>(position * static_cast<double>(MonteCarlo::kBins));
    ++bins[std::min(index, MonteCarlo::kBins - 1)];
  }
  ASSERT_EQ(engine.histogram().size(), MonteCarlo::kBins);
  EXPECT_TRUE(std::equal(bins.begin(), bins.end(), engine.histogram().begin()));
  EXPECT_LE(engine.pass(), 10U);
}

TEST(MonteCarlo, SortingAgreesAtAThousandTrials) {
  for (const Case& c : cases(1000)) {
    for (const std::size_t percent : {1U, 50U, 90U, 95U, 99U}) {
      check(c, percent);
    }
  }
}

TEST(MonteCarlo, SortingAgreesAtOddNumbers) {
  for (const Case& c : cases(1011)) {
    for (const std::size_t percent : {50U, 95U, 99U}) {
      check(c, percent);
    }
  }
}

TEST(MonteCarlo, SortingAgreesAtTwoHundredThousandTrials) {
  for (const Case& c : cases(200000)) {
    check(c, 95);
  }
}

TEST(MonteCarlo, SortingAgreesAtMillionsOfTrials) {
  // More values per bin than the pool has places: the bins are narrowed first.
  check({"uniform", values_of(2000000, [](Draws& d) { return d.uniform(); }), true}, 95);
  check({"steep", values_of(1000000, [](Draws& d) { return std::exp(8.0 * d.normal()); }), false},
        95);
}

TEST(MonteCarlo, ThreePassesForASmoothDistribution) {
  Engine engine;
  run(engine, values_of(200000, [](Draws& d) { return d.normal(); }), 0.95);
  EXPECT_EQ(engine.pass(), 3U);
  run(engine, std::vector<double>(5000, 0.1), 0.95);
  EXPECT_EQ(engine.pass(), 1U);
}

TEST(MonteCarlo, EqualValuesHaveNoSpread) {
  Engine engine;
  const MonteCarloResult result = run(engine, std::vector<double>(5000, 0.1), 0.95);
  EXPECT_EQ(result.mean, 0.1);
  EXPECT_EQ(result.u, 0.0);
  EXPECT_EQ(result.trial_of_maximum, 0U);
  EXPECT_EQ(result.shortest.low, 0.1);
  EXPECT_EQ(result.symmetric.high, 0.1);
  EXPECT_EQ(engine.histogram()[0], 5000U);
}

TEST(MonteCarlo, FirstMaximumOnTies) {
  std::vector<double> values(1000, 1.0);
  values[17] = values[400] = 2.0;
  values[30] = values[999] = 0.0;
  Engine engine;
  const MonteCarloResult result = run(engine, values, 0.95);
  EXPECT_EQ(result.trial_of_maximum, 17U);
  EXPECT_EQ(result.trial_of_minimum, 30U);
}

TEST(MonteCarlo, StatesOnTheWay) {
  Engine engine;
  EXPECT_TRUE(engine.done());
  EXPECT_EQ(engine.progress(), 0.0);
  EXPECT_EQ(engine.pass(), 0U);
  EXPECT_EQ(engine.result().status, Status::kTooFewTrials);
  engine.add(1.0);
  EXPECT_EQ(engine.pass(), 0U);

  ASSERT_EQ(engine.start(1000, 0.95), Status::kOk);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(engine.next_trial(), static_cast<std::uint32_t>(i));
    EXPECT_EQ(engine.result().mean, 0.0);
    engine.add(i);
  }
  EXPECT_EQ(engine.pass(), 2U);
  EXPECT_EQ(engine.next_trial(), 0U);
  EXPECT_EQ(engine.result().status, Status::kTooFewTrials);
  EXPECT_EQ(engine.result().maximum, 999.0);
  EXPECT_NEAR(engine.result().mean, 499.5, 1e-12);
  EXPECT_NEAR(engine.progress(), 1.0 / 3.0, 1e-15);
  EXPECT_EQ(engine.histogram().size(), 0U);
}

TEST(MonteCarlo, StartRefuses) {
  Engine engine;
  ASSERT_EQ(engine.start(1000, 0.95), Status::kOk);
  engine.add(3.0);
  EXPECT_EQ(engine.start(999, 0.95), Status::kTooFewTrials);
  EXPECT_EQ(engine.start(1000, 0.9996), Status::kTooFewTrials);
  for (const double bad : {0.0, 1.0, -0.5, 1.5, kNan, kInfinity, 1e-9}) {
    EXPECT_EQ(engine.start(1000, bad), Status::kInvalidArgument) << bad;
  }
  EXPECT_EQ(engine.next_trial(), 1U);
}

TEST(MonteCarlo, ValueThatIsNotANumberEnds) {
  for (const double bad : {kNan, kInfinity, -kInfinity, 1.1e145, -1.1e145}) {
    Engine engine;
    ASSERT_EQ(engine.start(1000, 0.95), Status::kOk);
    for (int i = 0; i < 123; ++i) {
      engine.add(i);
    }
    engine.add(bad);
    EXPECT_TRUE(engine.done());
    EXPECT_EQ(engine.result().status, Status::kInvalidArgument);
    EXPECT_EQ(engine.result().failed_trial, 123U);
    EXPECT_EQ(engine.result().mean, 0.0);
    EXPECT_EQ(engine.histogram().size(), 0U);
    run(engine, std::vector<double>(1000, 1.0), 0.95);
    EXPECT_EQ(engine.result().status, Status::kOk);
  }
}

TEST(MonteCarlo, TrialsThatDoNotReplayEnd) {
  const std::vector<double> values = values_of(1000, [](Draws& d) { return d.uniform(); });
  for (const std::uint32_t from_pass : {2U, 3U}) {
    for (const double other : {values[0], 2.0}) {
      Engine engine;
      ASSERT_EQ(engine.start(1000, 0.95), Status::kOk);
      while (!engine.done()) {
        const double value = values[engine.next_trial()];
        // All trials in one place, or outside the range; in pass 2 the former is a histogram like
        // any other.
        engine.add(engine.pass() >= from_pass ? other : value);
        ASSERT_LE(engine.pass(), 12U);
      }
      if (from_pass == 3 || other == 2.0) {
        EXPECT_EQ(engine.result().status, Status::kInvalidArgument);
        EXPECT_EQ(engine.result().failed_trial, other == 2.0 ? 0U : 1000U);
      }
    }
  }
}

TEST(MonteCarlo, MinimumTrials) {
  EXPECT_EQ(emax::minimum_trials(0.95), 200000U);
  EXPECT_EQ(emax::minimum_trials(0.9), 100000U);
  EXPECT_EQ(emax::minimum_trials(0.99), 1000000U);
  EXPECT_EQ(emax::minimum_trials(0.999), 10000000U);
  EXPECT_EQ(emax::minimum_trials(0.9999), 100000000U);
  EXPECT_EQ(emax::minimum_trials(0.5), 20000U);
  EXPECT_EQ(emax::minimum_trials(0.997), 3333334U);
  EXPECT_EQ(emax::minimum_trials(0.9545), 219781U);  // 219780.2
  for (const double bad : {0.0, 1.0, -1.0, 2.0, kNan, 1.0 - 1e-7}) {
    EXPECT_EQ(emax::minimum_trials(bad), 0U) << bad;
  }
}

// Clause 9. A quantile of M draws has the standard deviation sqrt(p(1 - p)/M)/density; means and u
// have u/sqrt(M) and, for kurtosis k, u sqrt((k - 1)/(4M)). Four of them are allowed.
constexpr std::size_t kTrials = 200000;
constexpr double kRootTrials = 447.21359549995793;

TEST(Clause9, SumOfFourNormals) {
  Engine engine;
  const MonteCarloResult result =
      run(engine,
          values_of(kTrials,
                    [](Draws& d) { return d.normal() + d.normal() + d.normal() + d.normal(); }),
          0.95);
  EXPECT_NEAR(result.mean, 0.0, 4.0 * 2.0 / kRootTrials);
  EXPECT_NEAR(result.u, 2.0, 4.0 * 2.0 * std::sqrt(0.5) / kRootTrials);
  const double end = 1.959964 * 2.0;
  const double density = 0.0584451 / 2.0;
  const double tolerance = 4.0 * std::sqrt(0.025 * 0.975) / kRootTrials / density;
  EXPECT_NEAR(result.symmetric.low, -end, tolerance);
  EXPECT_NEAR(result.symmetric.high, end, tolerance);
  // Both ends of the shortest one may move together almost for free; its length is as certain as
  // the other's.
  EXPECT_NEAR(result.shortest.high - result.shortest.low, 2.0 * end, 2.0 * tolerance);
  EXPECT_LE(result.shortest.high - result.shortest.low,
            result.symmetric.high - result.symmetric.low);
}

TEST(Clause9, SumOfFourRectangulars) {
  Engine engine;
  const double half = std::sqrt(3.0);
  const auto draw = [half](Draws& d) { return emax::uniform_in(-half, half, d.uniform()); };
  const MonteCarloResult result =
      run(engine,
          values_of(kTrials, [&draw](Draws& d) { return draw(d) + draw(d) + draw(d) + draw(d); }),
          0.95);
  EXPECT_NEAR(result.mean, 0.0, 4.0 * 2.0 / kRootTrials);
  EXPECT_NEAR(result.u, 2.0, 4.0 * 2.0 * std::sqrt(0.5) / kRootTrials);
  // The tail of the sum of four uniforms is x^4/24 = 0.025, x = 0.88011 from its end; there the
  // density is x^3/6, divided by 2 sqrt(3) for the scale.
  const double x = std::pow(24.0 * 0.025, 0.25);
  const double end = 2.0 * half * (2.0 - x);
  EXPECT_NEAR(end, 3.8794, 5e-5);
  const double density = x * x * x / 6.0 / (2.0 * half);
  const double tolerance = 4.0 * std::sqrt(0.025 * 0.975) / kRootTrials / density;
  EXPECT_NEAR(result.symmetric.low, -end, tolerance);
  EXPECT_NEAR(result.symmetric.high, end, tolerance);
  EXPECT_NEAR(result.shortest.high - result.shortest.low, 2.0 * end, 2.0 * tolerance);
}

TEST(Clause9, SquaresAboutZero) {
  // Exponential with mean 50e-6: u is the mean, kurtosis 9, the shortest interval [0, 50e-6 ln 20].
  Engine engine;
  const MonteCarloResult result = run(engine,
                                      values_of(kTrials,
                                                [](Draws& d) {
                                                  const double x1 = 0.005 * d.normal();
                                                  const double x2 = 0.005 * d.normal();
                                                  return x1 * x1 + x2 * x2;
                                                }),
                                      0.95);
  EXPECT_NEAR(result.mean, 50e-6, 4.0 * 50e-6 / kRootTrials);
  EXPECT_NEAR(result.u, 50e-6, 4.0 * 50e-6 * std::sqrt(2.0) / kRootTrials);
  const double density = 0.05 / 50e-6;
  const double tolerance = 4.0 * std::sqrt(0.05 * 0.95) / kRootTrials / density;
  EXPECT_NEAR(result.shortest.low, 0.0, tolerance);
  EXPECT_NEAR(result.shortest.high, 149.79e-6, tolerance);
  EXPECT_NEAR(result.symmetric.low, -50e-6 * std::log(0.975),
              4.0 * std::sqrt(0.025 * 0.975) / kRootTrials / (0.975 / 50e-6));
  EXPECT_NEAR(result.symmetric.high, -50e-6 * std::log(0.025),
              4.0 * std::sqrt(0.025 * 0.975) / kRootTrials / (0.025 / 50e-6));
}

TEST(Clause9, SquaresAwayFromZero) {
  // Noncentral: mean 2 s^2 + x1^2, variance 4 s^4 + 4 s^2 x1^2.
  Engine engine;
  const MonteCarloResult result = run(engine,
                                      values_of(kTrials,
                                                [](Draws& d) {
                                                  const double x1 = 0.010 + 0.005 * d.normal();
                                                  const double x2 = 0.005 * d.normal();
                                                  return x1 * x1 + x2 * x2;
                                                }),
                                      0.95);
  const double u = std::sqrt(1.25e-8);
  // Kurtosis of the noncentral chi-square of 2 degrees and noncentrality 4: 3 + 12(2 + 16)/(2 +
  // 8)^2 = 5.16.
  EXPECT_NEAR(result.mean, 150e-6, 4.0 * u / kRootTrials);
  EXPECT_NEAR(result.u, u, 4.0 * u * std::sqrt(4.16 / 4.0) / kRootTrials);
  // Density at the end, e^-(y + x1^2)/(2 s^2) I0(sqrt(y) x1/s^2)/(2 s^2) = 585.
  const double y = 366.01e-6;
  const double argument = std::sqrt(y) * 0.010 / 25e-6;
  const double density = std::exp(-(y + 1e-4) / 50e-6) * std::cyl_bessel_i(0.0, argument) / 50e-6;
  const double tolerance = 4.0 * std::sqrt(0.05 * 0.95) / kRootTrials / density;
  EXPECT_NEAR(result.shortest.low, 0.0, tolerance);
  EXPECT_NEAR(result.shortest.high, y, tolerance);
}

TEST(NumericalTolerance, ByHand) {
  // JCGM 101 7.9.2: 0.00035 g as 35e-5 g gives 0.5e-5 g; 2 K to one digit gives 0.5 K.
  EXPECT_NEAR(emax::numerical_tolerance(0.00035, 2), 0.5e-5, 1e-20);
  EXPECT_EQ(emax::numerical_tolerance(2.0, 1), 0.5);
  EXPECT_EQ(emax::numerical_tolerance(2.0, 2), 0.05);
  EXPECT_EQ(emax::numerical_tolerance(2.0, 4), 0.0005);
  EXPECT_EQ(emax::numerical_tolerance(1234.0, 2), 50.0);
  EXPECT_EQ(emax::numerical_tolerance(99.4, 2), 0.5);
  EXPECT_EQ(emax::numerical_tolerance(99.6, 2), 5.0);  // Rounds to 100 = 10e1.
  EXPECT_EQ(emax::numerical_tolerance(10.0, 2), 0.5);
  EXPECT_EQ(emax::numerical_tolerance(9.96, 2), 0.5);  // Rounds to 10.
  EXPECT_EQ(emax::numerical_tolerance(0.0, 2), 0.0);
  EXPECT_NEAR(emax::numerical_tolerance(1.1e-5, 2) / 0.5e-6, 1.0, 1e-15);
  EXPECT_NEAR(emax::numerical_tolerance(1e-200, 1) / 0.5e-200, 1.0, 1e-13);
  EXPECT_GE(emax::numerical_tolerance(5e-324, 2), 0.0);
  EXPECT_NEAR(emax::numerical_tolerance(2e100, 2) / 0.5e99, 1.0, 1e-13);
}

template <typename Function>
AdaptiveResult run_adaptive(AdaptiveTrials& adaptive, Engine& engine, Function evaluate) {
  while (!adaptive.done()) {
    adaptive.add(evaluate(adaptive.next_trial(engine.procedure)), engine.procedure, engine.store);
  }
  return adaptive.result();
}

TEST(AdaptiveTrials, AgreesWithTheRuleByHand) {
  // Three digits take about 460 blocks: y_low of one scatters by 0.0535.
  constexpr std::size_t kMaxBlocks = 550;
  constexpr std::size_t kBlock = 10000;
  const std::vector<double> values =
      values_of(kMaxBlocks * kBlock, [](Draws& d) { return 2.0 * d.normal(); });
  for (const std::uint32_t digits : {1U, 2U, 3U}) {
    static Engine engine;
    AdaptiveTrials adaptive;
    ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.95, digits, kMaxBlocks),
              Status::kOk);
    const AdaptiveResult result =
        run_adaptive(adaptive, engine, [&values](std::uint32_t trial) { return values[trial]; });
    ASSERT_EQ(result.status, Status::kOk);

    // 7.9.4 step by step.
    const double tolerance = digits == 1 ? 0.5 : (digits == 2 ? 0.05 : 0.005);  // u is 2.
    std::vector<double> blocks[4];
    std::size_t h = 0;
    double s[4] = {};
    for (bool stable = false; !stable && h < kMaxBlocks;) {
      std::vector<double> block(values.begin() + static_cast<std::ptrdiff_t>(h * kBlock),
                                values.begin() + static_cast<std::ptrdiff_t>((h + 1) * kBlock));
      ++h;
      double mean = 0.0;
      for (const double value : block) {
        mean += value / kBlock;
      }
      double squares = 0.0;
      for (const double value : block) {
        squares += (value - mean) * (value - mean);
      }
      std::sort(block.begin(), block.end());
      const double of_block[4] = {mean, std::sqrt(squares / (kBlock - 1)), block[249], block[9749]};
      stable = h > 1;
      for (std::size_t i = 0; i < 4; ++i) {
        blocks[i].push_back(of_block[i]);
        double average = 0.0;
        for (const double value : blocks[i]) {
          average += value / static_cast<double>(h);
        }
        double sum = 0.0;
        for (const double value : blocks[i]) {
          sum += (value - average) * (value - average);
        }
        s[i] = h > 1 ? std::sqrt(sum / static_cast<double>(h * (h - 1))) : 0.0;
        stable = stable && 2.0 * s[i] <= tolerance;
      }
    }
    EXPECT_EQ(result.blocks, h);
    EXPECT_EQ(result.trials, h * kBlock);
    EXPECT_TRUE(result.stabilised);
    EXPECT_EQ(result.tolerance, tolerance);
    EXPECT_NEAR(result.s_mean, s[0], 1e-12);
    EXPECT_NEAR(result.s_u, s[1], 1e-12);
    EXPECT_NEAR(result.s_low, s[2], 1e-12);
    EXPECT_NEAR(result.s_high, s[3], 1e-12);

    double mean = 0.0;
    for (std::size_t i = 0; i < result.trials; ++i) {
      mean += values[i];
    }
    mean /= result.trials;
    double squares = 0.0;
    for (std::size_t i = 0; i < result.trials; ++i) {
      squares += (values[i] - mean) * (values[i] - mean);
    }
    EXPECT_NEAR(result.mean, mean, 1e-12);
    EXPECT_NEAR(result.u, std::sqrt(squares / (result.trials - 1.0)), 1e-12);
    // The rule asks for two standard deviations within delta; three deltas are six of them. A few
    // blocks know their scatter badly, hence not less.
    EXPECT_NEAR(result.mean, 0.0, 3.0 * tolerance);
    EXPECT_NEAR(result.u, 2.0, 3.0 * tolerance);
    EXPECT_NEAR(result.symmetric.low, -3.919928, 3.0 * tolerance);
    EXPECT_NEAR(result.symmetric.high, 3.919928, 3.0 * tolerance);
  }
}

TEST(AdaptiveTrials, EngineServesTheWholeRunAfterwards) {
  const auto evaluate = [](std::uint32_t trial) {
    Draws draws(std::uint64_t{2} * trial);
    return draws.normal();
  };
  static Engine engine;
  AdaptiveTrials adaptive;
  ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.95), Status::kOk);
  const AdaptiveResult blocks = run_adaptive(adaptive, engine, evaluate);
  ASSERT_EQ(engine.start(blocks.trials, 0.95), Status::kOk);
  while (!engine.done()) {
    engine.add(evaluate(engine.next_trial()));
  }
  const MonteCarloResult all = engine.result();
  EXPECT_NEAR(all.mean, blocks.mean, 1e-14);
  EXPECT_NEAR(all.u, blocks.u, 1e-14);
  // The mean of the blocks' quantiles has a bias of the order of the spacing over a block, far
  // inside delta.
  EXPECT_NEAR(all.symmetric.low, blocks.symmetric.low, blocks.tolerance);
  EXPECT_NEAR(all.symmetric.high, blocks.symmetric.high, blocks.tolerance);
}

TEST(AdaptiveTrials, StopsAtTheLimit) {
  static Engine engine;
  AdaptiveTrials adaptive;
  ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.95, 4, 5), Status::kOk);
  Draws draws;
  std::vector<double> values(50000);
  for (double& value : values) {
    value = draws.normal();
  }
  const AdaptiveResult result =
      run_adaptive(adaptive, engine, [&values](std::uint32_t trial) { return values[trial]; });
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_FALSE(result.stabilised);
  EXPECT_EQ(result.trials, 50000U);
}

TEST(AdaptiveTrials, EqualValuesNeedTwoBlocks) {
  static Engine engine;
  AdaptiveTrials adaptive;
  ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.95), Status::kOk);
  const AdaptiveResult result = run_adaptive(adaptive, engine, [](std::uint32_t) { return 0.1; });
  EXPECT_TRUE(result.stabilised);
  EXPECT_EQ(result.trials, 20000U);
  EXPECT_EQ(result.u, 0.0);
  EXPECT_EQ(result.mean, 0.1);
}

TEST(AdaptiveTrials, SizeOfABlock) {
  static Engine engine;
  AdaptiveTrials adaptive;
  ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.999), Status::kOk);
  EXPECT_EQ(run_adaptive(adaptive, engine, [](std::uint32_t) { return 1.0; }).trials, 200000U);
  ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.5), Status::kOk);
  EXPECT_EQ(run_adaptive(adaptive, engine, [](std::uint32_t) { return 1.0; }).trials, 20000U);
}

TEST(AdaptiveTrials, FailureNamesTheTrial) {
  static Engine engine;
  AdaptiveTrials adaptive;
  ASSERT_EQ(adaptive.start(engine.procedure, engine.store, 0.95), Status::kOk);
  const AdaptiveResult result = run_adaptive(adaptive, engine, [](std::uint32_t trial) {
    return trial == 12345 ? kNan : static_cast<double>(trial % 100);
  });
  EXPECT_EQ(result.status, Status::kInvalidArgument);
  EXPECT_EQ(result.failed_trial, 12345U);
}

TEST(AdaptiveTrials, StartRefuses) {
  static Engine engine;
  AdaptiveTrials adaptive;
  EXPECT_TRUE(adaptive.done());
  EXPECT_EQ(adaptive.result().status, Status::kTooFewTrials);
  adaptive.add(1.0, engine.procedure, engine.store);
  for (const double bad : {0.0, 1.0, -1.0, kNan, 1e-9, 1.0 - 1e-9, 1.0 - 1e-15}) {
    EXPECT_EQ(adaptive.start(engine.procedure, engine.store, bad), Status::kInvalidArgument) << bad;
  }
  EXPECT_EQ(adaptive.start(engine.procedure, engine.store, 0.95, 0), Status::kInvalidArgument);
  EXPECT_EQ(adaptive.start(engine.procedure, engine.store, 0.95, 5), Status::kInvalidArgument);
  EXPECT_EQ(adaptive.start(engine.procedure, engine.store, 0.95, 2, 1), Status::kInvalidArgument);
  EXPECT_EQ(adaptive.start(engine.procedure, engine.store, 0.95, 2, 429497),
            Status::kInvalidArgument);
  EXPECT_TRUE(adaptive.done());
}

}  // namespace
