// A first look at magnitudes without phases: a polynomial through 1/|K|^2.
#include "emax/identify/magnitude_fit.hpp"

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

// Normal equations are good to about 1e-16 times the condition; beyond this nothing is left.
constexpr double kDependent = 1e-11;

struct NormalEquations {
  double matrix[3][3] = {};
  double rhs[3] = {};
};

NormalEquations equations_of(const FrequencyResponse& response) noexcept {
  NormalEquations normal;
  const Span<const ResponsePoint> points = response.points();
  const double max_hz = points[points.size() - 1].frequency_hz;
  for (const ResponsePoint& point : points) {
    const double ratio = point.frequency_hz / max_hz;
    const double x = ratio * ratio;
    const double y = 1.0 / (point.amplitude * point.amplitude);
    const double u = 2.0 * (point.u_amplitude / point.amplitude) * y;
    const double row[3] = {1.0 / u, x / u, x * x / u};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        normal.matrix[i][j] += row[i] * row[j];
      }
      normal.rhs[i] += row[i] * (y / u);
    }
  }
  return normal;
}

// The lower triangular factor of a symmetric matrix, or false if it is not positive definite.
bool factor(const double (&matrix)[3][3], double (&l)[3][3]) noexcept {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      double rest = matrix[i][j];
      for (int k = 0; k < j; ++k) {
        rest -= l[i][k] * l[j][k];
      }
      if (i != j) {
        l[i][j] = rest / l[j][j];
        continue;
      }
      if (!(rest > kDependent * matrix[i][i]) || !is_finite(rest)) {
        return false;
      }
      l[i][i] = sqrt(rest);
    }
  }
  return true;
}

void solve(const double (&l)[3][3], double (&x)[3]) noexcept {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < i; ++k) {
      x[i] -= l[i][k] * x[k];
    }
    x[i] /= l[i][i];
  }
  for (int i = 2; i >= 0; --i) {
    for (int k = i + 1; k < 3; ++k) {
      x[i] -= l[k][i] * x[k];
    }
    x[i] /= l[i][i];
  }
}

}  // namespace

MagnitudeFit fit_magnitudes(const FrequencyResponse& response) noexcept {
  MagnitudeFit fit;
  double l[3][3] = {};
  if (response.size() < 3) {
    return fit;
  }
  const NormalEquations normal = equations_of(response);
  if (!factor(normal.matrix, l)) {
    return fit;
  }
  double a[3] = {normal.rhs[0], normal.rhs[1], normal.rhs[2]};
  solve(l, a);
  double covariance[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    covariance[i][i] = 1.0;
    solve(l, covariance[i]);
    fit.a[i] = a[i];
    fit.u[i] = sqrt(covariance[i][i]);
  }
  fit.is_found = is_finite(a[0]) && is_finite(a[1]) && is_finite(a[2]);
  if (!fit.is_found || !(a[0] > 0.0) || !(a[2] > 0.0)) {
    return fit;
  }
  const double root = sqrt(a[0] * a[2]);
  fit.damping2 = 0.25 * (a[1] / root + 2.0);
  // beta^2 = (a1/sqrt(a0 a2) + 2)/4, by the law of propagation.
  const double gradient[3] = {-0.125 * a[1] / root / a[0], 0.25 / root,
                              -0.125 * a[1] / root / a[2]};
  double variance = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      variance += gradient[i] * covariance[i][j] * gradient[j];
    }
  }
  fit.u_damping2 = sqrt(variance);
  return fit;
}

}  // namespace emax
