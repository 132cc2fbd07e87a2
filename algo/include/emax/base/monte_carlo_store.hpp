// The memory of a Monte Carlo procedure, in a file of its own: code that only lends this memory
// need not know the procedure.
#pragma once

#include <cstddef>
#include <cstdint>

namespace emax {

/// Memory for `MonteCarlo`: 16 KiB. No initialisers, as it may share its place with other things.
struct MonteCarloStore {
  static constexpr std::size_t kBins = 2048;
  static constexpr std::size_t kPoolSize = 1024;

  std::uint64_t pool[kPoolSize];
  std::uint32_t bins[kBins];
};

}  // namespace emax
