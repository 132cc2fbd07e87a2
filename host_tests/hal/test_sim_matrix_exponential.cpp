// The matrix exponential against closed forms.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "emax/sim/matrix_exponential.hpp"

namespace emax::sim {
namespace {

void exponentiate_in_place(Matrix& matrix) {
  Matrix scratch;
  // What it holds does not matter.
  for (auto& row : scratch) {
    row.fill(std::numeric_limits<double>::quiet_NaN());
  }
  exponentiate(matrix, scratch);
}

// A few roundings per product, and each squaring doubles what there is.
constexpr double kRelative = 1e-14;

TEST(MatrixExponential, OfZeroIsOne) {
  Matrix matrix = {};
  exponentiate_in_place(matrix);
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    for (std::size_t j = 0; j < kMatrixOrder; ++j) {
      EXPECT_EQ(matrix[i][j], i == j ? 1.0 : 0.0);
    }
  }
}

TEST(MatrixExponential, OfADiagonal) {
  Matrix matrix = {};
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    matrix[i][i] = static_cast<double>(i) * 0.7 - 5.0;
  }
  exponentiate_in_place(matrix);
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    const double expected = std::exp(static_cast<double>(i) * 0.7 - 5.0);
    // Relative to the largest element: squaring keeps absolute accuracy.
    EXPECT_NEAR(matrix[i][i], expected, kRelative * std::exp(2.0)) << i;
  }
}

TEST(MatrixExponential, OfARotationThatDecays) {
  for (const double angle : {0.01, 1.0, 20.0, 800.0}) {
    const double decay = -0.03 * angle;
    Matrix matrix = {};
    matrix[3][3] = decay;
    matrix[4][4] = decay;
    matrix[3][4] = -angle;
    matrix[4][3] = angle;
    exponentiate_in_place(matrix);
    // One rounding of the angle itself turns the result by its last digit.
    const double tolerance = kRelative * (1.0 + angle) * std::exp(decay);
    EXPECT_NEAR(matrix[3][3], std::exp(decay) * std::cos(angle), tolerance) << angle;
    EXPECT_NEAR(matrix[3][4], -std::exp(decay) * std::sin(angle), tolerance) << angle;
    EXPECT_NEAR(matrix[4][3], std::exp(decay) * std::sin(angle), tolerance) << angle;
    EXPECT_NEAR(matrix[4][4], std::exp(decay) * std::cos(angle), tolerance) << angle;
    EXPECT_EQ(matrix[0][0], 1.0);
  }
}

// A Jordan block of eigenvalue z: e^z over the factorials along the diagonals.
TEST(MatrixExponential, OfAJordanBlockAndItsZeros) {
  constexpr double kEigenvalue = -3.0;
  Matrix matrix = {};
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    matrix[i][i] = kEigenvalue;
    if (i > 0) {
      matrix[i][i - 1] = 1.0;
    }
  }
  exponentiate_in_place(matrix);
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    for (std::size_t j = 0; j < kMatrixOrder; ++j) {
      if (j > i) {
        EXPECT_EQ(matrix[i][j], 0.0);
        continue;
      }
      const double expected = std::exp(kEigenvalue) / std::tgamma(static_cast<double>(i - j) + 1.0);
      EXPECT_NEAR(matrix[i][j], expected, kRelative) << i << ' ' << j;
    }
  }
}

// The solution of x' = a x + b u for constant u: (e^a - 1) b / a.
TEST(MatrixExponential, OfAnInputAsOneMoreState) {
  constexpr double kRate = -0.37;
  Matrix matrix = {};
  matrix[0][0] = kRate;
  matrix[0][10] = 2.5;
  exponentiate_in_place(matrix);
  EXPECT_NEAR(matrix[0][10], 2.5 * std::expm1(kRate) / kRate, kRelative);
  EXPECT_EQ(matrix[10][10], 1.0);
}

// No number of halvings makes an infinity small.
TEST(MatrixExponential, EndsForElementsThatAreNotPermitted) {
  Matrix matrix = {};
  matrix[0][0] = std::numeric_limits<double>::infinity();
  exponentiate_in_place(matrix);
  EXPECT_FALSE(std::isfinite(matrix[0][0]));
}

}  // namespace
}  // namespace emax::sim
