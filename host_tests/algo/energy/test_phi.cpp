// Phi stored and Phi applied against each other, against exact energies, and by enumeration of all
// signals.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/energy/switching_signal.hpp"

#include "support/paper_device.hpp"
#include "support/rounding.hpp"
#include "support/sign_pattern.hpp"

namespace emax {
namespace {

using test::kPaperA2;
using test::kPaperDevice;
using test::paper_model;

constexpr Criterion kIse = Criterion::kIntegralSquareError;
constexpr Criterion kDifference = Criterion::kEnergyDifference;

template <typename T>
Span<T> span_of(std::vector<T>& values) {
  return Span<T>(values.data(), values.size());
}

double quadratic_form(const PhiMatrix& phi, Signs signs) {
  double sum = 0.0;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    for (std::size_t j = 0; j < signs.size(); ++j) {
      sum += signs[i] * signs[j] * phi.at(i, j);
    }
  }
  return sum;
}

struct Case {
  int order;
  double gain;
  double damping;
  double duration_s;
  Criterion criterion;
};

class PhiCase : public testing::TestWithParam<Case> {
 protected:
  PhiCase() {
    const Case& c = GetParam();
    EXPECT_EQ(model_.set({1.037, 4073.0, c.damping}, {c.order, 1000.0, c.gain}, c.criterion),
              Status::kOk);
    EXPECT_EQ(buffer_.fill(model_, c.duration_s, kCells), Status::kOk);
    EXPECT_EQ(operator_.set(model_, c.duration_s, kCells), Status::kOk);
    for (std::size_t i = 0; i < kCells; ++i) {
      scale_ = std::fmax(scale_, std::fabs(buffer_.matrix().diagonal(i)));
    }
  }

  static constexpr std::size_t kCells = 61;
  ModalModel model_{};
  PhiBuffer<64> buffer_{};
  PhiOperator operator_{};
  double scale_ = 0.0;
};

TEST_P(PhiCase, QuadraticFormIsTheExactEnergyOfTheSignal) {
  // The energy has another derivation: states at the switches, no cells.
  std::mt19937_64 random(1);
  for (int run = 0; run < 50; ++run) {
    const test::SignPattern signs = test::random_signs(kCells, random);
    SwitchingSignal signal{};
    ASSERT_EQ(signal.set_signs(signs.view(), GetParam().duration_s), Status::kOk);
    // kCells^2 terms of up to the size of the diagonal, rounded at random.
    EXPECT_NEAR(quadratic_form(buffer_.matrix(), signs.view()), energy(model_, signal),
                1e-14 * scale_ * kCells + test::rounding_of(model_));
  }
}

TEST_P(PhiCase, OperatorAndMatrixAreTheSame) {
  // The operator takes what is missing after T from the endless record, at whose scale it is
  // rounded.
  const double tolerance = 1e-14 * scale_ + test::rounding_of(model_) / kCells;
  for (std::size_t j = 0; j < kCells; ++j) {
    std::vector<double> column(kCells, 0.0);
    operator_.add_column(j, 2.0, span_of(column));
    for (std::size_t i = 0; i < kCells; ++i) {
      EXPECT_NEAR(column[i], 2.0 * buffer_.matrix().at(i, j), 2.0 * tolerance);
    }
    EXPECT_NEAR(operator_.diagonal(j), buffer_.matrix().diagonal(j), tolerance);
  }
  std::mt19937_64 random(2);
  const test::SignPattern signs = test::random_signs(kCells, random);
  std::vector<double> by_matrix(kCells);
  std::vector<double> by_operator(kCells);
  const Signs pattern = signs.view();
  buffer_.matrix().multiply(pattern, span_of(by_matrix));
  operator_.multiply(pattern, span_of(by_operator));
  for (std::size_t i = 0; i < kCells; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < kCells; ++j) {
      sum += buffer_.matrix().at(i, j) * pattern[j];
    }
    EXPECT_NEAR(by_matrix[i], sum, kCells * tolerance);
    EXPECT_NEAR(by_operator[i], sum, kCells * tolerance);
  }
}

TEST_P(PhiCase, NoElementOfTheDiagonalIsAboveTheLimit) {
  for (std::size_t i = 0; i < kCells; ++i) {
    EXPECT_LE(operator_.diagonal(i), operator_.diagonal_limit() * (1.0 + 1e-13));
  }
}

TEST_P(PhiCase, PulseIsASumOverTheMatrixAndNotAboveItsLimit) {
  const double tolerance = 1e-14 * scale_ + test::rounding_of(model_) / kCells;
  for (std::size_t width = 1; width <= PhiOperator::kMaxPulse; ++width) {
    for (std::size_t first = 0; first + width <= kCells; ++first) {
      double sum = 0.0;
      double sizes = 0.0;
      for (std::size_t i = first; i < first + width; ++i) {
        for (std::size_t j = first; j < first + width; ++j) {
          sum += buffer_.matrix().at(i, j);
          sizes += std::fabs(buffer_.matrix().at(i, j));
        }
      }
      const double pulse = operator_.pulse(first, width);
      const double rounding = static_cast<double>(width * width) * tolerance;
      EXPECT_NEAR(pulse, sum, rounding) << first << ' ' << width;
      EXPECT_LE(pulse, operator_.pulse_limit(width) + 1e-13 * sizes + rounding);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, PhiCase,
    testing::Values(Case{1, 1.037, 0.3182, 2e-3, kIse}, Case{2, 0.5, 0.01, 2e-3, kIse},
                    Case{5, 1.037, 0.9, 2e-3, kIse}, Case{10, 1.037, 0.3182, 2e-3, kIse},
                    Case{10, 0.0, 0.3182, 2e-3, kIse}, Case{15, 1.037, 0.3182, 2e-3, kIse},
                    Case{10, 1.037, 0.3182, 2e-5, kIse}, Case{10, 1.037, 0.3182, 2e-2, kIse},
                    Case{1, 1.037, 0.3182, 2e-3, kDifference},
                    Case{10, 1.037, 0.3182, 2e-3, kDifference},
                    Case{15, 0.8, 0.05, 5e-3, kDifference}));

/// The largest energy of all patterns that start with +1, by Gray code: one sign changes from each
/// to the next.
struct Enumerated {
  double energy;
  std::uint32_t pattern;  // Bit i - 1 is set where cell i is negative.
};

Enumerated enumerate(const PhiMatrix& phi) {
  const std::size_t cells = phi.cells();
  std::vector<double> full(cells * cells);
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t j = 0; j < cells; ++j) {
      full[i * cells + j] = phi.at(i, j);
    }
  }
  std::vector<double> signs(cells, 1.0);
  std::vector<double> product(cells, 0.0);
  double form = 0.0;
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t j = 0; j < cells; ++j) {
      product[i] += full[i * cells + j];
    }
    form += product[i];
  }
  Enumerated best{form, 0};
  std::uint32_t pattern = 0;
  for (std::uint32_t step = 1; step < (1u << (cells - 1)); ++step) {
    const std::size_t cell = static_cast<std::size_t>(__builtin_ctz(step)) + 1;
    const double change = -2.0 * signs[cell];
    form += 2.0 * change * product[cell] + change * change * full[cell * cells + cell];
    for (std::size_t j = 0; j < cells; ++j) {
      product[j] += change * full[cell * cells + j];
    }
    signs[cell] = -signs[cell];
    pattern ^= 1u << (cell - 1);
    if (form > best.energy) {
      best = {form, pattern};
    }
  }
  // The running sum has been rounded millions of times; the winner is summed afresh.
  best.energy = 0.0;
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t j = 0; j < cells; ++j) {
      const bool same = ((best.pattern << 1 >> i) & 1u) == ((best.pattern << 1 >> j) & 1u);
      best.energy += same ? full[i * cells + j] : -full[i * cells + j];
    }
  }
  return best;
}

/// A pattern of `positive` cells of one sign, the rest of the other.
std::uint32_t one_switch(std::size_t cells, std::size_t positive) {
  const std::uint32_t all = (1u << (cells - 1)) - 1;
  return all & ~((1u << (positive - 1)) - 1);
}

TEST(PhiOperator, KeepsNothingOfALargerModel) {
  // Six modes, then three.
  const ModalModel large = paper_model();
  ModalModel small{};
  ASSERT_EQ(small.set(kPaperDevice, {4, 1000.0, 1.037}, kIse), Status::kOk);
  PhiOperator reused;
  PhiOperator fresh;
  ASSERT_EQ(reused.set(large, 2e-3, 30), Status::kOk);
  ASSERT_EQ(reused.set(small, 2e-3, 30), Status::kOk);
  ASSERT_EQ(fresh.set(small, 2e-3, 30), Status::kOk);
  const std::vector<double> signal(30, 1.0);
  std::vector<double> of_reused(30);
  std::vector<double> of_fresh(30);
  reused.multiply(Span<const double>(signal.data(), signal.size()), span_of(of_reused));
  fresh.multiply(Span<const double>(signal.data(), signal.size()), span_of(of_fresh));
  EXPECT_EQ(of_reused, of_fresh);
}

TEST(PhiEnumeration, LargestEnergyOnTwentyCells) {
  static PhiBuffer<24> phi;
  ASSERT_EQ(phi.fill(paper_model(), 2e-3, 20), Status::kOk);
  const Enumerated best = enumerate(phi.matrix());
  // Fourteen digits are given.
  EXPECT_NEAR(kPaperA2 * best.energy, 0.0050935397728704, 1e-15);
  EXPECT_EQ(best.pattern, one_switch(20, 10));
}

TEST(PhiEnumeration, LargestEnergyOnTwentyFourCells) {
  static PhiBuffer<24> phi;
  ASSERT_EQ(phi.fill(paper_model(), 2e-3, 24), Status::kOk);
  const Enumerated best = enumerate(phi.matrix());
  EXPECT_NEAR(kPaperA2 * best.energy, 0.0051028687271305, 1e-15);
  EXPECT_EQ(best.pattern, one_switch(24, 13));
}

TEST(PhiBuffer, LeavesMemoryBeyondTheTriangleAlone) {
  std::vector<double> packed(packed_size(10) + 5, -7.0);
  ASSERT_EQ(fill_phi(paper_model(), 2e-3, 10, span_of(packed)), Status::kOk);
  for (std::size_t i = packed_size(10); i < packed.size(); ++i) {
    EXPECT_EQ(packed[i], -7.0);
  }
}

TEST(PhiBuffer, OneCellHoldsTheEnergyOfTheConstantSignal) {
  PhiBuffer<1> phi{};
  ASSERT_EQ(phi.fill(paper_model(), 2e-3, 1), Status::kOk);
  EXPECT_NEAR(kPaperA2 * phi.matrix().at(0, 0), 0.00110693771864, 0.6e-14);
}

TEST(PhiBuffer, RefusesWhatItCannotHoldAndStaysAsItWas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  static PhiBuffer<8> phi;
  ASSERT_EQ(phi.fill(paper_model(), 2e-3, 8), Status::kOk);
  const double before = phi.matrix().at(3, 5);
  EXPECT_EQ(phi.fill(paper_model(), 2e-3, 9), Status::kBufferTooSmall);
  EXPECT_EQ(phi.fill(paper_model(), 2e-3, 0), Status::kInvalidArgument);
  EXPECT_EQ(phi.fill(paper_model(), 0.0, 8), Status::kInvalidArgument);
  EXPECT_EQ(phi.fill(paper_model(), nan, 8), Status::kInvalidArgument);
  EXPECT_EQ(phi.fill(paper_model(), std::numeric_limits<double>::infinity(), 8),
            Status::kInvalidArgument);
  EXPECT_EQ(phi.matrix().cells(), 8u);
  EXPECT_EQ(phi.matrix().at(3, 5), before);
  const ModalModel model = paper_model();
  PhiOperator apply{};
  EXPECT_EQ(apply.set(model, 2e-3, kMaxCells + 1), Status::kTooManyCells);
  EXPECT_EQ(apply.set(model, 2e-3, kMaxCells), Status::kOk);
}

}  // namespace
}  // namespace emax
