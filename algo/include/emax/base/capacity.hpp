// How much the fixed tables hold. The build may choose it, the same for all libraries.
#pragma once

#include <cstddef>

// CMake passes its cache variables of these names to the libraries and to all that link them.
// A build without CMake defines them for all sources alike, or for none.
#ifndef EMAX_MAX_SWITCHES
#define EMAX_MAX_SWITCHES 256
#endif
#ifndef EMAX_MAX_CELLS
#define EMAX_MAX_CELLS 8192
#endif
#ifndef EMAX_PHI_CELLS
#define EMAX_PHI_CELLS 128
#endif
#ifndef EMAX_MAX_POINTS
#define EMAX_MAX_POINTS 64
#endif

/// The value of a macro as text, for messages.
#define EMAX_TEXT_OF(macro) EMAX_TEXT(macro)
#define EMAX_TEXT(text) #text

namespace emax {

/// The most switches that a signal may have; 8 to 4096.
inline constexpr std::size_t kMaxSwitches = EMAX_MAX_SWITCHES;
/// The most cells that a grid may have; 512 to 65536.
inline constexpr std::size_t kMaxCells = EMAX_MAX_CELLS;
/// The workspace of a search has room for the packed triangle of Phi with this many cells at least;
/// 32 to 1024. Bounds depend on it, so that it is the same for a board and a PC.
inline constexpr std::size_t kPhiCells = EMAX_PHI_CELLS;
/// The most points of a frequency response; 3 to 1024.
inline constexpr std::size_t kMaxPoints = EMAX_MAX_POINTS;

static_assert(kMaxSwitches >= 8 && kMaxSwitches <= 4096, "EMAX_MAX_SWITCHES is 8 to 4096");
static_assert(kMaxCells >= 512 && kMaxCells <= 65536, "EMAX_MAX_CELLS is 512 to 65536");
static_assert(kPhiCells >= 32 && kPhiCells <= 1024, "EMAX_PHI_CELLS is 32 to 1024");
static_assert(kMaxPoints >= 3 && kMaxPoints <= 1024, "EMAX_MAX_POINTS is 3 to 1024");

/// True for the capacities that the budgets of memory are stated for.
inline constexpr bool kHasDefaultCapacities =
    kMaxSwitches == 256 && kMaxCells == 8192 && kPhiCells == 128 && kMaxPoints == 64;

}  // namespace emax
