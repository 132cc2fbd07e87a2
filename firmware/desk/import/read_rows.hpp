// The rows of a table as numbers.
#pragma once

#include <vector>

#include "desk/import/conversions.hpp"
#include "desk/import/find_table.hpp"
#include "desk/import/import_error.hpp"
#include "desk/import/import_options.hpp"
#include "desk/import/merge_rows.hpp"

namespace emax::desk {

/// Reads every row behind the header, in the order of the table, in Hz, V/(m/s^2) and rad with
/// standard uncertainties.
///
/// @param[out] rows Of no use after an error, which names the first cell that is no such number.
ImportError read_rows(const FoundTable& table, const Conversions& conversions,
                      const ImportOptions& options, std::vector<Row>& rows);

}  // namespace emax::desk
