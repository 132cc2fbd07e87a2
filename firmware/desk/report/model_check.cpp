// Which devices can be given by their parameters.
#include "desk/report/model_check.hpp"

#include "emax/model/accelerometer.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace emax::desk {

namespace {

Problem check_estimate(const Accelerometer& device) {
  if (device.sensitivity < 0.0) {
    return bad_input(
        "--model: S is negative, so the polarity is inverted; expected S above 0: swap the "
        "sensor's leads, or give the magnitude");
  }
  if (!(device.sensitivity > 0.0)) {
    return bad_input("--model: S is zero; expected a sensitivity above 0 in V/(m/s^2)");
  }
  if (!(device.natural_frequency_hz >= kMinFrequency_hz) ||
      !(device.natural_frequency_hz <= kMaxFrequency_hz)) {
    return bad_input("--model: f0 is out of range; expected 0.001 to 1e9 Hz");
  }
  if (device.damping >= 1.0) {
    return bad_input(
        "--model: beta is 1 or more; expected 0.0001 to below 1: only a second-order sensor "
        "with a resonance is supported, on which identification and grid depend");
  }
  if (!(device.damping >= kMinDamping)) {
    return bad_input("--model: beta is out of range; expected 0.0001 to below 1");
  }
  return {};
}

}  // namespace

Problem check_model(const app::Device& device) {
  if (Problem problem = check_estimate(device.estimate)) {
    return problem;
  }
  const Accelerometer& estimate = device.estimate;
  const ParameterBox& u = device.u;
  if (!(u.sensitivity >= 0.0) || !(u.natural_frequency_hz >= 0.0) || !(u.damping >= 0.0)) {
    return bad_input("--model: an uncertainty is negative; expected 0 or more");
  }
  if (!(estimate.sensitivity - u.sensitivity > 0.0)) {
    return bad_input("--model: u(S) is too large; expected S - u(S) above 0");
  }
  if (!(estimate.natural_frequency_hz - u.natural_frequency_hz >= kMinFrequency_hz) ||
      !(estimate.natural_frequency_hz + u.natural_frequency_hz <= kMaxFrequency_hz)) {
    return bad_input("--model: u(f0) is too large; expected f0 +- u(f0) from 0.001 to 1e9 Hz");
  }
  if (!(estimate.damping - u.damping >= kMinDamping) || !(estimate.damping + u.damping < 1.0)) {
    return bad_input(
        "--model: u(beta) is too large; expected beta +- u(beta) from 0.0001 to below 1");
  }
  return {};
}

}  // namespace emax::desk
