// Scaling and squaring with a Taylor series.
#include "emax/sim/matrix_exponential.hpp"

#include "emax/base/elementary.hpp"

namespace emax::sim {
namespace {

/// Half to the power of 18, over 18!, is far below the last digit.
constexpr int kTaylorTerms = 18;
constexpr double kScaledNorm = 0.5;
constexpr int kMaxHalvings = 21;

double row_sum_norm(const Matrix& matrix) noexcept {
  double norm = 0.0;
  for (const auto& row : matrix) {
    double sum = 0.0;
    for (const double element : row) {
      sum += abs(element);
    }
    norm = sum > norm ? sum : norm;
  }
  return norm;
}

void square(const Matrix& matrix, Matrix& result) noexcept {
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    for (std::size_t j = 0; j < kMatrixOrder; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kMatrixOrder; ++k) {
        sum += matrix[i][k] * matrix[k][j];
      }
      result[i][j] = sum;
    }
  }
}

/// One step of Horner's rule, result = 1 + (matrix * result) / divisor, column by column so that no
/// third matrix is needed.
void horner_step(const Matrix& matrix, double divisor, Matrix& result) noexcept {
  for (std::size_t j = 0; j < kMatrixOrder; ++j) {
    std::array<double, kMatrixOrder> column = {};
    for (std::size_t i = 0; i < kMatrixOrder; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kMatrixOrder; ++k) {
        sum += matrix[i][k] * result[k][j];
      }
      column[i] = (i == j ? 1.0 : 0.0) + sum / divisor;
    }
    for (std::size_t i = 0; i < kMatrixOrder; ++i) {
      result[i][j] = column[i];
    }
  }
}

}  // namespace

void exponentiate(Matrix& matrix, Matrix& scratch) noexcept {
  int halvings = 0;
  double scale = 1.0;
  for (double norm = row_sum_norm(matrix); norm > kScaledNorm && halvings < kMaxHalvings;
       norm *= 0.5) {
    scale *= 0.5;
    ++halvings;
  }
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    for (double& element : matrix[i]) {
      element *= scale;
    }
    scratch[i].fill(0.0);
    scratch[i][i] = 1.0;
  }
  for (int term = kTaylorTerms; term >= 1; --term) {
    horner_step(matrix, term, scratch);
  }
  matrix = scratch;
  for (; halvings > 0; --halvings) {
    square(matrix, scratch);
    matrix = scratch;
  }
}

}  // namespace emax::sim
