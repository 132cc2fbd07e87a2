// Which commit the program was built from.
#pragma once

namespace emax::desk {

/// @returns The first ten digits of the commit, with " and changes" where there were any; empty
/// where the sources are no repository. The build makes the source of it.
const char* commit() noexcept;

}  // namespace emax::desk
