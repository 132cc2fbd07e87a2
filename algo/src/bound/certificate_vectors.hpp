// What multipliers and cases of a certificate share: the vectors of the relaxation, the units of y.
#pragma once

#include <cstddef>

#include "emax/bound/energy_certificate.hpp"

namespace emax {

inline constexpr std::size_t kRank = kCertificateRank;
inline constexpr double kUnitsPerOne = 1073741824.0;  // 2^30

inline double dot(const double* a, const double* b) noexcept {
  double sum = 0.0;
  for (std::size_t r = 0; r < kRank; ++r) {
    sum += a[r] * b[r];
  }
  return sum;
}

}  // namespace emax
