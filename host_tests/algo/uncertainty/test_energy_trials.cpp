// Trials of the Monte Carlo procedure: their draws, their order, and the energy they find.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "emax/energy/refinement.hpp"
#include "emax/uncertainty/energy_trials.hpp"

#include "support/paper_device.hpp"
#include "support/rounding.hpp"

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
MaximumEnergy best;

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
  Status status = search.start(model, settings.search);
  while (status == Status::kOk && !search.done()) {
    status = search.step(model, workspace);
  }
  if (status != Status::kOk) {
    return status;
  }
  best = search.result();
  status = trials.start(model, best, settings);
  while (status == Status::kOk && !trials.ready()) {
    trials.prepare(search, workspace);
  }
  return status;
}

/// The largest energy that the whole search finds for a device, filter unchanged.
double full_search(const ModalModel& estimate, const Accelerometer& device,
                   const TrialSettings& settings) {
  ModalModel model = estimate;
  EXPECT_EQ(model.set_device(device), Status::kOk);
  EnergySearch full;
  EXPECT_EQ(full.start(model, settings.search), Status::kOk);
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

TEST(EnergyTrials, AreAsManyAsWantedWherePolynomialsAnswerThem) {
  std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  settings.pieces = TrialPieces({pieces.data(), pieces.size()});
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_TRUE(trials.predicts());
  EXPECT_EQ(trials.most_trials(), std::numeric_limits<std::uint32_t>::max());
}

TEST(EnergyTrials, FindWhatAFullSearchOfThatDeviceFinds) {
  for (const double duration_s : {2e-3, 5e-3}) {
    const TrialSettings settings = settings_for(Method::kBest, duration_s);
    ASSERT_EQ(start(settings, paper_model()), Status::kOk);
    for (std::uint32_t t = 0; t < 12; ++t) {
      const Accelerometer device = trials.device(t);
      const double expected = full_search(paper_model(), device, settings);
      EXPECT_NEAR(trials.energy(t, workspace), expected, 1e-12 * expected) << t;
    }
  }
}

struct Sensor {
  Accelerometer device;
  Butterworth filter;
  ParameterBox box;
  double duration_s;
  Criterion criterion;
};

class TrialsOf : public testing::TestWithParam<Sensor> {};

TEST_P(TrialsOf, AreWhatRefinementToTheEndFinds) {
  const Sensor& c = GetParam();
  ModalModel model{};
  ASSERT_EQ(model.set(c.device, c.filter, c.criterion), Status::kOk);
  for (const bool follows : {false, true}) {
    TrialSettings settings = settings_for(Method::kBest, c.duration_s);
    settings.box = c.box;
    settings.gain_follows = follows;
    ASSERT_EQ(start(settings, model), Status::kOk);
    const SwitchingSignal best_signal = best.signal;
    EXPECT_TRUE(trials.predicts());
    EXPECT_EQ(trials.notes().branches, 1u);  // So the best signal is the best all over the box.
    for (std::uint32_t t = 0; t < 1000; ++t) {
      const Accelerometer device = trials.device(t);
      ModalModel moved = model;
      ASSERT_EQ(moved.set_device(device), Status::kOk);
      if (follows) {
        ASSERT_EQ(moved.set_gain(device.sensitivity), Status::kOk);
      }
      SwitchingSignal signal = best_signal;
      const double expected = refine(moved, signal, workspace.refinement()).energy;
      // What the polynomial was accepted with, at 38 places; some other place may be a little
      // worse.
      ASSERT_NEAR(trials.energy(t, workspace), expected,
                  2.0 * trials.tolerance() * std::fabs(expected))
          << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, TrialsOf,
                         testing::Values(Sensor{kPaperDevice, test::kPaperFilter, kPaperBox, 2e-3,
                                                Criterion::kIntegralSquareError},
                                         Sensor{kPaperDevice, test::kPaperFilter, kPaperBox, 10e-3,
                                                Criterion::kIntegralSquareError},
                                         Sensor{kPaperDevice, test::kPaperFilter, kPaperBox, 2e-3,
                                                Criterion::kEnergyDifference},
                                         Sensor{{1.0, 900.0, 0.05},
                                                {1, 200.0, 1.0},
                                                {0.003, 0.5, 1e-4},
                                                8e-3,
                                                Criterion::kIntegralSquareError},
                                         Sensor{{0.5, 5000.0, 0.7},
                                                {5, 1000.0, 0.5},
                                                {0.002, 5.0, 1e-3},
                                                4e-3,
                                                Criterion::kIntegralSquareError},
                                         Sensor{{1.0, 4000.0, 0.5},
                                                {15, 2000.0, 1.0},
                                                {0.001, 4.0, 5e-4},
                                                2.5e-3,
                                                Criterion::kIntegralSquareError}));

// Two to four signals are the best somewhere in this box, with f0 within +-80 Hz and damping within
// +-0.016.
TrialSettings wide_settings() {
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  settings.box = {0.003, 80.0, 0.016};
  return settings;
}

TEST(EnergyTrials, TakeTheLargestOfSeveralSignals) {
  const TrialSettings settings = wide_settings();
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_GT(trials.notes().branches, 1u);
  EXPECT_FALSE(trials.notes().is_crowded);
  EXPECT_EQ(trials.notes().unsearched, 0u);
  // A search at this corner, found outside this code, reaches 5.29736e-3; the estimate's signal
  // 5.15e-3.
  const double corner = kPaperA2 * trials.energy_of({1.040, 4153.0, 0.3022}, workspace);
  EXPECT_GE(corner, 5.297355e-3);
  EXPECT_LT(corner, 5.2974e-3);
  for (std::uint32_t t = 0; t < 12; ++t) {
    const double expected = full_search(paper_model(), trials.device(t), settings);
    // A trial may find more than a search; what it may be off by is its tolerance.
    EXPECT_GE(trials.energy(t, workspace), (1.0 - 2.0 * trials.tolerance()) * expected) << t;
  }
}

TEST(EnergyTrials, WhereAPolynomialFailsTheTrialIsARefinement) {
  // The energy of a lightly damped sensor far from its estimate is no polynomial of degree 6: other
  // signals become the best on the way.
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 900.0, 0.05}, {1, 200.0, 1.0}, Criterion::kIntegralSquareError),
            Status::kOk);
  TrialSettings settings = settings_for(Method::kBest, 8e-3);
  settings.box = {0.01, 9.0, 5e-4};
  ASSERT_EQ(start(settings, model), Status::kOk);
  EXPECT_FALSE(trials.predicts());
  for (std::uint32_t t = 0; t < 20; ++t) {
    ASSERT_EQ(model.set_device(trials.device(t)), Status::kOk);
    SwitchingSignal signal = best.signal;
    const double expected = refine(model, signal, workspace.refinement()).energy;
    // At least what the estimate's signal is refined to, to rounding.
    EXPECT_GE(trials.energy(t, workspace), (1.0 - 1e-12) * expected) << t;
  }
}

/// Refinements times switches that a piece takes: 3 nodes along S, which is drawn uniformly, and 5
/// along f0 and damping.
double work_of(const EnergyBranches& piece) {
  return 3.0 * 5.0 * 5.0 * static_cast<double>(piece.notes().branches) *
         static_cast<double>(piece.most_switches() + 1);
}

/// Whether pieces were cut as long as that is worth it: until those made so far have taken
/// `most_work`.
///
/// @param[in] least_share Of the draws, in a piece that is cut; 0 where that is not looked at.
void expect_cuts_within(double most_work, double least_share, Span<const TrialPiece> pieces) {
  double work = 0.0;
  std::size_t cuts = 0;
  for (const TrialPiece& piece : pieces.first(trials.pieces_in_use())) {
    work += work_of(piece.branches);
    const bool is_large = piece.half[1] * piece.half[2] > least_share;
    const bool is_worth_it = !piece.branches.is_accurate() && is_large && work <= most_work;
    EXPECT_EQ(piece.child != 0, is_worth_it) << work << " of " << most_work;
    cuts += piece.child != 0 ? 1 : 0;
  }
  EXPECT_EQ(trials.pieces_in_use(), EnergyTrials::kFirstPieces + 2 * cuts);
  EXPECT_LE(trials.pieces_in_use() + 2, pieces.size());  // So none was left whole for want of room.
}

// Lightly damped: signals end and others begin within the ranges, so that no polynomial of degree 6
// holds all over them.
constexpr Sensor kHardSensors[] = {
    {{1.0, 4073.0, 0.01},
     {4, 1000.0, 1.0},
     {0.003, 12.0, 1e-4},
     10e-3,
     Criterion::kIntegralSquareError},
    {{1.0, 4073.0, 0.1},
     {4, 1000.0, 1.0},
     {0.003, 12.0, 1e-3},
     10e-3,
     Criterion::kIntegralSquareError},
    {{1.0, 900.0, 0.05}, {1, 200.0, 1.0}, {0.01, 9.0, 5e-4}, 8e-3, Criterion::kEnergyDifference},
};

TEST(EnergyTrials, InPiecesOfTheRangesFindWhatAFullSearchOfThatDeviceFinds) {
  std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);
  for (const Sensor& sensor : kHardSensors) {
    for (const Distribution distribution : {Distribution::kBox, Distribution::kNormal}) {
      if (distribution == Distribution::kNormal && sensor.device.damping != 0.1) {
        continue;  // One is enough.
      }
      ModalModel model{};
      ASSERT_EQ(model.set(sensor.device, sensor.filter, sensor.criterion), Status::kOk);
      TrialSettings settings = settings_for(Method::kBest, sensor.duration_s);
      settings.distribution = distribution;
      settings.box = sensor.box;
      settings.covariance[0][0] = sensor.box.sensitivity * sensor.box.sensitivity / 3.0;
      settings.covariance[1][1] =
          sensor.box.natural_frequency_hz * sensor.box.natural_frequency_hz / 3.0;
      settings.covariance[2][2] = sensor.box.damping * sensor.box.damping / 3.0;
      settings.pieces = TrialPieces({pieces.data(), pieces.size()});
      ASSERT_EQ(start(settings, model), Status::kOk);
      EXPECT_GE(trials.notes().pieces, EnergyTrials::kFirstPieces);
      if (distribution == Distribution::kBox) {
        // Nobody said how many trials there will be: half a second of a PC.
        expect_cuts_within(2.5e5, 1.0 / 256.0, {pieces.data(), pieces.size()});
      }
      // With 80 switches the cuts end before the polynomials are as good as that: it is said.
      EXPECT_LE(trials.tolerance(), sensor.device.damping == 0.01 ? 1e-3 : 1e-7);
      EXPECT_LE(trials.notes().rough_part, sensor.device.damping == 0.01 ? 0.011F : 1e-3F);
      // A few in a hundred are refined; all were before.
      int refined = 0;
      for (std::uint32_t t = 0; t < 400; ++t) {
        trials.begin(t, workspace);
        refined += trials.done() ? 0 : 1;
        while (!trials.done()) {
          trials.step(workspace);
        }
        if (t % 40 == 0) {
          const double found = trials.energy();
          const double expected = full_search(model, trials.device(t), settings);
          EXPECT_NEAR(found, expected, 2.0 * trials.tolerance() * std::fabs(expected)) << t;
        }
      }
      EXPECT_LT(refined, 40);
    }
  }
}

// Some hundred switches: pieces cost more than a few refinements, and much less than many.
TEST(EnergyTrials, AreWorthTheMorePiecesTheMoreThereAre) {
  constexpr std::uint32_t kLooked = 200;
  std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 27000.0, 0.02}, {4, 1000.0, 1.0}, Criterion::kIntegralSquareError),
            Status::kOk);
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  settings.box = {0.003, 1500.0, 0.008};
  settings.pieces = TrialPieces({pieces.data(), pieces.size()});
  const auto refined = [] {
    std::uint32_t count = 0;
    for (std::uint32_t t = 0; t < kLooked; ++t) {
      trials.begin(t, workspace);
      count += trials.done() ? 0U : 1U;
    }
    return count;
  };
  settings.expected_trials = 1000;
  ASSERT_EQ(start(settings, model), Status::kOk);
  EXPECT_EQ(trials.notes().pieces, 0);
  EXPECT_EQ(refined(), kLooked);
  // 275 refinements of 109 switches would be worth it.
  EXPECT_EQ(trials.most_trials(), EnergyTrials::kFewestTrials);
  const double work_of_trial = static_cast<double>(trials.work()) / 32.0;  // 32 for a switch.

  settings.expected_trials = 12000;
  ASSERT_EQ(start(settings, model), Status::kOk);
  // As all trials would be refined, pieces save that.
  const double saved = 12000.0 * work_of_trial;
  ASSERT_GT(0.25 * saved, 2.5e5);  // More than the half second that is worth it anyway.
  expect_cuts_within(0.25 * saved, 0.0, {pieces.data(), pieces.size()});
  EXPECT_GE(trials.notes().pieces, EnergyTrials::kFirstPieces);
  EXPECT_LT(refined(), kLooked / 4);
  EXPECT_GE(trials.most_trials(), EnergyTrials::kFewestTrials);
  for (std::uint32_t t = 0; t < 4; ++t) {
    const double found = trials.energy(t, workspace);
    const double expected = full_search(model, trials.device(t), settings);
    EXPECT_NEAR(found, expected, 2.0 * trials.tolerance() * expected) << t;
  }
}

TEST(EnergyTrials, BeforeTheyAreReadyTheyRefineTheEstimatesSignal) {
  const TrialSettings settings = wide_settings();
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  ASSERT_EQ(trials.start(paper_model(), best, settings), Status::kOk);
  EXPECT_FALSE(trials.ready());
  EXPECT_EQ(trials.progress(), 0.0);
  const Accelerometer corner = {1.040, 4153.0, 0.3022};  // A search there finds 2.8 % more.
  ModalModel moved = paper_model();
  ASSERT_EQ(moved.set_device(corner), Status::kOk);
  SwitchingSignal signal = best.signal;
  const double expected = refine(moved, signal, workspace.refinement()).energy;
  // The refinement begins at switches of 16 bits: rounding of two ways to the same maximum.
  EXPECT_NEAR(trials.energy_of(corner, workspace), expected, 1e-12 * expected);
}

TEST(EnergyTrials, ProgressOfThePreparationRisesToOne) {
  ASSERT_EQ(start(wide_settings(), paper_model()), Status::kOk);
  ASSERT_EQ(trials.start(paper_model(), best, settings_for(Method::kBest, 2e-3)), Status::kOk);
  double progress = 0.0;
  while (!trials.ready()) {
    trials.prepare(search, workspace);
    EXPECT_GE(trials.progress(), progress);
    progress = trials.progress();
  }
  EXPECT_EQ(progress, 1.0);
}

constexpr double kPaperCovariance[3][3] = {
    {9e-6, 4e-3, -3e-7}, {4e-3, 36.0, -1.5e-3}, {-3e-7, -1.5e-3, 1.6e-7}};

TrialSettings normal_settings(double duration_s) {
  TrialSettings settings = settings_for(Method::kBest, duration_s);
  settings.distribution = Distribution::kNormal;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      settings.covariance[i][j] = kPaperCovariance[i][j];
    }
  }
  return settings;
}

TEST(NormalTrials, HaveTheMomentsOfTheGivenCovariance) {
  ASSERT_EQ(start(normal_settings(2e-3), paper_model()), Status::kOk);
  constexpr int kDraws = 100000;
  const double u[3] = {3e-3, 6.0, 4e-4};
  double sum[3] = {};
  double products[3][3] = {};
  double fourth[3] = {};
  for (int t = 0; t < kDraws; ++t) {
    const Accelerometer device = trials.device(static_cast<std::uint32_t>(t));
    const double z[3] = {(device.sensitivity - kPaperDevice.sensitivity) / u[0],
                         (device.natural_frequency_hz - kPaperDevice.natural_frequency_hz) / u[1],
                         (device.damping - kPaperDevice.damping) / u[2]};
    for (std::size_t i = 0; i < 3; ++i) {
      sum[i] += z[i] / kDraws;
      fourth[i] += z[i] * z[i] * z[i] * z[i] / kDraws;
      for (std::size_t j = 0; j < 3; ++j) {
        products[i][j] += z[i] * z[j] / kDraws;
      }
    }
  }
  // Four standard deviations of a mean over 1e5 normal numbers (1/316), of a product of two with
  // correlation r (sqrt(1 + r^2)/316), and of a fourth power (sqrt(96)/316).
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sum[i], 0.0, 4.0 / 316.0);
    EXPECT_NEAR(fourth[i], 3.0, 4.0 * 9.8 / 316.0);
    for (std::size_t j = 0; j < 3; ++j) {
      const double r = kPaperCovariance[i][j] / (u[i] * u[j]);
      EXPECT_NEAR(products[i][j], r, 4.0 * std::sqrt(1.0 + r * r) / 316.0) << i << j;
    }
  }
}

TEST(NormalTrials, TakeFourNumbersEachAndReplay) {
  ASSERT_EQ(start(normal_settings(2e-3), paper_model()), Status::kOk);
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, kSeed), Status::kOk);
  for (std::uint32_t t = 0; t < 20; ++t) {
    double u[4];
    for (double& number : u) {
      number = generator.next();
    }
    // Box and Muller in the arithmetic of the C library; S comes from the first number alone.
    const double pi = std::acos(-1.0);
    const double z = std::sqrt(-2.0 * std::log(u[0])) * std::cos(2.0 * pi * u[1]);
    EXPECT_NEAR(trials.device(t).sensitivity, 1.037 + 3e-3 * z, 1e-14) << t;
  }
  const double seventeen = trials.energy(17, workspace);
  const double three = trials.energy(3, workspace);
  EXPECT_EQ(trials.energy(17, workspace), seventeen);
  EXPECT_EQ(trials.energy(3, workspace), three);
}

TEST(NormalTrials, AreWhatRefinementToTheEndFinds) {
  for (const double duration_s : {2e-3, 10e-3}) {
    ASSERT_EQ(start(normal_settings(duration_s), paper_model()), Status::kOk);
    const SwitchingSignal best_signal = best.signal;
    for (std::uint32_t t = 0; t < 1000; ++t) {
      ModalModel moved = paper_model();
      ASSERT_EQ(moved.set_device(trials.device(t)), Status::kOk);
      SwitchingSignal signal = best_signal;
      const double expected = refine(moved, signal, workspace.refinement()).energy;
      ASSERT_NEAR(trials.energy(t, workspace), expected, 1e-9 * expected) << t;
    }
  }
}

// Wide ranges, cut into pieces: below the estimate's damping another signal is the best, which in
// the middle of some pieces has ended.
TEST(NormalTrials, InPiecesKnowTheSignalsAtTheirCornersToo) {
  std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  settings.distribution = Distribution::kNormal;
  settings.covariance[0][0] = 0.003 * 0.003;
  settings.covariance[1][1] = 80.0 * 80.0;
  settings.covariance[2][2] = 0.016 * 0.016;
  settings.pieces = TrialPieces({pieces.data(), pieces.size()});
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_GT(trials.notes().pieces, EnergyTrials::kFirstPieces);
  for (std::uint32_t t = 0; t < 200; ++t) {
    const double expected = full_search(paper_model(), trials.device(t), settings);
    // What the comparison with a search in every trial asks for; a trial may find more.
    EXPECT_GE(trials.energy(t, workspace), (1.0 - 1e-6) * expected) << t;
  }
}

TEST(NormalTrials, TakeAParameterWithoutUncertaintyAndRefuseWhatIsNoCovariance) {
  TrialSettings settings = normal_settings(2e-3);
  for (std::size_t i = 0; i < 3; ++i) {
    settings.covariance[1][i] = settings.covariance[i][1] = 0.0;
  }
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_EQ(trials.device(5).natural_frequency_hz, 4073.0);
  EXPECT_NE(trials.device(5).damping, 0.3182);
  const auto refuse = [&](std::size_t i, std::size_t j, double value) {
    TrialSettings bad = normal_settings(2e-3);
    bad.covariance[i][j] = bad.covariance[j][i] = value;
    return trials.start(paper_model(), best, bad);
  };
  EXPECT_EQ(refuse(0, 0, -1e-9), Status::kInvalidArgument);
  EXPECT_EQ(refuse(0, 1, 0.019), Status::kInvalidArgument);  // A correlation above 1.
  EXPECT_EQ(refuse(2, 2, std::nan("")), Status::kInvalidArgument);
  TrialSettings bad = normal_settings(2e-3);
  bad.covariance[0][1] *= 1.1;
  EXPECT_EQ(trials.start(paper_model(), best, bad), Status::kInvalidArgument);
}

TEST(NormalTrials, OfADeviceNearTheEndOfWhatOneMayBeAreDrawnAgain) {
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 4000.0, 0.02}, {4, 1000.0, 1.0}, Criterion::kIntegralSquareError),
            Status::kOk);
  TrialSettings settings = settings_for(Method::kBest, 1e-3);
  settings.distribution = Distribution::kNormal;
  settings.covariance[0][0] = 1e-6;
  settings.covariance[1][1] = 16.0;
  settings.covariance[2][2] = 1e-4;  // 0.02 +- 0.01: one draw in 43 is no device.
  ASSERT_EQ(start(settings, model), Status::kOk);
  for (std::uint32_t t = 0; t < 300; ++t) {
    EXPECT_GT(trials.energy(t, workspace), 0.0);
    EXPECT_GE(trials.device(t).damping, kMinDamping);
  }
  EXPECT_FALSE(trials.is_exhausted());
  // 300/43 = 7 are expected.
  EXPECT_GT(trials.redraws(), 0u);
  EXPECT_LT(trials.redraws(), 20u);
}

TEST(NormalTrials, WithoutADeviceInAllRedrawsHaveNoEnergy) {
  TrialSettings settings = normal_settings(2e-3);
  for (std::size_t i = 0; i < 3; ++i) {
    settings.covariance[2][i] = settings.covariance[i][2] = i == 2 ? 1e12 : 0.0;
  }
  ASSERT_EQ(start(normal_settings(2e-3), paper_model()), Status::kOk);
  ASSERT_EQ(trials.start(paper_model(), best, settings), Status::kOk);
  EXPECT_FALSE(trials.is_exhausted());
  trials.begin(0, workspace);
  EXPECT_TRUE(trials.done());
  EXPECT_TRUE(std::isnan(trials.energy()));
  EXPECT_TRUE(trials.is_exhausted());
}

TEST(EnergyTrials, PaperMethodRunsTheWholeFixedPointInEachTrial) {
  const TrialSettings settings = settings_for(Method::kPaper, 2e-3);
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  EXPECT_NEAR(kPaperA2 * trials.energy_of(kPaperDevice, workspace), 0.00448654991209, 0.6e-14);
  for (std::uint32_t t = 0; t < 5; ++t) {
    const Accelerometer device = trials.device(t);
    const double expected = full_search(paper_model(), device, settings);
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

TEST(EnergyTrials, GainThatFollowsMakesEnergyGoWithTheSquareOfS) {
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  settings.gain_follows = true;
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  const double at_estimate = trials.energy_of(kPaperDevice, workspace);
  const double at_double = trials.energy_of({2.074, 4073.0, 0.3182}, workspace);
  EXPECT_NEAR(at_double, 4.0 * at_estimate, 1e-13 * at_double);
  settings.gain_follows = false;
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  // Another polynomial of the same energy.
  EXPECT_NEAR(trials.energy_of(kPaperDevice, workspace), at_estimate, 1e-12 * at_estimate);
  // A filter that stays at 1.037 leaves a lasting error of 1.037 a.
  EXPECT_NE(trials.energy_of({2.074, 4073.0, 0.3182}, workspace), at_double);
}

TEST(EnergyTrials, WithAHeldSensitivityOnlyFrequencyAndDampingAreDrawn) {
  for (const Distribution distribution : {Distribution::kBox, Distribution::kNormal}) {
    TrialSettings settings = normal_settings(2e-3);  // S is correlated with the others.
    settings.distribution = distribution;
    settings.holds_sensitivity = true;
    ASSERT_EQ(start(settings, paper_model()), Status::kOk);
    EXPECT_TRUE(trials.predicts());
    const SwitchingSignal best_signal = best.signal;
    double f0_squares = 0.0;
    for (std::uint32_t t = 0; t < 1000; ++t) {
      const Accelerometer device = trials.device(t);
      ASSERT_EQ(device.sensitivity, kPaperDevice.sensitivity);
      const double from_f0 = device.natural_frequency_hz - kPaperDevice.natural_frequency_hz;
      f0_squares += from_f0 * from_f0;
      ModalModel moved = paper_model();
      ASSERT_EQ(moved.set_device(device), Status::kOk);
      SwitchingSignal signal = best_signal;
      const double expected = refine(moved, signal, workspace.refinement()).energy;
      ASSERT_NEAR(trials.energy(t, workspace), expected, 2.0 * trials.tolerance() * expected) << t;
    }
    // The variance of f0 is as without holding S; that of 1000 draws is within 4 times 4.5 %.
    const double variance = distribution == Distribution::kBox ? 36.0 / 3.0 : 36.0;
    EXPECT_NEAR(f0_squares / 1000.0, variance, 0.18 * variance);
  }
}

TEST(EnergyTrials, RefusesABoxThatLeavesWhatADeviceMayBe) {
  TrialSettings settings = settings_for(Method::kBest, 2e-3);
  ASSERT_EQ(start(settings, paper_model()), Status::kOk);
  const double before = trials.energy(3, workspace);
  const auto refuse = [&](const ParameterBox& box) {
    settings.box = box;
    return trials.start(paper_model(), best, settings);
  };
  EXPECT_EQ(refuse({1.037, 6.0, 0.0004}), Status::kInvalidArgument);
  EXPECT_EQ(refuse({0.003, 4073.0, 0.0004}), Status::kInvalidArgument);
  EXPECT_EQ(refuse({0.003, 6.0, 0.3182}), Status::kInvalidArgument);
  EXPECT_EQ(refuse({0.003, 6.0, -0.1}), Status::kInvalidArgument);
  ModalModel heavy{};
  ASSERT_EQ(heavy.set({1.0, 4000.0, 0.9}, test::kPaperFilter, Criterion::kIntegralSquareError),
            Status::kOk);
  settings.box = {0.003, 6.0, 0.2};
  EXPECT_EQ(trials.start(heavy, best, settings), Status::kOverdamped);
  EXPECT_EQ(trials.energy(3, workspace), before);
}

}  // namespace
}  // namespace emax
