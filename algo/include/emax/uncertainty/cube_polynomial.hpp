// A polynomial of three variables on the cube [-1, 1]^3, from values at Chebyshev nodes.
#pragma once

#include <array>
#include <cstddef>

#include "emax/base/span.hpp"

namespace emax {

/// The highest total degree of a `CubePolynomial`.
inline constexpr std::size_t kMaxCubeDegree = 6;

/// @returns The number of products x^i y^j z^k with i + j + k up to a degree: 35 for 4, 56 for 5,
/// 84 for 6.
constexpr std::size_t cube_terms(std::size_t degree) noexcept {
  return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

using CubePoint = std::array<double, 3>;

/// The nodes that a polynomial goes through: the zeros of Chebyshev's polynomial of degree + 1 on
/// each axis along which the values change, 0 alone on the others.
class CubeNodes {
 public:
  /// @param[in] degree Up to kMaxCubeDegree.
  /// @param[in] first_axis_nodes The most nodes on the first axis, 1 to degree + 1: powers of its
  ///   variable are below that number.
  CubeNodes(std::size_t degree, const std::array<bool, 3>& axes,
            std::size_t first_axis_nodes = kMaxCubeDegree + 1) noexcept;

  std::size_t size() const noexcept { return counts_[0] * counts_[1] * counts_[2]; }
  CubePoint point(std::size_t index) const noexcept;

  /// Takes the value at a node into the coefficients of a polynomial in Chebyshev's polynomials
  /// T_i(x) T_j(y) T_k(z), which are zero before the first node. By their discrete orthogonality
  /// the sum over all nodes is the interpolating polynomial, without the products above the degree.
  ///
  /// @param[in,out] coefficients cube_terms(degree) of them, in the order of `cube_value()`.
  void add(std::size_t index, double value, Span<double> coefficients) const noexcept;

 private:
  std::array<std::size_t, 3> index_on_axes(std::size_t index) const noexcept;

  std::array<std::size_t, 3> counts_;
  std::size_t degree_;
};

/// Turns the coefficients of `CubeNodes::add()` into those of powers, for `cube_value()`. Up to
/// degree 6 that costs a digit at most.
void to_powers(std::size_t degree, Span<double> coefficients) noexcept;

/// @returns The polynomial at a point, by Horner's scheme: one multiplication and one addition per
/// term, always in the same order.
///
/// @param[in] coefficients Of x^i y^j z^k with i from the degree down to 0, in that j from
///   degree - i down to 0, in that k from degree - i - j down to 0.
double cube_value(std::size_t degree, Span<const double> coefficients,
                  const CubePoint& point) noexcept;

/// @returns The derivatives of the polynomial at (0, 0, 0).
CubePoint cube_slopes(std::size_t degree, Span<const double> coefficients) noexcept;

}  // namespace emax
