// The matrix of the cells against energies that know no cells, and what rounding costs at most.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "emax/bound/certificate_grid.hpp"
#include "emax/energy/refinement.hpp"

#include "support/paper_device.hpp"
#include "support/rounding.hpp"

namespace emax {
namespace {

using test::paper_model;

class Grid {
 public:
  Grid(const ModalModel& model, double duration_s, std::size_t wanted)
      : numbers_(kernel_bounds_numbers(mesh_intervals(model, duration_s))) {
    EXPECT_EQ(lay_out_cells(model, duration_s, wanted, grid), Status::kOk);
    EXPECT_EQ(bounds.start(model, duration_s, {numbers_.data(), numbers_.size()}), Status::kOk);
    while (!bounds.done()) {
      bounds.step();
    }
    fill_costs(model, bounds, 1.0, grid);
    matrix.resize(grid.cells * grid.cells);
    std::vector<double> scratch(4 * kMaxModes * grid.cells);
    fill_certificate_phi(model, grid, {matrix.data(), matrix.size()},
                         {scratch.data(), scratch.size()});
  }

  /// The energy of a pattern without the costs of rounding.
  double plain(const std::vector<int>& signs) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < grid.cells; ++i) {
      for (std::size_t j = 0; j < grid.cells; ++j) {
        sum += signs[i] * signs[j] * matrix[i * grid.cells + j];
      }
    }
    return sum;
  }

  double with_costs(const std::vector<int>& signs) const {
    double sum = plain(signs) + grid.constant;
    for (std::size_t edge = 1; edge < grid.cells; ++edge) {
      sum += signs[edge] != signs[edge - 1] ? grid.switch_cost[edge] : 0.0;
    }
    return sum;
  }

  std::vector<int> middles_of(const SwitchingSignal& signal) const {
    std::vector<int> signs;
    for (std::size_t cell = 0; cell < grid.cells; ++cell) {
      signs.push_back(signal.value(0.5 * (grid.edges_s[cell] + grid.edges_s[cell + 1])) > 0.0 ? 1
                                                                                              : -1);
    }
    return signs;
  }

  CertificateGrid grid{};
  KernelBounds bounds{};
  std::vector<double> matrix;

 private:
  std::vector<double> numbers_;
};

SwitchingSignal signal_of(const std::vector<double>& times_s, double duration_s) {
  SwitchingSignal signal{};
  EXPECT_EQ(signal.set({times_s.data(), times_s.size()}, duration_s), Status::kOk);
  return signal;
}

SwitchingSignal random_signal(std::mt19937_64& random, std::size_t count, double duration_s) {
  std::vector<double> times_s(count);
  for (double& time_s : times_s) {
    time_s = duration_s * (static_cast<double>(random() % 9973) + 1.0) / 9975.0;
  }
  std::sort(times_s.begin(), times_s.end());
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  return signal_of(times_s, duration_s);
}

TEST(CertificateGrid, CoversTheTimeWithNarrowCellsAtTheEnds) {
  const ModalModel model = paper_model();
  for (const std::size_t wanted : {std::size_t{82}, std::size_t{190}, std::size_t{500}}) {
    CertificateGrid grid{};
    ASSERT_EQ(lay_out_cells(model, 2e-3, wanted, grid), Status::kOk);
    EXPECT_EQ(grid.edges_s[0], 0.0);
    EXPECT_EQ(grid.edges_s[grid.cells], 2e-3);
    for (std::size_t cell = 0; cell < grid.cells; ++cell) {
      const double width_s = grid.edges_s[cell + 1] - grid.edges_s[cell];
      EXPECT_GT(width_s, 0.9e-6);
      EXPECT_LE(width_s, 2e-3 / static_cast<double>(wanted) * 1.0000001);
    }
    EXPECT_LT(grid.edges_s[grid.cells] - grid.edges_s[grid.cells - 1], 2.1e-6);
    EXPECT_LE(grid.cells, wanted + wanted / 10 + 32);
  }
  CertificateGrid grid{};
  ASSERT_EQ(lay_out_cells(model, 0.3e-3, 170, grid), Status::kOk);  // None of them is narrow.
  EXPECT_EQ(grid.edges_s[grid.cells], 0.3e-3);
  EXPECT_EQ(lay_out_cells(model, 2e-3, kMaxCertificateCells + 1, grid), Status::kTooManyCells);
  EXPECT_EQ(lay_out_cells(model, 2e-3, kMinCertificateCells - 1, grid), Status::kInvalidArgument);
  EXPECT_EQ(lay_out_cells(model, 0.0, 100, grid), Status::kInvalidArgument);
}

TEST(CertificateGrid, MatrixHasTheEnergiesOfPatterns) {
  for (const int order : {2, 7, 10}) {
    ModalModel model{};
    ASSERT_EQ(model.set(test::kPaperDevice, {order, 1000.0, 0.9}, Criterion::kIntegralSquareError),
              Status::kOk);
    const Grid grid(model, 1.5e-3, 80);
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<int> signs(grid.grid.cells, 1);
      std::vector<double> times_s;
      for (std::size_t edge = 1; edge < grid.grid.cells; ++edge) {
        const bool turns = random() % 5 == 0;
        signs[edge] = turns ? -signs[edge - 1] : signs[edge - 1];
        if (turns) {
          times_s.push_back(grid.grid.edges_s[edge]);
        }
      }
      EXPECT_NEAR(grid.plain(signs), energy(model, signal_of(times_s, 1.5e-3)),
                  100.0 * test::rounding_of(model));
    }
  }
}

// Every signal whose gradient is zero at its switches loses no more than what rounding costs at
// most; refined signals are of that kind, good ones and bad ones.
TEST(CertificateGrid, RoundingNeverLosesMoreThanItsCost) {
  std::vector<double> scratch(kRefinementScratch);
  for (const double duration_s : {1e-3, 2e-3, 4e-3}) {
    const ModalModel model = paper_model();
    const Grid grid(model, duration_s, static_cast<std::size_t>(duration_s / 2.4e-5) + 1);
    std::mt19937_64 random(11);
    double least_slack = 1.0;
    int rounded = 0;
    for (int trial = 0; trial < 300; ++trial) {
      SwitchingSignal signal = random_signal(random, 1 + random() % 8, duration_s);
      const double exact = refine(model, signal, {scratch.data(), scratch.size()}).energy;
      const std::vector<int> signs = grid.middles_of(signal);
      std::size_t turns = 0;
      for (std::size_t edge = 1; edge < grid.grid.free_from; ++edge) {
        turns += signs[edge] != signs[edge - 1] ? 1u : 0u;
      }
      if (turns != signal.count()) {
        continue;  // Two switches too close for a maximiser, or near T.
      }
      ++rounded;
      EXPECT_GE(grid.with_costs(signs), exact);
      least_slack = std::fmin(least_slack, grid.with_costs(signs) / exact - 1.0);
    }
    EXPECT_GT(rounded, 100);
    EXPECT_LT(least_slack, 0.05);  // And the costs are of the size of the losses.
  }
}

TEST(CertificateGrid, RunsOfTheBestSignalsAreLongEnough) {
  const ModalModel model = paper_model();
  const Grid grid(model, 2e-3, 190);
  // Shortest runs of 83 us in the middle, measured elsewhere, and none shorter than 60.
  const std::size_t middle = grid.grid.cells / 2;
  const double run_s = grid.grid.edges_s[grid.grid.run_end[middle]] - grid.grid.edges_s[middle];
  EXPECT_GT(run_s, 60e-6);
  EXPECT_LT(run_s, 95e-6);
  EXPECT_GT(grid.grid.edges_s[grid.grid.free_from], 2e-3 - 70e-6);
  EXPECT_TRUE(grid.grid.no_run_between(50, 51, 53));
  EXPECT_FALSE(grid.grid.no_run_between(50, 55, 80));
  EXPECT_FALSE(
      grid.grid.no_run_between(grid.grid.cells - 4, grid.grid.cells - 3, grid.grid.cells - 2));
}

// By the lemma a shorter pulse between two zeros could be turned with profit.
TEST(CertificateGrid, ShorterRunsBreakTheCondition) {
  const ModalModel model = paper_model();
  const Grid grid(model, 2e-3, 120);
  for (std::size_t edge = 1; edge < grid.grid.free_from; edge += 7) {
    const std::size_t end = grid.grid.run_end[edge] - 1u;
    const double from_s = 0.5 * (grid.grid.edges_s[edge - 1] + grid.grid.edges_s[edge]);
    const double to_s = 0.5 * (grid.grid.edges_s[edge] + grid.grid.edges_s[edge + 1]);
    const double longest_s = 0.5 * (grid.grid.edges_s[end] + grid.grid.edges_s[end + 1]) - from_s;
    for (double width_s = 0.01 * longest_s; width_s <= longest_s; width_s += 0.01 * longest_s) {
      const double most =
          grid.bounds.bound(2, from_s, to_s + width_s) * std::pow(width_s, 3) / 12.0;
      EXPECT_GT(pulse_energy(model, 2e-3 - to_s, width_s), most);
      EXPECT_GT(pulse_energy(model, 2e-3 - from_s, width_s), most);
    }
  }
}

}  // namespace
}  // namespace emax
