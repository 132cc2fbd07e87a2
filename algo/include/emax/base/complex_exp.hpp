// The functions of a complex argument that the sums over modes are made of.
#pragma once

#include "emax/base/complex.hpp"

namespace emax {

/// e^z.
Complex exp(Complex z) noexcept;

/// (e^z - 1) / z, to full precision for small z too.
Complex phi1(Complex z) noexcept;

/// (e^z - 1 - z) / z^2, to full precision for small z too.
Complex phi2(Complex z) noexcept;

}  // namespace emax
