// gnuplot, where there is one: draws what a script asks for, in a directory.
#pragma once

#include <chrono>
#include <string>

namespace emax::desk {

enum class GnuplotEnd {
  kDone,
  kMissing,  ///< There is none on the PATH.
  kFailed,
  kStopped,  ///< By Ctrl-C.
};

struct GnuplotRun {
  GnuplotEnd end = GnuplotEnd::kDone;
  std::string reason = {};  ///< Of kFailed, as the middle of a line.
};

/// How long drawing may take, on a slow and busy machine.
inline constexpr std::chrono::milliseconds kDrawingTime{20'000};

/// Runs gnuplot without a shell and without the user's own settings.
///
/// @param[in] directory Where it runs: names in the script are relative to it.
/// @param[in] script    The name of a file there.
/// @param[in] longest   What has not ended then is killed, and kFailed.
GnuplotRun run_gnuplot(const std::string& directory, const char* script,
                       std::chrono::milliseconds longest = kDrawingTime);

/// @returns Text as an expression of a script: strings in single quotes without line feeds, so that
/// nothing in them can end them, and nothing is expanded. Single quotes stand in strings of their
/// own, in double ones, since gnuplot 5.4 loses some of those that are doubled.
std::string gnuplot_string(const std::string& text);

}  // namespace emax::desk
