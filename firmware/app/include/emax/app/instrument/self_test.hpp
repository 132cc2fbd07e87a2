// The numeric self test: does this build, on this processor, compute what it should?
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/modal_model.hpp"

namespace emax::app {

// What a check expects comes from outside this code: from 400-bit arithmetic on the formulas, from
// published tables, or from another program. `first_failed_check()` says how close is close enough.

/// first * second + third, rounded twice, and first / second.
struct ArithmeticCheck {
  double first;
  double second;
  double third;
  double product_and_sum;
  double quotient;
};

enum class ElementaryFunction : std::uint8_t { kExp, kLog, kSin, kCos, kAtan2, kSqrt };

/// A value to the last bit. The exact one is within 0.02 ulp of it (any distance for kSqrt, which
/// rounds correctly), so that a function with an error below 1 ulp that rounds well must hit it.
struct ElementaryCheck {
  ElementaryFunction function;
  double argument;
  double second;  ///< x of atan2(y, x); unused by the others.
  double value;
};

/// Text to a number and back to 17 digits.
struct DecimalCheck {
  const char* text;
  double value;
  const char* printed;
};

/// The 2006 generator with the default seeds.
struct GeneratorCheck {
  std::uint32_t draw;  ///< Ascending; the first is 1.
  double value;
  std::array<std::uint32_t, 4> state;
};

/// k(t) of the device of the paper's Table 2 with its filter.
struct ResponseCheck {
  double time_s;
  double value;
};

inline constexpr std::size_t kMaxCheckSwitches = 9;

/// The energy of a signal at the output of the same device, for a = S.
struct EnergyCheck {
  double duration_s;
  double energy;
  std::size_t switches;
  std::array<double, kMaxCheckSwitches> times_s;
};

/// The checks in the order in which they are made and numbered, from 1 on.
struct SelfTestTables {
  Span<const ArithmeticCheck> arithmetic;
  Span<const ElementaryCheck> elementary;
  Span<const DecimalCheck> decimal;
  Span<const GeneratorCheck> generator;
  Span<const ResponseCheck> response;
  Span<const EnergyCheck> energy;

  std::size_t size() const noexcept {
    return arithmetic.size() + elementary.size() + decimal.size() + generator.size() +
           response.size() + energy.size();
  }
};

/// Memory for the test; 6 KiB.
struct SelfTestWorkspace {
  ModalModel model;
  SwitchingSignal signal;
};

static_assert(std::is_trivially_copyable_v<SelfTestWorkspace>);

const SelfTestTables& self_test_tables() noexcept;

/// Makes the checks until one fails. About a million instructions with double in hardware.
///
/// @returns Its number, or 0 if all is well.
std::uint32_t first_failed_check(const SelfTestTables& tables,
                                 SelfTestWorkspace& workspace) noexcept;

/// All of them: the answer of *TST?.
inline std::uint32_t run_self_test(SelfTestWorkspace& workspace) noexcept {
  return first_failed_check(self_test_tables(), workspace);
}

/// @returns "arithmetic", "elementary functions" and so on: what this check of these tables is
/// about; "nothing" for a number that none has. Never null.
const char* name_of_check(const SelfTestTables& tables, std::uint32_t number) noexcept;

}  // namespace emax::app
