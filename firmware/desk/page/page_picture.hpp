// A picture inside a page.
#pragma once

#include <cstddef>
#include <string>

namespace emax::desk {

/// What is said of a picture; text of others may be in it.
struct PictureWords {
  std::string title;    ///< What it shows, for those who do not see it.
  std::string caption;  ///< What to look at.
};

/// Adds what gnuplot has drawn to a page.
///
/// @param[in] svg    The content of its file.
/// @param[in] number Another one for each picture of a page: the parts of the picture are named by
///                   it.
void append_picture(std::string& html, const std::string& svg, const PictureWords& words,
                    std::size_t number);

}  // namespace emax::desk
