// The conversation with an instrument.
#include "desk/instrument/instrument_client.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <string_view>

#include "emax/app/settings/sweep_settings_rows.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/setting_options.hpp"
#include "desk/cli/stop_request.hpp"

namespace emax::desk {

namespace {

using Duration = InstrumentPort::Duration;
using Deadline = InstrumentPort::Deadline;

// The longest step of an instrument takes 50 ms, and a report line by serial line some seconds.
constexpr Duration kPatience{10'000};
// Long enough for the drive to come to zero.
constexpr Duration kStopPatience{2'000};
constexpr Duration kBetweenLooks{100};
constexpr std::size_t kLongestLine = 65'536;
// A fiftieth of what a serial line brings: an emulated board on a busy PC takes its time.
constexpr std::size_t kBytesPerSecond = 230;
constexpr int kGreetingLines = 16;
constexpr std::size_t kShown = 60;     // Of what somebody else answers.
constexpr unsigned kBusyBits = 0x118;  // Sweeping, measuring, computing.
constexpr unsigned kSweepBits = 0x018;
constexpr const char* kNoError = "0,\"No error\"";

std::string number_text(double value) {
  StringSink sink;
  app::TextWriter writer(sink);
  writer.exact(value);
  return sink.text();
}

// "[SENSe:]SWEep:CYCLes" as it may be sent.
std::string header_of(const app::SettingRow& row) {
  std::string header;
  for (const char* c = row.command.header; *c != '\0'; ++c) {
    header += *c == '[' || *c == ']' ? "" : std::string(1, *c);
  }
  return ":" + header;
}

bool is_list(const app::SettingField& field) {
  return field.kind == app::SettingKind::kNumbers || field.kind == app::SettingKind::kMoreNumbers;
}

// Not of the bench, whose description stays where it was told.
bool is_of_the_sweep(const app::SettingRow& row) {
  constexpr std::string_view kNames[] = {"level", "settle", "cycles", "repeats"};
  return std::find(std::begin(kNames), std::end(kNames), row.option.name) != std::end(kNames);
}

// "f1,S1,f2,S2"; "0,S" where it is one value.
std::string table_of(const app::ReferenceCalibration& reference) {
  std::string table;
  for (std::size_t i = 0; i < reference.count; ++i) {
    table += (i > 0 ? "," : "") + number_text(reference.frequency_hz[i]) + "," +
             number_text(reference.sensitivity[i]);
  }
  return table;
}

std::string frequencies_of(const app::SweepSettings& sweep) {
  std::string list;
  for (std::size_t i = 0; i < sweep.frequency_count; ++i) {
    list += (i > 0 ? "," : "") + number_text(sweep.frequency_hz[i]);
  }
  return list;
}

}  // namespace

Problem InstrumentClient::problem_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::kOk:
      return {};
    case Outcome::kStopped:
      return stop();
    case Outcome::kTimeout:
      return fault("--instrument: " + printable(port_.name()) +
                   (input_.empty() ? ": no answer for 10 s; check cable, baud rate and power"
                                   : ": no end of an answer within 10 s; it begins with \"" +
                                         printable(input_.substr(0, kShown)) + "\"") +
                   (is_sweeping_ ? ", and send ABORt: its sweep may still run" : ""));
    case Outcome::kLost:
      break;
  }
  return fault("--instrument: " + printable(port_.name()) +
               ": the connection was closed; another client may be connected" +
               (is_sweeping_ ? ", and the sweep may still run: ABORt ends it" : ""));
}

Problem InstrumentClient::send(const std::string& line) {
  return problem_of(port_.write(line + "\n", kPatience, true));
}

// Until so many bytes are there.
Problem InstrumentClient::read_until(std::size_t count, Deadline end) {
  while (input_.size() < count) {
    if (Problem problem = problem_of(port_.read(input_, end, true))) {
      return problem;
    }
  }
  return {};
}

// All of a line within the patience, however many bytes of it come one by one.
Problem InstrumentClient::read_line(std::string& line) {
  const Deadline deadline = InstrumentPort::after(kPatience);
  std::size_t end = input_.find('\n');
  while (end == std::string::npos) {
    if (input_.size() > kLongestLine) {
      return fault("--instrument: " + printable(port_.name()) + ": answers without an end");
    }
    if (Problem problem = read_until(input_.size() + 1, deadline)) {
      return problem;
    }
    end = input_.find('\n');
  }
  line = input_.substr(0, end);
  input_.erase(0, end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.pop_back();
  }
  return {};
}

Problem InstrumentClient::ask(const std::string& query, std::string& line) {
  const Problem problem = send(query);
  return problem ? problem : read_line(line);
}

Problem InstrumentClient::ask_block(const std::string& query, std::string& content) {
  if (Problem problem = send(query)) {
    return problem;
  }
  const Deadline deadline = InstrumentPort::after(kPatience);
  if (Problem problem = read_until(2, deadline)) {
    return problem;
  }
  const int digits = input_[1] - '0';
  if (input_[0] != '#' || digits < 1 || digits > 9) {
    return fault("--instrument: " + printable(port_.name()) + ": " + query +
                 " was not answered with a block; expected an emax of this version");
  }
  const std::size_t head = 2 + static_cast<std::size_t>(digits);
  if (Problem problem = read_until(head, deadline)) {
    return problem;
  }
  const std::size_t length = std::strtoul(input_.substr(2, head - 2).c_str(), nullptr, 10);
  const Duration for_all = kPatience + Duration{1000 * (length / kBytesPerSecond)};
  if (Problem problem = read_until(head + length, InstrumentPort::after(for_all))) {
    return problem;
  }
  content = input_.substr(head, length);
  input_.erase(0, head + length);
  std::string rest;
  return read_line(rest);
}

Problem InstrumentClient::open(const std::string& port) {
  if (Problem problem = port_.open(port)) {
    return problem;
  }
  return greet();
}

Problem InstrumentClient::no_emax(const std::string& answer) const {
  return fault("--instrument: " + printable(port_.name()) + ": answers \"" +
               printable(answer.substr(0, kShown)) + "\" to *IDN?; expected an emax");
}

// A device clear ends what somebody has left half said; its answer may begin with the end of a line
// that was sent in part.
Problem InstrumentClient::greet() {
  if (Problem problem = send("\x03*IDN?;:STAT:OPER:COND?")) {
    return problem;
  }
  std::string line;
  std::string other;  // Whatever came in its place.
  for (int i = 0; i < kGreetingLines && line.compare(0, 5, "emax,") != 0; ++i) {
    if (Problem problem = read_line(line)) {
      const bool is_other = problem.status == ExitStatus::kFault && !(other + input_).empty();
      return is_other ? no_emax(other.empty() ? input_ : other) : problem;
    }
    other = line.empty() ? other : line;
  }
  const std::size_t end = line.rfind(';');
  if (line.compare(0, 5, "emax,") != 0 || end == std::string::npos) {
    return no_emax(line);
  }
  if ((std::strtoul(line.c_str() + end + 1, nullptr, 10) & kBusyBits) != 0) {
    return fault("--instrument: " + printable(port_.name()) +
                 ": it is at work already; wait for its end, or send ABORt");
  }
  return {};
}

Problem InstrumentClient::set(const std::string& command, const std::string& option) {
  std::string error;
  if (Problem problem = ask(command + ";:SYST:ERR?", error)) {
    return problem;
  }
  if (error == kNoError) {
    return {};
  }
  return bad_input(option + ": the instrument refuses " + command.substr(0, 60) + ": " +
                   printable(error));
}

// A single value takes the place of a table, and a table keeps the uncertainty that was set with a
// value: so the value comes first, of the table that is there if none is given.
Problem InstrumentClient::set_reference(const ReportOptions& options) {
  const app::ReferenceCalibration& reference = options.sweep.reference;
  const bool is_given = options.given_value("reference-sensitivity") != nullptr ||
                        options.given_value("reference-table") != nullptr;
  const bool has_uncertainty = options.given_value("reference-uncertainty") != nullptr;
  if (!is_given && !has_uncertainty) {
    return {};
  }
  std::string table = table_of(reference);
  if (!is_given) {
    if (Problem problem = ask(":SENS:REF:TABL?", table)) {
      return problem;
    }
  }
  const std::size_t comma = table.find(',');
  const std::string value = table.substr(comma + 1, table.find(',', comma + 1) - comma - 1);
  const bool is_table = std::strtod(table.c_str(), nullptr) > 0.0;
  if (has_uncertainty || !is_table) {
    const std::string percent =
        has_uncertainty ? "," + number_text(reference.expanded_percent) : std::string();
    if (Problem problem =
            set(":SENS:REF:SENS " + value + percent,
                has_uncertainty ? "--reference-uncertainty" : "--reference-sensitivity")) {
      return problem;
    }
  }
  return is_table ? set(":SENS:REF:TABL " + table, "--reference-table") : Problem{};
}

// A row, with the next one where that is its uncertainty.
Problem InstrumentClient::set_row(const app::SettingRow& row, const app::SettingRow* uncertainty,
                                  const app::SweepSettings& sweep) {
  const std::string option = std::string("--") + row.option.name;
  if (row.command.header == nullptr) {
    return bad_input(option + ": a board has no command for it; leave it out");
  }
  std::string command = header_of(row) + " " + number_text(number_in(row.field, &sweep));
  if (uncertainty != nullptr) {
    command += "," + number_text(number_in(uncertainty->field, &sweep));
  }
  return set(command, option);
}

// The rows are set from the last to the first: what limits another one comes before it, which is
// right where both rise. Where they fall, the one that is limited makes way first.
Problem InstrumentClient::lower_first(const ReportOptions& options) {
  const struct {
    const char* command;
    const char* option;
    double wanted;
    bool is_set;
  } limited[] = {
      {":SOUR:LEV", "level", options.sweep.level_mps2, true},
      {":SOUR:LIM:VOLT", "drive-limit", options.sweep.drive_limit_v,
       options.given_value("drive-limit") != nullptr},
  };
  for (const auto& one : limited) {
    std::string present;
    Problem problem = one.is_set ? ask(std::string(one.command) + "?", present) : Problem{};
    if (!problem && one.is_set && one.wanted < std::strtod(present.c_str(), nullptr)) {
      problem = set(std::string(one.command) + " " + number_text(one.wanted),
                    std::string("--") + one.option);
    }
    if (problem) {
      return problem;
    }
  }
  return {};
}

Problem InstrumentClient::set_up(const ReportOptions& options) {
  if (Problem problem = set("*CLS", "--instrument")) {
    return problem;
  }
  if (Problem problem = lower_first(options)) {
    return problem;
  }
  if (Problem problem = set(":SENS:SWE:FREQ " + frequencies_of(options.sweep), "--frequencies")) {
    return problem;
  }
  if (Problem problem = set_reference(options)) {
    return problem;
  }
  // From the last to the first: level and drive after their limits.
  for (std::size_t i = std::size(app::kSweepSettingRows); i-- > 0;) {
    const app::SettingRow& row = app::kSweepSettingRows[i];
    if (row.option.name == nullptr || is_list(row.field)) {
      continue;
    }
    const std::string* const given = options.given_value(row.option.name);
    if (given == nullptr && !is_of_the_sweep(row)) {
      continue;
    }
    const bool has_uncertainty = given != nullptr && given->find(',') != std::string::npos &&
                                 row.command.next_unit != nullptr;
    const app::SettingRow* const next = has_uncertainty ? &app::kSweepSettingRows[i + 1] : nullptr;
    if (Problem problem = set_row(row, next, options.sweep)) {
      return problem;
    }
  }
  return {};
}

Problem InstrumentClient::measure(ConsoleProgress& progress) {
  is_sweeping_ = true;
  if (Problem problem = set(":INIT", "--instrument")) {
    return problem;
  }
  for (;;) {
    std::string line;
    if (Problem problem = ask(":SYST:PROG?;:TRAC:FRES:POIN?;:STAT:OPER:COND?", line)) {
      return problem;
    }
    const std::size_t end = line.rfind(';');
    const char* const condition = end != std::string::npos ? line.c_str() + end + 1 : "0";
    if ((std::strtoul(condition, nullptr, 10) & kSweepBits) == 0) {
      is_sweeping_ = false;
      return {};
    }
    progress.show("sweep of the instrument,", std::strtod(line.c_str(), nullptr) / 100.0);
    const std::size_t begin = line.find(';') + 1;
    if (Problem problem = keep_points(std::strtoul(line.c_str() + begin, nullptr, 10))) {
      return problem;
    }
    const Outcome outcome = port_.read(input_, InstrumentPort::after(kBetweenLooks), true);
    if (outcome != Outcome::kOk && outcome != Outcome::kTimeout) {
      return problem_of(outcome);
    }
  }
}

// Those that are new.
Problem InstrumentClient::keep_points(std::size_t count) {
  while (early_points_.size() < count && count <= kMaxPoints) {
    std::string line;
    if (Problem problem =
            ask(":FETC:FRES:POIN? " + std::to_string(early_points_.size() + 1), line)) {
      return problem;
    }
    EarlyPoint point;
    char* rest = nullptr;
    point.frequency_hz = std::strtod(line.c_str(), &rest);
    for (double* const number : {&point.amplitude, &point.phase_deg}) {
      if (*rest != ',') {
        return fault("--instrument: " + printable(port_.name()) + ": FETC:FRES:POIN? answers \"" +
                     printable(line.substr(0, kShown)) + "\"; expected an emax of this version");
      }
      *number = std::strtod(rest + 1, &rest);
    }
    early_points_.push_back(point);
  }
  return {};
}

// The instrument comes first: whether it has heard is said.
Problem InstrumentClient::stop() {
  if (!is_sweeping_) {
    return stopped();
  }
  is_sweeping_ = false;
  bool is_at_rest = port_.write(
                        "\x03"
                        "ABOR;*OPC?\n",
                        kStopPatience, false) == Outcome::kOk;
  input_.clear();
  const Deadline end = InstrumentPort::after(kStopPatience);
  while (is_at_rest && input_.find("1\n") == std::string::npos) {
    is_at_rest = port_.read(input_, end, false) == Outcome::kOk;
  }
  return {ExitStatus::kStopped,
          is_at_rest ? "stopped during the sweep of the instrument, which has led its drive to zero"
                     : "stopped; ABORt WAS SENT BUT THE INSTRUMENT DOES NOT ANSWER"};
}

Problem InstrumentClient::fetch(InstrumentSweep& sweep) {
  std::string json;
  if (Problem problem = ask_block(":FETC:JSON?", json)) {
    return problem;
  }
  const std::string wrong = read_instrument_sweep(json, sweep);
  return wrong.empty() ? Problem{}
                       : fault("--instrument: " + printable(port_.name()) + ": " + wrong);
}

}  // namespace emax::desk
