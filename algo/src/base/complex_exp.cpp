// e^z and its first two divided differences at zero.
#include "emax/base/complex_exp.hpp"

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

/// Below this modulus the series is as good as the closed form, which loses digits to cancellation
/// there.
constexpr double kSeriesRadius = 0.5;
/// 0.5^16 / 18! is far below the last digit of the first term.
constexpr int kSeriesTerms = 16;

/// sum over n of z^n / (n + 1 + shift)! * (1 + shift)!, by Horner's rule: phi1 for shift 0, 2 phi2
/// for shift 1.
Complex series(Complex z, int shift) noexcept {
  Complex sum{1.0, 0.0};
  for (int n = kSeriesTerms; n >= 1; --n) {
    sum = Complex{1.0, 0.0} + (1.0 / (n + 1 + shift)) * (z * sum);
  }
  return sum;
}

}  // namespace

Complex exp(Complex z) noexcept {
  const double modulus = exp(z.re);
  if (z.im == 0.0) {
    return {modulus, 0.0};
  }
  const SinCos angle = sincos(z.im);
  return {modulus * angle.cos, modulus * angle.sin};
}

Complex phi1(Complex z) noexcept {
  if (norm(z) < kSeriesRadius * kSeriesRadius) {
    return series(z, 0);
  }
  return (exp(z) - Complex{1.0, 0.0}) / z;
}

Complex phi2(Complex z) noexcept {
  if (norm(z) < kSeriesRadius * kSeriesRadius) {
    return 0.5 * series(z, 1);
  }
  return (exp(z) - Complex{1.0, 0.0} - z) / (z * z);
}

Complex power(Complex z, std::size_t n) noexcept {
  Complex result{1.0, 0.0};
  for (; n != 0; n /= 2) {
    result = n % 2 != 0 ? z * result : result;
    z = z * z;
  }
  return result;
}

}  // namespace emax
