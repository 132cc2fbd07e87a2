// Peak and settling time of the impulse response, in short steps.
#pragma once

#include <cstdint>
#include <type_traits>

#include "emax/model/modal_model.hpp"

namespace emax {

/// Samples k at 64 points per period of its fastest mode, and remembers how far it has come.
struct ResponseScan {
  /// Samples of one step, which costs up to some thousand exponentials.
  static constexpr std::uint32_t kSamplesPerStep = 24;

  double step_s = 0.0;
  double slope = 0.0;       ///< Of k at the last sample.
  std::uint32_t taken = 0;  ///< Samples.
  bool running = false;
  bool complete = false;  ///< True if nothing of interest can follow; false if the samples ran out.
};

/// The value of k farthest from zero, to the last digits, and its time; bisects on the derivative.
class PeakSearch {
 public:
  void start(const ModalModel& model) noexcept;
  /// @param[in] model The same in each step.
  void step(const ModalModel& model) noexcept;
  bool done() const noexcept { return !scan_.running; }
  /// @returns With `done()`, the peak.
  Peak result() const noexcept { return best_; }

 private:
  ResponseScan scan_ = {};
  Peak best_ = {};
};

/// The last time at which |k| leaves the band of +-`limit`.
class SettlingSearch {
 public:
  void start(const ModalModel& model, double limit) noexcept;
  /// @param[in] model The same in each step.
  void step(const ModalModel& model) noexcept;
  bool done() const noexcept { return !scan_.running; }
  /// @returns With `done()`, the time; see `ModalModel::settling_time()`.
  SettlingTime result() const noexcept { return {time_s_, scan_.complete}; }

 private:
  ResponseScan scan_ = {};
  double limit_ = 0.0;
  double time_s_ = 0.0;
};

static_assert(std::is_trivially_copyable_v<PeakSearch>);
static_assert(std::is_trivially_copyable_v<SettlingSearch>);

}  // namespace emax
