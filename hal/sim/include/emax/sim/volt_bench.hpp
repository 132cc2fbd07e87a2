// A test bench in volts and virtual time: amplifier, shaker, two sensors, conditioners, and their
// faults. Any converter can be put in front of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/elementary.hpp"
#include "emax/base/status.hpp"
#include "emax/sim/noise.hpp"
#include "emax/sim/plant.hpp"

namespace emax::sim {

/// By how much the conditioner's gain jumps in FaultKind::kSaturation.
inline constexpr double kSaturationFactor = 20.0;
/// Volts per second by which the offset climbs in FaultKind::kDcDrift.
inline constexpr double kOffsetClimbPerSecond_v = 5.0;

/// By how much the device's gain changes in FaultKind::kGainStep.
inline constexpr double kGainStepFactor = 1.25;

/// The amplitude of a sine at which a channel's gain has changed by its linearity error, where the
/// front end has no full scale of its own.
inline constexpr double kLinearScale_v = 10.0;

/// What goes wrong: once, or from then on.
enum class FaultKind : std::uint8_t {
  kNone,
  kLostBlock,           ///< Once: a block of response vanishes; the frame index jumps.
  kLateBlock,           ///< Once: no block within two block times.
  kStuckChannel,        ///< The device's ADC repeats its last word.
  kSaturation,          ///< The device's conditioner multiplies by kSaturationFactor more.
  kUnpluggedReference,  ///< Only the conditioner's offset, hum and noise remain.
  kUnpluggedDevice,     ///< Likewise.
  kSwappedChannels,     ///< Each channel's signal comes in as the other's.
  kInvertedPolarity,    ///< The device's signal changes its sign.
  kDcDrift,             ///< The device's offset climbs by kOffsetClimbPerSecond_v.
  kGainStep,            ///< The device's conditioner multiplies by kGainStepFactor more.
};
inline constexpr std::size_t kFaultKinds = 11;

/// @returns The name for command lines: "none", "lost-block", "late-block", "stuck-channel",
/// "saturation", "unplugged-reference", "unplugged-device", "swapped-channels",
/// "inverted-polarity", "dc-drift", "gain-step". Never null.
const char* name_of(FaultKind kind) noexcept;

struct ParsedFault {
  bool known = false;
  FaultKind kind = FaultKind::kNone;
};

/// The kind of this name, which ends in a zero byte. Names are in small letters.
ParsedFault parse_fault(const char* name) noexcept;

/// One fault, from this frame of the bench's clock on.
struct Fault {
  FaultKind kind = FaultKind::kNone;
  std::uint64_t at_frame = 0;
};

/// Full scales in volts outside the front end, which scales between them and the converters; 0 for
/// a wire.
struct FrontEnd {
  double drive_v = 0.0;
  double reference_v = 0.0;
  double device_v = 0.0;
};

/// What a bench is made of. `BenchSettings{}` is the default one. Percentages are expanded
/// uncertainties, k = 2: each seed draws from a normal distribution whose standard deviation is
/// half of it.
struct BenchSettings {
  std::uint64_t seed = 1;  ///< Of all draws and of the noise.
  Device device;           ///< The truth that a calibration should find.
  Shaker shaker;
  /// Amplitudes of the harmonics in the drive for a sine of 1 V, as fractions of it. The second
  /// grows with the amplitude, the third with its square. Static, before the reconstruction filter.
  double second_harmonic = 1e-3;
  double third_harmonic = 3e-4;

  double reference_sensitivity = 0.1;       ///< As the certificate says, V/(m/s^2). Flat.
  double reference_expanded_percent = 0.5;  ///< Of the certificate.
  double drift_expanded_percent = 0.02;     ///< How far the sensitivity drifts, and
  double drift_time_s = 10.0;               ///< how long it takes; then it stays.
  double reference_gain = 10.0;             ///< Conditioners, nominal.
  double device_gain = 1.0;
  double gain_expanded_percent = 0.1;      ///< Of the ratio of both gains.
  double ratio = 1.0;                      ///< Of the channels behind them: a loopback finds it.
  double ratio_expanded_percent = 0.0;     ///< Of that.
  double mounting_expanded_percent = 0.2;  ///< Mounting, transverse motion, temperature.

  double noise_v = 5e-3;   ///< Standard deviation of each channel's white noise, at the ADC.
  double offset_v = 3e-3;  ///< Standard deviation of the offset that is drawn for each channel.
  double hum_v = 2e-4;     ///< Amplitude at the ADC; a third as much at three times the frequency.
  double hum_hz = 49.97;
  double skew_s = 1.25e-6;       ///< The device is sampled later than the reference; see `Plant`.
  double skew_expanded_s = 0.0;  ///< Of that.
  double clock_expanded_ppm = 0.0;          ///< Of the rate of sampling.
  double crosstalk_expanded_percent = 0.0;  ///< Of each channel's voltage seen in the other.
  /// Change of each channel's gain at its full scale, growing with the square of the voltage.
  double linearity_expanded_percent = 0.0;
  FrontEnd front_end;
  bool ideal_converters = false;  ///< DAC and ADC use all 32 bits of a word; they still clip.
  Fault fault;
  Fault second_fault;
};

/// What was drawn, which a calibration cannot know. Constant until the next `configure()`.
struct BenchTruth {
  Device device;
  double reference_sensitivity = 0.0;  ///< True, at time 0, V/(m/s^2).
  double reference_drift = 0.0;        ///< Relative, reached at drift_time_s.
  double gain_factor = 1.0;      ///< True ratio of the gains, device over reference, over nominal,
  double channel_ratio = 1.0;    ///< with this of the channels behind the conditioners.
  double mounting_factor = 1.0;  ///< Of the device's channel.
  double skew_s = 0.0;           ///< True.
  double clock_factor = 1.0;     ///< True rate of sampling over the nominal one.
  double into_reference = 0.0;   ///< Crosstalk.
  double into_device = 0.0;
  double reference_linearity = 0.0;  ///< Relative change of the gain at full scale.
  double device_linearity = 0.0;
  double reference_offset_v = 0.0;
  double device_offset_v = 0.0;
  /// The device's sensitivity that follows from certificate and nominal gains if nothing else is
  /// wrong: S times what was drawn.
  double apparent_sensitivity = 0.0;
};

/// What both conditioners hand to their converters at one instant of sampling.
struct BenchVolts {
  double reference_v = 0.0;
  double device_v = 0.0;
};

/// Everything between the output of a DAC and the inputs of two ADCs.
///
/// Drive with zero-order hold -> distortion -> `Plant` -> reference and device -> conditioners with
/// offset, hum and noise. Both channels are seen in the middle of a hold, the device's later by the
/// skew: the delay of the hold cancels, and the acceleration over the drive is the shaker's
/// response times sin(x)/x, x = pi f/rate. Device over reference is K(jw) e^(+jw skew). The images
/// of the held drive, which sampling folds back, change that by 1e-9 f/Hz of it at most (up to
/// 6 kHz, default shaker).
///
///     VoltBench bench;
///     bench.configure(BenchSettings{}, 100000.0);
///     const BenchVolts volts = bench.step(0.5);
///
/// Faults of blocks and of converters (kLostBlock, kLateBlock, kStuckChannel) are left to whoever
/// has blocks and converters. The same to the last bit on every target, no heap, no pointers;
/// `configure()` takes 1.5 KiB of stack. One step costs about 50 ns on a PC.
class VoltBench {
 public:
  /// Builds the bench anew: draws its truth, at rest, clock at zero.
  ///
  /// @param[in] sample_rate_hz Steps per second, above 0.
  /// @returns
  /// * kOk: Ready for `step()`.
  /// * kInvalidArgument: A setting that `Plant` refuses, an uncertainty outside 0 to 100 %, a
  ///   harmonic outside 0 to 0.1, a negative noise, offset or hum, a gain, reference sensitivity or
  ///   drift time that is not above 0, a hum beyond half the sampling rate, an unknown fault, or
  ///   not a number. Nothing has changed.
  Status configure(const BenchSettings& settings, double sample_rate_hz) noexcept;

  /// Holds this voltage for one interval of sampling. Before `configure()` it answers zeros.
  ///
  /// @returns The volts within this interval, not limited to any converter's range.
  BenchVolts step(double drive_v) noexcept;

  /// The same interval with a wire in place of shaker, sensors and conditioners: these volts at
  /// both inputs. What has broken down stays so; the shaker stands still.
  BenchVolts step_wired(double reference_v, double device_v) noexcept;

  const BenchSettings& settings() const noexcept { return settings_; }
  const BenchTruth& truth() const noexcept { return truth_; }
  /// Largest |acceleration| since `configure()`, whatever the sensors tell.
  double peak_mps2() const noexcept { return peak_mps2_; }
  /// Steps since `configure()`.
  std::uint64_t clock_frames() const noexcept { return clock_; }

 private:
  /// From a sensor to the output of its conditioner.
  struct Channel {
    double scale = 0.0;  ///< Volts per unit of what the sensor hands over.
    double offset_v = 0.0;
    double bend = 0.0;  ///< Of the gain, per square of the volts.
    double hum_phase_rad = 0.0;
    SinCos hum = {0.0, 1.0};
  };

  void draw() noexcept;
  void refresh() noexcept;
  void begin_step() noexcept;
  BenchVolts end_step(double reference, double device) noexcept;
  void break_down(FaultKind kind) noexcept;
  double distorted_v(double drive_v) const noexcept;
  double conditioned_v(Channel& channel, double sensor, double noise) const noexcept;

  BenchSettings settings_ = {};
  BenchTruth truth_ = {};
  Plant plant_ = {};
  Noise noise_ = {};
  Channel reference_ = {};
  Channel device_ = {};
  double sample_rate_hz_ = 0.0;
  double drift_factor_ = 1.0;
  double peak_mps2_ = 0.0;
  double offset_climb_v_ = 0.0;   ///< Per frame.
  SinCos hum_turn_ = {0.0, 1.0};  ///< Per frame.
  std::uint64_t hum_step_ = 0;    ///< The same in turns, in units of 2^-64.
  std::uint64_t clock_ = 0;
  bool swapped_ = false;
};

static_assert(sizeof(VoltBench) <= 1920);

}  // namespace emax::sim
