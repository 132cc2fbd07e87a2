// A table of measured points from CSV text, one line at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// What was wrong with a table, in words for the one who made it.
struct PointsError {
  std::size_t line = 0;               ///< From 1; 0 where the table as a whole is meant.
  const char* problem = nullptr;      ///< Null if all is well: "amplitude is not a number".
  const char* expectation = nullptr;  ///< "expected five numbers: f_hz,amplitude,...".
};

/// Reads the columns of the paper's Table 1, f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg, with
/// expanded uncertainties (k = 2): the points hold radians and standard uncertainties.
///
/// A table whose header is that of frequency_response.csv has up to ten columns; those behind the
/// fifth, which are the fit's and what the points have in common, are not looked at.
///
/// Numbers are separated by commas and have a point as decimal sign. Allowed are one header line
/// before the numbers (it begins with a letter and has five names, or those nine), empty lines,
/// lines that begin with '#', spaces around numbers, CR LF, and the byte order mark of UTF-8.
/// Refused are lines of more than 250 characters, control characters, a number that is missing, not
/// finite or outside its range (frequency, amplitude and uncertainties above 0, phase within +-360
/// degrees), frequencies that do not ascend, fewer than 3 points and more than 64.
///
/// 3.3 KiB. The work per line is proportional to its length.
class PointsReader {
 public:
  static constexpr std::size_t kMaxLineLength = 250;
  static constexpr std::size_t kMinPoints = 3;

  /// Forgets the table of before.
  void start() noexcept;
  /// Takes the next line, without its line feed. After an error further lines are ignored.
  void add_line(Span<const char> line) noexcept;
  /// Checks the table as a whole: 3 points or more.
  ///
  /// @returns The first error of all, as `error()` does from then on.
  PointsError finish() noexcept;
  const PointsError& error() const noexcept { return error_; }
  /// @returns The points read so far, those before the error if there is one.
  const FrequencyResponse& points() const noexcept { return points_; }
  /// @param[in] index Of a point, below `points().size()`.
  /// @returns The line that it came from; the first is 1.
  std::size_t line_of(std::size_t index) const noexcept { return lines_[index]; }

 private:
  void fail(const char* problem, const char* expectation) noexcept;
  void add_numbers(Span<const char> line) noexcept;
  void add_point(const double* numbers) noexcept;

  FrequencyResponse points_;
  std::uint32_t lines_[kMaxPoints] = {};
  PointsError error_;
  std::size_t line_ = 0;
  std::size_t columns_ = 0;
  bool header_is_past_ = false;
};

static_assert(std::is_trivially_copyable_v<PointsReader>);

}  // namespace emax::app
