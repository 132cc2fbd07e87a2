// A line on the terminal that says how far the work is.
#include "desk/cli/console_progress.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace emax::desk {

namespace {

constexpr auto kPatience = std::chrono::milliseconds(500);
constexpr auto kInterval = std::chrono::milliseconds(100);

}  // namespace

ConsoleProgress::ConsoleProgress() noexcept
    : start_(Clock::now()), next_(start_ + kPatience), is_terminal_(isatty(STDERR_FILENO) == 1) {}

void ConsoleProgress::show(const char* stage, double fraction) noexcept {
  if (!is_terminal_) {
    return;
  }
  const auto now = Clock::now();
  if (now < next_) {
    return;
  }
  next_ = now + kInterval;
  if (!announced_.empty()) {
    std::fprintf(stderr, "emax: %s\n", announced_.c_str());
    announced_.clear();
  }
  const auto elapsed = std::chrono::duration_cast<std::chrono::seconds>(now - start_).count();
  const int percent = static_cast<int>(100.0 * std::clamp(fraction, 0.0, 1.0));
  char line[79];
  std::snprintf(line, sizeof line, "emax: %s %d %%, %lld s", stage, percent,
                static_cast<long long>(elapsed));
  const std::size_t length = std::strlen(line);
  const std::size_t blanks = shown_ > length ? shown_ - length : 0;
  std::fprintf(stderr, "\r%s%*s", line, static_cast<int>(blanks), "");
  shown_ = length;
}

void ConsoleProgress::erase() noexcept {
  if (shown_ == 0) {
    return;
  }
  std::fprintf(stderr, "\r%*s\r", static_cast<int>(shown_), "");
  shown_ = 0;
}

}  // namespace emax::desk
