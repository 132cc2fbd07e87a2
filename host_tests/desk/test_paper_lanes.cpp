// The paper's procedure in the lanes of a vector against one run after the other.
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "emax/base/signs.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/energy/phi_operator.hpp"

#include "desk/trials/paper_lanes.hpp"
#include "desk/trials/paper_trials.hpp"
#include "support/paper_device.hpp"
#include "support/sign_pattern.hpp"

namespace emax {
namespace {

double one_by_one(const ModalModel& at_estimate, const Accelerometer& device, double duration_s,
                  std::size_t cells, std::size_t max_iterations) {
  ModalModel model = at_estimate;
  EXPECT_EQ(model.set_device(device), Status::kOk);
  PhiOperator phi{};
  EXPECT_EQ(phi.set(model, duration_s, cells), Status::kOk);
  const test::SignPattern signs(cells);
  const test::SignPattern best(cells);
  std::vector<double> product(cells);
  const Span<double> memory(product.data(), cells);
  signs_of_column(phi, 0, signs.view(), memory);
  return run_fixed_point(phi, max_iterations, 0.0, signs.view(), best.view(), memory,
                         Span<double>())
      .energy;
}

TEST(PaperLanes, EveryBitIsThatOfOneRunAfterTheOther) {
  if (!desk::has_lanes()) {
    GTEST_SKIP() << "The processor has no AVX2.";
  }
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> part(-0.02, 0.02);
  for (const int order : {1, 2, 9, 10, 15}) {
    for (const Criterion criterion :
         {Criterion::kIntegralSquareError, Criterion::kEnergyDifference}) {
      ModalModel model{};
      ASSERT_EQ(model.set(test::kPaperDevice, {order, 1000.0, 1.037}, criterion), Status::kOk);
      std::vector<Accelerometer> devices;
      for (int i = 0; i < 23; ++i) {
        devices.push_back({1.037 * (1.0 + part(random)), 4073.0 * (1.0 + part(random)),
                           0.3182 * (1.0 + part(random))});
      }
      for (const std::size_t max_iterations : {1u, 4u, 30u}) {
        desk::PaperLanes lanes(model, 2e-3, 301, max_iterations);
        std::vector<double> energies(devices.size());
        // Twice: a second run must not depend on the first one.
        for (int repeat = 0; repeat < 2; ++repeat) {
          lanes.run(Span<const Accelerometer>(devices.data(), devices.size()),
                    Span<double>(energies.data(), energies.size()));
          for (std::size_t i = 0; i < devices.size(); ++i) {
            EXPECT_EQ(energies[i], one_by_one(model, devices[i], 2e-3, 301, max_iterations))
                << order << ' ' << i;
          }
        }
      }
    }
  }
}

TEST(PaperTrials, DoNotDependOnTheNumberOfThreads) {
  const ModalModel model = test::paper_model();
  std::vector<Accelerometer> devices;
  for (int i = 0; i < 11; ++i) {
    devices.push_back({1.037, 4000.0 + 10.0 * i, 0.3182});
  }
  for (const std::size_t count : {devices.size(), std::size_t{2}, std::size_t{0}}) {
    for (const std::size_t threads : {1u, 2u, 3u, 40u}) {
      std::vector<double> energies(count);
      desk::find_paper_energies(model, {2e-3, 200, 30}, threads,
                                Span<const Accelerometer>(devices.data(), count),
                                Span<double>(energies.data(), count));
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(energies[i], one_by_one(model, devices[i], 2e-3, 200, 30)) << threads;
      }
    }
  }
}

TEST(PaperLanes, ADeviceThatIsNoneHasNoEnergy) {
  if (!desk::has_lanes()) {
    GTEST_SKIP() << "The processor has no AVX2.";
  }
  desk::PaperLanes lanes(test::paper_model(), 2e-3, 100, 30);
  const Accelerometer devices[] = {{1.0, 4000.0, 1.5}, {1.0, 4000.0, 0.3}, {-1.0, 4000.0, 0.3}};
  double energies[3];
  lanes.run(Span<const Accelerometer>(devices), Span<double>(energies));
  EXPECT_NE(energies[0], energies[0]);
  EXPECT_EQ(energies[1], one_by_one(test::paper_model(), devices[1], 2e-3, 100, 30));
  EXPECT_NE(energies[2], energies[2]);
}

}  // namespace
}  // namespace emax
