// A small instrument with a command of every kind, and a peer that talks to it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "emax/app/scpi/command.hpp"
#include "emax/app/scpi/session.hpp"
#include "emax/app/scpi/standard_commands.hpp"
#include "emax/base/span.hpp"

namespace emax::test {

/// What the toy's commands set. `log` has a letter for each handler that acted.
struct Toy {
  bool is_busy = false;
  double level_mps2 = 1.0;
  double time_s = 0.002;
  std::int64_t order = 10;
  double gain = 0.0;
  std::size_t gain_word = 0;  ///< AUTO, TRACk, or 2 for a number.
  std::size_t criterion = 0;
  bool output = false;
  double frequencies_hz[8] = {};
  std::size_t frequency_count = 0;
  char text[64] = {};  ///< Of the last string.
  std::size_t text_length = 0;
  int stored = 0;  ///< How often a setting was said to have a new value.
  std::string log;
};

namespace toy {

using app::scpi::Call;
using app::scpi::ErrorCode;
using app::scpi::Forms;
using app::scpi::standard;

inline constexpr double kHuge = 1e300;

inline void keep(Toy& toy, Span<const char> text) noexcept {
  toy.text_length = std::min(text.size(), sizeof toy.text);
  std::copy_n(text.data(), toy.text_length, toy.text);
}

inline void identify(Toy&, Call& call) noexcept { call.answer().word("maker,toy,0,1.0"); }

inline void reset(Toy& toy, Call&) noexcept {
  const std::string log = toy.log;
  toy = {};
  toy.log = log + "R";
}

inline void operation_complete(Toy& toy, Call& call) noexcept {
  if (call.is_query() && toy.is_busy) {
    call.wait();
  } else if (call.is_query()) {
    call.answer().integer(1);
  } else {
    call.status().add_events(app::scpi::kOperationComplete);
  }
}

inline void wait(Toy& toy, Call& call) noexcept {
  if (toy.is_busy) {
    call.wait();
    return;
  }
  toy.log += 'W';
}

inline void initiate(Toy& toy, Call& call) noexcept {
  if (toy.is_busy) {
    call.fail(ErrorCode::kInitIgnored, "busy");
    return;
  }
  toy.is_busy = true;
  toy.log += 'I';
}

inline void abort(Toy& toy, Call&) noexcept {
  toy.is_busy = false;
  toy.log += 'A';
}

inline void level(Toy& toy, Call& call) noexcept {
  toy.stored += call.setting({0.5, 20.0, 2.0, app::scpi::kMetrePerSecondSquared}, toy.level_mps2,
                             toy.level_mps2)
                    ? 1
                    : 0;
}

inline void time(Toy& toy, Call& call) noexcept {
  (void)call.setting({-kHuge, kHuge, __builtin_nan(""), app::scpi::kSecond}, toy.time_s,
                     toy.time_s);
}

inline void frequency(Toy& toy, Call& call) noexcept {
  double value_hz = 0.0;
  if (call.number({-kHuge, kHuge, 0.0, app::scpi::kHertz}, value_hz)) {
    toy.time_s = 1.0 / value_hz;
    call.answer().number(value_hz);
  }
}

inline void order(Toy& toy, Call& call) noexcept {
  toy.stored += call.integer_setting({1, 15, 10}, toy.order, toy.order) ? 1 : 0;
}

inline void gain(Toy& toy, Call& call) noexcept {
  static constexpr const char* kWords[] = {"AUTO", "TRACk"};
  app::scpi::NumberOrWord value{toy.gain, toy.gain_word};
  if (call.number_or_word_setting({0.0, 100.0, __builtin_nan(""), nullptr}, kWords, value, value)) {
    toy.gain = value.number;
    toy.gain_word = value.word;
    ++toy.stored;
  }
}

inline void criterion(Toy& toy, Call& call) noexcept {
  static constexpr const char* kWords[] = {"ISE", "DIFFerence"};
  toy.stored += call.choice_setting(kWords, toy.criterion, toy.criterion) ? 1 : 0;
}

inline void output(Toy& toy, Call& call) noexcept {
  toy.stored += call.boolean_setting(toy.output, toy.output) ? 1 : 0;
}

inline void frequencies(Toy& toy, Call& call) noexcept {
  if (!call.is_query()) {
    double values_hz[8] = {};
    std::size_t count = 0;
    if (call.numbers({0.0, 1e6, 0.0, app::scpi::kHertz}, values_hz, count)) {
      std::copy_n(values_hz, count, toy.frequencies_hz);
      toy.frequency_count = count;
    }
    return;
  }
  for (std::size_t i = 0; i < toy.frequency_count; ++i) {
    call.answer().number(toy.frequencies_hz[i]);
  }
}

/// Waits while the instrument is busy, as a result does that is being computed.
inline void energy(Toy& toy, Call& call) noexcept {
  if (toy.is_busy) {
    call.wait();
    return;
  }
  if (toy.log.find('A') != std::string::npos) {
    call.fail(ErrorCode::kDataCorruptOrStale, "aborted");
    return;
  }
  call.answer().number(0.005).integer(call.stage() == Call::Stage::kAgain ? 1 : 0);
}

inline void progress(Toy& toy, Call& call) noexcept {
  call.answer().integer(toy.is_busy ? 50 : 100);
}

/// n, 0, 1, ..., n - 1.
inline void series(Toy&, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().integer(static_cast<std::int64_t>(call.item()));
    return;
  }
  std::int64_t count = 0;
  if (call.integer({0, 1000000, 0}, count)) {
    call.answer().integer(count);
    call.answer_items(static_cast<std::size_t>(count));
  }
}

inline constexpr char kReport[] = "first line\nsecond line\n";

inline void block(Toy& toy, Call& call) noexcept {
  if (call.is_query()) {
    call.answer().block(Span<const char>(kReport, sizeof kReport - 1));
    return;
  }
  Span<const char> text;
  if (call.string(text)) {
    keep(toy, text);
  }
}

/// The same block, its bytes as items of one line each.
inline void pieces(Toy&, Call& call) noexcept {
  constexpr std::size_t kPiece = 11;
  if (call.stage() != Call::Stage::kItem) {
    call.answer().block_header(sizeof kReport - 1);
    call.answer_items(2);
    return;
  }
  const Span<const char> all(kReport, sizeof kReport - 1);
  call.answer().piece(call.item() == 0 ? all.first(kPiece) : all.from(kPiece));
}

inline void text(Toy& toy, Call& call) noexcept {
  Span<const char> value;
  if (call.is_query()) {
    call.answer().string(Span<const char>(toy.text, toy.text_length));
  } else if (call.string(value)) {
    keep(toy, value);
  }
}

inline void count(Toy& toy, Call& call) noexcept {
  toy.log += static_cast<char>('0' + call.count());
}

inline void half_answer(Toy&, Call& call) noexcept {
  call.answer().integer(7);
  call.fail(ErrorCode::kHardwareError);
}

inline void flood(Toy&, Call& call) noexcept {
  for (int i = 0; i < 100; ++i) {
    call.answer().integer(1234567);
  }
}

/// Breaks the rule of immediate commands.
inline void bad_immediate(Toy&, Call& call) noexcept { call.wait(); }

/// Breaks the rule of commands that are no queries.
inline void talkative(Toy&, Call& call) noexcept { call.answer().integer(7); }

/// Asks for more parameters than its row has.
inline void greedy(Toy& toy, Call& call) noexcept {
  static constexpr const char* kWords[] = {"AUTO", "TRACk"};
  const app::scpi::NumberRule rule{0.0, 100.0, 0.0, nullptr};
  double number = 0.0;
  std::int64_t whole = 0;
  bool is_on = false;
  std::size_t word = 0;
  Span<const char> text;
  app::scpi::NumberOrWord value{0.0, 0};
  (void)call.number(rule, number);
  const bool takes_more = call.number(rule, number) || call.integer({1, 15, 10}, whole) ||
                          call.boolean(is_on) || call.choice(kWords, word) || call.string(text) ||
                          call.number_or_word_setting(rule, kWords, value, value);
  toy.stored += takes_more ? 1 : 0;
}

using app::scpi::kImmediate;
using app::scpi::kPlain;
using app::scpi::kQueryLimits;

inline constexpr app::scpi::Command<Toy> kCommands[] = {
    {"*CLS", Forms::kSet, "", "", kImmediate, standard<app::scpi::clear_status, Toy>},
    {"*ESE", Forms::kSetAndQuery, "<mask>", "", kImmediate, standard<app::scpi::event_enable, Toy>},
    {"*ESR", Forms::kQuery, "", "", kImmediate, standard<app::scpi::event_status, Toy>},
    {"*SRE", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::service_enable, Toy>},
    {"*STB", Forms::kQuery, "", "", kImmediate, standard<app::scpi::status_byte, Toy>},
    {"*IDN", Forms::kQuery, "", "", kPlain, identify},
    {"*RST", Forms::kSet, "", "", kPlain, reset},
    {"*OPC", Forms::kSetAndQuery, "", "", kPlain, operation_complete},
    {"*WAI", Forms::kSet, "", "", kPlain, wait},
    {"SYSTem:ERRor[:NEXT]", Forms::kQuery, "", "", kImmediate,
     standard<app::scpi::next_error, Toy>},
    {"SYSTem:ERRor:COUNt", Forms::kQuery, "", "", kImmediate,
     standard<app::scpi::error_count, Toy>},
    {"SYSTem:VERSion", Forms::kQuery, "", "", kImmediate, standard<app::scpi::version, Toy>},
    {"SYSTem:PROGress", Forms::kQuery, "", "", kImmediate, progress},
    {"STATus:PRESet", Forms::kSet, "", "", kImmediate, standard<app::scpi::status_preset, Toy>},
    {"STATus:OPERation[:EVENt]", Forms::kQuery, "", "", kImmediate,
     standard<app::scpi::operation_event, Toy>},
    {"STATus:OPERation:CONDition", Forms::kQuery, "", "", kImmediate,
     standard<app::scpi::operation_condition, Toy>},
    {"STATus:OPERation:ENABle", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::operation_enable, Toy>},
    {"STATus:OPERation:PTRansition", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::operation_positive, Toy>},
    {"STATus:OPERation:NTRansition", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::operation_negative, Toy>},
    {"STATus:QUEStionable[:EVENt]", Forms::kQuery, "", "", kImmediate,
     standard<app::scpi::questionable_event, Toy>},
    {"STATus:QUEStionable:CONDition", Forms::kQuery, "", "", kImmediate,
     standard<app::scpi::questionable_condition, Toy>},
    {"STATus:QUEStionable:ENABle", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::questionable_enable, Toy>},
    {"STATus:QUEStionable:PTRansition", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::questionable_positive, Toy>},
    {"STATus:QUEStionable:NTRansition", Forms::kSetAndQuery, "<mask>", "", kImmediate,
     standard<app::scpi::questionable_negative, Toy>},
    {"ABORt", Forms::kSet, "", "", kImmediate, abort},
    {"INITiate[:SWEep]", Forms::kSet, "", "", kPlain, initiate},
    {"INITiate:ENERgy", Forms::kSet, "", "", kPlain, initiate},
    {"[SENSe:]SWEep:FREQuency", Forms::kSetAndQuery, "<f1>,...", "", kPlain, frequencies},
    {"[SENSe:]SWEep:CYCLes", Forms::kSetAndQuery, "<n>", "", kQueryLimits, order},
    {"SOURce:LEVel", Forms::kSetAndQuery, "<a>", "", kQueryLimits, level},
    {"CALCulate:FILTer:ORDer", Forms::kSetAndQuery, "<n>", "", kQueryLimits, order},
    {"CALCulate:FILTer:GAIN", Forms::kSetAndQuery, "<g>|AUTO|TRACk", "", kQueryLimits, gain},
    {"CALCulate:ENERgy", Forms::kQuery, "", "", kPlain, energy},
    {"CALCulate:ENERgy:TIME", Forms::kSetAndQuery, "<T>", "", kQueryLimits, time},
    {"CALCulate:ENERgy:CRITerion", Forms::kSetAndQuery, "ISE|DIFFerence", "", kPlain, criterion},
    {"CALCulate:MODel", Forms::kSet, "<S>,<f0>,<beta>[,<uS>,<uf0>,<ubeta>]", "", kPlain, count},
    {"CALCulate:SERies", Forms::kQuery, "<n>", "", kPlain, series},
    {"CALCulate:FREQuency", Forms::kQuery, "<f>", "", kPlain, frequency},
    {"DATA:BLOCk", Forms::kSetAndQuery, "<block>", "", kPlain, block},
    {"DATA:PIECes", Forms::kQuery, "", "", kPlain, pieces},
    {"DISPlay:TEXT", Forms::kSetAndQuery, "<text>", "", kPlain, text},
    {"OUTPut[:STATe]", Forms::kSetAndQuery, "ON|OFF", "", kPlain, output},
    {"ROUTe:CHANnel[1]:CLOSe", Forms::kSet, "", "", kPlain, count},
    {"TEST:HALF", Forms::kQuery, "", "", kPlain, half_answer},
    {"TEST:FLOod", Forms::kQuery, "", "", kPlain, flood},
    {"TEST:WAIT", Forms::kQuery, "", "", kImmediate, bad_immediate},
    {"TEST:TALK", Forms::kSet, "", "", kImmediate, talkative},
    {"TEST:GREEdy", Forms::kSet, "<n>", "", kPlain, greedy},
};

static_assert(app::scpi::first_bad_row(kCommands) == sizeof kCommands / sizeof kCommands[0]);

inline constexpr auto kRows = app::scpi::rows_of(kCommands);

}  // namespace toy

/// A toy and its session, and a peer that sends and reads as fast as it can.
class ToyConsole {
 public:
  ToyConsole() { session.power_on(); }

  /// Hands over what there is room for.
  ///
  /// @returns How many bytes were taken.
  std::size_t send(const std::string& bytes) {
    const std::size_t count = std::min(bytes.size(), session.room());
    session.receive(Span<const char>(bytes.data(), count));
    return count;
  }

  bool step() { return session.step(toy, toy::kRows.rows); }

  /// Steps until nothing more happens, or `most` times; nothing is read.
  int run(int most = 100000) {
    int steps = 0;
    while (steps < most && step()) {
      ++steps;
    }
    return steps;
  }

  /// Takes up to `count` characters of what waits to be read.
  std::string read(std::size_t count = 1000000) {
    std::string text;
    while (text.size() < count && !session.output().empty()) {
      const Span<const char> output = session.output();
      const std::size_t part = std::min(count - text.size(), output.size());
      text.append(output.data(), part);
      session.consume(part);
    }
    return text;
  }

  /// Sends all of it and reads all answers, in turns.
  std::string ask(const std::string& bytes) {
    std::string answer;
    std::size_t sent = 0;
    bool acts = true;
    while (acts || sent < bytes.size()) {
      const std::size_t count = send(bytes.substr(sent, 100));
      sent += count;
      acts = step();
      const std::string part = read();
      answer += part;
      acts = acts || !part.empty() || count > 0;
      if (!acts) {
        break;
      }
    }
    return answer;
  }

  /// @returns The next error, as SYSTem:ERRor? has it.
  std::string error() { return ask("SYST:ERR?\n"); }

  Toy toy;
  app::scpi::Session session;
};

}  // namespace emax::test
