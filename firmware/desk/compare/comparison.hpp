// Devices side by side: the order that their uncertainties carry.
#pragma once

#include <cstddef>
#include <vector>

#include "desk/cli/problem.hpp"
#include "desk/files/result_file.hpp"

namespace emax::desk {

/// What the figures of two devices say of one another.
struct Pair {
  double difference = 0.0;  ///< The second one's figure minus the first one's.
  /// U of the difference; 0 unless `has_uncertainty`. The devices' uncertainties count as
  /// independent: what they share, such as the reference sensor, would only make it smaller.
  double expanded = 0.0;
  /// The interval of the difference, as far as that of each figure reaches to that side: +-U, but
  /// for figures at one end of their intervals. With `has_uncertainty`.
  double low = 0.0;
  double high = 0.0;
  bool is_one_sided = false;  ///< One of the figures is.
  /// One of the figures has the range over its open damping in the place of U.
  bool has_range = false;
  /// How far the difference can be off beside that, by the way the figures are computed.
  double epsilon = 0.0;
  bool has_uncertainty = false;  ///< Both devices have one, or such a range.
  /// Neither fit warns and neither bench was simulated. Of others nothing is said: u is too small
  /// where the fit warns, and a simulated bench says nothing of a device.
  bool is_compared = false;
  /// The points of one of the two do not determine its damping, and no range of its figure is
  /// known: it has a place, but the other may be better or worse.
  bool has_open_damping = false;
  bool told_apart = false;  ///< Compared, and 0 is outside the interval of the difference.
  /// Able to be told apart, and even the first one's upper bound is below the second one's figure:
  /// true at the estimates for whatever signal.
  bool proven = false;
};

/// A device's place: one more than the number of those that are better and can be told apart from
/// it, up to the number of all less those that are worse and can be told apart.
struct Rank {
  std::size_t best = 0;
  std::size_t worst = 0;
};

struct Comparison {
  FigureKind asked = FigureKind::kMatched;  ///< What to rank by.
  /// What they are ranked by: kBand in place of kMatched where a device has no matched figure.
  FigureKind by = FigureKind::kMatched;
  std::vector<Result> results;  ///< By ascending figure: the most accurate device first.
  std::vector<Rank> ranks;      ///< Of each.
  std::vector<Pair> pairs;      ///< Each with its successor; one fewer.

  const Figure& figure(const Result& result) const noexcept { return result.figure(by); }
};

/// @returns Whether the fit of a device warns or leaves its damping open, or its bench was
/// simulated.
bool is_marked(const Result& result) noexcept;

/// @returns Whether its damping is open and no range of the figure that ranks is known.
bool is_without_range(const Result& result, FigureKind by) noexcept;

/// @returns Whether nobody can say which of two devices is better if this is one of them.
bool is_told_from_none(const Result& result, FigureKind by) noexcept;

/// @returns The probability of the intervals that `comparison` has; 0 if it has none.
double probability_of(const Comparison& comparison) noexcept;

/// Compares two devices; the figure of the first is no more than that of the second.
///
/// How far the difference reaches to a side is the root of the sum of the squares of how far the
/// figures do (Zou and Donner, Statistics in Medicine 27 (2008) 1693): for intervals of any shape,
/// and +-U of the difference for symmetric ones. Over a range nothing is more likely than the rest,
/// so that with one of them the reaches add up: a device is better if even its greatest figure is
/// below the least of the other.
Pair compare(const Result& first, const Result& second, FigureKind by) noexcept;

/// Compares devices that were measured under the same conditions: filter order, cut-off and gain,
/// T, criterion, method, the probability of the intervals, and the delay taken out of the figure
/// that ranks; for kEnergy also a. The figures of the band are in percent of S a, which may differ.
///
/// @param[in]  results    Two or more. Equal figures stay in their order.
/// @param[in]  asked      What to rank by.
/// @param[out] comparison Of no use if there is a problem.
/// @returns The first difference between conditions, or the first file without figures of the
/// band where they are needed, with what to do.
Problem compare_all(std::vector<Result> results, FigureKind asked, Comparison& comparison);

}  // namespace emax::desk
