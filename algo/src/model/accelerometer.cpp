// The accelerometer as a second-order system.
#include "emax/model/accelerometer.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {

Status validate(const Accelerometer& device) noexcept {
  if (!(device.sensitivity > 0.0) || !is_finite(device.sensitivity)) {
    return Status::kInvalidArgument;
  }
  if (!(device.natural_frequency_hz >= kMinFrequency_hz) ||
      !(device.natural_frequency_hz <= kMaxFrequency_hz)) {
    return Status::kInvalidArgument;
  }
  if (device.damping >= 1.0) {
    return Status::kOverdamped;
  }
  if (!(device.damping >= kMinDamping)) {
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

double amplitude(const Accelerometer& device, double frequency_hz) noexcept {
  const double ratio = frequency_hz / device.natural_frequency_hz;
  const double in_phase = 1.0 - ratio * ratio;
  const double quadrature = 2.0 * device.damping * ratio;
  return device.sensitivity / sqrt(in_phase * in_phase + quadrature * quadrature);
}

double phase_rad(const Accelerometer& device, double frequency_hz) noexcept {
  const double ratio = frequency_hz / device.natural_frequency_hz;
  return -atan2(2.0 * device.damping * ratio, 1.0 - ratio * ratio);
}

Mode mode_of(const Accelerometer& device) noexcept {
  const double w0 = kTwoPi * device.natural_frequency_hz;
  // (1 - b)(1 + b) keeps all digits where 1 - b^2 would lose them near b = 1.
  const double root = sqrt((1.0 - device.damping) * (1.0 + device.damping));
  Mode mode;
  mode.pole = {-device.damping * w0, w0 * root};
  mode.residue = {0.0, -device.sensitivity * w0 / root};
  return mode;
}

}  // namespace emax
