// What is said of faults that a bench was to have, and has not had.
#pragma once

#include <string>

#include "emax/sim/sim_bench.hpp"

namespace emax::desk {

/// @returns "dc-drift did not strike: the sweep has ended after 6.123 s; ..." with all faults of
/// the bench's script that its clock has not reached; empty if there are none.
std::string words_of_unstruck(const sim::SimBench& bench);

}  // namespace emax::desk
