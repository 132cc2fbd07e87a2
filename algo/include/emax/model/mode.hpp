// One term of an impulse response written as a sum of damped oscillations.
#pragma once

#include "emax/base/complex.hpp"

namespace emax {

/// The term Re(residue * e^(pole * t)) of an impulse response.
///
/// A conjugate pair of poles is one mode, its residue twice that of the partial fraction; a real
/// pole is one mode with imaginary parts of zero. So every sum over modes runs over half as many
/// terms, and needs no special case.
struct Mode {
  Complex pole;     ///< In 1/s; the real part is negative.
  Complex residue;  ///< In V/(m/s) for a sensor: the unit of the impulse response.
};

}  // namespace emax
