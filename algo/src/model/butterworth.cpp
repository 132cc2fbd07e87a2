// Butterworth poles and partial fractions.
#include "emax/model/butterworth.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax {
namespace {

/// The pole with index 1 to order of the filter with a cutoff of 1 rad/s.
Complex unit_pole(int index, int order) noexcept {
  if (2 * index == order + 1) {
    return {-1.0, 0.0};
  }
  const SinCos angle = sincos(kPi * (2 * index + order - 1) / (2.0 * order));
  return {angle.cos, angle.sin};
}

}  // namespace

Status validate(const Butterworth& filter) noexcept {
  if (filter.order < 1 || filter.order > kMaxFilterOrder) {
    return Status::kInvalidOrder;
  }
  if (!(filter.cutoff_hz >= kMinFrequency_hz) || !(filter.cutoff_hz <= kMaxFrequency_hz)) {
    return Status::kInvalidArgument;
  }
  if (!(filter.gain >= 0.0) || !is_finite(filter.gain)) {
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

double amplitude(const Butterworth& filter, double frequency_hz) noexcept {
  const double ratio = frequency_hz / filter.cutoff_hz;
  double power = 1.0;
  for (int i = 0; i < filter.order; ++i) {
    power *= ratio * ratio;
  }
  return filter.gain / sqrt(1.0 + power);
}

ReferenceFilter butterworth(const Butterworth& filter) noexcept {
  const double wc = kTwoPi * filter.cutoff_hz;
  ReferenceFilter result;
  result.relative_degree = filter.order;
  result.gain = filter.gain;
  result.band_hz = filter.cutoff_hz;
  // The poles with index up to (order + 1) / 2 have no negative imaginary part; the others are
  // their conjugates.
  for (int i = 1; 2 * i <= filter.order + 1; ++i) {
    const Complex pole = unit_pole(i, filter.order);
    Complex others{1.0, 0.0};
    for (int n = 1; n <= filter.order; ++n) {
      if (n != i) {
        others = others * (pole - unit_pole(n, filter.order));
      }
    }
    const double weight = 2 * i == filter.order + 1 ? 1.0 : 2.0;
    Mode& mode = result.modes[result.count++];
    mode.pole = wc * pole;
    mode.residue = Complex{weight * filter.gain * wc, 0.0} / others;
  }
  return result;
}

}  // namespace emax
