// An instrument on the simulated bench, with everything else in memory.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "emax/app/base/in_place.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"
#include "emax/sim/sim_bench.hpp"

#include "support/manual_clock.hpp"
#include "support/manual_watchdog.hpp"
#include "support/memory_byte_stream.hpp"
#include "support/memory_store.hpp"
#include "support/quick_sweep.hpp"

namespace emax::test {

/// A new instrument, switched on, with a peer connected. One at a time.
class InstrumentBench {
 public:
  /// A poll takes this long on the instrument's clock.
  static constexpr std::uint64_t kPoll_us = 100;
  /// Room for all settings that there can be.
  static constexpr std::uint32_t kSlotBytes =
      (app::kMaxSavedSettingsBytes + app::RecordStore::kFrameBytes + 7) / 8 * 8;
  /// Far more polls than any job of a test takes.
  static constexpr int kMostPolls = 3'000'000;

  explicit InstrumentBench(const sim::BenchSettings& settings = {}, std::size_t room = 1U << 22U)
      : console(room), store({2 * app::kSavedRecords, kSlotBytes, 8}) {
    (void)bench.configure(settings);
    simulated = {settings.seed,
                 {settings.device.sensitivity, settings.device.natural_frequency_hz,
                  settings.device.damping}};
    switch_on();
  }

  /// Power off and on; the store keeps what it holds.
  void switch_on() {
    static app::InPlace<app::Instrument> memory;
    const app::Ports ports = {bench, console, clock,
                              other_watchdog != nullptr ? other_watchdog : &watchdog, &store};
    const app::Board board = {"test", "4711", &sweep, &simulated, nullptr};
    instrument = &memory.make(ports, board);
    instrument->start();
  }

  void poll(int count = 1) {
    for (int i = 0; i < count; ++i) {
      clock.wait_us(kPoll_us);
      watchdog.wait_us(kPoll_us);
      instrument->poll();
    }
  }

  /// Until everything that was sent is executed and answered.
  bool settle() {
    for (int i = 0; i < kMostPolls; ++i) {
      poll();
      if (instrument->is_settled() && !instrument->is_busy()) {
        return true;
      }
      if (instrument->is_settled() && instrument->is_working()) {
        return true;
      }
    }
    return false;
  }

  /// Until nothing runs.
  bool finish() {
    for (int i = 0; i < kMostPolls; ++i) {
      if (!instrument->is_working() && instrument->is_settled()) {
        return true;
      }
      poll();
    }
    return false;
  }

  void send(const std::string& text) { console.send(text + "\n"); }

  /// Sends one message and takes its answer, without the line feed.
  std::string ask(const std::string& text) {
    send(text);
    if (!settle()) {
      return "no end";
    }
    std::string answer = console.receive();
    if (!answer.empty() && answer.back() == '\n') {
      answer.pop_back();
    }
    return answer;
  }

  /// The same as numbers.
  std::vector<double> numbers(const std::string& text) {
    std::vector<double> values;
    std::stringstream fields(ask(text));
    std::string field;
    while (std::getline(fields, field, ',')) {
      values.push_back(std::strtod(field.c_str(), nullptr));
    }
    return values;
  }

  /// All errors that wait, each with a line feed.
  std::string errors() {
    std::string all;
    for (;;) {
      const std::string error = ask("SYST:ERR?");
      if (error == "0,\"No error\"" || error.empty() || error == "no end") {
        return all;
      }
      all += error + "\n";
    }
  }

  bool drive_is_at_zero() const { return bench.drive_is_at_zero(); }

  sim::SimBench bench;
  MemoryByteStream console;
  ManualClock clock;
  ManualWatchdog watchdog{100'000};
  hal::Watchdog* other_watchdog = nullptr;  // Instead of it, from the next `switch_on()`.
  MemoryStore store;
  app::SweepSettings sweep = quick_sweep();
  app::SimulatedBench simulated;
  app::Instrument* instrument = nullptr;
};

}  // namespace emax::test
