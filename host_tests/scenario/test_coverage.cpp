// Five hundred benches, each with its own truth and noise: do the intervals of the fit contain the
// truth as often as they say?
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>

#include "emax/app/measure/sweep.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/sim/sim_bench.hpp"

namespace {

using emax::Status;

constexpr std::uint64_t kBenches = 500;
// Of a binomial distribution with 500 trials of 0.95, 99.9 % lie within.
constexpr int kFewest = 458;
constexpr int kMost = 489;
constexpr double kCoverageFactor = 1.96;

struct Inside {
  std::array<int, 3> of = {};  // S, f0, beta.
};

void count(const emax::WlspFit& fit, const emax::sim::Device& truth, Inside& inside) {
  inside.of[0] +=
      std::fabs(fit.model.sensitivity - truth.sensitivity) < kCoverageFactor * fit.u_sensitivity;
  inside.of[1] += std::fabs(fit.model.natural_frequency_hz - truth.natural_frequency_hz) <
                  kCoverageFactor * fit.u_natural_frequency_hz;
  inside.of[2] += std::fabs(fit.model.damping - truth.damping) < kCoverageFactor * fit.u_damping;
}

TEST(Coverage, OfFiveHundredBenches) {
  static emax::sim::SimBench bench;
  static emax::app::SweepResults results;
  static emax::app::SweepWorkspace work;
  emax::app::Sweep sweep(results, work, bench);
  static emax::FrequencyResponse response;
  static emax::Wlsp wlsp;
  Inside with_common;
  Inside without_common;
  double chi2 = 0.0;
  std::uint64_t frames = 0;
  for (std::uint64_t seed = 1; seed <= kBenches; ++seed) {
    emax::sim::BenchSettings settings;
    settings.seed = seed;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    ASSERT_EQ(sweep.start(emax::app::default_sweep_settings()), Status::kOk);
    while (!sweep.done()) {
      sweep.step();
    }
    ASSERT_EQ(results.status, Status::kOk) << "seed " << seed;
    ASSERT_EQ(results.copy_to(response), Status::kOk);
    frames += bench.clock_frames();

    ASSERT_EQ(wlsp.fit(response), Status::kOk) << "seed " << seed;
    count(wlsp.result(), bench.truth().device, with_common);
    chi2 += wlsp.result().chi2;

    ASSERT_EQ(response.set_common(0.0), Status::kOk);
    ASSERT_EQ(wlsp.fit(response), Status::kOk) << "seed " << seed;
    count(wlsp.result(), bench.truth().device, without_common);
  }
  for (const int inside : with_common.of) {
    EXPECT_GE(inside, kFewest);
    EXPECT_LE(inside, kMost);
  }
  // What is common to all points cannot be seen from their scatter: without it the interval of S
  // is as good as never right, while those of f0 and beta stay what they were.
  EXPECT_LT(without_common.of[0], kFewest / 2);
  EXPECT_EQ(without_common.of[1], with_common.of[1]);
  EXPECT_EQ(without_common.of[2], with_common.of[2]);
  // 81 degrees of freedom, variance 162 each, four standard deviations of the mean of 500. The
  // noise is itself known to sqrt(1/288) only, which moves chi-square by 10 from bench to bench,
  // and by half of one in the mean.
  EXPECT_NEAR(chi2 / static_cast<double>(kBenches), 81.0, 4.0 * std::sqrt(262.0 / 500.0) + 0.6);
  RecordProperty("inside_S", with_common.of[0]);
  RecordProperty("inside_f0", with_common.of[1]);
  RecordProperty("inside_beta", with_common.of[2]);
  RecordProperty("inside_S_without_common", without_common.of[0]);
  std::printf(
      "inside: S %d, f0 %d, beta %d of %d; S without the common part %d; chi-square %.2f; "
      "%.0f frames per sweep\n",
      with_common.of[0], with_common.of[1], with_common.of[2], static_cast<int>(kBenches),
      without_common.of[0], chi2 / static_cast<double>(kBenches),
      static_cast<double>(frames) / static_cast<double>(kBenches));
}

}  // namespace
