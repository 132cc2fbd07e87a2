// The exponential of a small real matrix.
#pragma once

#include <array>
#include <cstddef>

namespace emax::sim {

inline constexpr std::size_t kMatrixOrder = 11;

/// By rows.
using Matrix = std::array<std::array<double, kMatrixOrder>, kMatrixOrder>;

/// Replaces `matrix` by e^matrix. `scratch` is a second matrix that is overwritten; what it holds
/// before does not matter.
///
/// Scaling and squaring with a Taylor series (Moler, Van Loan, SIAM Review 45 (2003) 3, method 3).
/// The elements must be finite, the row sum norm below 2^20. The relative error, as the norm of the
/// error over the norm of the result, is about 1e-16 times the norm for matrices whose exponential
/// does not grow. Zeros of a block triangular matrix stay exact. 18 to 39 products of matrices.
void exponentiate(Matrix& matrix, Matrix& scratch) noexcept;

}  // namespace emax::sim
