// The simulated bench's transfer functions in closed form, with the images of the held drive.
#pragma once

#include <cmath>
#include <complex>

#include "emax/sim/plant.hpp"

namespace emax::test {

using Complex = std::complex<double>;

constexpr double kTurn = 6.283185307179586;
// Images fall with the seventh power of their number: the next one is below 1e-15.
constexpr int kImages = 100;

inline Complex low_pass(double frequency_hz, double natural_hz, double damping) {
  const double ratio = frequency_hz / natural_hz;
  return 1.0 / Complex(1.0 - ratio * ratio, 2.0 * damping * ratio);
}

// By its poles on the circle, at angles of pi/8 and 3 pi/8 from the negative real axis.
inline Complex butterworth4(double frequency_hz, double corner_hz) {
  const Complex s(0.0, frequency_hz / corner_hz);
  Complex result = 1.0;
  for (const double eighths : {5.0, 7.0, 9.0, 11.0}) {
    result /= s - std::polar(1.0, eighths * kTurn / 16.0);
  }
  return result;
}

inline Complex shaker_response(const sim::Shaker& shaker, double frequency_hz) {
  const double ratio = frequency_hz / shaker.suspension_hz;
  const Complex high_pass =
      -ratio * ratio * low_pass(frequency_hz, shaker.suspension_hz, shaker.suspension_damping);
  return shaker.gain * butterworth4(frequency_hz, shaker.reconstruction_hz) *
         low_pass(frequency_hz, shaker.armature_hz, shaker.armature_damping) * high_pass;
}

inline Complex device_response(const sim::Device& device, double frequency_hz) {
  return device.sensitivity * low_pass(frequency_hz, device.natural_frequency_hz, device.damping);
}

// What samples in the middle of a hold, or later by `later_s`, show of a cosine of 1 V that is held
// from sample to sample: the drive has images at all f + k/interval, each sin(x)/x as large, and
// sampling folds them all back onto f.
template <typename Response>
Complex seen(const Response& response, double frequency_hz, double interval_s, double later_s) {
  Complex sum = 0.0;
  for (int k = -kImages; k <= kImages; ++k) {
    const double image_hz = frequency_hz + k / interval_s;
    const double x = 0.5 * kTurn * image_hz * interval_s;
    // The delay of the hold and that of sampling in its middle cancel, for all images.
    const double hold = x == 0.0 ? 1.0 : std::sin(x) / x;
    sum += response(image_hz) * hold * std::polar(1.0, kTurn * image_hz * later_s);
  }
  return sum;
}

inline Complex acceleration_seen(const sim::Shaker& shaker, double frequency_hz,
                                 double interval_s) {
  return seen([&shaker](double f) { return shaker_response(shaker, f); }, frequency_hz, interval_s,
              0.0);
}

inline Complex device_seen(const sim::Device& device, const sim::Shaker& shaker,
                           double frequency_hz, double interval_s, double skew_s) {
  return seen([&](double f) { return shaker_response(shaker, f) * device_response(device, f); },
              frequency_hz, interval_s, skew_s);
}

}  // namespace emax::test
