// The converter's step from the bits of its words.
#include "emax/app/measure/channel_monitor.hpp"

namespace emax::app {

double ChannelMonitor::step() const noexcept {
  if (all_bits_ == 0) {
    return 0.0;
  }
  const std::uint32_t lowest = all_bits_ & (~all_bits_ + 1u);
  return static_cast<double>(lowest) / hal::kWordsPerFullScale;
}

}  // namespace emax::app
