// The text of a whole file or of standard input.
#pragma once

#include <cstddef>
#include <string>

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// @returns The file's name for people: "standard input" for "-".
std::string name_of_input(const std::string& path);

/// Reads a file of at most `most` bytes. A stop request ends the wait for somebody who types.
///
/// @param[in]  path        "-" for standard input.
/// @param[in]  expectation What the file should be, as the end of a complaint: "expected ...".
/// @param[out] text        Of no use if there is a problem.
Problem read_text_file(const std::string& path, std::size_t most, const char* expectation,
                       std::string& text);

}  // namespace emax::desk
