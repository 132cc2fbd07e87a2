// The self test passes here, and finds each single expectation that is made wrong.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <type_traits>

#include "emax/app/instrument/self_test.hpp"

namespace emax::app {
namespace {

SelfTestWorkspace workspace;

/// One table with one check in it; the others are empty.
template <typename Check>
SelfTestTables only(Span<const Check> SelfTestTables::*table, const Check& check) {
  SelfTestTables tables;
  tables.*table = Span<const Check>(&check, 1);
  return tables;
}

/// Makes the check wrong with `spoil`, which must be found, for every row of the table.
template <typename Check, typename Spoil>
void expect_found(Span<const Check> SelfTestTables::*table, const Spoil& spoil) {
  for (const Check& right : self_test_tables().*table) {
    Check check = right;
    EXPECT_EQ(first_failed_check(only(table, check), workspace), 0U);
    spoil(check);
    EXPECT_EQ(first_failed_check(only(table, check), workspace), 1U);
  }
}

double next_to(double value) {
  return std::nextafter(value, std::numeric_limits<double>::infinity());
}

TEST(SelfTest, Passes) {
  EXPECT_GE(self_test_tables().size(), 40U);
  EXPECT_EQ(run_self_test(workspace), 0U);
  EXPECT_EQ(run_self_test(workspace), 0U) << "what the first run left in the memory";
}

TEST(SelfTest, FindsOneWrongBit) {
  expect_found(&SelfTestTables::arithmetic, [](ArithmeticCheck& check) {
    check.product_and_sum = next_to(check.product_and_sum);
  });
  expect_found(&SelfTestTables::arithmetic,
               [](ArithmeticCheck& check) { check.quotient = next_to(check.quotient); });
  expect_found(&SelfTestTables::elementary,
               [](ElementaryCheck& check) { check.value = next_to(check.value); });
  expect_found(&SelfTestTables::decimal,
               [](DecimalCheck& check) { check.value = next_to(check.value); });
  expect_found(&SelfTestTables::generator, [](GeneratorCheck& check) { check.state[3] ^= 1U; });
}

TEST(SelfTest, FindsWrongText) {
  expect_found(&SelfTestTables::decimal, [](DecimalCheck& check) { check.printed = "1"; });
  expect_found(&SelfTestTables::decimal, [](DecimalCheck& check) { check.text = "x"; });
  expect_found(&SelfTestTables::decimal, [](DecimalCheck& check) { check.text = "1.5"; });
  std::string longer;
  expect_found(&SelfTestTables::decimal, [&longer](DecimalCheck& check) {
    longer = check.text + std::string("x");
    check.text = longer.c_str();
  });
  std::string printed;
  expect_found(&SelfTestTables::decimal, [&printed](DecimalCheck& check) {
    printed = check.printed;
    printed.back() = printed.back() == '0' ? '1' : '0';
    check.printed = printed.c_str();
  });
}

TEST(SelfTest, FindsWrongDigits) {
  // Wrong in the last digit that is published, and in the twelfth of the others.
  expect_found(&SelfTestTables::generator, [](GeneratorCheck& check) { check.value += 2e-15; });
  expect_found(&SelfTestTables::response, [](ResponseCheck& check) { check.value += 4e-9; });
  expect_found(&SelfTestTables::energy, [](EnergyCheck& check) { check.energy *= 1.0 + 1e-12; });
  expect_found(&SelfTestTables::energy,
               [](EnergyCheck& check) { check.energy = std::numeric_limits<double>::quiet_NaN(); });
}

TEST(SelfTest, FindsOtherSignal) {
  expect_found(&SelfTestTables::energy, [](EnergyCheck& check) { check.duration_s *= 1.01; });
  expect_found(&SelfTestTables::energy, [](EnergyCheck& check) { check.duration_s = -1.0; });
}

TEST(SelfTest, AnswersTheNumberOfTheFirstOne) {
  const SelfTestTables right = self_test_tables();
  ASSERT_GE(right.response.size(), 3U);
  std::array<ResponseCheck, 3> wrong = {right.response[0], right.response[1], right.response[2]};
  wrong[1].value += 1.0;
  wrong[2].value += 1.0;
  SelfTestTables tables = right;
  tables.response = wrong;
  const std::size_t before = right.arithmetic.size() + right.elementary.size() +
                             right.decimal.size() + right.generator.size();
  EXPECT_EQ(first_failed_check(tables, workspace), before + 2);
  EXPECT_STREQ(name_of_check(tables, static_cast<std::uint32_t>(before + 2)), "impulse response");
}

TEST(SelfTest, NamesEveryCheck) {
  const SelfTestTables& tables = self_test_tables();
  EXPECT_STREQ(name_of_check(tables, 0), "nothing");
  EXPECT_STREQ(name_of_check(tables, 1), "arithmetic");
  const auto last = static_cast<std::uint32_t>(tables.size());
  EXPECT_STREQ(name_of_check(tables, last), "energy");
  EXPECT_STREQ(name_of_check(tables, last + 1), "nothing");
}

// The workspace may be memory that held something else before.
TEST(SelfTest, TakesMemoryAsItIs) {
  for (const int filling : {0x00, 0xFF, 0x5A}) {
    std::memset(static_cast<void*>(&workspace), filling, sizeof workspace);
    EXPECT_EQ(run_self_test(workspace), 0U) << filling;
  }
}

}  // namespace
}  // namespace emax::app
