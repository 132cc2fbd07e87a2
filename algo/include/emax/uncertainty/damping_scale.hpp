// The coordinates that polynomials of the largest energy are laid in.
#pragma once

#include <type_traits>

#include "emax/uncertainty/device_draws.hpp"

namespace emax {

/// Places of draws as coordinates: the units of a place, or, where the damping varies by much of
/// itself, ln(beta + 1/(w0 T)) in place of the third unit.
///
/// A resonance makes the energy grow about as a power of 1/beta as long as it rings for less than
/// T. So a polynomial in the logarithm needs a lower degree by far, and reaches from the least
/// damping to the largest one that there is.
class DampingScale {
 public:
  /// @param[in] duration_s T.
  /// @param[in] most       How far polynomials reach, in units of a place.
  void start(const DeviceDraws& draws, double duration_s, double most) noexcept;

  /// @returns Whether the third coordinate is a logarithm.
  bool is_logarithm() const noexcept { return is_logarithm_; }
  /// The range of the third coordinate; only with a logarithm.
  double low() const noexcept { return low_; }
  double high() const noexcept { return high_; }
  /// The standard deviation of the third coordinate over the draws, nearly; only with a logarithm.
  double deviation() const noexcept { return deviation_ / (estimate_ + knee_); }

  DeviceDraws::Place to_coordinates(const DeviceDraws::Place& place) const noexcept {
    return {place[0], place[1], is_logarithm_ ? coordinate(place) : place[2]};
  }
  DeviceDraws::Place to_place(const DeviceDraws::Place& coordinates) const noexcept;
  /// @returns How many standard deviations a third coordinate is from the estimate.
  double distance(double coordinate) const noexcept;

 private:
  double coordinate(const DeviceDraws::Place& place) const noexcept;

  double estimate_ = 0.0;  // Of the damping.
  DeviceDraws::Place units_ = {};
  double deviation_ = 0.0;
  double knee_ = 0.0;
  double low_ = 0.0;
  double high_ = 0.0;
  bool is_logarithm_ = false;
};

static_assert(std::is_trivially_copyable_v<DampingScale>);

}  // namespace emax
