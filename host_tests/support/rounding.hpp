// How far rounding alone may move an energy.
#pragma once

#include <cmath>

#include "emax/model/modal_model.hpp"

namespace emax::test {

/// The energy for a = 1 is a difference of Gramian forms whose terms are at most (sum |r/p|)^2 / (2
/// min |Re p|): a dozen roundings of terms of that size. Up to order 10 this is 1e-14 of typical
/// energies, at order 15, where the residues alternate and reach dozens of times the gain, 1e-11.
inline double rounding_of(const ModalModel& model) {
  double size = 0.0;
  double slowest = 1e300;
  for (const Mode& mode : model.modes()) {
    size += std::sqrt(norm(mode.residue) / norm(mode.pole));
    slowest = std::fmin(slowest, -mode.pole.re);
  }
  return 12 * 1.1e-16 * size * size / (2.0 * slowest);
}

}  // namespace emax::test
