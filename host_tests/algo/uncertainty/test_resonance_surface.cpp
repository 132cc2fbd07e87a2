// The surface of the largest energy of lightly damped sensors against whole searches.
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "emax/uncertainty/energy_trials.hpp"
#include "emax/uncertainty/resonance_surface.hpp"

namespace emax {
namespace {

constexpr std::uint32_t kSeed[] = {123456789, 345678901, 567890123, 789012345};
constexpr Butterworth kFilter = {10, 1000.0, 0.0102};
constexpr double kT_s = 2e-3;

GridWorkspace workspace;
EnergySearch search;
EnergyTrials trials;
ResonanceSurface surface;

ModalModel model_of(const Accelerometer& device) {
  ModalModel model{};
  EXPECT_EQ(model.set(device, kFilter, Criterion::kIntegralSquareError), Status::kOk);
  return model;
}

MaximumEnergy searched(const ModalModel& model) {
  EXPECT_EQ(search.start(model, {Method::kBest, kT_s, 0.0, 0}), Status::kOk);
  while (!search.done()) {
    EXPECT_EQ(search.step(model, workspace), Status::kOk);
  }
  return search.result();
}

/// f0 and beta jointly normal, S with 0.1 %; or uniform.
TrialSettings settings_for(const Accelerometer& device, Distribution distribution, double u_hz,
                           double u_damping) {
  TrialSettings settings;
  settings.distribution = distribution;
  settings.box = {1e-3 * device.sensitivity, u_hz, u_damping};
  settings.covariance[0][0] = 1e-6 * device.sensitivity * device.sensitivity;
  settings.covariance[1][1] = u_hz * u_hz;
  settings.covariance[2][2] = u_damping * u_damping;
  settings.search = {Method::kBest, kT_s, 0.0, 0};
  EXPECT_EQ(settings.generator.seed(Generator::k2006, kSeed), Status::kOk);
  return settings;
}

/// Makes the trials ready. @returns In how many steps.
int prepare(const ModalModel& model, const TrialSettings& settings) {
  const MaximumEnergy best = searched(model);
  EXPECT_EQ(trials.start(model, best, settings), Status::kOk);
  int steps = 0;
  for (; !trials.ready(); ++steps) {
    EXPECT_FALSE(trials.has_surface());
    trials.prepare(search, workspace);
  }
  return steps;
}

TEST(ResonantEnergy, IsWhatAWholeSearchFinds) {
  for (const double f0_hz : {30000.0, 41234.5, 55000.0}) {
    for (const double damping : {1e-4, 1e-3, 0.01, 0.03}) {
      const ModalModel model = model_of({0.0102, f0_hz, damping});
      const double expected = searched(model).energy;
      const double found = resonant_energy(model, kT_s, workspace);
      // Both are refined to rounding, over two hundred switches.
      EXPECT_NEAR(found, expected, 1e-11 * expected) << f0_hz << ' ' << damping;
      EXPECT_NEAR(energy(model, workspace.signal()), found, 1e-11 * expected);
    }
  }
}

TEST(ResonantEnergy, IsNothingWhereThereIsNoRoomForTheSwitches) {
  const ModalModel model = model_of({0.0102, 55000.0, 0.01});
  const double too_long_s = (static_cast<double>(kMaxSwitches) + 2.0) * 0.5 / 55000.0;
  EXPECT_EQ(resonant_energy(model, too_long_s, workspace), 0.0);
}

struct Sensor {
  Accelerometer device;
  Distribution distribution;
  double u_hz;
  double u_damping;
  int steps;  // The estimate, nodes and checks.
};

class Surface : public testing::TestWithParam<Sensor> {};

TEST_P(Surface, IsAsNearToWholeSearchesAsItSays) {
  const Sensor& c = GetParam();
  TrialSettings settings = settings_for(c.device, c.distribution, c.u_hz, c.u_damping);
  settings.pieces = TrialPieces({}, &surface);
  const ModalModel model = model_of(c.device);
  EXPECT_EQ(prepare(model, settings), c.steps);
  ASSERT_TRUE(trials.has_surface());
  EXPECT_TRUE(trials.predicts());
  EXPECT_LE(trials.notes().rough_part, 0.02);
  EXPECT_LE(trials.tolerance(), 0.01);
  // Other draws than those that it has been checked at.
  for (std::uint32_t t = 1000; t < 1010; ++t) {
    const Accelerometer device = trials.device(t);
    ModalModel moved = model;
    ASSERT_EQ(moved.set_device(device), Status::kOk);
    const double expected = searched(moved).energy;
    const double found = trials.energy(t, workspace);
    EXPECT_NEAR(found, expected, 2.0 * trials.tolerance() * expected) << t;
    EXPECT_EQ(trials.energy_of(device, workspace), found);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, Surface,
    testing::Values(Sensor{{0.0102, 55000.0, 0.03}, Distribution::kNormal, 2500.0, 0.014, 45},
                    Sensor{{0.0102, 30000.0, 0.017}, Distribution::kNormal, 500.0, 0.0073, 45},
                    Sensor{{0.0102, 55000.0, 0.03}, Distribution::kBox, 2500.0, 0.014, 33},
                    Sensor{{0.0102, 50000.0, 0.02}, Distribution::kNormal, 0.0, 0.006, 21}));

// Memory that others have left in the middle of their work is begun anew.
TEST(ResonanceSurface, IsTheSameInMemoryThatWasInUse) {
  const Accelerometer device = {0.0102, 30000.0, 0.017};
  TrialSettings settings = settings_for(device, Distribution::kNormal, 500.0, 0.0073);
  settings.pieces = TrialPieces({}, &surface);
  const ModalModel model = model_of(device);
  surface = ResonanceSurface();
  const int steps = prepare(model, settings);
  const double energy = trials.energy(7, workspace);
  ASSERT_EQ(trials.start(model, searched(model), settings), Status::kOk);
  double before = surface.progress();
  for (int step = 0; step < 20; ++step) {
    trials.prepare(search, workspace);
    EXPECT_TRUE(step == 0 || surface.progress() > before) << step;
    before = surface.progress();
  }
  EXPECT_EQ(prepare(model, settings), steps);
  EXPECT_EQ(trials.energy(7, workspace), energy);
}

// What lies outside the nodes is refined: f0 by 6 standard deviations, where the nodes end at 4.5.
TEST(ResonanceSurface, OutsideItsNodesTheSignalIsRefined) {
  TrialSettings settings =
      settings_for({0.0102, 30000.0, 0.017}, Distribution::kNormal, 500.0, 0.0073);
  settings.pieces = TrialPieces({}, &surface);
  (void)prepare(model_of({0.0102, 30000.0, 0.017}), settings);
  const Accelerometer far = {0.0102, 33000.0, 0.017};
  EXPECT_FALSE(surface.reaches(far));
  const double expected = searched(model_of(far)).energy;
  EXPECT_NEAR(trials.energy_of(far, workspace), expected, 1e-11 * expected);
}

TEST(ResonanceSurface, GainThatFollowsMakesEnergyGoWithTheSquareOfS) {
  TrialSettings settings =
      settings_for({0.0102, 30000.0, 0.017}, Distribution::kNormal, 500.0, 0.0073);
  settings.pieces = TrialPieces({}, &surface);
  settings.gain_follows = true;
  (void)prepare(model_of({0.0102, 30000.0, 0.017}), settings);
  ASSERT_TRUE(trials.has_surface());
  const double at_estimate = trials.energy_of({0.0102, 30500.0, 0.02}, workspace);
  const double at_other = trials.energy_of({0.0104, 30500.0, 0.02}, workspace);
  const double ratio = 0.0104 / 0.0102;
  EXPECT_NEAR(at_other, ratio * ratio * at_estimate, 1e-12 * at_other);
}

// A surface is not laid where a search has found more than the resonant signal has.
TEST(ResonanceSurface, FailsWhereTheResonanceIsNotTheWorst) {
  DeviceDraws draws{};
  const Accelerometer device = {0.0102, 30000.0, 0.017};
  const TrialSettings settings = settings_for(device, Distribution::kBox, 500.0, 0.0073);
  ASSERT_EQ(draws.start(device, settings), Status::kOk);
  const ModalModel model = model_of(device);
  const MaximumEnergy best = searched(model);
  EnergyBranches branches{};
  branches.start(model, best, draws, settings.search, false);
  for (const double factor : {1.0005, 1.002}) {
    surface.start(draws, kT_s, factor * best.energy);
    surface.step(draws, branches, search, workspace);
    EXPECT_EQ(surface.has_failed(), factor > 1.001) << factor;
  }
}

// With uncertainties so small that the change from one count of switches to the next is as large
// as what they do, the misfit is more than a tenth of u(E), and branches come.
TEST(ResonanceSurface, WhereItMisfitsBranchesCome) {
  const Accelerometer device = {0.0102, 30000.0, 0.01};
  TrialSettings settings = settings_for(device, Distribution::kBox, 500.0, 1e-9);
  settings.box.sensitivity = 0.0;
  std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);
  settings.pieces = TrialPieces({pieces.data(), pieces.size()}, &surface);
  (void)prepare(model_of(device), settings);
  EXPECT_TRUE(surface.has_failed());
  EXPECT_GT(surface.rough_part(), ResonanceSurface::kAccepted);
  EXPECT_FALSE(trials.has_surface());
  EXPECT_GE(trials.notes().branches, 1);
}

TEST(ResonanceSurface, IsNotLaidForASignalOfFewSwitches) {
  const Accelerometer device = {0.0102, 4073.0, 0.3182};
  TrialSettings settings = settings_for(device, Distribution::kBox, 6.0, 4e-4);
  settings.pieces = TrialPieces({}, &surface);
  (void)prepare(model_of(device), settings);
  EXPECT_FALSE(trials.has_surface());
}

}  // namespace
}  // namespace emax
