// The measurement of `emax report`.
#include "desk/report/bench_job.hpp"

#include <cstddef>
#include <string>

#include "emax/base/status.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"

namespace emax::desk {

namespace {

// Between two looks at the clock and at stop requests: less than a millisecond of work.
constexpr int kBlocksPerLook = 64;

std::string in_hz(double frequency_hz) {
  StringSink sink;
  app::TextWriter writer(sink);
  writer.general(frequency_hz, 7).text(" Hz");
  return sink.text();
}

std::string stage_of(const app::Sweep& sweep) {
  switch (sweep.stage()) {
    case app::SweepStage::kCheckBefore:
    case app::SweepStage::kCheckAfter:
      return "sweep, check at " + in_hz(sweep.settings().check_hz) + ",";
    case app::SweepStage::kPoints:
      return "sweep, " + in_hz(sweep.settings().frequency_hz[sweep.points().size()]) + ",";
    case app::SweepStage::kIdle:
    case app::SweepStage::kSilence:
    case app::SweepStage::kDone:
    case app::SweepStage::kFailed:
      break;
  }
  return "sweep,";
}

// "The channel ...; check ... ." as the end of a line.
std::string in_line(std::string sentence) {
  sentence[0] = static_cast<char>(sentence[0] - 'A' + 'a');
  sentence.pop_back();
  return sentence;
}

}  // namespace

Problem BenchJob::run(const ReportOptions& options, ConsoleProgress& progress) {
  simulated_ = {options.bench.seed,
                {options.bench.device.sensitivity, options.bench.device.natural_frequency_hz,
                 options.bench.device.damping}};
  Status status = bench_.configure(options.bench);
  if (status == Status::kOk) {
    status = sweep_.start(options.sweep, bench_, work_);
  }
  if (status != Status::kOk) {
    return fault("the bench does not start: " + in_line(explain(status)));
  }
  while (!sweep_.done()) {
    if (stop_requested()) {
      sweep_.stop(bench_, work_);
      break;
    }
    progress.show(stage_of(sweep_).c_str(), sweep_.progress());
    for (int i = 0; i < kBlocksPerLook && !sweep_.done(); ++i) {
      sweep_.step(bench_, work_);
    }
  }
  return describe_end();
}

Problem BenchJob::describe_end() const {
  const Status status = sweep_.status();
  if (status == Status::kOk) {
    return {};
  }
  const bool is_at_zero = bench_.drive_is_at_zero();
  const std::string drive = is_at_zero ? "drive at zero" : "DRIVE NOT AT ZERO";
  if (status == Status::kStopped && is_at_zero) {
    return {ExitStatus::kStopped, "stopped during the sweep, " + drive};
  }
  const std::string where = sweep_.failed_frequency_hz() > 0.0
                                ? "at " + in_hz(sweep_.failed_frequency_hz())
                                : "before the first frequency";
  return fault(std::string(app::name_of_fault(status)) + " " + where + ": " +
               in_line(explain(status)) + " (" + std::to_string(sweep_.points().size()) + " of " +
               std::to_string(sweep_.settings().frequency_count) + " points kept, " + drive + ")");
}

}  // namespace emax::desk
