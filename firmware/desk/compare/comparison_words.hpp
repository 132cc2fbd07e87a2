// What is said of a comparison, in plain ASCII but for names, for text and page alike.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "desk/compare/comparison.hpp"

namespace emax::desk {

/// A name with what is said of it.
struct Fact {
  std::string name;
  std::string words;
};

/// What must be known to read the ranks right.
struct Note {
  std::string words;
  bool is_warning = false;  ///< The ranks are not what they seem to be.
};

/// One row per device below headings.
struct ComparisonTable {
  std::vector<std::string> headings;
  std::vector<std::vector<std::string>> rows;
  std::size_t names = 0;  ///< Which column has the devices' names, in full.
};

/// @returns "2", or "2-4" where the uncertainties do not say which.
std::string text_of(const Rank& rank);

/// @returns "fit", "beta", "sim", several of them for a device that is told apart from no other;
/// else empty.
std::string mark_of(const Result& result);

/// @returns "SIMULATION: ..." for the top of text and page, and for the title of the picture; empty
/// if all was measured.
std::string banner_of(const Comparison& comparison);

/// @returns What the energy is that of: "integral-square error", for instance.
std::string criterion_of(const Result& result);
/// The same for all; the delay taken out of the energy may differ where the energy does not rank.
std::string criterion_of(const Comparison& comparison);

/// @returns Filter, signal, criterion, and what ranks.
std::vector<Fact> conditions_of(const Comparison& comparison);

/// @returns Rank, device, mark if there is one, the three figures, and U, interval and bound of the
/// one that ranks.
ComparisonTable table_of(const Comparison& comparison);

/// @returns What columns and marks mean.
std::vector<Fact> legend_of(const Comparison& comparison);

/// @returns As warnings that another figure than the one asked for ranks, and which devices are not
/// compared; besides where u(E) comes from, and that the order in percent is another one.
std::vector<Note> notes_of(const Comparison& comparison);

/// @param[in] index Of a pair.
/// @returns "told apart", "CANNOT BE TOLD APART", "CANNOT BE RANKED" or "not compared" as the name,
/// and why.
Fact verdict_of(const Comparison& comparison, std::size_t index);

}  // namespace emax::desk
