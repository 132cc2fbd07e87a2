// The name that somebody who mistyped it may have meant.
#pragma once

#include <string_view>

#include "emax/base/span.hpp"

namespace emax::desk {

/// @param[in] names At least one.
/// @returns The name that the text is the start of, or the other way round; else the one that takes
/// the fewest changes of single characters.
std::string_view nearest(std::string_view text, Span<const std::string_view> names);

}  // namespace emax::desk
