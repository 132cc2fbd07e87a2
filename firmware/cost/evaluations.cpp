// Evaluations step by step, as the instrument runs them.
#include <array>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/board/instruction_counter.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/model/accelerometer.hpp"

#include "memory.hpp"
#include "rows.hpp"

namespace emax::cost {
namespace {

constexpr std::size_t kStages = static_cast<std::size_t>(app::Stage::kFailed) + 1;
constexpr std::uint32_t kTrials = 1000;
constexpr double kRelativeU = 0.003;
constexpr double kPhaseU_rad = 0.01;

struct StageCost {
  Ticks sum = 0;
  Ticks longest = 0;
};
struct StageName {
  app::Stage stage;
  const char* text;
};
using StageCosts = std::array<StageCost, kStages>;

/// Points of the device itself, at the frequencies of a default sweep.
Status fill(FrequencyResponse& points) noexcept {
  const app::SweepSettings defaults = app::default_sweep_settings();
  for (std::size_t i = 0; i < defaults.frequency_count; ++i) {
    const double frequency_hz = defaults.frequency_hz[i];
    const double k = amplitude(kDevice, frequency_hz);
    const Status status = points.add(
        {frequency_hz, k, phase_rad(kDevice, frequency_hz), kRelativeU * k, kPhaseU_rad});
    if (status != Status::kOk) {
      return status;
    }
  }
  return points.set_common(kRelativeU);
}

Status run(const app::Settings& settings, Evaluations& work, StageCosts& costs) noexcept {
  Status status = fill(work.points);
  if (status != Status::kOk) {
    return status;
  }
  app::Evaluation evaluation(work.results, work.workspace);
  StageCost& start = costs[static_cast<std::size_t>(app::Stage::kIdle)];
  start.sum = ticks_of([&] { status = evaluation.start_from_points(work.points, settings); });
  start.longest = start.sum;
  while (status == Status::kOk && !evaluation.done()) {
    StageCost& cost = costs[static_cast<std::size_t>(work.results.stage)];
    const Ticks ticks = ticks_of([&] { evaluation.step(); });
    cost.sum += ticks;
    cost.longest = ticks > cost.longest ? ticks : cost.longest;
  }
  return status == Status::kOk ? work.results.status() : status;
}

}  // namespace

Status count_steps(std::uint32_t duration_ms, Rows& rows) noexcept {
  constexpr StageName kNames[] = {
      {app::Stage::kIdle, "step_start"},        {app::Stage::kModel, "step_model"},
      {app::Stage::kFitDraws, "step_fit"},      {app::Stage::kEnergy, "step_energy"},
      {app::Stage::kBound, "step_bound"},       {app::Stage::kPrediction, "step_prediction"},
      {app::Stage::kMonteCarlo, "step_trials"}, {app::Stage::kGuard, "step_guard"},
      {app::Stage::kIdeal, "step_ideal"},       {app::Stage::kBand, "step_band"},
      {app::Stage::kMatched, "step_matched"},   {app::Stage::kUncertainty, "step_uncertainty"},
      {app::Stage::kTrend, "step_trend"},
  };
  Evaluations& work = memory().evaluations.make();
  app::Settings settings = app::kDefaultSettings;
  settings.duration_s = static_cast<double>(duration_ms) / 1000.0;
  settings.trials = kTrials;
  settings.trend_s = {0.5 * settings.duration_s, settings.duration_s};
  settings.trend_count = 2;
  StageCosts costs = {};
  const Status status = run(settings, work, costs);
  for (const StageName& name : kNames) {
    rows.add(name.text, duration_ms,
             instructions_of(costs[static_cast<std::size_t>(name.stage)].longest));
  }
  return status;
}

Status count_report(Rows& rows) noexcept {
  Evaluations& work = memory().evaluations.make();
  app::Settings settings = app::kDefaultSettings;
  settings.trials = kTrials;
  StageCosts costs = {};
  const Status status = run(settings, work, costs);
  Ticks sum = 0;
  for (const StageCost& cost : costs) {
    sum += cost.sum;
  }
  constexpr StageName kFigures[] = {{app::Stage::kIdeal, "stage_ideal"},
                                    {app::Stage::kBand, "stage_band"},
                                    {app::Stage::kMatched, "stage_matched"},
                                    {app::Stage::kUncertainty, "stage_uncertainty"}};
  for (const StageName& figure : kFigures) {
    rows.add(figure.text, instructions_of(costs[static_cast<std::size_t>(figure.stage)].sum));
  }
  const StageCost& trials = costs[static_cast<std::size_t>(app::Stage::kMonteCarlo)];
  rows.add("report", instructions_of(sum - trials.sum));
  return status;
}

}  // namespace emax::cost
