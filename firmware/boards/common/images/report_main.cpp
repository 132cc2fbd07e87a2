// Test image: prints the report that `emax` prints on a PC, for the arguments that both take.
#include <array>
#include <cstddef>
#include <cstdint>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/measure/sweep.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/base/decimal.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/board/board.hpp"
#include "emax/board/semihosting.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frequency_response.hpp"

#include "command_line.hpp"
#include "test_image.hpp"

namespace emax::board {
namespace {

constexpr int kBadInput = 2;
constexpr int kFault = 3;

struct Job {
  app::Settings settings;
  app::Device device;
  bool measures = false;
};

/// Reads numbers with commas between them.
///
/// @returns How many; 0 if something else is there, or too many.
std::size_t read_numbers(Span<const char> text, Span<double> numbers) noexcept {
  std::size_t count = 0;
  while (count < numbers.size()) {
    const ParsedNumber number = parse_decimal(text);
    if (number.status != Status::kOk) {
      return 0;
    }
    numbers[count++] = number.value;
    text = text.from(number.length);
    if (text.empty()) {
      return count;
    }
    if (text[0] != ',') {
      return 0;
    }
    text = text.from(1);
  }
  return 0;
}

bool take_model(Span<const char> value, Job& job) noexcept {
  std::array<double, 7> numbers = {};
  const std::size_t count = read_numbers(value, numbers);
  job.device = {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
  job.measures = false;
  return count == 3 || count == 6;
}

bool take_trials(Span<const char> value, Job& job) noexcept {
  std::array<double, 1> trials = {};
  if (read_numbers(value, trials) != 1 || !(trials[0] >= 0.0 && trials[0] <= app::kMaxTrials)) {
    return false;
  }
  job.settings.trials = static_cast<std::uint32_t>(trials[0]);
  return true;
}

bool take_trend(Span<const char> value, Job& job) noexcept {
  job.settings.trend_count = read_numbers(value, job.settings.trend_s);
  return job.settings.trend_count != 0;
}

bool take_option(Span<const char> name, Span<const char> value, Job& job) noexcept {
  if (is(name, "--model")) {
    return take_model(value, job);
  }
  if (is(name, "--trials")) {
    return take_trials(value, job);
  }
  return is(name, "--trend") && take_trend(value, job);
}

bool read_job(Span<const char> command_line, Job& job) noexcept {
  Words words(command_line);
  // The emulator puts the path of the image in front.
  while (!words.done() && !is(words.next(), "report")) {
  }
  while (!words.done()) {
    const Span<const char> name = words.next();
    if (!take_option(name, words.next(), job)) {
      return false;
    }
  }
  return app::check(job.settings).setting == nullptr;
}

/// What takes memory. Of the workspaces only one is used at a time.
class Work {
 public:
  /// Runs the job on this bench.
  Status run(const Job& job, hal::AnalogStream& bench) noexcept {
    const Status status = job.measures ? measure(bench) : Status::kOk;
    return status == Status::kOk ? evaluate(job) : status;
  }

  void print(const Job& job, app::TextWriter& out) const noexcept;

 private:
  union Workspace {
    constexpr Workspace() noexcept : none{} {}

    char none;
    app::SweepWorkspace sweep;
    app::EvaluationWorkspace evaluation;
  };

  Status measure(hal::AnalogStream& bench) noexcept;
  Status evaluate(const Job& job) noexcept;

  app::Sweep sweep_;
  FrequencyResponse points_;
  app::Evaluation evaluation_;
  Workspace workspace_;
};

Status Work::measure(hal::AnalogStream& bench) noexcept {
  Status status = sweep_.start(app::default_sweep_settings(), bench, workspace_.sweep);
  if (status != Status::kOk) {
    return status;
  }
  while (!sweep_.done()) {
    sweep_.step(bench, workspace_.sweep);
  }
  status = sweep_.status();
  return status == Status::kOk ? sweep_.copy_to(points_) : status;
}

Status Work::evaluate(const Job& job) noexcept {
  app::EvaluationWorkspace& workspace = workspace_.evaluation;
  const Status status = job.measures
                            ? evaluation_.start_from_points(points_, job.settings, workspace)
                            : evaluation_.start_from_model(job.device, job.settings, workspace);
  while (status == Status::kOk && !evaluation_.done()) {
    evaluation_.step(workspace);
  }
  return evaluation_.status();
}

void Work::print(const Job& job, app::TextWriter& out) const noexcept {
  if (!job.measures) {
    write_report(evaluation_, app::ReportContext{}, out);
    return;
  }
  const app::Measurement measurement = {sweep_, ports().analog.format(), about().simulated};
  app::ReportContext context;
  context.measurement = &measurement;
  write_report(evaluation_, context, out);
}

int run() noexcept {
  static Job job;
  static Work work;
  Status status = start_board();
  ConsoleSink sink(ports().console);
  app::TextWriter out(sink);
  job = {app::kDefaultSettings, {}, true};
  std::array<char, kCommandLineRoom> line = {};
  if (!read_job({line.data(), read_command_line(line)}, job)) {
    out.text(
        "expected: report [--model S,f0,beta[,uS,uf0,ubeta]] [--trials N] [--trend T,T,...]\n");
    return kBadInput;
  }
  if (status == Status::kOk) {
    status = work.run(job, ports().analog);
  }
  if (status != Status::kOk) {
    out.text(explain(status)).line();
    return kFault;
  }
  work.print(job, out);
  return 0;
}

}  // namespace
}  // namespace emax::board

extern "C" int main() { emax::board::finish(emax::board::run()); }
