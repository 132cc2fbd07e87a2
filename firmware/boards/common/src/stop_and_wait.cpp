// The end of a product that cannot go on.
#include "emax/board/fault_report.hpp"

namespace emax::board {

void stop(int status) noexcept {
  (void)status;
  for (;;) {
    asm volatile("wfi");
  }
}

}  // namespace emax::board
