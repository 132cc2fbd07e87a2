// The expected values, and the comparisons.
#include "emax/app/instrument/self_test.hpp"

#include <algorithm>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/model/accelerometer.hpp"
#include "emax/model/butterworth.hpp"

namespace emax::app {
namespace {

using Function = ElementaryFunction;

// By hand. A fused multiply-add gives -2^-54 for the first product and sum; the others are a tie, a
// subnormal product, and a quotient next to a tie.
constexpr ArithmeticCheck kArithmetic[] = {
    {0x1.0000002p+0, 0x1.ffffffcp-1, -1.0, 0.0, 0x1.0000004000001p+0},
    {0x1.0000000000001p+0, 1.5, 0x1p-53, 0x1.8000000000002p+0, 0x1.5555555555557p-1},
    {0x1p-1000, 0x1.8p-74, 0.0, 0x1p-1073, 0x1.5555555555555p-927},
    {1.0, 3.0, 0.0, 3.0, 0x1.5555555555555p-2},
};

// From 400-bit arithmetic.
constexpr ElementaryCheck kElementary[] = {
    {Function::kExp, 0x1.71c73fc0c1002p-1, 0.0, 0x1.078d810951473p+1},
    {Function::kExp, -0x1.cff02f5a21a70p+5, 0.0, 0x1.42dfcc0391c1bp-84},
    {Function::kExp, 0x1.d5444d6837c92p+5, 0.0, 0x1.8b1c3ea644677p+84},
    {Function::kLog, 0x1.301ac5eda7a76p-1, 0.0, -0x1.0aba58b3e7903p-1},
    {Function::kLog, 0x1.fecb3001a60a7p-674, 0.0, -0x1.d27d8b992125dp+8},
    {Function::kLog, 0x1.c172654b3d189p+13, 0.0, 0x1.325c305a64231p+3},
    {Function::kSin, -0x1.12d44efb3fa1bp-1, 0.0, -0x1.05d20a35ba4cep-1},
    {Function::kSin, 0x1.76ab1206c07a2p+5, 0.0, 0x1.252aeae5b96d5p-2},
    {Function::kSin, 0x1.33e0d8b89f2dap+59, 0.0, 0x1.ff872e55a5ca7p-1},
    {Function::kCos, -0x1.0d46aa11c1fd4p-1, 0.0, 0x1.bace9c55278ebp-1},
    {Function::kCos, 0x1.317474e936cd8p+6, 0.0, 0x1.235457fd51234p-1},
    {Function::kCos, 0x1.537e4d3502ba5p+59, 0.0, -0x1.88ee38edbe020p-2},
    {Function::kAtan2, 0x1.1684e8f53f46ep-1, 0x1.0accc2dd7724bp-1, 0x1.9d201d326e73bp-1},
    {Function::kAtan2, -0x1.e93f9ca6161dcp+0, -0x1.7649a83149b6ap+0, -0x1.1ca6f25a883a1p+1},
    {Function::kAtan2, 0x1.05bf5442d8bbcp-9, 0x1.1393919646774p+7, 0x1.e64e814886577p-17},
    {Function::kSqrt, 2.0, 0.0, 0x1.6a09e667f3bcdp+0},
    {Function::kSqrt, 0x1.fffffffffffffp+1023, 0.0, 0x1.fffffffffffffp+511},
    {Function::kSqrt, 0x1p-1074, 0.0, 0x1p-537},
};

// From Python 3, which converts by David Gay's dtoa.c.
constexpr DecimalCheck kDecimal[] = {
    {"0.1", 0x1.999999999999ap-4, "0.10000000000000001"},
    {"1552.0713", 0x1.8404902de00d2p+10, "1552.0713000000001"},
    {"9007199254740993", 0x1p+53, "9007199254740992"},
    {"2.2250738585072011e-308", 0x0.fffffffffffffp-1022, "2.2250738585072009e-308"},
    {"1.7976931348623157e308", 0x1.fffffffffffffp+1023, "1.7976931348623157e+308"},
    {"5e-324", 0x1p-1074, "4.9406564584124654e-324"},
};

// The sequence that Wichmann and Hill published in 2006.
constexpr std::array<std::uint32_t, 4> kSeeds = {123456789, 345678901, 567890123, 789012345};
constexpr GeneratorCheck kGenerator[] = {
    {1, 0.75099757068263173, {1874688786, 84897365, 478650314, 1322001748}},
    {2, 0.05838148864854009, {971196646, 406424201, 957195702, 2085523378}},
    {100, 0.73211169856915226, {258119475, 1585670981, 459850852, 1416039761}},
};

constexpr Accelerometer kDevice = {1.037, 4073.0, 0.3182};
constexpr Butterworth kFilter = {10, 1000.0, 1.037};
constexpr double kA2 = 1.037 * 1.037;

// From 400-bit arithmetic on the partial fractions.
constexpr ResponseCheck kResponse[] = {
    {10e-6, 6199.1623967232911},   {50e-6, 17451.150881774921},    {100e-6, 8133.6089069660504},
    {500e-6, -259.55996812950951}, {1000e-6, -1744.3326780597443}, {2000e-6, 424.17575172108879},
};

// From 400-bit arithmetic too: a constant; the paper's signal; the best of all patterns of signs on
// 20 cells and on 24, which others have found by enumeration; the best known signals.
constexpr EnergyCheck kEnergy[] = {
    {0.002, 0.0011069377186389731, 0, {}},
    {0.002, 0.0039906310653567231, 2, {0.68e-3, 1.49e-3}},
    {0.002, 0.0050935397728703824, 1, {1e-3}},
    {0.002, 0.0051028687271305179, 1, {0.002 * 13 / 24}},
    {0.002, 0.0051152513598758544, 1, {1.0474909417558e-3}},
    {0.010,
     0.038091221314761278,
     9,
     {0.84866315101641e-3, 1.9058315037729e-3, 2.9367350905267e-3, 3.976378908253e-3,
      5.0135209735015e-3, 6.049938135172e-3, 7.0918057372703e-3, 8.1148875436357e-3,
      9.1942917643007e-3}},
};

constexpr SelfTestTables kTables = {kArithmetic, kElementary, kDecimal,
                                    kGenerator,  kResponse,   kEnergy};

// Four roundings of numbers up to 4.
constexpr double kDrawTolerance = 1e-15;
// Of the peak of k, 17462: rounding in eleven modes, whose residues are ten times as large.
constexpr double kResponseTolerance = 17462.0 * 1e-13;
// Rounding is about 1e-14 of the energies of both outputs, which are up to three times as large.
constexpr double kEnergyTolerance = 1e-13;

// False for what is not a number, too.
bool is_near(double value, double expected, double tolerance) noexcept {
  return abs(value - expected) <= tolerance;
}

Span<const char> text_of(const char* text) noexcept {
  std::size_t length = 0;
  while (text[length] != '\0') {
    ++length;
  }
  return {text, length};
}

bool is_met(const ArithmeticCheck& check) noexcept {
  // The processor has to compute this, not the compiler.
  const volatile double first = check.first;
  const volatile double second = check.second;
  const volatile double third = check.third;
  const double sum = first * second + third;
  return sum == check.product_and_sum && first / second == check.quotient;
}

double value_of(Function function, double argument, double second) noexcept {
  switch (function) {
    case Function::kExp:
      return exp(argument);
    case Function::kLog:
      return log(argument);
    case Function::kSin:
      return sin(argument);
    case Function::kCos:
      return cos(argument);
    case Function::kAtan2:
      return atan2(argument, second);
    case Function::kSqrt:
      return sqrt(argument);
  }
  return 0.0;
}

bool is_met(const ElementaryCheck& check) noexcept {
  return value_of(check.function, check.argument, check.second) == check.value;
}

bool is_met(const DecimalCheck& check) noexcept {
  const Span<const char> text = text_of(check.text);
  const Span<const char> printed = text_of(check.printed);
  const ParsedNumber parsed = parse_decimal(text);
  std::array<char, 24> characters = {};
  const std::size_t count = format_general(check.value, 17, characters);
  return parsed.status == Status::kOk && parsed.length == text.size() &&
         parsed.value == check.value && count == printed.size() &&
         std::equal(printed.begin(), printed.end(), characters.begin());
}

// The checks one after the other, until one fails.
class Run {
 public:
  explicit Run(SelfTestWorkspace& workspace) noexcept : workspace_(workspace) {}

  template <typename Check>
  void check(Span<const Check> checks) noexcept {
    for (const Check& check : checks) {
      if (failed_ != 0) {
        return;
      }
      ++number_;
      failed_ = holds(check) ? 0 : number_;
    }
  }

  std::uint32_t failed() const noexcept { return failed_; }

  Status prepare() noexcept {
    const Status status = generator_.seed(Generator::k2006, kSeeds);
    return status == Status::kOk
               ? workspace_.model.set(kDevice, kFilter, Criterion::kIntegralSquareError)
               : status;
  }

 private:
  static bool holds(const ArithmeticCheck& check) noexcept { return is_met(check); }
  static bool holds(const ElementaryCheck& check) noexcept { return is_met(check); }
  static bool holds(const DecimalCheck& check) noexcept { return is_met(check); }

  bool holds(const GeneratorCheck& check) noexcept {
    double value = 0.0;
    for (; draws_ < check.draw; ++draws_) {
      value = generator_.next();
    }
    return is_near(value, check.value, kDrawTolerance) && generator_.state() == check.state;
  }

  bool holds(const ResponseCheck& check) const noexcept {
    return is_near(workspace_.model.impulse_response(check.time_s), check.value,
                   kResponseTolerance);
  }

  bool holds(const EnergyCheck& check) noexcept {
    const Span<const double> times_s = Span<const double>(check.times_s).first(check.switches);
    return workspace_.signal.set(times_s, check.duration_s) == Status::kOk &&
           is_near(kA2 * energy(workspace_.model, workspace_.signal), check.energy,
                   kEnergyTolerance * check.energy);
  }

  SelfTestWorkspace& workspace_;
  WichmannHill generator_;
  std::uint32_t draws_ = 0;
  std::uint32_t number_ = 0;
  std::uint32_t failed_ = 0;
};

}  // namespace

const SelfTestTables& self_test_tables() noexcept { return kTables; }

std::uint32_t first_failed_check(const SelfTestTables& tables,
                                 SelfTestWorkspace& workspace) noexcept {
  Run run(workspace);
  if (run.prepare() != Status::kOk) {
    return 1;
  }
  run.check(tables.arithmetic);
  run.check(tables.elementary);
  run.check(tables.decimal);
  run.check(tables.generator);
  run.check(tables.response);
  run.check(tables.energy);
  return run.failed();
}

const char* name_of_check(const SelfTestTables& tables, std::uint32_t number) noexcept {
  const struct {
    const char* name;
    std::size_t count;
  } groups[] = {
      {"arithmetic", tables.arithmetic.size()},
      {"elementary functions", tables.elementary.size()},
      {"decimal numbers", tables.decimal.size()},
      {"random numbers", tables.generator.size()},
      {"impulse response", tables.response.size()},
      {"energy", tables.energy.size()},
  };
  std::size_t last = 0;
  for (const auto& group : groups) {
    last += group.count;
    if (number != 0 && number <= last) {
      return group.name;
    }
  }
  return "nothing";
}

}  // namespace emax::app
