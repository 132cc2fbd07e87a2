// The numbers of an axis, with a power of ten in its unit.
#pragma once

#include <string>

namespace emax::desk {

/// What numbers of an axis are multiplied by, and the unit that they have then.
struct Scale {
  double factor;
  std::string unit;
};

/// @returns The power of a thousand that is not above `largest`; 0 for 0.
int thousands_of(double largest);

/// @param[in] largest What the axis reaches to.
/// @param[in] plain   Below 1000 and from this on there is no power of ten.
/// @returns "10⁻³ V² s", for instance.
Scale scaled(double largest, const std::string& unit, double plain = 1.0);

}  // namespace emax::desk
