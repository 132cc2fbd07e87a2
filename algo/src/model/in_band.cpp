// Residues by product forms and differences that do not cancel.
#include "emax/model/in_band.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

/// Terms of a power series beyond the first one; (p tau)^n is at most 1.
constexpr int kSeriesTerms = 22;

}  // namespace

Complex unit_transfer(const ReferenceFilter& filter, Complex s) noexcept {
  Complex product{1.0, 0.0};
  for (const Mode& mode : filter.terms()) {
    const Complex pole = mode.pole;
    if (pole.im == 0.0) {
      product = product * (Complex{-pole.re, 0.0} / (s - pole));
    } else {
      product = product * (Complex{norm(pole), 0.0} / ((s - pole) * (s - conj(pole))));
    }
  }
  return product;
}

Accelerometer with_simple_poles(const Accelerometer& device, const ReferenceFilter& filter,
                                double distance) noexcept {
  Accelerometer moved = device;
  const Complex pole = mode_of(device).pole;
  for (const Mode& mode : filter.terms()) {
    if (norm(pole - mode.pole) < distance * distance * norm(pole)) {
      const double away = norm(mode.pole) > norm(pole) ? -distance : distance;
      moved.natural_frequency_hz = device.natural_frequency_hz * (1.0 + away);
    }
  }
  return moved;
}

double change_by_move(const Accelerometer& device) noexcept {
  const double b = device.damping;
  const double root = sqrt((1.0 - b) * (1.0 + b));
  // The envelopes are those of any f0 in between; 1 % is far more than they differ by.
  return 1.01 * kPoleDistance * device.sensitivity * (1.0 / b + 1.0 / (b * b)) / root;
}

Complex in_band_residue(const Accelerometer& device, const ReferenceFilter& filter) noexcept {
  const Mode mode = mode_of(device);
  return mode.residue * unit_transfer(filter, mode.pole);
}

// With q = p/w0, z = p tau and d = 2 b q - z, Ka(p) - G e^-z = [S - G e^-z (1 + 2 b q + q^2)] / (1
// + 2 b q + q^2), and e^-z (1 + z) = 1 - z^2 e^-z phi2(z). For tau = 2 b/w0 d is 0 and what is left
// of G is of the order of q^2.
Complex in_band_residue(const Accelerometer& device, const ReferenceFilter& filter,
                        const Mode& mode, double delay_s) noexcept {
  const double w0 = kTwoPi * device.natural_frequency_hz;
  const double per_w0 = w0 > 0.0 ? 1.0 / w0 : 0.0;
  const double twice_damping = 2.0 * device.damping;
  const Complex q = per_w0 * mode.pole;
  const Complex z = delay_s * mode.pole;
  const Complex d = ((w0 > 0.0 ? twice_damping / w0 : 0.0) - delay_s) * mode.pole;
  const Complex denominator = Complex{1.0, 0.0} + twice_damping * q + q * q;
  const Complex left = exp(-z) * (z * z * phi2(z) - d - q * q);
  const Complex offset{device.sensitivity - filter.gain, 0.0};
  const Complex difference = (offset + filter.gain * left) / denominator;
  return (1.0 / filter.gain) * (mode.residue * difference);
}

double in_band_amplitude(const Accelerometer& device, const ReferenceFilter& filter, double delay_s,
                         double frequency_hz) noexcept {
  const Complex s{0.0, kTwoPi * frequency_hz};
  const double ratio = frequency_hz / device.natural_frequency_hz;
  const Complex inverse{1.0 - ratio * ratio, 2.0 * device.damping * ratio};
  const Complex difference =
      device.sensitivity * reciprocal(inverse) - filter.gain * exp(-delay_s * s);
  return sqrt(norm(difference) * norm(unit_transfer(filter, s)));
}

double reach_before_start(const ReferenceFilter& filter, double delay_s) noexcept {
  // The term of order n is h^(n)(0) (-tau)^n tau/(n + 1)!, and 0 up to the relative degree less 2.
  double sum = 0.0;
  for (const Mode& mode : filter.terms()) {
    const Complex z = -delay_s * mode.pole;
    Complex term = (delay_s / filter.gain) * mode.residue;
    int n = 0;
    for (; n + 1 < filter.relative_degree; ++n) {
      term = (1.0 / (n + 2)) * (z * term);
    }
    for (const int end = n + kSeriesTerms; n < end; ++n) {
      sum += term.re;
      term = (1.0 / (n + 2)) * (z * term);
    }
  }
  return sum;
}

}  // namespace emax
