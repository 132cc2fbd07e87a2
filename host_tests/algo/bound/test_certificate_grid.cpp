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
  Grid(const ModalModel& model, double duration_s, std::size_t wanted,
       const std::vector<double>& switches_s = {})
      : numbers_(kernel_bounds_numbers(mesh_intervals(model, duration_s))) {
    EXPECT_EQ(lay_out_cells(duration_s, wanted, {switches_s.data(), switches_s.size()}, grid),
              Status::kOk);
    EXPECT_EQ(bounds.start(model, duration_s, {numbers_.data(), numbers_.size()}), Status::kOk);
    while (!bounds.done()) {
      bounds.step();
    }
    raise_costs(bounds, 1.0, grid);
    matrix.resize(grid.cells * grid.cells);
    std::vector<double> scratch(4 * kMaxModes * grid.cells);
    fill_certificate_phi(model, grid, {matrix.data(), matrix.size()},
                         {scratch.data(), scratch.size()});
  }

  /// The energy of a signal that is constant on each cell.
  double plain(const std::vector<double>& means) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < grid.cells; ++i) {
      for (std::size_t j = 0; j < grid.cells; ++j) {
        sum += means[i] * means[j] * matrix[i * grid.cells + j];
      }
    }
    return sum;
  }

  double with_costs(const std::vector<double>& means) const {
    double sum = plain(means);
    for (std::size_t cell = 0; cell < grid.cells; ++cell) {
      sum += grid.costs[cell] * (1.0 - means[cell] * means[cell]);
    }
    return sum;
  }

  std::vector<double> means_of(const SwitchingSignal& signal) const {
    std::vector<double> means;
    for (std::size_t cell = 0; cell < grid.cells; ++cell) {
      const double from_s = grid.edges_s[cell];
      const double to_s = grid.edges_s[cell + 1];
      double sum = 0.0;
      double at_s = from_s;
      for (const double switch_s : signal.times_s()) {
        if (switch_s > at_s && switch_s < to_s) {
          sum += (switch_s - at_s) * signal.value(0.5 * (at_s + switch_s));
          at_s = switch_s;
        }
      }
      sum += (to_s - at_s) * signal.value(0.5 * (at_s + to_s));
      means.push_back(sum / (to_s - from_s));
    }
    return means;
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

TEST(CertificateGrid, CoversTheTimeWithNarrowCellsAboutSwitches) {
  const double switches_s[] = {0.31e-3, 1.0475e-3};
  for (const std::size_t wanted : {std::size_t{82}, std::size_t{190}, std::size_t{500}}) {
    CertificateGrid grid{};
    ASSERT_EQ(lay_out_cells(2e-3, wanted, switches_s, grid), Status::kOk);
    EXPECT_EQ(grid.edges_s[0], 0.0);
    EXPECT_EQ(grid.edges_s[grid.cells], 2e-3);
    const double usual_s = 2e-3 / static_cast<double>(wanted);
    std::size_t usual = 0;
    for (std::size_t cell = 0; cell < grid.cells; ++cell) {
      const double width_s = grid.edges_s[cell + 1] - grid.edges_s[cell];
      EXPECT_GT(width_s, 0.1 * usual_s);
      EXPECT_LT(width_s, 1.0000001 * usual_s);
      usual += width_s > 0.99 * usual_s ? 1u : 0u;
      for (const double switch_s : switches_s) {
        if (grid.edges_s[cell] <= switch_s && switch_s <= grid.edges_s[cell + 1]) {
          EXPECT_LT(width_s, 0.2 * usual_s);
        }
      }
    }
    EXPECT_GE(usual, wanted - 10);
  }
  CertificateGrid grid{};
  ASSERT_EQ(lay_out_cells(0.3e-3, 170, Span<const double>(), grid), Status::kOk);
  EXPECT_EQ(grid.cells, 170U);
  EXPECT_EQ(lay_out_cells(2e-3, kMaxCertificateCells + 1, switches_s, grid), Status::kTooManyCells);
  EXPECT_EQ(lay_out_cells(2e-3, kMinCertificateCells - 1, switches_s, grid),
            Status::kInvalidArgument);
  EXPECT_EQ(lay_out_cells(0.0, 100, switches_s, grid), Status::kInvalidArgument);
}

TEST(CertificateGrid, MatrixHasTheEnergiesOfPatterns) {
  for (const int order : {2, 7, 10}) {
    ModalModel model{};
    ASSERT_EQ(model.set(test::kPaperDevice, {order, 1000.0, 0.9}, Criterion::kIntegralSquareError),
              Status::kOk);
    const Grid grid(model, 1.5e-3, 80, {0.4e-3});
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<double> signs(grid.grid.cells, 1.0);
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

// For every signal, whatever its switches, good or bad.
TEST(CertificateGrid, MeansNeverLoseMoreThanTheirCost) {
  std::vector<double> scratch(kRefinementScratch);
  for (const double duration_s : {1e-3, 2e-3, 4e-3}) {
    const ModalModel model = paper_model();
    const Grid grid(model, duration_s, static_cast<std::size_t>(duration_s / 2.4e-5) + 1);
    std::mt19937_64 random(11);
    double least_slack = 1.0;
    for (int trial = 0; trial < 300; ++trial) {
      SwitchingSignal signal = random_signal(random, 1 + random() % 8, duration_s);
      if (trial % 2 == 0) {
        (void)refine(model, signal, {scratch.data(), scratch.size()});
      }
      const double exact = energy(model, signal);
      const double bound = grid.with_costs(grid.means_of(signal));
      EXPECT_GE(bound, exact * (1.0 - 1e-12));
      least_slack = std::fmin(least_slack, bound / exact - 1.0);
    }
    EXPECT_LT(least_slack, 0.05);  // And the costs are of the size of the losses.
  }
}

// A fast square wave has a mean of nearly 0 in every cell, and the costs have to pay for all of it.
TEST(CertificateGrid, CostsCoverSignalsThatSwitchWithinCells) {
  const ModalModel model = paper_model();
  const double duration_s = 2e-3;
  const Grid grid(model, duration_s, 84);
  for (const double half_period_s : {3e-6, 8e-6, 30e-6, 62e-6, 120e-6}) {
    std::vector<double> times_s;
    for (double time_s = half_period_s; time_s < duration_s && times_s.size() < 200;
         time_s += half_period_s) {
      times_s.push_back(time_s);
    }
    const SwitchingSignal signal = signal_of(times_s, duration_s);
    EXPECT_GE(grid.with_costs(grid.means_of(signal)), energy(model, signal)) << half_period_s;
  }
}

TEST(CertificateGrid, CostsFallWithTheSquareOfTheWidth) {
  const ModalModel model = paper_model();
  const Grid coarse(model, 2e-3, 100);
  const Grid fine(model, 2e-3, 200);
  // At the same place; m_1 is the largest of the cell.
  EXPECT_NEAR(fine.grid.costs[80] / coarse.grid.costs[40], 0.25, 0.01);
}

}  // namespace
}  // namespace emax
