// Trials of the Monte Carlo procedure: their draws, their order, and the energy they find.
#include <gtest/gtest.h>
#include <vector>

#include "emax/energy_trials.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::kPaperA2;
using test::kPaperDevice;
using test::paper_model;

constexpr std::uint32_t kSeed[] = {123456789, 345678901, 567890123, 789012345};
constexpr ParameterBox kPaperBox = {0.003, 6.0, 0.0004};

GridWorkspace workspace;
EnergySearch search;
EnergyTrials trials;

TrialSettings settings_for(Method method, double duration_s) {
  TrialSettings settings;
  settings.box = kPaperBox;
  EXPECT_EQ(settings.generator.seed(Generator::k2006, kSeed), Status::kOk);
  settings.search.method = method;
  settings.search.duration_s = duration_s;
  settings.search.step_s = 2e-6;
  settings.search.max_iterations = 30;
  return settings;
}

Status start(const TrialSettings& settings, const ModalModel& model) {
  Status status = search.start(model, settings.search, workspace);
  while (status == Status::kOk && !search.done()) {
    status = search.step(model, workspace);
  }
  return status == Status::kOk ? trials.start(model, search.result(), settings) : status;
}

/// The largest energy that the whole search finds for a device, filter unchanged.
double full_search(const Accelerometer& device, const TrialSettings& settings) {
  ModalModel model = paper_model();
  EXPECT_EQ(model.set_device(device), Status::kOk);
  EnergySearch full;
  EXPECT_EQ(full.start(model, settings.search, workspace), Status::kOk);
  while (!full.done()) {
    EXPECT_EQ(full.step(model, workspace), Status::kOk);
  }
  return full.result().energy;
}

TEST(EnergyTrials, DrawsThreeNumbersPerTrialInTheOrderSensitivityFrequencyDamping) {
  ASSERT_EQ(start(settings_for(Method::kBest, 2e-3), paper_model()), Status::kOk);
  // The published first numbers of the generator for this seed.
  const double u[] = {0.75099757068263173, 0.05838148864854009, 0.32888922619308092,
                      0.11645956405699120};
  const Accelerometer first = trials.device(0);
  EXPECT_NEAR(first.sensitivity, 1.034 + 0.006 * u[0], 1e-15);
  EXPECT_NEAR(first.natural_frequency_hz, 4067.0 + 12.0 * u[1], 1e-12);
  EXPECT_NEAR(first.damping, 0.3178 + 0.0008 * u[2], 1e-15);
  EXPECT_NEAR(trials.device(1).sensitivity, 1.034 + 0.006 * u[3], 1e-15);
}

TEST(EnergyTrials, DoNotDependOnTheirOrder) {
  ASSERT_EQ(start(settings_for(Method::kBest, 2e-3), paper_model()), Status::kOk);
  std::vector<double> forward;
  for (std::uint32_t t = 0; t < 50; ++t) {
    forward.push_back(trials.energy(t, workspace));
  }
  for (std::uint32_t t = 50; t-- > 0;) {
    EXPECT_EQ(trials.energy(t, workspace), forward[t]);
  }
  EXPECT_EQ(trials.energy(17, workspace), forward[17]);
}

TEST(EnergyTrials, FindWhatAFullSearchOfThatDeviceFinds) {
  for (const double duration_s : {2e-3, 5e-3}) {
    const TrialSettings settings = settings_for(Method::kBest, duration_s);
    ASSERT_EQ(start(settings, paper_model()), Status::kOk);
    for (std::uint32_t t = 0; t < 12; ++t) {
      const Accelerometer device = trials.device(t);
      const double expected = full_search(device, settings);
      EXPECT_NEAR(trials.energy(t, workspace), expected, 1e-12 * expected) << t;
    }
  }
}

TEST(EnergyTrials, PaperMethodRunsTheWholeFixedPointInEachTrial) {
  const TrialSettings settings = settings_for(Method::kPaper, 2e-3);
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_NEAR(kPaperA2 * trials.energy_of(kPaperDevice, workspace), 0.00448654991209, 0.6e-14);
  for (std::uint32_t t = 0; t < 5; ++t) {
    const Accelerometer device = trials.device(t);
    const double expected = full_search(device, settings);
    EXPECT_NEAR(trials.energy(t, workspace), expected, 1e-12 * expected) << t;
  }
}

TEST(EnergyTrials, LargestCornerOfTheBoxMeetsTheKnownNumber) {
  ASSERT_EQ(start(settings_for(Method::kBest, 2e-3), paper_model()), Status::kOk);
  // Eight digits are known.
  const double corner = kPaperA2 * trials.energy_of({1.040, 4067.0, 0.3178}, workspace);
  EXPECT_NEAR(corner, 0.0051346992, 0.5e-10);
  for (const double s : {1.034, 1.040}) {
    for (const double f0_hz : {4067.0, 4079.0}) {
      for (const double damping : {0.3178, 0.3186}) {
        EXPECT_LE(kPaperA2 * trials.energy_of({s, f0_hz, damping}, workspace), corner);
      }
    }
  }
}

TEST(EnergyTrials, WithAGainThatFollowsTheEnergyGoesWithTheSquareOfTheSensitivity) {
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  settings.gain_follows = true;
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  const double at_estimate = trials.energy_of(kPaperDevice, workspace);
  const double at_double = trials.energy_of({2.074, 4073.0, 0.3182}, workspace);
  EXPECT_NEAR(at_double, 4.0 * at_estimate, 1e-13 * at_double);
  settings.gain_follows = false;
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_EQ(trials.energy_of(kPaperDevice, workspace), at_estimate);
  // A filter that stays at 1.037 leaves a lasting error of 1.037 a.
  EXPECT_NE(trials.energy_of({2.074, 4073.0, 0.3182}, workspace), at_double);
}

TEST(EnergyTrials, RefusesABoxThatLeavesWhatADeviceMayBe) {
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  const double before = trials.energy(3, workspace);
  const auto refuse = [&](const ParameterBox& box) {
    settings.box = box;
    return trials.start(paper_model(), search.result(), settings);
  };
  EXPECT_EQ(refuse({1.037, 6.0, 0.0004}), Status::kInvalidArgument);
  EXPECT_EQ(refuse({0.003, 4073.0, 0.0004}), Status::kInvalidArgument);
  EXPECT_EQ(refuse({0.003, 6.0, 0.3182}), Status::kInvalidArgument);
  EXPECT_EQ(refuse({0.003, 6.0, -0.1}), Status::kInvalidArgument);
  ModalModel heavy{};
  ASSERT_EQ(heavy.set({1.0, 4000.0, 0.9}, test::kPaperFilter, Criterion::kIntegralSquareError),
            Status::kOk);
  settings.box = {0.003, 6.0, 0.2};
  EXPECT_EQ(trials.start(heavy, search.result(), settings), Status::kOverdamped);
  EXPECT_EQ(trials.energy(3, workspace), before);
}

}  // namespace
}  // namespace emax
