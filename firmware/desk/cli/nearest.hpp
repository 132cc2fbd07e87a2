// The name that somebody who mistyped it may have meant.
#pragma once

#include <string_view>

#include "emax/base/span.hpp"

namespace emax::desk {

/// @returns The name that the text is the start of, or the other way round; else the one that takes
/// the fewest changes of single characters, but of no more than half of the text: empty if there is
/// none. Leading dashes do not count.
std::string_view nearest(std::string_view text, Span<const std::string_view> names);

}  // namespace emax::desk
