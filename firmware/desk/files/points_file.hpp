// A table of measured points from a file or from standard input.
#pragma once

#include <string>

#include "emax/identify/frequency_response.hpp"

#include "desk/cli/problem.hpp"
#include "desk/import/import_points.hpp"

namespace emax::desk {

/// Reads the points of a table (`desk::import_points()`) of at most 1 MiB.
///
/// @param[in]  path              "-" for standard input.
/// @param[in]  options           What the command line says about the table.
/// @param[in]  reference_percent The reference's expanded uncertainty, which is within that of each
///                               amplitude and is made the part common to all points; 0 for none.
/// @param[out] imported          The points; of no use if there is a problem.
/// @returns The problem with file name, line and expectation, if there is one.
Problem read_points(const std::string& path, const desk::ImportOptions& options,
                    double reference_percent, desk::ImportedPoints& imported);

}  // namespace emax::desk
