#include "chip/findings.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace emax::chip {

void Findings::locate_with(const Events* events, std::function<std::uint32_t()> block) {
  events_ = events;
  block_ = std::move(block);
}

void Findings::report(const std::string& what, const std::string& where, std::uint32_t value) {
  const std::uint32_t block = block_ ? block_() : 0;
  const auto same = std::find_if(all_.begin(), all_.end(), [&](const Finding& known) {
    return known.what == what && known.where == where && known.block == block;
  });
  if (same != all_.end()) {
    ++same->times;
    return;
  }
  all_.push_back({what, where, value, block, events_ ? events_->now() : 0, 1});
}

bool Findings::has(const std::string& what) const {
  return std::any_of(all_.begin(), all_.end(),
                     [&](const Finding& finding) { return finding.what == what; });
}

std::string Findings::text() const {
  std::string text;
  for (const Finding& finding : all_) {
    char line[256];
    std::snprintf(line, sizeof line, "%s at %s, value 0x%08x, block 0x%08x, %.9f s, %u times\n",
                  finding.what.c_str(), finding.where.c_str(), finding.value, finding.block,
                  seconds(finding.at), finding.times);
    text += line;
  }
  return text;
}

}  // namespace emax::chip
