// The timer that resets the board when the program hangs.
#pragma once

#include <cstdint>

#include "emax/base/status.hpp"

namespace emax::hal {

/// A watchdog. Once it is started, a pause of one period without a kick resets the board, which
/// then starts with the drive at zero.
class Watchdog {
 public:
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// Starts the first period. Nothing ends it but a reset.
  ///
  /// @returns
  /// * kOk: `kick()` more often than every period from now on.
  /// * kAlreadyRunning: The running period goes on; this call does not count as a kick.
  /// * kHardwareFault: The timer did not start as it should, or the board states a period of zero.
  ///   Should it run nevertheless, `kick()` holds it.
  Status start() noexcept;

  /// Starts the period anew. Does nothing before `start()`. Does not wait.
  void kick() noexcept;

  /// @returns The least time from a kick to the reset. Constant for the life of the object.
  std::uint32_t period_us() const noexcept { return period_us_; }
  bool running() const noexcept { return running_; }
  /// @returns True if it was started and cannot be relied on; false on a board that states a period
  ///   of zero, for none.
  bool failed() const noexcept { return has_begun_ && !running_; }

  /// @returns True if the last reset of the board came from its watchdog.
  bool caused_reset() const noexcept { return do_caused_reset(); }

 protected:
  constexpr explicit Watchdog(std::uint32_t period_us) noexcept : period_us_(period_us) {}
  ~Watchdog() = default;

 private:
  /// @returns kOk or kHardwareFault.
  virtual Status do_start() noexcept = 0;
  virtual void do_kick() noexcept = 0;
  virtual bool do_caused_reset() const noexcept = 0;

  const std::uint32_t period_us_;
  bool has_begun_ = false;
  bool running_ = false;
};

}  // namespace emax::hal
