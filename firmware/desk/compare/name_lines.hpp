// Names of devices in lines of a limited width: wrapped, and cut at their end only.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "desk/files/result_file.hpp"

namespace emax::desk {

/// How many characters of a name there are room for anywhere, in as many lines as it takes: as many
/// as a report shows. Longer ones are cut.
inline constexpr std::size_t kNameShown = 240;

/// @returns The device's label or file with its serial number, in one printable line; with the file
/// in brackets where another result has the same label and number.
std::string name_of(const Result& result);

/// How wide characters are: one each in columns of text, by their shape in a picture.
enum class Typeface { kMonospaced, kProportional };

/// @returns The width of printable text, in small letters.
double width_of(const std::string& text, Typeface typeface);

/// Breaks printable text, at a blank where there is one.
///
/// @param[in] width Of a line, at least 4.
/// @param[in] most  Lines, at least 1. Of text that needs more the end is cut, as "..." says.
std::vector<std::string> wrapped(const std::string& text, double width, std::size_t most,
                                 Typeface typeface = Typeface::kMonospaced);

/// @returns `name_of()` in lines. Where that is too much, the device's name and the serial number
/// are cut at their ends, each by itself.
std::vector<std::string> name_lines(const Result& result, double width, std::size_t most,
                                    Typeface typeface = Typeface::kMonospaced);

/// @returns `name_of()` in one line of at most so many characters, 12 or more.
std::string short_name_of(const Result& result, std::size_t most = kNameShown);

/// @param[in] last Word before the last one: "and" or "or".
/// @returns "A, B and C" by `short_name_of()`; beyond the fifth "and 3 others".
std::string list_of(const std::vector<const Result*>& results, const char* last = "and");

}  // namespace emax::desk
