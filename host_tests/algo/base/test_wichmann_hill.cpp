// The generators against published sequences, and the jump against modular powers of its own.
#include <array>
#include <cstdint>
#include <gtest/gtest.h>

#include "emax/base/wichmann_hill.hpp"

namespace emax {
namespace {

using State = std::array<std::uint32_t, 4>;

constexpr State kSeeds = {123456789, 345678901, 567890123, 789012345};
constexpr std::uint64_t kTwoTo59 = std::uint64_t{1} << 59U;
constexpr std::uint64_t kTwoTo60 = std::uint64_t{1} << 60U;

WichmannHill seeded(Generator generator = Generator::k2006) {
  WichmannHill result;
  EXPECT_EQ(result.seed(generator, kSeeds), Status::kOk);
  return result;
}

// By repeated squaring from the top bit: another way than the code's. Base and modulus have 31
// bits.
std::uint64_t power(std::uint64_t base, std::uint64_t exponent, std::uint64_t modulus) {
  std::uint64_t result = 1;
  for (int bit = 63; bit >= 0; --bit) {
    result = result * result % modulus;
    if (((exponent >> static_cast<unsigned>(bit)) & 1U) != 0) {
      result = result * base % modulus;
    }
  }
  return result;
}

TEST(WichmannHill, PublishedSequenceOf2006) {
  struct Row {
    int draw;
    double value;
    State state;
  };
  const Row rows[] = {
      {1, 0.75099757068263173, {1874688786, 84897365, 478650314, 1322001748}},
      {2, 0.05838148864854009, {971196646, 406424201, 957195702, 2085523378}},
      {3, 0.32888922619308092, {182238166, 1290604618, 1648576827, 1879831219}},
      {4, 0.11645956405699120, {838883864, 173737190, 1299704512, 85252899}},
      {100, 0.73211169856915226, {258119475, 1585670981, 459850852, 1416039761}},
      {1000, 0.71003348258806565, {390086939, 647973173, 843362640, 1790845619}},
  };
  WichmannHill generator = seeded();
  int draw = 0;
  for (const Row& row : rows) {
    double value = 0.0;
    for (; draw < row.draw; ++draw) {
      value = generator.next();
    }
    EXPECT_EQ(generator.state(), row.state) << row.draw;
    EXPECT_NEAR(value, row.value, 1e-15) << row.draw;  // Four roundings of numbers up to 4.
  }
}

TEST(WichmannHill, MultipliersAndModuliOf2006) {
  // From the published table: the step of every component from 1 and from m - 1, which give a and m
  // - a.
  const State a = {11600, 47003, 23000, 33000};
  const State m = {2147483579, 2147483543, 2147483423, 2147483123};
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, State{1, 1, 1, 1}), Status::kOk);
  generator.next();
  EXPECT_EQ(generator.state(), a);
  ASSERT_EQ(generator.seed(Generator::k2006, State{m[0] - 1, m[1] - 1, m[2] - 1, m[3] - 1}),
            Status::kOk);
  generator.next();
  EXPECT_EQ(generator.state(), (State{m[0] - a[0], m[1] - a[1], m[2] - a[2], m[3] - a[3]}));
}

TEST(WichmannHill, ResultsNextToTheModulus) {
  // The state that steps to t is t/a mod m, with 1/a = a^(m - 2): small t and m - t, where a
  // reduction slips.
  const State a = {11600, 47003, 23000, 33000};
  const State m = {2147483579, 2147483543, 2147483423, 2147483123};
  for (std::uint32_t t = 1; t <= 1000; ++t) {
    State small{};
    State large{};
    for (std::size_t j = 0; j < 4; ++j) {
      const std::uint64_t inverse = power(a[j], m[j] - 2, m[j]);
      small[j] = static_cast<std::uint32_t>(inverse * t % m[j]);
      large[j] = m[j] - small[j];
    }
    WichmannHill generator;
    ASSERT_EQ(generator.seed(Generator::k2006, small), Status::kOk);
    generator.next();
    EXPECT_EQ(generator.state(), (State{t, t, t, t}));
    ASSERT_EQ(generator.seed(Generator::k2006, large), Status::kOk);
    generator.next();
    EXPECT_EQ(generator.state(), (State{m[0] - t, m[1] - t, m[2] - t, m[3] - t}));
  }
}

TEST(WichmannHill, SequenceOfR) {
  // RNGkind("Wichmann-Hill"); set.seed(0); runif(5)
  WichmannHill generator;
  const std::uint32_t seeds[] = {2882, 21792, 10079};
  ASSERT_EQ(generator.seed(Generator::k1982, seeds), Status::kOk);
  for (const double expected : {0.4625532, 0.2658268, 0.5772108, 0.5107932, 0.3375606}) {
    EXPECT_NEAR(generator.next(), expected, 0.5e-7);  // R prints seven digits.
  }
}

TEST(WichmannHill, JumpIsThatManySteps) {
  for (const Generator kind : {Generator::k2006, Generator::k1982}) {
    WichmannHill stepped = seeded(kind);
    for (std::uint64_t n = 0; n < 2000; ++n) {
      WichmannHill jumped = seeded(kind);
      jumped.jump(n);
      ASSERT_EQ(jumped.state(), stepped.state()) << n;
      ASSERT_EQ(jumped.next(), stepped.next()) << n;
    }
  }
}

TEST(WichmannHill, LongJumpsAgainstModularPowers) {
  const State a2006 = {11600, 47003, 23000, 33000};
  const State m2006 = {2147483579, 2147483543, 2147483423, 2147483123};
  const State a1982 = {171, 172, 170, 0};
  const State m1982 = {30269, 30307, 30323, 1};
  for (const std::uint64_t n :
       {std::uint64_t{1} << 20U, kTwoTo59, kTwoTo60, kTwoTo60 + 12345, ~std::uint64_t{0}}) {
    for (const Generator kind : {Generator::k2006, Generator::k1982}) {
      WichmannHill generator = seeded(kind);
      const State before = generator.state();
      generator.jump(n);
      const State& a = kind == Generator::k2006 ? a2006 : a1982;
      const State& m = kind == Generator::k2006 ? m2006 : m1982;
      for (std::size_t j = 0; j < generator.components(); ++j) {
        EXPECT_EQ(generator.state()[j], power(a[j], n, m[j]) * before[j] % m[j]) << n << ' ' << j;
      }
    }
  }
}

TEST(WichmannHill, TwoHalfJumpsAreOne) {
  WichmannHill once = seeded();
  WichmannHill twice = seeded();
  once.jump(kTwoTo60);
  twice.jump(kTwoTo59);
  EXPECT_NE(once.state(), twice.state());
  twice.jump(kTwoTo59);
  EXPECT_EQ(once.state(), twice.state());
}

TEST(WichmannHill, StateContinuesTheSequence) {
  for (const Generator kind : {Generator::k2006, Generator::k1982}) {
    WichmannHill first = seeded(kind);
    for (int i = 0; i < 77; ++i) {
      first.next();
    }
    const State state = first.state();
    WichmannHill second;
    ASSERT_EQ(second.seed(kind, Span<const std::uint32_t>(state).first(first.components())),
              Status::kOk);
    for (int i = 0; i < 1000; ++i) {
      ASSERT_EQ(first.next(), second.next());
    }
  }
}

TEST(WichmannHill, Seeds1982AreReduced) {
  WichmannHill generator = seeded(Generator::k1982);
  EXPECT_EQ(generator.state(),
            (State{1 + 123456788 % 30268, 1 + 345678900 % 30306, 1 + 567890122 % 30322, 0}));
  ASSERT_EQ(generator.seed(Generator::k1982, State{30268, 30306, 30322, 1}), Status::kOk);
  EXPECT_EQ(generator.state(), (State{30268, 30306, 30322, 0}));
  ASSERT_EQ(generator.seed(Generator::k1982, State{30269, 30307, 30323, 1}), Status::kOk);
  EXPECT_EQ(generator.state(), (State{1, 1, 1, 0}));
  ASSERT_EQ(generator.seed(Generator::k1982, State{0xffffffffU, 1, 1, 0}), Status::kOk);
  EXPECT_EQ(generator.state(), (State{1 + 4294967294U % 30268, 1, 1, 0}));
}

TEST(WichmannHill, BadSeedsChangeNothing) {
  WichmannHill generator = seeded();
  const State before = generator.state();
  const State largest = {2147483578, 2147483542, 2147483422, 2147483122};
  const std::uint32_t five[] = {1, 2, 3, 4, 5};
  const Span<const std::uint32_t> all(five);
  EXPECT_EQ(generator.seed(Generator::k2006, all), Status::kInvalidArgument);
  EXPECT_EQ(generator.seed(Generator::k2006, all.first(3)), Status::kInvalidArgument);
  EXPECT_EQ(generator.seed(Generator::k2006, {}), Status::kInvalidArgument);
  EXPECT_EQ(generator.seed(Generator::k1982, all), Status::kInvalidArgument);
  EXPECT_EQ(generator.seed(Generator::k1982, all.first(2)), Status::kInvalidArgument);
  for (std::size_t j = 0; j < 4; ++j) {
    State seeds = kSeeds;
    seeds[j] = 0;
    EXPECT_EQ(generator.seed(Generator::k2006, seeds), Status::kInvalidArgument) << j;
    if (j < 3) {
      EXPECT_EQ(generator.seed(Generator::k1982, seeds), Status::kInvalidArgument) << j;
    }
    seeds[j] = largest[j] + 1;
    EXPECT_EQ(generator.seed(Generator::k2006, seeds), Status::kInvalidArgument) << j;
  }
  EXPECT_EQ(generator.state(), before);
  EXPECT_EQ(generator.generator(), Generator::k2006);
  EXPECT_EQ(generator.seed(Generator::k2006, largest), Status::kOk);
}

TEST(WichmannHill, ZeroBeforeUse) {
  WichmannHill generator;
  EXPECT_EQ(generator.next(), 0.0);
  generator.jump(5);
  EXPECT_EQ(generator.state(), State{});
}

TEST(WichmannHill, MomentsOfTheUniformDistribution) {
  constexpr int kDraws = 1000000;
  for (const Generator kind : {Generator::k2006, Generator::k1982}) {
    WichmannHill generator = seeded(kind);
    double sums[4] = {};
    double product = 0.0;
    double previous = generator.next();
    for (int i = 0; i < kDraws; ++i) {
      const double u = generator.next();
      ASSERT_GE(u, 0.0);
      ASSERT_LT(u, 1.0);
      double term = 1.0;
      for (double& sum : sums) {
        term *= u;
        sum += term;
      }
      product += (u - 0.5) * (previous - 0.5);
      previous = u;
    }
    for (int k = 1; k <= 4; ++k) {
      // E u^k = 1/(k + 1), Var u^k = 1/(2k + 1) - 1/(k + 1)^2; four standard deviations of the
      // mean.
      const double mean = 1.0 / (k + 1.0);
      const double variance = 1.0 / (2.0 * k + 1.0) - mean * mean;
      const double deviation = sums[k - 1] / kDraws - mean;
      EXPECT_LT(deviation * deviation, 16.0 * variance / kDraws) << k;
    }
    // Neighbours are uncorrelated: the product has variance 1/144.
    EXPECT_LT(product * product, 16.0 * kDraws / 144.0);
  }
}

}  // namespace
}  // namespace emax
