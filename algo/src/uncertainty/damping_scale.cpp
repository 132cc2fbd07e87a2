// Damping on the scale of its logarithm.
#include "emax/uncertainty/damping_scale.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

/// Half of the range of the damping, as part of its middle, from which on the logarithm is better.
constexpr double kWide = 0.2;
/// The least part of the damping's standard deviation that its own unit must have: with less, the
/// other units say what it is.
constexpr double kLeastShare = 0.3;
/// How near to its ends the damping goes: not quite, for rounding.
constexpr double kNearLeast = 1.0 + 1e-9;
constexpr double kNearMost = 1.0 - 1e-6;
constexpr double kInverseRoot3 = 0.57735026918962576;

}  // namespace

void DampingScale::start(const DeviceDraws& draws, double duration_s, double most) noexcept {
  const bool is_normal = draws.distribution() == Distribution::kNormal;
  estimate_ = draws.estimate().damping;
  units_ = draws.units_of_damping();
  const double spread = sqrt(units_[0] * units_[0] + units_[1] * units_[1] + units_[2] * units_[2]);
  deviation_ = is_normal ? spread : kInverseRoot3 * spread;
  knee_ = 1.0 / (kTwoPi * draws.estimate().natural_frequency_hz * duration_s);
  const double least = std::max(estimate_ - most * spread, kMinDamping * kNearLeast);
  const double largest = std::min(estimate_ + most * spread, kNearMost);
  is_logarithm_ = units_[2] > kLeastShare * spread && least < largest &&
                  largest - least > kWide * (largest + least + 2.0 * knee_);
  low_ = is_logarithm_ ? log(least + knee_) : 0.0;
  high_ = is_logarithm_ ? log(largest + knee_) : 0.0;
}

double DampingScale::coordinate(const DeviceDraws::Place& place) const noexcept {
  const double damping =
      estimate_ + (units_[0] * place[0] + units_[1] * place[1] + units_[2] * place[2]);
  // What is no damping is far below all that are.
  return damping + knee_ > 0.0 ? log(damping + knee_) : low_ - 1.0;
}

DeviceDraws::Place DampingScale::to_place(const DeviceDraws::Place& c) const noexcept {
  if (!is_logarithm_) {
    return c;
  }
  const double off = exp(c[2]) - knee_ - estimate_;
  return {c[0], c[1], (off - units_[0] * c[0] - units_[1] * c[1]) / units_[2]};
}

double DampingScale::distance(double coordinate) const noexcept {
  return (exp(coordinate) - knee_ - estimate_) / deviation_;
}

}  // namespace emax
