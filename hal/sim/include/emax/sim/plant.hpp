// The continuous part of the bench, integrated exactly: from the voltage that the DAC holds to the
// acceleration and the voltage of the device under test.
#pragma once

#include <array>
#include <cstddef>

#include "emax/base/status.hpp"
#include "emax/sim/matrix_exponential.hpp"

namespace emax::sim {

/// The device under test: K(s) = S w0^2 / (s^2 + 2 damping w0 s + w0^2).
struct Device {
  double sensitivity = 1.037;  ///< S in V/(m/s^2). May be negative.
  double natural_frequency_hz = 4073.0;
  double damping = 0.3182;
};

/// Reconstruction filter, power amplifier and shaker. Acceleration over held voltage:
/// gain * B4(s) * w_a^2/(s^2 + 2 d_a w_a s + w_a^2) * s^2/(s^2 + 2 d_s w_s s + w_s^2), with a
/// Butterworth filter B4 of fourth order, the armature (a) and the suspension (s).
struct Shaker {
  double gain = 2.0;  ///< In the middle of the band, (m/s^2)/V.
  double reconstruction_hz = 25000.0;
  double armature_hz = 14000.0;
  double armature_damping = 0.05;
  double suspension_hz = 15.0;
  double suspension_damping = 0.3;
};

/// What the sensors see within one hold of the drive.
struct PlantOutput {
  double acceleration_mps2 = 0.0;  ///< In the middle of the hold.
  double device_v = 0.0;           ///< The device's output, later than that by the skew.
};

/// A linear system in state space, driven by a voltage that is constant over each sampling interval
/// (zero-order hold). Its matrix exponential is computed once, so a step is exact to rounding
/// whatever the sampling rate; so are the outputs at any instant within the interval.
///
/// Ten states in five pairs; each pair is driven by those before it only. 1.2 KiB. One step: 90
/// multiplications. Setting it up takes 1.3 KiB of stack with what it calls.
class Plant {
 public:
  /// Sets the system up, at rest.
  ///
  /// @param[in] interval_s Of the hold; greater than 0.
  /// @param[in] skew_s     Within half an interval, of either sign.
  /// @returns
  /// * kOk: Ready for `step()`.
  /// * kInvalidArgument: A frequency that is not above 0 or is above 20/interval, a damping outside
  ///   0.001 to 10, a time outside its range, or not a number. Nothing has changed.
  Status configure(const Device& device, const Shaker& shaker, double interval_s,
                   double skew_s) noexcept;

  /// Advances by one interval with this voltage held. @returns What was seen in this interval.
  PlantOutput step(double drive_v) noexcept;

  /// Takes states below 1e-150 for zero. Once in a while, so that a plant at rest does not compute
  /// with subnormal numbers, which are slow.
  void flush() noexcept;

 private:
  static constexpr std::size_t kStates = 10;
  /// The last state is the held voltage.
  using Row = std::array<double, kStates + 1>;
  static_assert(kStates + 1 == kMatrixOrder);

  Matrix transition_ = {};  ///< By columns, so that a step adds columns times numbers.
  Row acceleration_ = {};
  Row device_ = {};
  std::array<double, kStates> state_ = {};
};

}  // namespace emax::sim
