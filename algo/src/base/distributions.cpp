// Uniform and normal numbers from uniform numbers in [0, 1).
#include "emax/base/distributions.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr double kSmallestUniform = 1.1102230246251565e-16;  // 2^-53

}  // namespace

double uniform_in(double low, double high, double u) noexcept { return low + (high - low) * u; }

NormalPair box_muller(double u1, double u2) noexcept {
  const double radius = sqrt(-2.0 * log(u1 > 0.0 ? u1 : kSmallestUniform));
  const SinCos angle = sincos(kTwoPi * u2);
  return {radius * angle.cos, radius * angle.sin};
}

}  // namespace emax
