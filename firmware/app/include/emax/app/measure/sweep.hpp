// The back-to-back calibration: stepped sine over the frequencies, levelled, fitted, budgeted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/sweep_results.hpp"
#include "emax/base/complex.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"

namespace emax {

struct SineFitResult;

namespace app {

class SweepWorkspace;

/// Runs the calibration block by block; nothing ever waits longer than one block.
///
///     Sweep sweep(results, workspace, stream);
///     sweep.start(settings);
///     while (!sweep.done()) {
///       sweep.step();
///     }
///
/// At each frequency the drive moves to the amplitude that the last one needed per acceleration,
/// rests, and takes repeats of whole periods, each with a fit on both channels. The first repeat
/// also tells the level: where it is off, the drive is corrected by the ratio and the frequency
/// begins anew. Overrange halves the drive and with it the level, for this frequency and, doubling
/// again, for those after it. The first look is at little drive, which under a small limit of
/// acceleration rises over two seconds, and at less where that is too much; a level that would take
/// a channel beyond its full scale is lowered from then on.
///
/// The limit of acceleration does not hang on the reference alone. A step to more than 1.5 times
/// the drive that the frequency before predicts is refused until a second look at half of the drive
/// agrees with the first, and where the device's channel contradicts it: a reference that reads a
/// tenth less per drive from one look to the next at a frequency, while the device does not, ends
/// the sweep. The cables are judged before the level follows the reference; a reading that is no
/// sine is no reason for more drive; and while nothing was seen at all, a tenth of the drive limit
/// is the most, and what noise may hide is below the limit of acceleration. Channels of which the
/// device's reads more than the data sheet lets it, as exchanged ones do, are refused at the first
/// look. As long as an exchange is not excluded, the level is kept below the limit by either
/// channel, read as the reference: without a data sheet this alone protects. A device without a
/// signal lets no reading of the reference raise the drive.
///
/// A run is three references: what it has found so far is in the results, what it needs to go on in
/// the workspace. A new one on the same three goes on where the last one was. Nobody else may write
/// to them while a sweep runs. Results take at most 11 KiB and the workspace 13, whatever the
/// number of samples, and no call takes longer for a longer record. Every end, good or bad, leaves
/// the drive at zero: a normal one along a ramp, a fault along the permitted slope within 256
/// frames.
class Sweep {
 public:
  /// All three outlive this object.
  Sweep(SweepResults& results, SweepWorkspace& workspace, hal::AnalogStream& stream) noexcept
      : results_(results), work_(workspace), stream_(stream) {}

  /// Starts the stream and the sweep. Results of before are lost if it answers kOk.
  ///
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: A setting that is refused: `refused` of the results names it. Nothing else
  ///   has changed.
  /// * kAlreadyRunning: A sweep runs. Nothing has changed.
  /// * Else what the stream answered. Nothing has changed.
  Status start(const SweepSettings& settings) noexcept;

  /// Exchanges one block; nothing unless a sweep runs.
  void step() noexcept;

  /// Ends the sweep at once: the drive is led to zero; what was measured stays. Status kStopped.
  /// Nothing unless a sweep runs.
  void stop() noexcept;

  /// @returns True unless a sweep runs.
  bool done() const noexcept { return results_.done(); }

 private:
  /// By how much an offset may move within the silence or within a frequency, of full scale.
  static constexpr double kWanderShare = 0.002;
  /// What noise hardly ever exceeds, in standard deviations.
  static constexpr double kNoisePeak = 6.0;

  struct Reading;

  void reset() noexcept;
  void take_frames() noexcept;
  void watch() noexcept;
  double reference_peak_v() const noexcept;
  void lower_level(bool full_scale) noexcept;
  void consume(std::size_t from, std::size_t count) noexcept;
  void end_activity() noexcept;
  void end_silence() noexcept;
  void foresee_resonance() noexcept;
  void foresee_ringing() noexcept;
  void begin_target(double frequency_hz) noexcept;
  double rise_s() const noexcept;
  void drive_to(double amplitude_v) noexcept;
  void begin_repeat() noexcept;
  void end_repeat() noexcept;
  Reading reading_of(const SineFitResult& fit, const SilentChannel& silent) const noexcept;
  void judge_first(const Reading& reference, const Reading& device) noexcept;
  Status status_at_first(const Reading& reference, const Reading& device) noexcept;
  bool has_lost_gain(const Reading& reference, const Reading& device) noexcept;
  bool is_level_little() const noexcept;
  void fail_at_level() noexcept;
  double room_mps2(double reference_v, double device_v) const noexcept;
  double least_expected() const noexcept;
  bool may_rise(const Reading& reference, const Reading& device, double needed_v) noexcept;
  bool look_for_exchange(const Reading& reference, const Reading& device) noexcept;
  double seen_v(const Reading& reference, const Reading& device) const noexcept;
  void raise_drive(const Reading& reference, const Reading& device) noexcept;
  double offset_change_v(double reference_v, double device_v) const noexcept;
  bool has_left_silence(const Reading& reference, const Reading& device) const noexcept;
  Status disturbance_of(const Reading& reference, const Reading& device) const noexcept;
  void suspect(Status status) noexcept;
  Status distortion() const noexcept;
  double few_steps_v() const noexcept;
  double first_drive_v() const noexcept;
  bool has_few_steps() const noexcept;
  Status status_of_steps() const noexcept;
  Status few_steps() const noexcept;
  void end_target() noexcept;
  bool is_neighbour() const noexcept;
  bool has_turned_round(const Complex& ratio, const Complex& before) const noexcept;
  double inverse_slope() const noexcept;
  Complex inverse_expected() const noexcept;
  Status plausibility_of(const Complex& ratio, double noise, double turn_rad = 0.0) const noexcept;
  void store_point(const PointScatter& scatter, const Complex& ratio) noexcept;
  void begin_next() noexcept;
  void fail(Status status) noexcept;
  void finish() noexcept;
  void share_effects(double check_change) noexcept;
  double acceleration_of(double reference_v) const noexcept;
  double aim_mps2() const noexcept;
  double most_mps2() const noexcept;
  double ratio_factor() const noexcept;
  double sheet_v_per_v() const noexcept;
  Complex ratio_of(const Complex& reference, const Complex& device) const noexcept;

  SweepResults& results_;
  SweepWorkspace& work_;
  hal::AnalogStream& stream_;
};

static_assert(std::is_trivially_copyable_v<Sweep>);

}  // namespace app
}  // namespace emax
