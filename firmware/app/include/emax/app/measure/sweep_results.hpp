// What a sweep leaves: the points with their budget, and why it ended early if it did.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/sweep_budget.hpp"
#include "emax/app/settings/settings_error.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// One measured point with what was seen on the way.
struct SweepPoint {
  ResponsePoint point;  ///< Without the common part in its uncertainties.
  PointBudget budget;
  double acceleration_mps2 = 0.0;  ///< Peak.
  double drive_v = 0.0;            ///< Peak.
  float residual_percent = 0.0F;   ///< What the sine leaves over, of the amplitude, worse channel.
  bool flagged = false;            ///< Residual, distortion or scatter beyond its limit.
  bool scatters = false;           ///< Flagged for its scatter.
};

enum class SweepStage : std::uint8_t {
  kIdle,
  kSilence,      ///< Offsets, noise and hum, with the drive at zero.
  kCheckBefore,  ///< The check frequency.
  kPoints,
  kCheckAfter,
  kDone,
  kFailed,
};

/// The results of a sweep, while it runs and afterwards. 11 KiB, all zero before the first one.
struct SweepResults {
  SweepSettings settings;
  BudgetInputs inputs;  ///< With both channels without drive.
  CommonBudget common;  ///< Complete when `done()`; without drift unless both checks were measured.
  ChannelNoise noise;   ///< Pooled over the points, when `done()`.
  SharedEffects shared;   ///< When `done()`.
  SettingsError refused;  ///< What the last start refused, if it did.
  /// The ratio at the check frequency in V/(m/s^2), before and after the points; 0 if not measured.
  Complex check_before;
  Complex check_after;
  double failed_frequency_hz = 0.0;  ///< Where it failed; 0 in the silence or if it has not.
  /// What a drive of five steps of 12 bits makes, where it failed with fewer or with a limit below
  /// that; 0 if it did not.
  double least_level_mps2 = 0.0;
  std::uint64_t blocks = 0;  ///< Exchanged so far.
  std::size_t point_count = 0;
  SweepStage stage = SweepStage::kIdle;
  bool may_swing = false;  ///< The shaker, after a fault: the next sweep waits for rest first.
  /// kOk while the sweep runs and after a good end; else why it failed:
  /// * kLostBlock, kLateBlock, kHardwareFault, kNotRunning: The stream.
  /// * kSaturated: A channel at full scale at a sixteenth of the level, or without drive, or a
  ///   ratio that is far off after the drive was lowered; or full scale leaves so little level that
  ///   the drive has few steps.
  /// * kStuckChannel: The same word for a whole period of the drive.
  /// * kNoReference, kNoDevice: One channel at the level of noise while the other has a signal.
  /// * kWeakSignal: Both, at the largest permitted drive; or a drive of few steps for the level.
  /// * kLevelNotReached: The level needs more drive than amplitude and slope permit.
  /// * kSwappedChannels: A ratio as of exchanged channels, or far from the expected one.
  /// * kInvertedPolarity: A phase half a turn off.
  /// * kDistorted: What the sine leaves over, or the differences between repeats, beyond 10 %.
  /// * kDcDrift: An offset that wanders.
  /// * kHum: Mains at the frequency, above 10 % of the ratio, at the check frequency above 2 %.
  /// * kFewSteps: The limit of acceleration is below what the drive's converter can set.
  /// * kStopped: `Sweep::stop()`.
  /// What disturbs a repeat is looked at twice: the frequency is measured again, once.
  Status status = Status::kOk;
  std::array<SweepPoint, kMaxPoints> table = {};  ///< `points()` is the part in use.

  /// @returns True unless a sweep runs.
  bool done() const noexcept {
    return stage == SweepStage::kIdle || stage == SweepStage::kDone || stage == SweepStage::kFailed;
  }
  /// @returns 0 to 1, by the number of frequencies.
  double progress() const noexcept;
  /// The points measured so far; their uncertainties are there when `done()`.
  Span<const SweepPoint> points() const noexcept {
    return Span<const SweepPoint>(table).first(point_count);
  }
  /// @returns Whether one of these points was measured by this sweep: the same frequency and
  /// amplitude, to the last bit.
  bool has_measured(Span<const ResponsePoint> any) const noexcept;
  /// Puts the points with their common part into a table for the fit, in place of what it held.
  ///
  /// @returns kOk, or kNotRunning if no sweep is done: the table is then empty.
  Status copy_to(FrequencyResponse& response) const noexcept;
};

static_assert(std::is_trivially_copyable_v<SweepResults>);
static_assert(!kHasDefaultCapacities || sizeof(SweepResults) <= 11 * 1024);
static_assert(!kHasDefaultCapacities ||
              sizeof(SweepResults) + sizeof(FrequencyResponse) <= 16 * 1024);

}  // namespace emax::app
