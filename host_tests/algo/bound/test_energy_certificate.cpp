// Bounds against enumerations, and proofs against a factorisation in wider numbers.
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "emax/bound/energy_certificate.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/switching_signal.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::kPaperA2;
using test::paper_model;

class Work {
 public:
  Work(std::size_t cells, std::size_t intervals)
      : numbers_(certificate_numbers(cells, intervals)),
        multipliers_(40000),
        hash_(131072),
        violated_(20 * cells),
        duals_(cells) {}

  CertificateWorkspace workspace() {
    CertificateWorkspace all;
    all.numbers = {numbers_.data(), numbers_.size()};
    all.multipliers = {multipliers_.data(), multipliers_.size()};
    all.hash = {hash_.data(), hash_.size()};
    all.violated = {violated_.data(), violated_.size()};
    all.duals = {duals_.data(), duals_.size()};
    return all;
  }

  EnergyCertificate& certificate() { return *certificate_; }

 private:
  std::vector<double> numbers_;
  std::vector<TriangleMultiplier> multipliers_;
  std::vector<std::uint32_t> hash_;
  std::vector<ViolatedTriangle> violated_;
  std::vector<std::int32_t> duals_;
  std::unique_ptr<EnergyCertificate> certificate_ = std::make_unique<EnergyCertificate>();
};

void improve(EnergyCertificate& certificate, int rounds, int steps) {
  for (int i = 0; i < rounds && !certificate.at_rest(); ++i) {
    certificate.relax();
  }
  for (int i = 0; i < steps; ++i) {
    certificate.polish(static_cast<double>(i) / steps);
  }
}

double enumerated(const std::vector<double>& matrix, std::size_t cells) {
  double largest = -1e300;
  std::vector<int> signs(cells, 1);
  for (std::uint32_t bits = 0; bits < 1u << (cells - 1); ++bits) {
    for (std::size_t i = 1; i < cells; ++i) {
      signs[i] = ((bits >> (i - 1)) & 1u) != 0 ? -1 : 1;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = 0; j < cells; ++j) {
        sum += signs[i] * signs[j] * matrix[i * cells + j];
      }
    }
    largest = std::fmax(largest, sum);
  }
  return largest;
}

std::vector<double> phi_of(std::size_t cells) {
  static PhiBuffer<32> buffer;
  EXPECT_EQ(buffer.fill(paper_model(), 2e-3, cells), Status::kOk);
  std::vector<double> matrix;
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t j = 0; j < cells; ++j) {
      matrix.push_back(buffer.matrix().at(i, j));
    }
  }
  return matrix;
}

double proven(const std::vector<double>& matrix, std::size_t cells) {
  Work work(cells, 0);
  EnergyCertificate& certificate = work.certificate();
  EXPECT_EQ(certificate.start({matrix.data(), matrix.size()}, cells, work.workspace()),
            Status::kOk);
  EXPECT_TRUE(certificate.ready());
  improve(certificate, 60, 1000);
  EXPECT_TRUE(certificate.prove());
  return certificate.bound();
}

// The largest energies of all sign patterns, computed by enumeration outside this code. The
// relaxation with triangles is tight there, to what the multipliers are off by.
TEST(EnergyCertificate, ReachesTheEnumeratedMaximum) {
  const double of_20 = kPaperA2 * proven(phi_of(20), 20) / 0.0050935397728704;
  EXPECT_GE(of_20, 1.0);
  EXPECT_LT(of_20, 1.0001);
  const double of_24 = kPaperA2 * proven(phi_of(24), 24) / 0.0051028687271305;
  EXPECT_GE(of_24, 1.0);
  EXPECT_LT(of_24, 1.0001);
}

// Matrices of any kind, with diagonals below 0 too, where numbers within +-1 are better than signs.
TEST(EnergyCertificate, IsNeverBelowTheEnumeratedMaximumOfAnyMatrix) {
  std::uint32_t state = 5;
  const auto random = [&state]() {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / 16777216.0 - 0.5;
  };
  for (const std::size_t cells : {std::size_t{5}, std::size_t{9}, std::size_t{14}}) {
    std::vector<double> matrix(cells * cells);
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = i; j < cells; ++j) {
        matrix[i * cells + j] = random();
        matrix[j * cells + i] = matrix[i * cells + j];
      }
    }
    const double best = enumerated(matrix, cells);
    const double bound = proven(matrix, cells);
    EXPECT_GE(bound, best * (1.0 - 1e-12)) << cells;
    EXPECT_LT(bound, 1.2 * best) << cells;
  }
}

// v' M v = -v_1^2 + 2 v_1 v_2/4 is 1/16 at (1/4, 1) and negative at every corner.
TEST(EnergyCertificate, AllowsNumbersInsideTheBox) {
  const std::vector<double> matrix = {-1.0, 0.25, 0.25, 0.0};
  EXPECT_NEAR(proven(matrix, 2), 0.0625, 1e-5);
}

TEST(EnergyCertificate, HoldsForShortAndLongEffort) {
  const ModalModel model = paper_model();
  const double duration_s = 2e-3;
  const double switches_s[] = {1.0475e-3};
  Work work(110, mesh_intervals(model, duration_s));
  EnergyCertificate& certificate = work.certificate();
  double before = 1.0;
  for (const int rounds : {1, 5, 30}) {
    ASSERT_EQ(certificate.start(model, duration_s, 90, switches_s, work.workspace()), Status::kOk);
    while (!certificate.ready()) {
      certificate.prepare();
    }
    improve(certificate, rounds, 20 * rounds);
    ASSERT_TRUE(certificate.prove());
    const double bound = kPaperA2 * certificate.bound();
    EXPECT_GT(bound, test::kBestEnergy2ms);
    EXPECT_LT(bound, before);
    before = bound;
  }
  EXPECT_LT(before, 1.005 * test::kBestEnergy2ms);
}

// The multipliers of the first serve the second, with costs that cover both.
TEST(EnergyCertificate, ProvesSeveralDevicesByTheSameMultipliers) {
  ModalModel models[2] = {};
  const Accelerometer devices[] = {{1.037, 4073.0, 0.3182}, {1.04, 4067.0, 0.3178}};
  const double energies[] = {test::kBestEnergy2ms, 0.0051346992};  // Of the refined switch at each.
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(models[i].set(devices[i], {10, 1000.0, 1.037}, Criterion::kIntegralSquareError),
              Status::kOk);
  }
  const double duration_s = 2e-3;
  const double switches_s[] = {1.0475e-3};
  Work work(110, mesh_intervals(models[1], duration_s));
  EnergyCertificate& certificate = work.certificate();
  ASSERT_EQ(certificate.start({models, 2}, duration_s, 90, switches_s, work.workspace()),
            Status::kOk);
  while (!certificate.ready()) {
    certificate.prepare();
  }
  improve(certificate, 30, 600);
  ASSERT_TRUE(certificate.prove());
  EXPECT_GT(kPaperA2 * certificate.bound(), energies[0]);
  EXPECT_LT(kPaperA2 * certificate.bound(), 1.005 * energies[0]);
  const std::vector<std::int32_t> first(certificate.duals().begin(), certificate.duals().end());
  const double bound = certificate.bound();
  ASSERT_TRUE(certificate.prove(1));
  EXPECT_GT(kPaperA2 * certificate.bound(), energies[1]);
  EXPECT_LT(kPaperA2 * certificate.bound(), 1.005 * energies[1]);
  ASSERT_TRUE(certificate.prove(0));  // And back.
  EXPECT_NEAR(certificate.bound() / bound, 1.0, 1e-6);
  EXPECT_EQ(
      certificate.start(Span<const ModalModel>(), duration_s, 90, switches_s, work.workspace()),
      Status::kInvalidArgument);
}

// The proof itself, built anew from multipliers and y, with long double and no margin.
TEST(EnergyCertificate, LeavesASemidefiniteMatrix) {
  const std::size_t cells = 24;
  const std::vector<double> matrix = phi_of(cells);
  Work work(cells, 0);
  EnergyCertificate& certificate = work.certificate();
  ASSERT_EQ(certificate.start({matrix.data(), matrix.size()}, cells, work.workspace()),
            Status::kOk);
  improve(certificate, 20, 300);
  ASSERT_TRUE(certificate.prove());
  std::vector<long double> slack(matrix.size());
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    slack[i] = -static_cast<long double>(matrix[i]);
  }
  long double bound = 0.0L;
  const Span<const std::int32_t> duals = certificate.duals();
  ASSERT_EQ(duals.size(), cells);
  for (std::size_t i = 0; i < cells; ++i) {
    const long double y = static_cast<long double>(duals[i]) * certificate.unit();
    slack[i * cells + i] += y;
    bound += y;
  }
  for (const TriangleMultiplier& own : certificate.multipliers()) {
    EXPECT_GE(own.units, 0);
    const long double half = 0.5L * own.units * certificate.unit();
    const std::int8_t* const signs = kTriangleSigns[own.kind];
    const std::size_t pairs[3][2] = {{own.i, own.j}, {own.j, own.k}, {own.i, own.k}};
    for (std::size_t p = 0; p < 3; ++p) {
      slack[pairs[p][0] * cells + pairs[p][1]] += half * signs[p];
      slack[pairs[p][1] * cells + pairs[p][0]] += half * signs[p];
    }
    bound += 2.0L * half;
  }
  EXPECT_NEAR(static_cast<double>(bound) / certificate.bound(), 1.0, 1e-11);
  for (std::size_t k = 0; k < cells; ++k) {
    ASSERT_GT(slack[k * cells + k], 0.0L) << k;
    for (std::size_t i = k + 1; i < cells; ++i) {
      const long double weight = slack[i * cells + k] / slack[k * cells + k];
      for (std::size_t j = k + 1; j < cells; ++j) {
        slack[i * cells + j] -= weight * slack[k * cells + j];
      }
    }
  }
}

TEST(EnergyCertificate, IsTheSameTwice) {
  const std::vector<double> matrix = phi_of(16);
  Work first(16, 0);
  Work second(16, 0);
  for (Work* const work : {&first, &second}) {
    ASSERT_EQ(work->certificate().start({matrix.data(), matrix.size()}, 16, work->workspace()),
              Status::kOk);
    improve(work->certificate(), 10, 100);
    ASSERT_TRUE(work->certificate().prove());
  }
  EXPECT_EQ(first.certificate().bound(), second.certificate().bound());
  const Span<const TriangleMultiplier> ones = first.certificate().multipliers();
  const Span<const TriangleMultiplier> others = second.certificate().multipliers();
  ASSERT_EQ(ones.size(), others.size());
  for (std::size_t i = 0; i < ones.size(); ++i) {
    EXPECT_EQ(ones[i].units, others[i].units);
  }
}

TEST(EnergyCertificate, RefusesSmallWorkspacesAndWrongSizes) {
  const std::vector<double> matrix = phi_of(8);
  Work work(8, 0);
  EnergyCertificate& certificate = work.certificate();
  const Span<const double> all(matrix.data(), matrix.size());
  EXPECT_EQ(certificate.start(all, 7, work.workspace()), Status::kInvalidArgument);
  EXPECT_EQ(certificate.start(all.first(1), 1, work.workspace()), Status::kInvalidArgument);
  CertificateWorkspace small = work.workspace();
  small.numbers = small.numbers.first(certificate_numbers(8, 0) - 1);
  EXPECT_EQ(certificate.start(all, 8, small), Status::kBufferTooSmall);
  small = work.workspace();
  small.hash = small.hash.first(60000);
  EXPECT_EQ(certificate.start(all, 8, small), Status::kBufferTooSmall);
  small = work.workspace();
  small.duals = small.duals.first(7);
  EXPECT_EQ(certificate.start(all, 8, small), Status::kBufferTooSmall);
  small = work.workspace();
  small.violated = {};
  EXPECT_EQ(certificate.start(all, 8, small), Status::kBufferTooSmall);
  EXPECT_EQ(certificate.start(paper_model(), 2e-3, 90, Span<const double>(), work.workspace()),
            Status::kBufferTooSmall);
  EXPECT_FALSE(certificate.ready());
}

}  // namespace
}  // namespace emax
