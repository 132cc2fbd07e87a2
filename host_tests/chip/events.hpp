// The chip's time, and what is due when.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>

namespace emax::chip {

/// Time since power was first on, in ticks.
using Time = std::uint64_t;

/// The cycles of 480, 400, 200, 170, 160, 150, 144, 100, 85, 80, 64, 24, 16 and 8 MHz and of 32 kHz
/// are whole ticks.
inline constexpr Time kTicksPerSecond = 244'800'000'000U;
inline constexpr Time kNever = std::numeric_limits<Time>::max();

constexpr double seconds(Time ticks) {
  return static_cast<double>(ticks) / static_cast<double>(kTicksPerSecond);
}
constexpr Time ticks(double time_s) {
  return static_cast<Time>(time_s * static_cast<double>(kTicksPerSecond) + 0.5);
}

/// A queue in order of time; what is due at the same time is done in the order of asking.
class Events {
 public:
  using Action = std::function<void()>;
  /// Names what waits; zero names nothing.
  using Id = std::uint64_t;

  Time now() const { return now_; }
  Id at(Time due, Action action);
  Id after(Time delay, Action action) { return at(now_ + delay, std::move(action)); }
  /// Forgets what waits; nothing happens if it has been done.
  void cancel(Id id);
  void clear();
  Time next() const { return waiting_.empty() ? kNever : waiting_.begin()->first.first; }

  /// Moves on without doing anything.
  void pass(Time delay) { now_ += delay; }
  /// Does all that is due by now, each at its own time.
  void run_due();

 private:
  std::map<std::pair<Time, Id>, Action> waiting_;
  std::map<Id, Time> due_;
  Time now_ = 0;
  Id last_ = 0;
};

}  // namespace emax::chip
