// Test image: prints the report that `emax` prints on a PC, for the arguments that both take.
#include <array>
#include <cstddef>
#include <cstdint>

#include "emax/app/base/in_place.hpp"
#include "emax/app/base/text_writer.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/app/sequencer/sequencer.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/decimal.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/board/board.hpp"
#include "emax/board/semihosting.hpp"
#include "emax/hal/analog_stream.hpp"

#include "command_line.hpp"
#include "test_image.hpp"

namespace emax::board {
namespace {

constexpr int kBadInput = 2;
constexpr int kFault = 3;

/// What the arguments ask for: these settings, and the sequencer's device if it has one.
struct Job {
  explicit Job(app::Sequencer& with) noexcept : sequencer(with) {}

  app::Settings settings = app::kDefaultSettings;
  app::Sequencer& sequencer;
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
  job.sequencer.take(
      app::Device{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}});
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

bool read_job(Job& job) noexcept {
  std::array<char, kCommandLineRoom> line = {};
  Words words({line.data(), read_command_line(line)});
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

bool measures(const Job& job) noexcept { return job.sequencer.origin() != app::Origin::kModel; }

/// @returns Why there is no result, if so.
Status work(const Job& job, hal::AnalogStream& bench) noexcept {
  app::Sequencer& sequencer = job.sequencer;
  const app::Refusal refusal =
      measures(job) ? sequencer.measure_and_evaluate(bench, app::default_sweep_settings(),
                                                     job.settings, app::Goal::kReport)
                    : sequencer.evaluate(job.settings, app::Goal::kReport);
  while (sequencer.is_working()) {
    sequencer.step();
  }
  return refusal ? refusal.status : sequencer.failure().status;
}

void print(const Job& job, app::TextWriter& out) noexcept {
  const app::Measurement measurement = {job.sequencer.sweep(), ports().analog.format(),
                                        about().simulated};
  app::ReportContext context;
  context.measurement = measures(job) ? &measurement : nullptr;
  write_report(job.sequencer.evaluation(), context, out);
}

int run() noexcept {
  static app::InPlace<Job> job_memory;
  static app::Sequencer sequencer;
  Status status = start_board();
  ConsoleSink sink(ports().console);
  app::TextWriter out(sink);
  Job& job = job_memory.make(sequencer);
  if (!read_job(job)) {
    out.text(
        "expected: report [--model S,f0,beta[,uS,uf0,ubeta]] [--trials N] [--trend T,T,...]\n");
    return kBadInput;
  }
  if (status == Status::kOk) {
    status = work(job, ports().analog);
  }
  if (status != Status::kOk) {
    out.text(explain(status)).line();
    return kFault;
  }
  print(job, out);
  return 0;
}

}  // namespace
}  // namespace emax::board

extern "C" int main() { emax::board::finish(emax::board::run()); }
