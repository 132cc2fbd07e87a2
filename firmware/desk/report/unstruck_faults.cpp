// What is said of faults that a bench was to have, and has not had.
#include "desk/report/unstruck_faults.hpp"

#include <cstdio>

namespace emax::desk {

std::string words_of_unstruck(const sim::SimBench& bench) {
  std::string names;
  for (const sim::Fault& fault : {bench.settings().fault, bench.settings().second_fault}) {
    if (fault.kind != sim::FaultKind::kNone && fault.at_frame >= bench.clock_frames()) {
      names += (names.empty() ? "" : " and ") + std::string(sim::name_of(fault.kind));
    }
  }
  if (names.empty()) {
    return "";
  }
  char end_s[32];
  (void)std::snprintf(end_s, sizeof end_s, "%.3f", bench.now_s());
  return names + " did not strike: the sweep has ended after " + end_s +
         " s; give an earlier time to --bench-fault";
}

}  // namespace emax::desk
