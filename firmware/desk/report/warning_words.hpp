// What a warning says, with the number that it asks for.
#pragma once

#include <string>

namespace emax::desk {

/// @param[in] words        Of a warning, without a full stop.
/// @param[in] least_time_s The T that it asks for in s; 0 if it asks for none.
/// @returns The words, and that T in three digits where there is one.
std::string sentence_of(const std::string& words, double least_time_s);

}  // namespace emax::desk
