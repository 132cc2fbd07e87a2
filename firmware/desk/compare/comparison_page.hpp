// A comparison as one page for a browser or a printer, with its picture inside.
#pragma once

#include <string>

#include "emax/app/base/text_writer.hpp"

#include "desk/compare/comparison.hpp"

namespace emax::desk {

/// Writes a page in UTF-8 that needs nothing from outside itself and no scripts.
///
/// @param[in] svg The picture as gnuplot has drawn it; empty if there is none, which the page says.
void write_comparison_page(const Comparison& comparison, const std::string& svg,
                           app::TextWriter& out);

}  // namespace emax::desk
