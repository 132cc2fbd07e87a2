// Work shared out to threads.
#pragma once

#include <cstddef>
#include <functional>

namespace emax::desk {

/// A part of a row of things to be done.
struct Share {
  std::size_t index = 0;  ///< Of the share, from 0.
  std::size_t begin = 0;  ///< The first thing,
  std::size_t size = 0;   ///< and how many.
};

/// Cuts `count` things into as many shares of equal size as there are threads, does each in a
/// thread of its own, the last one in this, and waits for all. Where the system gives no more
/// threads, the rest is done in this one.
///
/// @param[in] threads At least 1; there are no more shares than things.
/// @param[in] run     Must not throw.
void share_out(std::size_t threads, std::size_t count,
               const std::function<void(const Share&)>& run);

}  // namespace emax::desk
