// A line on the terminal that says how far the work is.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace emax::desk {

/// Shows stage, percent and elapsed time on standard error, in one line that is rewritten: only on
/// a terminal, and only once the work has lasted for half a second. The line is erased at the end.
class ConsoleProgress final {
 public:
  ConsoleProgress() noexcept;
  ConsoleProgress(const ConsoleProgress&) = delete;
  ConsoleProgress& operator=(const ConsoleProgress&) = delete;
  ~ConsoleProgress() { erase(); }

  /// What is known before the long work: a line of its own that stays, above the first that is
  /// shown. Work that ends at once never shows it.
  void announce(const std::string& line) { announced_ = line; }

  /// May be called as often as one likes: the line changes ten times a second at most.
  ///
  /// @param[in] fraction Of the stage, 0 to 1.
  void show(const char* stage, double fraction) noexcept;
  void erase() noexcept;

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point start_;
  Clock::time_point next_;
  std::string announced_;
  std::size_t shown_ = 0;  // Characters of the line on the screen.
  bool is_terminal_;
};

}  // namespace emax::desk
