// Why a table cannot be used.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "emax/base/capacity.hpp"

namespace emax::desk {

/// Where a table stops being one, or why none of it can be used.
struct ImportError {
  std::size_t line = 0;     ///< From 1; 0 where the table as a whole is meant.
  std::string problem;      ///< Empty if all is well: "amplitude is not a number".
  std::string expectation;  ///< "expected ...".

  explicit operator bool() const noexcept { return !problem.empty(); }
};

inline ImportError error_at(std::size_t line, std::string problem, std::string expectation) {
  return {line, std::move(problem), std::move(expectation)};
}

/// @returns "3 points", "1 point".
inline std::string count_of(std::size_t number, const char* noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

inline constexpr char kExpectedNative[] =
    "expected five numbers separated by commas: f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg; "
    "or a header that names the columns";
inline constexpr char kExpectedText[] = "expected lines of text with a table of numbers";
inline constexpr char kExpectedPoints[] = "expected 3 to " EMAX_TEXT_OF(EMAX_MAX_POINTS) " points";

}  // namespace emax::desk
