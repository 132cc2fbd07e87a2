// What in a table is unlikely, though it can be read.
#pragma once

#include <string>
#include <vector>

#include "desk/import/conversions.hpp"
#include "desk/import/find_table.hpp"
#include "desk/import/import_options.hpp"
#include "desk/import/merge_rows.hpp"

namespace emax::desk {

/// @returns Sentences that ask about units which nobody has named: amplitudes that no usual
/// accelerometer has in V/(m/s^2), uncertainties that look like percent. Empty if all is likely.
std::string doubts_of(const FoundTable& table, const Conversions& by, const ImportOptions& options,
                      const std::vector<Row>& rows);

}  // namespace emax::desk
