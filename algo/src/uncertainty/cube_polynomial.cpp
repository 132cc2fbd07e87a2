// Interpolation at Chebyshev nodes of a cube, and Horner's scheme for what comes of it.
#include "emax/uncertainty/cube_polynomial.hpp"

#include "emax/base/double_unit.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr std::size_t kMaxOrders = kMaxCubeDegree + 1;

/// Chebyshev's polynomials in powers: row i holds the coefficients of T_i.
constexpr double kChebyshev[kMaxOrders][kMaxOrders] = {
    {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},     {0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {-1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0},    {0.0, -3.0, 0.0, 4.0, 0.0, 0.0, 0.0},
    {1.0, 0.0, -8.0, 0.0, 8.0, 0.0, 0.0},    {0.0, 5.0, 0.0, -20.0, 0.0, 16.0, 0.0},
    {-1.0, 0.0, 18.0, 0.0, -48.0, 0.0, 32.0}};

/// Node k of an axis with `count` of them.
double node(std::size_t k, std::size_t count) noexcept {
  if (2 * k + 1 == count) {
    return 0.0;
  }
  const double part = static_cast<double>(2 * k + 1) / static_cast<double>(2 * count);
  return cos(0.5 * kTwoPi * part);
}

/// The products in the order of `cube_value()`: calls `term(place, i, j, k)` for each.
template <typename Term>
void for_each_term(std::size_t degree, const Term& term) noexcept {
  std::size_t place = 0;
  for (std::size_t i = degree + 1; i-- > 0;) {
    for (std::size_t j = degree - i + 1; j-- > 0;) {
      for (std::size_t k = degree - i - j + 1; k-- > 0;) {
        term(place++, i, j, k);
      }
    }
  }
}

}  // namespace

CubeNodes::CubeNodes(std::size_t degree, const std::array<bool, 3>& axes,
                     std::size_t first_axis_nodes) noexcept
    : counts_{}, degree_(degree) {
  for (std::size_t a = 0; a < 3; ++a) {
    counts_[a] = axes[a] ? degree + 1 : 1;
  }
  counts_[0] = counts_[0] < first_axis_nodes ? counts_[0] : first_axis_nodes;
}

std::array<std::size_t, 3> CubeNodes::index_on_axes(std::size_t index) const noexcept {
  return {index % counts_[0], index / counts_[0] % counts_[1], index / (counts_[0] * counts_[1])};
}

CubePoint CubeNodes::point(std::size_t index) const noexcept {
  const std::array<std::size_t, 3> at = index_on_axes(index);
  return {node(at[0], counts_[0]), node(at[1], counts_[1]), node(at[2], counts_[2])};
}

void CubeNodes::add(std::size_t index, double value, Span<double> coefficients) const noexcept {
  const CubePoint x = point(index);
  // T_i at the node times its weight in the sum over nodes; 0 for orders that an axis has not.
  double orders[3][kMaxOrders] = {};
  for (std::size_t a = 0; a < 3; ++a) {
    const double weight = 1.0 / static_cast<double>(counts_[a]);
    double before = x[a];
    double order = 1.0;
    for (std::size_t i = 0; i < counts_[a]; ++i) {
      orders[a][i] = (i == 0 ? 1.0 : 2.0) * weight * order;
      const double next = 2.0 * x[a] * order - before;
      before = order;
      order = next;
    }
  }
  for_each_term(degree_, [&](std::size_t place, std::size_t i, std::size_t j, std::size_t k) {
    coefficients[place] += value * (orders[0][i] * orders[1][j] * orders[2][k]);
  });
}

void to_powers(std::size_t degree, Span<double> coefficients) noexcept {
  double chebyshev[cube_terms(kMaxCubeDegree)] = {};
  for (std::size_t place = 0; place < cube_terms(degree); ++place) {
    chebyshev[place] = coefficients[place];
  }
  for_each_term(degree, [&](std::size_t place, std::size_t a, std::size_t b, std::size_t c) {
    double sum = 0.0;
    for_each_term(degree, [&](std::size_t from, std::size_t i, std::size_t j, std::size_t k) {
      sum += chebyshev[from] * (kChebyshev[i][a] * kChebyshev[j][b] * kChebyshev[k][c]);
    });
    coefficients[place] = sum;
  });
}

namespace {

double nested(std::size_t degree, const double* next, const CubePoint& point) noexcept {
  double sum = 0.0;
  for (std::size_t rest = 0; rest <= degree; ++rest) {
    double plane = 0.0;
    for (std::size_t left = 0; left <= rest; ++left) {
      double line = *next++;
      for (std::size_t k = 0; k < left; ++k) {
        line = line * point[2] + *next++;
      }
      plane = left == 0 ? line : plane * point[1] + line;
    }
    sum = rest == 0 ? plane : sum * point[0] + plane;
  }
  return sum;
}

// The same written out by the compiler, where it is the loops that cost.

template <std::size_t kLast>
[[gnu::always_inline]] inline double line(const double* c, double z) noexcept {
  if constexpr (kLast == 0) {
    return c[0];
  } else {
    return line<kLast - 1>(c, z) * z + c[kLast];
  }
}

template <std::size_t kLast>
[[gnu::always_inline]] inline double plane(const double* c, double y, double z) noexcept {
  constexpr std::size_t kOffset = kLast * (kLast + 1) / 2;
  if constexpr (kLast == 0) {
    return c[0];
  } else {
    return plane<kLast - 1>(c, y, z) * y + line<kLast>(c + kOffset, z);
  }
}

template <std::size_t kLast>
[[gnu::always_inline]] inline double written_out(const double* c, const CubePoint& point) noexcept {
  constexpr std::size_t kOffset = kLast * (kLast + 1) * (kLast + 2) / 6;
  if constexpr (kLast == 0) {
    return c[0];
  } else {
    return written_out<kLast - 1>(c, point) * point[0] +
           plane<kLast>(c + kOffset, point[1], point[2]);
  }
}

}  // namespace

double cube_value(std::size_t degree, Span<const double> coefficients,
                  const CubePoint& point) noexcept {
  if (kHasDoubleUnit && degree == 4) {
    return written_out<4>(coefficients.data(), point);
  }
  return nested(degree, coefficients.data(), point);
}

CubePoint cube_slopes(std::size_t degree, Span<const double> coefficients) noexcept {
  CubePoint slopes = {};
  for_each_term(degree, [&](std::size_t place, std::size_t i, std::size_t j, std::size_t k) {
    if (i + j + k == 1) {
      slopes[i == 1 ? 0 : (j == 1 ? 1 : 2)] = coefficients[place];
    }
  });
  return slopes;
}

}  // namespace emax
