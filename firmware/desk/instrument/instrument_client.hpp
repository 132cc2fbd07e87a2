// The PC as the front end of an instrument: sets it up, has it measure, and fetches the sweep.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/settings/setting_row.hpp"
#include "emax/hal/analog_stream.hpp"

#include "desk/cli/console_progress.hpp"
#include "desk/cli/options.hpp"
#include "desk/cli/problem.hpp"
#include "desk/instrument/instrument_port.hpp"

namespace emax::desk {

/// What an instrument has measured.
struct InstrumentSweep {
  app::SweepResults results;
  hal::StreamFormat format;  ///< Its sample rate; no more is told.
  bool is_simulated = false;
  app::SimulatedBench simulated;  ///< If so.
  std::string unstruck;           ///< Scripted faults that have not struck, in words.
};

/// A point as it is told while the sweep runs: its uncertainties are known at the end.
struct EarlyPoint {
  double frequency_hz = 0.0;
  double amplitude = 0.0;
  double phase_deg = 0.0;
};

/// Speaks SCPI with one instrument. Every answer has an end to its patience; a request to stop is
/// heeded within a tenth of a second, and ends the sweep of the instrument first.
class InstrumentClient final {
 public:
  /// Connects, and sees that an emax answers which has nothing else to do.
  Problem open(const std::string& port);

  /// Sets what a sweep is made of (frequencies, level, settling time, cycles, repeats), and of what
  /// describes the bench (limits, full scales, gains, reference, corrections, their uncertainties)
  /// what was given: the rest stays as somebody has told the instrument.
  ///
  /// @returns Bad input with its own words if it refuses a setting.
  Problem set_up(const ReportOptions& options);

  /// Has it measure, to the end or to a fault, which is in `status` of the results.
  Problem measure(ConsoleProgress& progress);

  /// Fetches what it has measured, with all its digits.
  Problem fetch(InstrumentSweep& sweep);

  /// What was told of a sweep that `measure()` has not seen the end of.
  const std::vector<EarlyPoint>& early_points() const noexcept { return early_points_; }

 private:
  using Outcome = InstrumentPort::Outcome;

  Problem greet();
  Problem set(const std::string& command, const std::string& option);
  Problem lower_first(const ReportOptions& options);
  Problem set_reference(const ReportOptions& options);
  Problem set_row(const app::SettingRow& row, const app::SettingRow* uncertainty,
                  const app::SweepSettings& sweep);
  Problem ask(const std::string& query, std::string& line);
  Problem ask_block(const std::string& query, std::string& content);
  Problem read_line(std::string& line);
  Problem no_emax(const std::string& answer) const;
  Problem read_until(std::size_t count, InstrumentPort::Deadline end);
  Problem keep_points(std::size_t count);
  Problem send(const std::string& line);
  Problem problem_of(Outcome outcome);
  Problem stop();

  InstrumentPort port_;
  std::string input_;  // Read and not taken.
  std::vector<EarlyPoint> early_points_;
  bool is_sweeping_ = false;  // INITiate was sent.
};

/// Reads the answer of FETCh:JSON?.
///
/// @returns What is wrong with it; empty if it was read.
std::string read_instrument_sweep(const std::string& json, InstrumentSweep& sweep);

}  // namespace emax::desk
