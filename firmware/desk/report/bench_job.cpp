// Runs the work of `emax report`, and says how its sweep has ended.
#include "desk/report/bench_job.hpp"

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>

#include "emax/base/status.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/report/failure_words.hpp"
#include "desk/report/unstruck_faults.hpp"

namespace emax::desk {

namespace {

// Between two looks at the clock and at stop requests: less than a millisecond of work.
constexpr int kBlocksPerLook = 64;
// Of the frequencies asked for, at least, to be evaluated after a fault.
constexpr std::size_t kShareOfRest = 2;
// Of what five steps make, that a limit of acceleration must be: with what they are off by.
constexpr double kStepsOfLimit = 3.5;

std::string in_hz(double frequency_hz) {
  StringSink sink;
  app::TextWriter writer(sink);
  writer.general(frequency_hz, 7).text(" Hz");
  return sink.text();
}

std::string stage_of(const app::SweepResults& sweep) {
  switch (sweep.stage) {
    case app::SweepStage::kCheckBefore:
    case app::SweepStage::kCheckAfter:
      return "sweep, check at " + in_hz(sweep.settings.check_hz) + ",";
    case app::SweepStage::kPoints:
      return "sweep, " + in_hz(sweep.settings.frequency_hz[sweep.points().size()]) + ",";
    case app::SweepStage::kIdle:
    case app::SweepStage::kSilence:
    case app::SweepStage::kDone:
    case app::SweepStage::kFailed:
      break;
  }
  return "sweep,";
}

std::string general(double value, int digits) {
  StringSink sink;
  app::TextWriter writer(sink);
  writer.general(value, digits);
  return sink.text();
}

// Of a device that gives more volts than its channel takes.
//
// @param[in] full_scale_v Of the device's channel; 0 where it is not known, or not the reason.
std::string words_on_divider(const app::SweepSettings& settings, double full_scale_v) {
  const double volts = settings.level_mps2 * settings.expected_sensitivity * settings.device_gain;
  if (!(full_scale_v > 0.0) || !(volts > full_scale_v)) {
    return "; --device-gain and --reference-gain below 1 are attenuators";
  }
  return "; by its data sheet the device makes " + general(volts, 3) + " V of the level of " +
         general(settings.level_mps2, 3) + " m/s^2, and its channel takes " +
         general(full_scale_v, 3) + " V: put a divider before it, told by --device-gain " +
         general(0.5 * settings.device_gain * full_scale_v / volts, 1) + ", or lower --level";
}

// A harmonic of the drive that falls on the resonance, by the points before.
std::string words_on_harmonic(const app::SweepResults& sweep) {
  constexpr double kMostHarmonic = 9.0;
  constexpr double kNear = 0.05;  // Of the resonance.
  FrequencyResponse points;
  const auto fit = std::make_unique<Wlsp>();
  if (sweep.copy_to(points) != Status::kOk || fit->fit(points) != Status::kOk) {
    return "";
  }
  const double f0_hz = fit->result().model.natural_frequency_hz;
  const double harmonic = std::round(f0_hz / sweep.failed_frequency_hz);
  const double at_hz = harmonic * sweep.failed_frequency_hz;
  if (harmonic < 2.0 || harmonic > kMostHarmonic || std::abs(at_hz - f0_hz) > kNear * f0_hz) {
    return "";
  }
  return "; harmonic " + general(harmonic, 1) + " of the drive, " + in_hz(at_hz) +
         ", falls on the resonance, which is near " + general(f0_hz, 2) +
         " Hz by the points before: leave this frequency out";
}

bool is_at_check(const app::SweepResults& sweep) {
  return sweep.points().empty() && sweep.failed_frequency_hz == sweep.settings.check_hz;
}

// The first frequencies are judged by the check alone.
bool is_at_first(const app::SweepResults& sweep) {
  constexpr std::size_t kFirst = 3;
  return sweep.points().size() < kFirst && !is_at_check(sweep);
}

// A device whose signal, by its data sheet, is hardly more than the noise of its channel.
std::string words_on_buried(const app::SweepResults& sweep) {
  constexpr double kClearly = 3.0;
  const app::SweepSettings& settings = sweep.settings;
  const double volts = settings.level_mps2 * settings.expected_sensitivity * settings.device_gain;
  const double noise_v = sweep.inputs.silent_device.noise_v;
  if (!(volts > 0.0) || volts > kClearly * noise_v) {
    return "";
  }
  return "; by its data sheet the device makes " + general(volts, 2) + " V of the level of " +
         general(settings.level_mps2, 3) + " m/s^2, and its channel has a noise of " +
         general(noise_v, 2) + " V: raise --level, or amplify, told by --device-gain";
}

// Of a drive that had fewer steps than five when the sweep ended. Where the level has more, it was
// a look at a part of the level, as of one that the steps have distorted.
std::string words_on_steps(const app::SweepResults& sweep) {
  constexpr double kFew = 5.0;
  const double level = sweep.settings.level_mps2;
  const double least = sweep.least_level_mps2;
  if (!(level > least)) {
    return ", and the drive has fewer: expected at least that for --level";
  }
  return "; the level of " + general(level, 3) + " m/s^2 has about " +
         std::to_string(std::lround(kFew * level / least)) +
         ", and the last look at this frequency, at a part of it, had fewer than five: raise "
         "--level, or put an attenuator behind the drive, told by --drive-full-scale";
}

// With what an option can do about it.
//
// @param[in] full_scale_v As above.
std::string words_on(const app::SweepResults& sweep, double full_scale_v) {
  const double least_mps2 = sweep.least_level_mps2;
  char level[64] = "";
  if (least_mps2 > 0.0) {
    (void)std::snprintf(level, sizeof level, "five steps of the drive's converter make %.2g m/s^2",
                        least_mps2);
  }
  std::string words = in_line(explain(sweep.status));
  if (sweep.status == Status::kSaturated) {
    const std::string cause = least_mps2 > 0.0
                                  ? "; " + std::string(level) +
                                        ", and full scale leaves less; an attenuator "
                                        "behind the drive is told by --drive-full-scale"
                                  : "";
    return words + cause + words_on_divider(sweep.settings, least_mps2 > 0.0 ? 0.0 : full_scale_v);
  }
  if (sweep.status == Status::kFewSteps) {
    const std::string least = least_mps2 > 0.0
                                  ? "; " + std::string(level) + ": expected at least " +
                                        general(kStepsOfLimit * least_mps2, 2) +
                                        " m/s^2 for --acceleration-limit"
                                  : "";
    return words + least + "; an attenuator is told by --drive-full-scale";
  }
  const bool are_cables =
      sweep.status == Status::kSwappedChannels || sweep.status == Status::kInvertedPolarity;
  if (are_cables && is_at_check(sweep)) {
    return words +
           "; or the device's f0 is near the check frequency: give a --check-frequency "
           "far below it; or an interference is at it: another one tells";
  }
  const bool may_be_disturbed =
      are_cables || sweep.status == Status::kLevelNotReached || sweep.status == Status::kDistorted;
  if (may_be_disturbed && is_at_first(sweep)) {
    words += "; or an interference is at the check frequency of " + in_hz(sweep.settings.check_hz) +
             ", by which this is judged: another --check-frequency tells";
  }
  if (sweep.status == Status::kNoDevice) {
    return words + words_on_buried(sweep);
  }
  if (sweep.status == Status::kHum && is_at_check(sweep)) {
    return words + "; the check frequency is given by --check-frequency";
  }
  if (sweep.status == Status::kDistorted) {
    words += words_on_harmonic(sweep);
  }
  if (!(least_mps2 > 0.0)) {
    return words;
  }
  const bool is_said = sweep.status == Status::kWeakSignal;
  return (is_said ? "" : words + "; ") + level + words_on_steps(sweep);
}

}  // namespace

Problem BenchJob::start(const ReportOptions& options) {
  options_ = &options;
  simulated_ = {options.bench.seed,
                {options.bench.device.sensitivity, options.bench.device.natural_frequency_hz,
                 options.bench.device.damping}};
  Status status = bench_.configure(options.bench);
  if (status == Status::kOk) {
    status =
        sequencer_.measure_and_evaluate(bench_, options.sweep, options.settings, app::Goal::kReport)
            .status;
  }
  return status == Status::kOk ? Problem{}
                               : fault("the bench does not start: " + in_line(explain(status)));
}

Problem BenchJob::measure_with_instrument(const ReportOptions& options, ConsoleProgress& progress) {
  options_ = &options;
  InstrumentClient client;
  Problem problem = client.open(options.instrument);
  if (!problem) {
    problem = client.set_up(options);
  }
  if (!problem) {
    problem = client.measure(progress);
    if (!problem) {
      problem = client.fetch(remote_);
      has_left_sweep_ = static_cast<bool>(problem);
    }
  }
  if (problem) {
    early_points_ = client.early_points();
    return problem;
  }
  is_remote_ = true;
  simulated_ = remote_.simulated;
  sequencer_.take(remote_.results);
  if (remote_.results.status != Status::kOk) {
    problem = describe_sweep();
    return evaluate_rest() ? Problem{} : problem;
  }
  const app::Refusal refusal = sequencer_.evaluate(options.settings, app::Goal::kReport);
  const bool is_told = !refusal || refusal.obstacle == app::Obstacle::kEvaluation;
  return is_told ? Problem{} : fault("the instrument has measured no points");
}

Problem BenchJob::run(ConsoleProgress& progress) {
  Problem problem = work(progress);
  if (problem || !has_measured()) {
    return problem;
  }
  const Problem fault_of_sweep = describe_sweep();
  if (fault_of_sweep && !is_rest_ && evaluate_rest()) {
    problem = work(progress);
  }
  return problem ? problem : fault_of_sweep;
}

// After half of the points a fault leaves a fit that is worth having.
bool BenchJob::evaluate_rest() {
  const app::SweepResults& sweep = sequencer_.sweep();
  is_rest_ = sweep.status != Status::kStopped && options_ != nullptr &&
             kShareOfRest * sweep.points().size() >= sweep.settings.frequency_count &&
             !sequencer_.evaluate(options_->settings, app::Goal::kReport);
  return is_rest_;
}

Problem BenchJob::work(ConsoleProgress& progress) {
  while (sequencer_.is_working()) {
    if (stop_requested()) {
      return stop();
    }
    const bool is_sweep = sequencer_.job() == app::Job::kSweep;
    progress.show(is_sweep ? stage_of(sequencer_.sweep()).c_str() : sequencer_.stage_name(),
                  sequencer_.progress());
    sequencer_.step();
    for (int i = 1; i < kBlocksPerLook && sequencer_.job() == app::Job::kSweep; ++i) {
      sequencer_.step();
    }
  }
  return {};
}

Problem BenchJob::unstruck() const {
  if (!has_measured()) {
    return {};
  }
  const std::string words = is_remote_ ? remote_.unstruck : words_of_unstruck(bench_);
  return words.empty() ? Problem{} : Problem{ExitStatus::kDone, words};
}

Problem BenchJob::stop() {
  const bool was_sweep = sequencer_.job() == app::Job::kSweep;
  sequencer_.abort();
  if (was_sweep) {
    return describe_sweep();
  }
  return is_rest_ ? Problem{ExitStatus::kStopped, describe_sweep().line + "; stopped"} : stopped();
}

Problem BenchJob::describe_sweep() const {
  const app::SweepResults& sweep = sequencer_.sweep();
  if (sweep.status == Status::kOk) {
    return {};
  }
  // An instrument ends every sweep that way.
  const bool is_at_zero = is_remote_ || bench_.drive_is_at_zero();
  const std::string drive = is_at_zero ? "drive at zero" : "DRIVE NOT AT ZERO";
  if (sweep.status == Status::kStopped && is_at_zero) {
    return {ExitStatus::kStopped, "stopped during the sweep, " + drive};
  }
  const double full_scale_v = app::full_scales(sweep.settings, measurement().format).device_v;
  const std::string where = sweep.failed_frequency_hz > 0.0
                                ? "at " + in_hz(sweep.failed_frequency_hz)
                                : "before the first frequency";
  return fault(std::string(app::name_of_fault(sweep.status)) + " " + where + ": " +
               words_on(sweep, full_scale_v) + " (" + std::to_string(sweep.points().size()) +
               " of " + std::to_string(sweep.settings.frequency_count) + " points kept, " + drive +
               ")");
}

}  // namespace emax::desk
