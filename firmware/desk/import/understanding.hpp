// What was understood of a table, in one line.
#pragma once

#include <string>

#include "desk/import/conversions.hpp"
#include "desk/import/find_table.hpp"
#include "desk/import/import_options.hpp"
#include "desk/import/merge_rows.hpp"

namespace emax::desk {

/// @returns "read as Hz, mV/g, deg, percent; 20 points; tabs; decimal comma": units, number of
/// points, what was changed, and the form where it is not the usual one.
std::string understanding_of(const FoundTable& table, const Conversions& by,
                             const ImportOptions& options, const MergedRows& merged);

}  // namespace emax::desk
