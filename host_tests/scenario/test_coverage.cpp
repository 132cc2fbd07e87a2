// Hundreds of benches, each with its own truth and noise: do the intervals of the fit, and that of
// E, contain the truth as often as they say?
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/app/measure/loopback.hpp"
#include "emax/app/measure/sweep.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/model/butterworth.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/sim/sim_bench.hpp"
#include "emax/uncertainty/energy_trials.hpp"
#include "emax/uncertainty/monte_carlo.hpp"

namespace {

using emax::Status;

constexpr std::uint64_t kBenches = 500;
// Of a binomial distribution with 500 trials of 0.95, 99.9 % lie within.
constexpr int kFewest = 458;
constexpr int kMost = 489;
/// No constant of the budget was chosen by benches of these seeds.
constexpr std::uint64_t kFirstSeed = 301;
constexpr double kCoverageFactor = 1.96;

struct Inside {
  std::array<int, 3> of = {};          // S, f0, beta.
  std::array<double, 3> squares = {};  // Of the errors over u.
};

void count(const emax::WlspFit& fit, const emax::sim::Device& truth, Inside& inside) {
  const double errors[] = {
      (fit.model.sensitivity - truth.sensitivity) / fit.u_sensitivity,
      (fit.model.natural_frequency_hz - truth.natural_frequency_hz) / fit.u_natural_frequency_hz,
      (fit.model.damping - truth.damping) / fit.u_damping};
  for (std::size_t i = 0; i < 3; ++i) {
    inside.of[i] += std::fabs(errors[i]) < kCoverageFactor;
    inside.squares[i] += errors[i] * errors[i];
  }
}

/// A sweep on a bench.
void measure(const emax::sim::BenchSettings& settings, const emax::app::SweepSettings& stated,
             emax::FrequencyResponse& response) {
  static emax::sim::SimBench bench;
  static emax::app::SweepResults results;
  static emax::app::SweepWorkspace work;
  emax::app::Sweep sweep(results, work, bench);
  EXPECT_EQ(bench.configure(settings), Status::kOk);
  EXPECT_EQ(sweep.start(stated), Status::kOk);
  while (!sweep.done()) {
    sweep.step();
  }
  EXPECT_EQ(results.status, Status::kOk)
      << emax::explain(results.status) << " seed " << settings.seed;
  EXPECT_EQ(results.copy_to(response), Status::kOk);
}

/// The same, fitted.
const emax::WlspFit& fitted(const emax::sim::BenchSettings& settings,
                            const emax::app::SweepSettings& stated) {
  static emax::FrequencyResponse response;
  static emax::Wlsp wlsp;
  measure(settings, stated, response);
  EXPECT_EQ(wlsp.fit(response), Status::kOk) << "seed " << settings.seed;
  return wlsp.result();
}

/// The interval of E as a report states it, with as few trials as there may be: their scatter of
/// 0.09 u at each end changes its coverage by less than 0.1 %. And E of any device.
class Energies {
 public:
  /// @param[in] fit Its S is the gain of the filter and the number of a, as in a default report.
  explicit Energies(const emax::WlspFit& fit)
      : filter_{10, 1000.0, fit.model.sensitivity},
        a2_(fit.model.sensitivity * fit.model.sensitivity) {}

  double of(const emax::Accelerometer& device) {
    EXPECT_EQ(model().set(device, filter_, emax::Criterion::kIntegralSquareError), Status::kOk);
    EXPECT_EQ(search().start(model(), kSearch), Status::kOk);
    while (!search().done()) {
      EXPECT_EQ(search().step(model(), workspace()), Status::kOk);
    }
    return a2_ * search().result().energy;
  }

  /// @param[in] jump Of the random numbers: each bench has its own, or one run of bad luck would
  ///   move all intervals alike.
  emax::CoverageInterval interval(const emax::WlspFit& fit, std::uint64_t jump) {
    (void)of(fit.model);
    emax::TrialSettings settings;
    settings.distribution = emax::Distribution::kNormal;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        settings.covariance[i][j] = fit.covariance[i][j];
      }
    }
    settings.search = kSearch;
    EXPECT_EQ(settings.generator.seed(emax::app::kDefaultSettings.generator,
                                      emax::app::kDefaultSettings.seed),
              Status::kOk);
    settings.generator.jump(jump);
    EXPECT_EQ(trials().start(model(), search().result(), settings), Status::kOk);
    while (!trials().ready()) {
      trials().prepare(search(), workspace());
    }
    std::vector<double> energies;
    for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
      energies.push_back(a2_ * trials().energy(trial, workspace()));
    }
    static emax::MonteCarloStore store;
    static emax::MonteCarlo monte_carlo;
    EXPECT_EQ(monte_carlo.start(kTrials, 0.95, store), Status::kOk);
    while (!monte_carlo.done()) {
      monte_carlo.add(energies[monte_carlo.next_trial()], store);
    }
    return monte_carlo.result().symmetric;
  }

  static constexpr std::uint32_t kTrials = 1000;

 private:
  static constexpr emax::SearchSettings kSearch = {emax::Method::kBest, 0.002, 0.0, 0};

  static emax::ModalModel& model() {
    static emax::ModalModel instance;
    return instance;
  }
  static emax::EnergySearch& search() {
    static emax::EnergySearch instance;
    return instance;
  }
  static emax::EnergyTrials& trials() {
    static emax::EnergyTrials instance;
    return instance;
  }
  static emax::GridWorkspace& workspace() {
    static emax::GridWorkspace instance;
    return instance;
  }

  emax::Butterworth filter_;
  double a2_;
};

/// The interval of an evaluation's own, with the same number of trials.
emax::CoverageInterval stated_interval(const emax::FrequencyResponse& response) {
  static emax::app::EvaluationResults results;
  static emax::app::EvaluationWorkspace workspace;
  emax::app::Evaluation run(results, workspace);
  emax::app::Settings settings = emax::app::kDefaultSettings;
  settings.trials = Energies::kTrials;
  EXPECT_EQ(run.start_from_points(response, settings, emax::app::Goal::kUncertainty), Status::kOk);
  while (!run.done()) {
    run.step();
  }
  EXPECT_TRUE(results.uncertainty.exists());
  return results.uncertainty.symmetric;
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
  int with_energy = 0;
  double chi2 = 0.0;
  std::uint64_t frames = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kBenches; ++seed) {
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

    Energies energies(wlsp.result());
    if (seed == kFirstSeed) {
      const emax::CoverageInterval stated = stated_interval(response);
      const emax::CoverageInterval here = energies.interval(wlsp.result(), 0);
      EXPECT_EQ(stated.low, here.low) << "these are not the intervals of a report";
      EXPECT_EQ(stated.high, here.high);
    }
    const emax::CoverageInterval interval = energies.interval(wlsp.result(), seed << 40U);
    const emax::sim::Device& device = bench.truth().device;
    const double truth =
        energies.of({device.sensitivity, device.natural_frequency_hz, device.damping});
    with_energy += interval.low <= truth && truth <= interval.high ? 1 : 0;

    ASSERT_EQ(response.set_common(0.0), Status::kOk);
    ASSERT_EQ(wlsp.fit(response), Status::kOk) << "seed " << seed;
    count(wlsp.result(), bench.truth().device, without_common);
  }
  // The budget counts limits (images, hum, drift) of which this bench has less, so more of a
  // parameter than 95 % may be inside, but no u is more than 1.4 times too large.
  constexpr double kLeastSquare = 0.5;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(with_common.of[i], kFewest);
    EXPECT_GE(with_common.squares[i] / static_cast<double>(kBenches), kLeastSquare);
    std::printf("parameter %d: errors of %.3f u\n", static_cast<int>(i),
                std::sqrt(with_common.squares[i] / static_cast<double>(kBenches)));
  }
  EXPECT_GE(with_energy, kFewest);
  EXPECT_LE(with_energy, kMost);
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
  RecordProperty("inside_E", with_energy);
  RecordProperty("inside_S_without_common", without_common.of[0]);
  std::printf(
      "inside: S %d, f0 %d, beta %d, E %d of %d; S without the common part %d; chi-square %.2f; "
      "%.0f frames per sweep\n",
      with_common.of[0], with_common.of[1], with_common.of[2], with_energy,
      static_cast<int>(kBenches), without_common.of[0], chi2 / static_cast<double>(kBenches),
      static_cast<double>(frames) / static_cast<double>(kBenches));
}

// With a gain that is a number the figures in band scatter with the S of each bench: their
// intervals are in percent of S a, of each trial's S.
TEST(Coverage, OfFiguresInBandWithAGivenGain) {
  constexpr std::uint64_t kSweeps = 40;
  // Of a binomial distribution with 40 trials of 0.95, 98.6 % are not below.
  constexpr int kFewestOfForty = 35;
  static emax::FrequencyResponse response;
  static emax::app::EvaluationResults results;
  static emax::app::EvaluationWorkspace workspace;
  emax::app::Evaluation run(results, workspace);
  emax::sim::BenchSettings bench;
  emax::app::Settings settings = emax::app::kDefaultSettings;
  settings.trials = Energies::kTrials;
  settings.trend_count = 0;
  settings.gain_mode = emax::app::GainMode::kFixed;
  settings.gain = bench.device.sensitivity;
  const auto finish = [&] {
    while (!run.done()) {
      run.step();
    }
    EXPECT_TRUE(results.band.exists() && results.matched.exists());
  };
  const emax::Accelerometer device = {bench.device.sensitivity, bench.device.natural_frequency_hz,
                                      bench.device.damping};
  ASSERT_EQ(run.start_from_model({device, {}}, settings, emax::app::Goal::kBand), Status::kOk);
  finish();
  const double truths[] = {results.percent_of(results.band.energy_v2s),
                           results.percent_of(results.matched.energy_v2s)};
  int inside[] = {0, 0};
  for (bench.seed = 1; bench.seed <= kSweeps; ++bench.seed) {
    measure(bench, emax::app::default_sweep_settings(), response);
    ASSERT_EQ(run.start_from_points(response, settings, emax::app::Goal::kReport), Status::kOk);
    finish();
    for (std::size_t i = 0; i < 2; ++i) {
      const emax::app::FigureResults& figure = i == 0 ? results.band : results.matched;
      const emax::CoverageInterval& interval = figure.uncertainty.symmetric_of_percent();
      const bool is_inside = results.percent_of(interval.low) <= truths[i] &&
                             truths[i] <= results.percent_of(interval.high);
      inside[i] += is_inside ? 1 : 0;
    }
  }
  std::printf("inside: in band %d, without its delay %d of %d\n", inside[0], inside[1],
              static_cast<int>(kSweeps));
  for (const int of_one : inside) {
    EXPECT_GE(of_one, kFewestOfForty);
  }
}

// On a quiet bench it is not noise that limits the estimates, but what no scatter shows.
TEST(Coverage, OfQuietBenches) {
  constexpr std::uint64_t kQuietBenches = 40;
  // Of a binomial distribution with 40 trials of 0.95, 99.9 % are not below.
  constexpr int kFewestQuiet = 33;
  // An interval that is twice or thrice too wide, as one is that counts something twice, has less.
  constexpr double kLeastSquare = 0.16;
  struct Case {
    double noise_v;
    double clock_ppm;
    double crosstalk_percent;
    double linearity_percent;
    double skew_s;
  };
  const Case cases[] = {{0.0, 0.0, 0.0, 0.0, 0.0},
                        {1e-4, 0.0, 0.0, 0.0, 0.0},
                        {1e-3, 0.0, 0.0, 0.0, 0.0},
                        {1e-4, 20.0, 0.0, 0.0, 0.0},
                        {1e-4, 20.0, 0.05, 0.05, 2e-8}};
  for (const Case& c : cases) {
    Inside inside;
    emax::sim::BenchSettings settings;
    settings.noise_v = c.noise_v;
    settings.clock_expanded_ppm = c.clock_ppm;
    settings.crosstalk_expanded_percent = c.crosstalk_percent;
    settings.linearity_expanded_percent = c.linearity_percent;
    settings.skew_expanded_s = c.skew_s;
    emax::app::SweepSettings stated = emax::app::default_sweep_settings();
    stated.clock_expanded_ppm = c.clock_ppm;
    stated.crosstalk_expanded_percent = c.crosstalk_percent;
    stated.linearity_expanded_percent = c.linearity_percent;
    stated.skew_expanded_s = c.skew_s;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kQuietBenches; ++seed) {
      settings.seed = seed;
      count(fitted(settings, stated), settings.device, inside);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const double square = inside.squares[i] / static_cast<double>(kQuietBenches);
      EXPECT_GE(inside.of[i], kFewestQuiet) << "noise " << c.noise_v << " V, parameter " << i;
      EXPECT_GE(square, kLeastSquare) << "noise " << c.noise_v << " V, parameter " << i;
      std::printf("noise %g V, clock %g ppm, parameter %d: inside %d of %d, errors %.2f u\n",
                  c.noise_v, c.clock_ppm, static_cast<int>(i), inside.of[i],
                  static_cast<int>(kQuietBenches), std::sqrt(square));
    }
  }
}

/// How many loopbacks state an interval that holds the truth.
struct InsideCorrections {
  int ratio = 0;
  int skew = 0;
};

/// What a wire from the drive to both inputs of this bench finds.
emax::app::LoopbackResults looped_back(const emax::sim::BenchSettings& settings,
                                       const emax::app::SweepSettings& stated,
                                       InsideCorrections& inside) {
  static emax::sim::SimBench bench;
  static emax::app::LoopbackRun run;
  run = emax::app::LoopbackRun();
  EXPECT_EQ(bench.configure(settings), Status::kOk);
  EXPECT_TRUE(bench.loop_back(true));
  EXPECT_EQ(run.start(bench, stated), Status::kOk);
  while (!run.done()) {
    run.step(bench);
  }
  EXPECT_EQ(run.status(), Status::kOk);
  EXPECT_NEAR(run.results().ratio, 1.03, 0.01);
  EXPECT_NEAR(run.results().skew_s, 3e-6, 1e-7);
  const emax::app::LoopbackResults& found = run.results();
  // The wire is in place of the conditioners: their errors are not in the ratio.
  const double ratio_u = 0.01 * found.ratio_percent * found.ratio;
  inside.ratio += std::fabs(found.ratio - settings.ratio) <= ratio_u ? 1 : 0;
  inside.skew += std::fabs(found.skew_s - bench.truth().skew_s) <= found.skew_expanded_s ? 1 : 0;
  return found;
}

// Sensors of 1e-4 to 100 V/(m/s^2) behind conditioners with gains of 1 to 1000 and a front end that
// takes what comes, whose gains are off by what is stated of them, in channels that differ by 3 %
// and 3 us, which a loopback has to find.
TEST(Coverage, OfSensorsGainsAndCorrections) {
  constexpr int kOfEach = 15;
  // Of a binomial distribution with 60 trials of 0.95, 99.9 % are not below.
  constexpr int kFewestOfSixty = 51;
  Inside inside;
  InsideCorrections corrections;
  std::uint64_t seed = kFirstSeed;
  for (const double sensitivity : {1e-4, 0.01, 1.0, 100.0}) {
    for (int i = 0; i < kOfEach; ++i) {
      emax::sim::BenchSettings settings;
      settings.seed = seed++;
      settings.device.sensitivity = sensitivity;
      // From 1 to 1000, with 0.1 to 100 V/(m/s^2) behind it; 1 to 30 for the reference.
      const double least = sensitivity < 0.1 ? 0.1 / sensitivity : 1.0;
      const double most = sensitivity > 0.1 ? 100.0 / sensitivity : 1000.0;
      settings.device_gain = least * std::pow(most / least, i / (kOfEach - 1.0));
      settings.reference_gain = std::pow(30.0, i / (kOfEach - 1.0));
      const double volts = 2.0 * sensitivity * settings.device_gain;
      settings.front_end.device_v = volts > 10.0 ? volts : 10.0;
      settings.front_end.drive_v = 5.0;
      settings.ratio = 1.03;
      settings.gain_expanded_percent = std::hypot(0.5, 1.0);
      settings.skew_s = 3e-6;
      settings.skew_expanded_s = 2e-8;
      emax::app::SweepSettings stated = emax::app::default_sweep_settings();
      stated.expected_sensitivity = 1.1 * sensitivity;
      stated.device_gain = settings.device_gain;
      stated.device_gain_expanded_percent = 1.0;
      stated.reference_gain = settings.reference_gain;
      stated.reference_gain_expanded_percent = 0.5;
      stated.device_full_scale_v = settings.front_end.device_v;
      stated.drive_full_scale_v = settings.front_end.drive_v;
      const emax::app::LoopbackResults found = looped_back(settings, stated, corrections);
      stated.ratio_correction = found.ratio;
      stated.ratio_expanded_percent = found.ratio_percent;
      stated.skew_s = found.skew_s;
      stated.skew_expanded_s = found.skew_expanded_s;
      SCOPED_TRACE(std::to_string(sensitivity) + " V/(m/s^2), gain " +
                   std::to_string(settings.device_gain));
      count(fitted(settings, stated), settings.device, inside);
    }
  }
  for (const int of_one : inside.of) {
    EXPECT_GE(of_one, kFewestOfSixty);
  }
  EXPECT_GE(corrections.ratio, kFewestOfSixty);
  EXPECT_GE(corrections.skew, kFewestOfSixty);
  std::printf("inside: S %d, f0 %d, beta %d, ratio %d, skew %d of %d\n", inside.of[0], inside.of[1],
              inside.of[2], corrections.ratio, corrections.skew, 4 * kOfEach);
}

// Of crosstalk of 0.5 % the squares, too, are beyond the noise, and the fit is right all the same.
TEST(Coverage, ChiSquareHoldsTheSquaresOfCrosstalk) {
  constexpr int kSeeds = 20;
  int doubtful = 0;
  Inside inside;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed) {
    emax::sim::BenchSettings bench;
    bench.seed = seed;
    bench.noise_v = 1e-4;
    bench.crosstalk_expanded_percent = 0.5;
    emax::app::SweepSettings stated = emax::app::default_sweep_settings();
    stated.crosstalk_expanded_percent = 0.5;
    const emax::WlspFit& fit = fitted(bench, stated);
    // One fit in a hundred exceeds it by chance.
    doubtful += fit.chi2 / fit.dof > 1.40 ? 1 : 0;
    count(fit, bench.device, inside);
  }
  std::printf("crosstalk 0.5 %%: %d of %d fits in doubt, inside: S %d, f0 %d, beta %d\n", doubtful,
              kSeeds, inside.of[0], inside.of[1], inside.of[2]);
  // One of the two draws is beyond twice its standard uncertainty in 9 of 100: more than 5 of 20
  // once in 500.
  EXPECT_LE(doubtful, 5);
  // Of a binomial distribution with 20 trials of 0.95, 99.7 % are not below.
  for (const int of_one : inside.of) {
    EXPECT_GE(of_one, 16);
  }
}

// Crosstalk and a bent gain move the points of a quiet bench by 100 times their own uncertainty, as
// its settings say: no reason to doubt the fit.
TEST(Coverage, ChiSquareHoldsWhatTheBudgetStates) {
  double sum = 0.0;
  double dof = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    emax::sim::BenchSettings bench;
    bench.seed = seed;
    bench.noise_v = 1e-3;
    bench.crosstalk_expanded_percent = 0.05;
    bench.linearity_expanded_percent = 0.05;
    emax::app::SweepSettings stated = emax::app::default_sweep_settings();
    stated.crosstalk_expanded_percent = 0.05;
    stated.linearity_expanded_percent = 0.05;
    const emax::WlspFit& fit = fitted(bench, stated);
    // One in 10 000 exceeds it (Wilson, Hilferty).
    EXPECT_LT(fit.chi2 / fit.dof, 1.65) << "seed " << seed;
    sum += fit.chi2;
    dof += fit.dof;
  }
  // Of 1620 degrees of freedom: five standard deviations, and 10 % for what is within the noise's
  // uncertainty and that of the converters' steps.
  EXPECT_LT(sum / dof, 1.0 + 5.0 * std::sqrt(2.0 / dof) + 0.1);
}

// A device that rings for 40 periods and more at its own frequency, far above most of the sweep's.
TEST(Coverage, HoldsForDevicesThatRing) {
  constexpr int kDevices = 8;
  const emax::sim::Device devices[] = {{1.1, 2110.0, 0.005}, {1.1, 1730.0, 0.002}};
  for (const emax::sim::Device& device : devices) {
    Inside inside;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kDevices; ++seed) {
      emax::sim::BenchSettings bench;
      bench.seed = seed;
      bench.noise_v = 5e-4;
      bench.device = device;
      emax::app::SweepSettings stated = emax::app::default_sweep_settings();
      stated.expected_sensitivity = device.sensitivity;
      count(fitted(bench, stated), device, inside);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const double square = inside.squares[i] / static_cast<double>(kDevices);
      std::printf("f0 %g Hz, parameter %d: errors %.2f u\n", device.natural_frequency_hz,
                  static_cast<int>(i), std::sqrt(square));
      // 0.1 % of chi-square with 8 degrees of freedom are beyond.
      EXPECT_LT(square, 3.27) << device.natural_frequency_hz << " Hz, parameter " << i;
    }
  }
}

}  // namespace
