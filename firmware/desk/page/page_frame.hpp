// The frame of every page of the program: its head with the style, its end, and figures in a
// headline. A page needs nothing from outside itself and no scripts.
#pragma once

#include <string>

#include "emax/app/base/text_writer.hpp"

namespace emax::desk {

/// @param[in] title The heading, as HTML.
/// @param[in] kind  What follows the heading in the title of the window: " - emax report".
/// @param[in] about A sentence below the heading, as HTML.
/// @param[in] banner What every reader of every printed page must see, as HTML; empty for nothing.
///                   With one, SIMULATION stands across every printed page.
/// @param[in] running What stands below every printed page, beside its number: text of others.
/// @returns All up to and with the header of the page.
std::string page_opening(const std::string& title, const std::string& kind,
                         const std::string& about, const std::string& banner,
                         const std::string& running = "");

/// @param[in] files What is in the files beside the page, as HTML.
/// @returns The end of the page.
std::string page_closing(const std::string& files);

/// Adds one figure to a list with the class "headline".
///
/// @param[in] kind  ` class="first"` for the one that leads, or nothing.
/// @param[in] name  As HTML.
/// @param[in] value As HTML.
void append_figure(std::string& html, const char* kind, const std::string& name,
                   const std::string& value);

void write_html(app::TextWriter& out, const std::string& html);

}  // namespace emax::desk
