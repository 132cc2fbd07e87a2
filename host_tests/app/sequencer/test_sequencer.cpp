// The sequencer by itself: what it starts, refuses, ends and keeps, without a console.
#include <algorithm>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "emax/app/report/report.hpp"
#include "emax/app/sequencer/sequencer.hpp"
#include "emax/sim/sim_bench.hpp"

#include "support/evaluations.hpp"
#include "support/quick_sweep.hpp"
#include "support/string_sink.hpp"

namespace {

using emax::Distribution;
using emax::FrequencyResponse;
using emax::Method;
using emax::Span;
using emax::Status;
using emax::app::Device;
using emax::app::Goal;
using emax::app::Identification;
using emax::app::Job;
using emax::app::Measurement;
using emax::app::Obstacle;
using emax::app::Origin;
using emax::app::Part;
using emax::app::Refusal;
using emax::app::ReportContext;
using emax::app::Sequencer;
using emax::app::Settings;
using emax::app::Source;
using emax::app::SweepStage;
using emax::app::TextWriter;
using emax::test::kTable2;
using emax::test::quick_settings;
using emax::test::quick_sweep;
using emax::test::synthetic_points;
using emax::test::text_of;

/// A bench with its sequencer.
struct Rig {
  explicit Rig(const emax::sim::BenchSettings& settings = {}) {
    EXPECT_EQ(bench.configure(settings), Status::kOk);
  }

  Sequencer& operator*() { return *sequencer; }
  Sequencer* operator->() { return sequencer.get(); }

  void finish() {
    while (sequencer->is_working()) {
      sequencer->step();
    }
  }

  /// An evaluation from begin to end.
  Obstacle evaluate(const Settings& settings, Goal goal) {
    const Refusal refusal = sequencer->evaluate(settings, goal);
    finish();
    return refusal ? refusal.obstacle : sequencer->failure().obstacle;
  }

  Obstacle measure() {
    const Refusal refusal = sequencer->measure(bench, quick_sweep());
    finish();
    return refusal ? refusal.obstacle : sequencer->failure().obstacle;
  }

  std::string report() const {
    const Measurement measurement = {sequencer->sweep(), bench.format(), nullptr};
    ReportContext context;
    context.measurement = sequencer->origin() == Origin::kSweep ? &measurement : nullptr;
    return text_of([&](TextWriter& out) { write_report(sequencer->evaluation(), context, out); });
  }

  bool drive_is_at_zero() const { return bench.dac().last == 0 && !bench.running(); }

  emax::sim::SimBench bench;
  std::unique_ptr<Sequencer> sequencer = std::make_unique<Sequencer>();
};

TEST(Sequencer, IsAllZeroBeforeUse) {
  // What a static object holds before any code has run: it takes no flash then.
  static Sequencer sequencer;
  const auto* const bytes = reinterpret_cast<const unsigned char*>(&sequencer);
  EXPECT_TRUE(std::all_of(bytes, bytes + sizeof sequencer, [](auto byte) { return byte == 0; }));
  EXPECT_FALSE(sequencer.is_working());
  EXPECT_EQ(sequencer.origin(), Origin::kNothing);
  EXPECT_FALSE(sequencer.failure());
}

TEST(Sequencer, MeasuresThenEvaluates) {
  Rig rig;
  ASSERT_FALSE(
      rig->measure_and_evaluate(rig.bench, quick_sweep(), quick_settings(), Goal::kReport));
  std::vector<Job> jobs;
  while (rig->is_working()) {
    if (jobs.empty() || jobs.back() != rig->job()) {
      jobs.push_back(rig->job());
    }
    EXPECT_GE(rig->progress(), 0.0);
    EXPECT_LE(rig->progress(), 1.0);
    rig->step();
  }
  EXPECT_EQ(jobs, (std::vector<Job>{Job::kSweep, Job::kEvaluation}));
  EXPECT_EQ(rig->progress(), 1.0);
  EXPECT_FALSE(rig->failure());
  EXPECT_EQ(rig->origin(), Origin::kSweep);
  EXPECT_EQ(rig->points().size(), 5U);
  EXPECT_TRUE(rig->holds(Goal::kReport, quick_settings()));
  EXPECT_TRUE(rig.drive_is_at_zero());
  // The bench's own device, within four of the fit's standard uncertainties.
  const Device& device = rig->evaluation().device;
  EXPECT_NEAR(device.estimate.sensitivity, 1.037, 4.0 * device.u.sensitivity);
  EXPECT_NEAR(device.estimate.natural_frequency_hz, 4073.0, 4.0 * device.u.natural_frequency_hz);
  EXPECT_NEAR(device.estimate.damping, 0.3182, 4.0 * device.u.damping);
}

// The sweep and the evaluation by hand, without a sequencer.
TEST(Sequencer, GivesTheWordsOfItsPartsByHand) {
  Rig by_hand;
  static emax::app::SweepResults sweep;
  static emax::app::SweepWorkspace sweep_memory;
  emax::app::Sweep measuring(sweep, sweep_memory, by_hand.bench);
  ASSERT_EQ(measuring.start(quick_sweep()), Status::kOk);
  while (!measuring.done()) {
    measuring.step();
  }
  FrequencyResponse points;
  ASSERT_EQ(sweep.copy_to(points), Status::kOk);
  const auto& results = emax::test::evaluated(points, quick_settings());
  const Measurement measurement = {sweep, by_hand.bench.format(), nullptr};
  ReportContext context;
  context.measurement = &measurement;
  const std::string expected =
      text_of([&](TextWriter& out) { write_report(results, context, out); });

  Rig rig;
  ASSERT_FALSE(
      rig->measure_and_evaluate(rig.bench, quick_sweep(), quick_settings(), Goal::kReport));
  rig.finish();
  EXPECT_EQ(rig.report(), expected);
  // One after the other is the same, too, and so are trials whose values are kept.
  Rig apart;
  std::vector<double> store(500);
  apart->lend_trial_store(Span<double>(store.data(), store.size()));
  EXPECT_EQ(apart.measure(), Obstacle::kNone);
  for (const Goal goal : {Goal::kMonteCarlo, Goal::kModel, Goal::kReport}) {
    EXPECT_EQ(apart.evaluate(quick_settings(), goal), Obstacle::kNone);
  }
  EXPECT_EQ(apart.report(), expected);
  EXPECT_NE(store[499], 0.0) << "the memory was used";
}

TEST(Sequencer, EvaluatesADeviceOrPoints) {
  Rig rig;
  rig->take(kTable2);
  EXPECT_EQ(rig->origin(), Origin::kModel);
  EXPECT_EQ(rig.evaluate(quick_settings(), Goal::kEnergy), Obstacle::kNone);
  EXPECT_NEAR(rig->evaluation().energy_v2s(), 0.005115251359876, 1e-15);  // Closed form.
  rig->take(synthetic_points(0.0));
  EXPECT_EQ(rig->origin(), Origin::kTable);
  EXPECT_EQ(rig->points_origin(), Origin::kTable);
  EXPECT_FALSE(rig->holds(Goal::kModel, quick_settings()));
  EXPECT_EQ(rig.evaluate(quick_settings(), Goal::kEnergy), Obstacle::kNone);
  // Points without noise: the same device but for rounding of the fit.
  EXPECT_NEAR(rig->evaluation().energy_v2s(), 0.005115251359876, 1e-11);
  EXPECT_EQ(rig->evaluation().source, Source::kPoints);
}

TEST(Sequencer, HoldsWhatIsOfTheDeviceAndSettingsOfNow) {
  Rig rig;
  const Settings settings = quick_settings();
  rig->take(kTable2);
  EXPECT_FALSE(rig->holds(Goal::kModel, settings));
  ASSERT_EQ(rig.evaluate(settings, Goal::kEnergy), Obstacle::kNone);
  EXPECT_TRUE(rig->holds(Goal::kEnergy, settings));
  EXPECT_FALSE(rig->holds(Goal::kMonteCarlo, settings));
  Settings other = settings;
  other.duration_s = 0.003;
  EXPECT_FALSE(rig->holds(Goal::kEnergy, other));
  // Another device, and this one again.
  rig->take(Device{{1.0, 4000.0, 0.3}, {}});
  EXPECT_FALSE(rig->holds(Goal::kEnergy, settings));
  rig->take(kTable2);
  EXPECT_TRUE(rig->holds(Goal::kEnergy, settings));
  // Points take over; without them there is no device.
  rig->take(synthetic_points(1.0));
  EXPECT_FALSE(rig->holds(Goal::kEnergy, settings));
  EXPECT_TRUE(rig->clear_points());
  EXPECT_EQ(rig->origin(), Origin::kNothing);
  EXPECT_FALSE(rig->holds(Goal::kEnergy, settings));
  rig->take(kTable2);
  EXPECT_TRUE(rig->holds(Goal::kEnergy, settings));
  rig->reset();
  EXPECT_FALSE(rig->holds(Goal::kModel, settings));
  rig->take(kTable2);
  EXPECT_FALSE(rig->holds(Goal::kModel, settings)) << "a reset forgets the results";
}

TEST(Sequencer, ComputesOnlyWhatIsMissing) {
  Rig rig;
  Settings settings = quick_settings();
  rig->take(kTable2);
  ASSERT_EQ(rig.evaluate(settings, Goal::kMonteCarlo), Obstacle::kNone);
  EXPECT_FALSE(rig->evaluate(settings, Goal::kEnergy));
  EXPECT_FALSE(rig->is_working()) << "all there";
  settings.trials = 2000;
  EXPECT_FALSE(rig->evaluate(settings, Goal::kMonteCarlo));
  EXPECT_STREQ(rig->stage_name(), "prediction") << "the energy is kept";
  rig.finish();
  EXPECT_EQ(rig->evaluation().trials.result.trials, 2000U);
  settings.cutoff_hz = 900.0;
  EXPECT_FALSE(rig->evaluate(settings, Goal::kMonteCarlo));
  EXPECT_STREQ(rig->stage_name(), "response") << "nothing is kept";
  rig->abort();
}

TEST(Sequencer, KeepsPointsBesideADevice) {
  Rig rig;
  const FrequencyResponse points = synthetic_points(1.0);
  EXPECT_FALSE(rig->take_points()) << "there are none";
  rig->take(points);
  EXPECT_FALSE(rig->take_points()) << "they are what is evaluated";
  rig->take(kTable2);
  EXPECT_EQ(rig->points().size(), points.size());
  EXPECT_TRUE(rig->take_points());
  EXPECT_EQ(rig->origin(), Origin::kTable);
  rig->take(kTable2);
  EXPECT_FALSE(rig->clear_points()) << "the device is another one";
  EXPECT_EQ(rig->origin(), Origin::kModel);
  EXPECT_EQ(rig->points_origin(), Origin::kNothing);
}

TEST(Sequencer, EvaluatesAFitOfBeforeAsFarAsItIsKept) {
  Rig rig;
  Identification fit;
  fit.source = Source::kPoints;
  fit.device = kTable2;
  fit.chi2 = 120.0;
  fit.dof = 81;
  rig->take(fit);
  ASSERT_NE(rig->kept_identification(), nullptr);
  EXPECT_EQ(rig->kept_identification()->dof, 81U);
  Settings settings = quick_settings();
  EXPECT_EQ(rig.evaluate(settings, Goal::kMonteCarlo), Obstacle::kNone);
  settings.distribution = Distribution::kNormal;  // Takes the covariance, which is kept.
  EXPECT_EQ(rig.evaluate(settings, Goal::kMonteCarlo), Obstacle::kNone);
  EXPECT_EQ(rig.evaluate(settings, Goal::kUncertainty), Obstacle::kNone);
  EXPECT_EQ(rig.evaluate(settings, Goal::kTrend), Obstacle::kNoTimes);
  settings = quick_settings();
  settings.birge = true;  // Takes chi2 of the points.
  EXPECT_EQ(rig.evaluate(settings, Goal::kMonteCarlo), Obstacle::kNoFit);
  EXPECT_EQ(rig.evaluate(settings, Goal::kReport), Obstacle::kNoFit);
  fit.chi2 = 80.0;  // A fit so good has no ratio above 1.
  rig->take(fit);
  EXPECT_EQ(rig.evaluate(settings, Goal::kMonteCarlo), Obstacle::kNone);
  rig->take(kTable2);
  EXPECT_EQ(rig->kept_identification(), nullptr);
}

TEST(Sequencer, SaysWhatIsMissing) {
  Rig rig;
  Settings settings = quick_settings();
  EXPECT_EQ(rig.evaluate(settings, Goal::kModel), Obstacle::kNoDevice);
  EXPECT_EQ(rig->iterate_fixed_point(settings).obstacle, Obstacle::kNoDevice);
  rig->take(FrequencyResponse());
  EXPECT_EQ(rig.evaluate(settings, Goal::kModel), Obstacle::kNoPoints);
  rig->take(Device{kTable2.estimate, {}});
  EXPECT_EQ(rig.evaluate(settings, Goal::kMonteCarlo), Obstacle::kNoUncertainty);
  EXPECT_EQ(rig.evaluate(settings, Goal::kTrend), Obstacle::kNoTimes);
  EXPECT_EQ(rig.evaluate(settings, Goal::kReport), Obstacle::kNone);
  settings.duration_s = 2.0;
  const Refusal refusal = rig->evaluate(settings, Goal::kEnergy);
  EXPECT_EQ(refusal.obstacle, Obstacle::kEvaluation);
  EXPECT_EQ(refusal.status, Status::kTooManyCells);
  EXPECT_EQ(rig->evaluation().failure.duration_s, 2.0);
  EXPECT_FALSE(rig->is_working());
}

TEST(Sequencer, SaysWhyNothingIsMeasured) {
  Rig rig;
  rig->take(kTable2);
  auto settings = quick_sweep();
  settings.level_mps2 = 50.0;
  Refusal refusal = rig->measure(rig.bench, settings);
  EXPECT_EQ(refusal.obstacle, Obstacle::kSweepSetting);
  EXPECT_EQ(refusal.status, Status::kInvalidArgument);
  EXPECT_NE(rig->sweep().refused.setting, nullptr);
  emax::sim::SimBench dead;  // Not configured.
  refusal = rig->measure_and_evaluate(dead, quick_sweep(), quick_settings(), Goal::kReport);
  EXPECT_EQ(refusal.obstacle, Obstacle::kSweep);
  EXPECT_EQ(refusal.status, Status::kHardwareFault);
  EXPECT_FALSE(rig->is_working());
  EXPECT_EQ(rig->origin(), Origin::kModel) << "nothing has changed";
}

TEST(Sequencer, AFaultEndsItWithTheDriveAtZero) {
  emax::sim::BenchSettings faulty;
  faulty.fault = {emax::sim::FaultKind::kUnpluggedDevice, 60'000};
  Rig rig(faulty);
  ASSERT_FALSE(
      rig->measure_and_evaluate(rig.bench, quick_sweep(), quick_settings(), Goal::kReport));
  rig.finish();
  EXPECT_EQ(rig->failure().obstacle, Obstacle::kSweep);
  EXPECT_EQ(rig->failure().status, Status::kNoDevice);
  EXPECT_TRUE(rig.drive_is_at_zero());
  EXPECT_EQ(rig->sweep().stage, SweepStage::kFailed);
  EXPECT_GE(rig->sweep().points().size(), 1U) << "what was measured before stays";
  EXPECT_EQ(rig->points_origin(), Origin::kSweep);
  EXPECT_EQ(rig->points().size(), rig->sweep().points().size()) << "and may be fitted";
  EXPECT_EQ(rig.evaluate(quick_settings(), Goal::kModel), Obstacle::kNone);
}

TEST(Sequencer, PointsThatGiveNoDeviceEndItAfterTheSweep) {
  Rig rig;
  Settings settings = quick_settings();
  settings.duration_s = 2.0;  // Too many cells for any device with this resonance.
  ASSERT_FALSE(rig->measure_and_evaluate(rig.bench, quick_sweep(), settings, Goal::kReport));
  rig.finish();
  EXPECT_EQ(rig->failure().obstacle, Obstacle::kEvaluation);
  EXPECT_EQ(rig->failure().status, Status::kTooManyCells);
  EXPECT_EQ(rig->sweep().status, Status::kOk);
  EXPECT_EQ(rig->points().size(), 5U);
}

/// Each kind of work, begun.
void begin(Rig& rig, Job job) {
  rig->take(kTable2);
  if (job == Job::kSweep) {
    ASSERT_FALSE(rig->measure(rig.bench, quick_sweep()));
  } else if (job == Job::kEvaluation) {
    ASSERT_FALSE(rig->evaluate(quick_settings(), Goal::kReport));
  } else {
    ASSERT_EQ(rig.evaluate(quick_settings(), Goal::kModel), Obstacle::kNone);
    ASSERT_FALSE(rig->iterate_fixed_point(quick_settings()));
  }
  ASSERT_EQ(rig->job(), job);
}

constexpr Job kJobs[] = {Job::kSweep, Job::kEvaluation, Job::kFixedPoint};

TEST(Sequencer, DoesOneThingAtATime) {
  for (const Job job : kJobs) {
    Rig rig;
    begin(rig, job);
    rig->step();
    const bool sweeps = job == Job::kSweep;
    const Obstacle runs = sweeps ? Obstacle::kSweepRuns : Obstacle::kComputes;
    EXPECT_EQ(rig->obstacle_to(Part::kDevice), runs);
    EXPECT_EQ(rig->obstacle_to(Part::kSweepSettings), sweeps ? runs : Obstacle::kNone);
    EXPECT_EQ(rig->obstacle_to(Part::kSettings), sweeps ? Obstacle::kNone : runs);
    EXPECT_EQ(rig->measure(rig.bench, quick_sweep()).obstacle, runs);
    EXPECT_EQ(rig->evaluate(quick_settings(), Goal::kModel).obstacle, runs);
    EXPECT_EQ(rig->iterate_fixed_point(quick_settings()).obstacle, runs);
    EXPECT_EQ(rig->job(), job);
    rig.finish();
    EXPECT_FALSE(rig->failure());
    for (const Part part : {Part::kDevice, Part::kSettings, Part::kSweepSettings}) {
      EXPECT_EQ(rig->obstacle_to(part), Obstacle::kNone);
    }
    EXPECT_STREQ(rig->stage_name(), "idle");
  }
}

TEST(Sequencer, EndsAtOnceOnAbort) {
  for (const Job job : kJobs) {
    Rig rig;
    begin(rig, job);
    for (int i = 0; i < 3; ++i) {
      rig->step();
    }
    rig->abort();
    EXPECT_FALSE(rig->is_working());
    EXPECT_TRUE(rig.drive_is_at_zero());
    EXPECT_TRUE(rig->sweep().done());
    EXPECT_TRUE(job == Job::kSweep || rig->evaluation().done()) << "no half-made part is left";
    rig->step();
    EXPECT_EQ(rig->progress(), 1.0);
    EXPECT_EQ(rig->fixed_point(), nullptr);
    begin(rig, job);  // And it can begin again.
    rig.finish();
    EXPECT_FALSE(rig->failure());
  }
}

TEST(Sequencer, GoesOnAfterAnAbortWithTheSameDigits) {
  Rig whole;
  whole->take(kTable2);
  ASSERT_EQ(whole.evaluate(quick_settings(), Goal::kReport), Obstacle::kNone);
  Rig rig;
  rig->take(kTable2);
  for (int steps = 1; !rig->holds(Goal::kReport, quick_settings()); steps *= 2) {
    ASSERT_FALSE(rig->evaluate(quick_settings(), Goal::kReport));
    for (int i = 0; i < steps; ++i) {
      rig->step();
    }
    rig->abort();
    rig->borrow<emax::app::SweepWorkspace>() = {};  // Somebody else works there meanwhile.
  }
  EXPECT_EQ(rig.report(), whole.report());
}

TEST(Sequencer, AbortOfTheSweepBeginsNoEvaluation) {
  Rig rig;
  ASSERT_FALSE(
      rig->measure_and_evaluate(rig.bench, quick_sweep(), quick_settings(), Goal::kReport));
  rig->step();
  rig->abort();
  EXPECT_EQ(rig->sweep().status, Status::kStopped);
  // The next sweep is one for its own sake.
  EXPECT_EQ(rig.measure(), Obstacle::kNone);
  EXPECT_FALSE(rig->holds(Goal::kModel, quick_settings()));
  EXPECT_EQ(rig.evaluate(quick_settings(), Goal::kModel), Obstacle::kNone);
}

// The paper's own run, with the energies that DESIGN lists: six iterations on 1000 cells.
TEST(Sequencer, IteratesTheFixedPoint) {
  Rig rig;
  Settings settings = quick_settings();
  rig->take(kTable2);
  ASSERT_EQ(rig.evaluate(settings, Goal::kModel), Obstacle::kNone);
  ASSERT_FALSE(rig->iterate_fixed_point(settings));
  EXPECT_STREQ(rig->stage_name(), "fixed point");
  EXPECT_EQ(rig->fixed_point(), nullptr) << "not yet";
  rig.finish();
  const emax::app::FixedPointRun* const run = rig->fixed_point();
  ASSERT_NE(run, nullptr);
  ASSERT_EQ(run->iterations(), 6U);
  EXPECT_NEAR(run->energy_v2s(0), 0.00381585783775, 1e-14);
  EXPECT_NEAR(run->energy_v2s(6), 0.00448654991209, 1e-14);
  // The search by the paper's method goes the same way.
  Rig paper;
  Settings by_paper = settings;
  by_paper.method = Method::kPaper;
  paper->take(kTable2);
  ASSERT_EQ(paper.evaluate(by_paper, Goal::kEnergy), Obstacle::kNone);
  ASSERT_EQ(paper->evaluation().trace().size(), 7U);
  for (std::size_t i = 0; i <= 6; ++i) {
    EXPECT_EQ(run->energy_v2s(i), paper->evaluation().trace()[i]);
  }
  (void)rig->borrow<int>();
  EXPECT_EQ(rig->fixed_point(), nullptr) << "its memory may be written to";
  settings.iterations = 2;
  ASSERT_FALSE(rig->iterate_fixed_point(settings));
  rig.finish();
  ASSERT_NE(rig->fixed_point(), nullptr);
  EXPECT_EQ(rig->fixed_point()->iterations(), 2U);
  rig->forget_fixed_point();
  EXPECT_EQ(rig->fixed_point(), nullptr);
}

TEST(Sequencer, RefusesAFixedPointWithoutAGrid) {
  Rig rig;
  Settings settings = quick_settings();
  rig->take(kTable2);
  ASSERT_EQ(rig.evaluate(settings, Goal::kModel), Obstacle::kNone);
  settings.step_s = 0.003;  // Longer than T.
  EXPECT_EQ(rig->iterate_fixed_point(settings).obstacle, Obstacle::kGrid);
  settings.step_s = 2e-8;  // 100000 cells.
  EXPECT_EQ(rig->iterate_fixed_point(settings).obstacle, Obstacle::kGrid);
  EXPECT_FALSE(rig->is_working());
}

}  // namespace
