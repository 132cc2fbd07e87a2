// UTF-8 in strings.
#pragma once

#include <cstdint>
#include <string>

namespace emax::desk {

/// Adds one character, of a code of at most U+10FFFF, to a text in UTF-8 (RFC 3629).
void append_utf8(std::uint32_t code, std::string& text);

}  // namespace emax::desk
