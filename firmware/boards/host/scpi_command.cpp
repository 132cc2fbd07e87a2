// `emax scpi`: the loop around the instrument.
#include "scpi_command.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

#include "emax/app/base/in_place.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/sim/sim_bench.hpp"

#include "console_port.hpp"
#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/report/unstruck_faults.hpp"
#include "desk/scpi/command_list.hpp"
#include "desk/scpi/scpi_options.hpp"
#include "file_store.hpp"
#include "stdio_stream.hpp"
#include "system_clock.hpp"
#include "tcp_stream.hpp"

namespace emax::host {

namespace {

using Microseconds = std::chrono::microseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr std::size_t kStoredTrials = 1'000'000;
// A stop request ends every sleep; this is for one that comes just before it.
constexpr Microseconds kLongestSleep{100'000};

app::MemoryUse memory_use() noexcept { return {sizeof(app::Instrument), 0, 0}; }

// Holds the time of the bench, which moves block by block, to that of the clock on the wall.
class Pacer final {
 public:
  // pace: seconds of the bench per second; 0 for as fast as it goes.
  Pacer(double pace, const sim::SimBench& bench) noexcept : pace_(pace), bench_(bench) {}

  // The time until the next block is due; 0 if it is.
  Microseconds until_due(bool is_sweeping) noexcept {
    if (pace_ == 0.0 || !is_sweeping) {
      runs_ = false;
      return Microseconds{0};
    }
    if (!runs_) {
      runs_ = true;
      start_ = SteadyClock::now();
      start_frames_ = bench_.clock_frames();
    }
    const auto frames = static_cast<double>(bench_.clock_frames() - start_frames_);
    const std::chrono::duration<double> bench_time(frames / bench_.format().sample_rate_hz);
    const auto left = bench_time / pace_ - (SteadyClock::now() - start_);
    return std::max(std::chrono::duration_cast<Microseconds>(left), Microseconds{0});
  }

 private:
  double pace_;
  const sim::SimBench& bench_;
  SteadyClock::time_point start_;
  std::uint64_t start_frames_ = 0;
  bool runs_ = false;
};

// The instrument on its simulated bench.
class ScpiJob final {
 public:
  ScpiJob(const desk::ScpiOptions& options, ConsolePort& port)
      : port_(port),
        pacer_(options.pace, bench_),
        sweep_(options.report.sweep),
        simulated_{options.report.bench.seed,
                   {options.report.bench.device.sensitivity,
                    options.report.bench.device.natural_frequency_hz,
                    options.report.bench.device.damping}},
        trials_(new (std::nothrow) double[kStoredTrials]),
        pieces_(new (std::nothrow) TrialPiece[EnergyTrials::kManyPieces]),
        store_(options.store_path.empty() ? static_cast<StoreBytes&>(volatile_bytes_)
                                          : static_cast<StoreBytes&>(file_bytes_)) {}
  ScpiJob(const ScpiJob&) = delete;
  ScpiJob& operator=(const ScpiJob&) = delete;

  desk::Problem run(const desk::ScpiOptions& options) {
    if (bench_.configure(options.report.bench) != Status::kOk) {
      return desk::fault("the simulated bench refuses its settings");
    }
    if (!options.store_path.empty()) {
      if (desk::Problem problem = file_bytes_.open(options.store_path)) {
        return problem;
      }
      if (file_bytes_.had_damaged_title()) {
        std::fputs("emax: --store: the first page of the file was damaged, and is mended\n",
                   stderr);
      }
    }
    static app::InPlace<app::Instrument> memory;
    const app::Ports ports = {bench_, port_, clock_, nullptr, &store_};
    const app::Board board = {"host", "0", &sweep_, &simulated_, memory_use};
    app::Instrument& instrument = memory.make(ports, board);
    if (trials_ != nullptr) {
      instrument.lend_trial_store(Span<double>(trials_.get(), kStoredTrials));
    }
    if (pieces_ != nullptr) {
      instrument.lend_trial_pieces(TrialPieces({pieces_.get(), EnergyTrials::kManyPieces}));
    }
    instrument.start();
    while (!desk::stop_requested()) {
      const Microseconds until_due = pacer_.until_due(instrument.is_sweeping());
      if (until_due > Microseconds{0}) {
        instrument.converse();  // The bench has time, the peer has not.
      } else {
        instrument.poll();
      }
      tell_unstruck(instrument.is_sweeping());
      if (!goes_on(instrument)) {
        instrument.abort();
        return {};
      }
      rest(instrument);
    }
    return stop(instrument);
  }

 private:
  // A session has come to its end once everything that came in is answered.
  bool goes_on(const app::Instrument& instrument) {
    const bool is_done = port_.input_ended() && instrument.is_settled();
    if (is_done || (instrument.is_held() && port_.is_left())) {
      return port_.end_session();
    }
    return port_.connected() || port_.serves_others();
  }

  void rest(const app::Instrument& instrument) {
    const ConsolePort::Wishes wishes = {instrument.takes_input(), instrument.wants_to_write()};
    const Microseconds until_due = pacer_.until_due(instrument.is_sweeping());
    const bool is_paced = until_due > Microseconds{0};
    const bool is_resting = !instrument.is_conversing() && (is_paced || !instrument.is_working());
    const Microseconds longest = is_paced ? std::min(until_due, kLongestSleep) : kLongestSleep;
    port_.wait(is_resting ? longest : Microseconds{0}, wishes);
  }

  // Once, at the end of the first sweep, and to who asks FETCh:JSON? after any: other answers have
  // no place for it.
  void tell_unstruck(bool is_sweeping) {
    if (was_sweeping_ && !is_sweeping) {
      unstruck_ = desk::words_of_unstruck(bench_);
      simulated_.unstruck = unstruck_.empty() ? nullptr : unstruck_.c_str();
      if (!unstruck_.empty() && !is_told_) {
        std::fprintf(stderr, "emax: %s\n", unstruck_.c_str());
      }
      is_told_ = true;
    }
    was_sweeping_ = is_sweeping;
  }

  desk::Problem stop(app::Instrument& instrument) {
    const bool was_sweeping = instrument.is_sweeping();
    instrument.abort();
    const bool is_at_zero = bench_.drive_is_at_zero();
    const std::string drive = is_at_zero ? "drive at zero" : "DRIVE NOT AT ZERO";
    return {desk::ExitStatus::kStopped,
            "stopped" + std::string(was_sweeping ? " during the sweep" : "") + ", " + drive};
  }

  sim::SimBench bench_;
  SystemClock clock_;
  ConsolePort& port_;
  Pacer pacer_;
  app::SweepSettings sweep_;
  app::SimulatedBench simulated_;
  std::string unstruck_;
  std::unique_ptr<double[]> trials_;
  std::unique_ptr<TrialPiece[]> pieces_;
  VolatileBytes volatile_bytes_;
  FileBytes file_bytes_;
  FileStore store_;
  bool was_sweeping_ = false;
  bool is_told_ = false;
};

desk::Problem run_on_tcp(const desk::ScpiOptions& options) {
  TcpStream port;
  if (desk::Problem problem = port.listen(options.address, options.port)) {
    return problem;
  }
  std::fprintf(stderr, "emax: listening on %s:%u\n", options.address.c_str(),
               unsigned{port.port()});
  return ScpiJob(options, port).run(options);
}

desk::Problem run_on_stdio(const desk::ScpiOptions& options) {
  StdioStream port;
  desk::Problem problem = ScpiJob(options, port).run(options);
  if (!problem && port.error() != 0) {
    // A reader that went away is no matter for words.
    return desk::fault(port.error() == EPIPE
                           ? ""
                           : std::string("standard output: ") + std::strerror(port.error()));
  }
  return problem;
}

}  // namespace

desk::Problem run_scpi(Span<const std::string_view> arguments) {
  desk::ScpiOptions options;
  if (desk::Problem problem = desk::parse_scpi_options(arguments, options)) {
    return problem;
  }
  if (options.prints_commands) {
    desk::FileSink sink(stdout);
    app::TextWriter out(sink);
    desk::write_command_list(out);
    return desk::check_output(sink);
  }
  return options.listens ? run_on_tcp(options) : run_on_stdio(options);
}

std::string help_on_scpi() {
  return R"(usage: emax scpi [options]
       emax scpi --tcp [ADDRESS:]PORT [options]
       emax scpi --commands

The instrument's console: SCPI commands, one message a line, executed in order;
answers on standard output. No echo, no prompt. At the end of the input it
finishes the queries that it was sent, then ends.
)" + desk::help_on_scpi_options();
}

}  // namespace emax::host
