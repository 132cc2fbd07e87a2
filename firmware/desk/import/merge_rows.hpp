// Rows of a table in the order of frequency, with repeated ones averaged.
#pragma once

#include <cstddef>
#include <vector>

namespace emax::desk {

/// One row in Hz, V/(m/s^2) and rad, with standard uncertainties.
struct Row {
  std::size_t line = 0;
  double frequency_hz = 0.0;
  double amplitude = 0.0;
  double phase_rad = 0.0;
  double u_amplitude = 0.0;
  double u_phase_rad = 0.0;
  double u_common = 0.0;  ///< What of `u_amplitude` all points have in common, relative.
  bool has_phase = false;
};

struct MergedRows {
  std::vector<Row> rows;    ///< Ascending, each frequency once.
  std::size_t repeats = 0;  ///< Rows that are the mean of several.
};

/// Sorts the rows and makes rows of the same frequency one: the means, u^2 = mean of u_i^2 + s^2/n
/// with the rows' standard deviation s. The phase is the mean of those rows that have one, taken
/// within half a turn of the first; the common part that of the first row.
MergedRows merge_rows(std::vector<Row> rows);

}  // namespace emax::desk
