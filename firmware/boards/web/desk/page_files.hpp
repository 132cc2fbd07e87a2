// The files of the PC program's code in a browser: texts that the page hands over by name.
#pragma once

#include <string>
#include <string_view>

namespace emax::web {

/// From here on `desk::read_text_file()` finds these; those of before are forgotten.
void forget_files() noexcept;

/// @param[in] text Outlives the reading.
void add_file(std::string name, std::string_view text);

}  // namespace emax::web
