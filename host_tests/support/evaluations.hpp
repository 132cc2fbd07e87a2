// Devices, points and finished evaluations for the tests of the instrument.
#pragma once

#include <cmath>
#include <complex>
#include <random>
#include <string>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"

#include "support/paper_device.hpp"
#include "support/table1.hpp"

namespace emax::test {

/// The paper's Table 2.
inline constexpr app::Device kTable2 = {kPaperDevice, {0.003, 6.0, 0.0004}};

/// As few trials as there may be and no trend: for tests that are about something else.
inline app::Settings quick_settings() {
  app::Settings settings = emax::app::kDefaultSettings;
  settings.trials = 1000;
  settings.trend_count = 0;
  return settings;
}

/// A filter that passes ten times what the sensor does: the energy difference is below zero.
inline app::Settings settings_below_zero() {
  app::Settings settings = quick_settings();
  settings.criterion = Criterion::kEnergyDifference;
  settings.method = Method::kPaper;
  settings.gain_mode = app::GainMode::kFixed;
  settings.gain = 10.0;
  settings.duration_s = 0.01;
  settings.step_s = 0.001;
  settings.cutoff_hz = 10000.0;
  settings.filter_order = 1;
  return settings;
}

/// 40 points of the device of Table 2 by its transfer function, with normal errors of `scatter`
/// times the stated standard uncertainties (1 % and 0.5 degrees).
inline FrequencyResponse synthetic_points(double scatter, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FrequencyResponse points;
  for (int i = 1; i <= 40; ++i) {
    const double frequency_hz = 150.0 * i;
    const std::complex<double> ratio(0.0, frequency_hz / 4073.0);
    const std::complex<double> response = 1.037 / (ratio * ratio + 2.0 * 0.3182 * ratio + 1.0);
    ResponsePoint p;
    p.frequency_hz = frequency_hz;
    p.u_amplitude = 0.01 * std::abs(response);
    p.u_phase_rad = 0.5 * 3.14159265358979323846 / 180.0;
    p.amplitude = std::abs(response) + scatter * p.u_amplitude * normal(random);
    p.phase_rad = std::arg(response) + scatter * p.u_phase_rad * normal(random);
    (void)points.add(p);
  }
  return points;
}

/// One is enough for a test program. Left as it is from use to use.
inline app::EvaluationResults& shared_evaluation() {
  static app::EvaluationResults results;
  return results;
}

/// The same of its memory.
inline app::EvaluationWorkspace& shared_workspace() {
  static app::EvaluationWorkspace workspace;
  return workspace;
}

/// A run on these results in that memory.
inline app::Evaluation run_on(app::EvaluationResults& results) {
  return {results, shared_workspace()};
}

inline void finish(app::EvaluationResults& results) {
  app::Evaluation run = run_on(results);
  while (!run.done()) {
    run.step();
  }
}

/// @param[in] store Lent for the trials.
inline app::EvaluationResults& evaluated(const app::Device& device, const app::Settings& settings,
                                         Span<double> store = {}) {
  app::EvaluationResults& results = shared_evaluation();
  if (run_on(results).start_from_model(device, settings) == Status::kOk) {
    run_on(results).lend_trial_store(store);
    finish(results);
  }
  return results;
}

inline app::EvaluationResults& evaluated(const FrequencyResponse& points,
                                         const app::Settings& settings) {
  app::EvaluationResults& results = shared_evaluation();
  if (run_on(results).start_from_points(points, settings) == Status::kOk) {
    finish(results);
  }
  return results;
}

}  // namespace emax::test
