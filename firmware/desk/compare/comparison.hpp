// Devices side by side: the order that their uncertainties carry.
#pragma once

#include <cstddef>
#include <vector>

#include "desk/cli/problem.hpp"
#include "desk/files/result_file.hpp"

namespace emax::desk {

/// What two devices' energies say of one another.
struct Pair {
  double difference_v2s = 0.0;  ///< The second one's energy minus the first one's.
  /// Of the difference, with the coverage factor kCoverageFactor; 0 unless `has_uncertainty`. The
  /// devices' uncertainties count as independent: what they share, such as the reference sensor,
  /// would only make it smaller.
  double expanded_v2s = 0.0;
  bool has_uncertainty = false;  ///< Both devices have one.
  bool told_apart = false;       ///< The difference is beyond its uncertainty.
  /// Even the first one's upper bound is below the second one's energy: true at the estimates for
  /// whatever signal.
  bool proven = false;
};

inline constexpr double kCoverageFactor = 2.0;

/// A device's place: one more than the number of those that are better and can be told apart from
/// it, up to the number of all less those that are worse and can be told apart.
struct Rank {
  std::size_t best = 0;
  std::size_t worst = 0;
};

struct Comparison {
  std::vector<Result> results;  ///< By ascending energy: the most accurate device first.
  std::vector<Rank> ranks;      ///< Of each.
  std::vector<Pair> pairs;      ///< Each with its successor; one fewer.
};

/// @returns The first that has an uncertainty, from a Monte Carlo run; the very first if none has.
const Result& first_with_trials(const std::vector<Result>& results) noexcept;

Pair compare(const Result& first, const Result& second) noexcept;

/// Compares devices that were measured under the same conditions: filter order, cut-off and gain,
/// a, T, criterion, method, distribution and probability.
///
/// @param[in]  results    Two or more. Equal energies stay in their order.
/// @param[out] comparison Of no use if there is a problem.
/// @returns The first difference between conditions, if there is one, with what to do.
Problem compare_all(std::vector<Result> results, Comparison& comparison);

}  // namespace emax::desk
