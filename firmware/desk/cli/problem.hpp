// What ends the program early: one line for its user and an exit status.
#pragma once

#include <string>
#include <utility>

namespace emax::desk {

enum class ExitStatus : int {
  kDone = 0,
  kBadInput = 2,
  kFault = 3,      ///< Of the measurement, or of what the results are written to.
  kStopped = 130,  ///< By Ctrl-C or a request to terminate.
};

/// An exit status with the line that explains it. `Problem{}` is none.
struct Problem {
  ExitStatus status = ExitStatus::kDone;
  std::string line = {};  ///< Without "emax: " and line feed; empty if there is nothing to say.

  explicit operator bool() const noexcept { return status != ExitStatus::kDone; }
};

inline Problem bad_input(std::string line) { return {ExitStatus::kBadInput, std::move(line)}; }
inline Problem fault(std::string line) { return {ExitStatus::kFault, std::move(line)}; }
inline Problem stopped() { return {ExitStatus::kStopped, "stopped"}; }

}  // namespace emax::desk
