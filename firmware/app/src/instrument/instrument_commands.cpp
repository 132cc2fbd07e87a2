// Commands of IEEE 488.2, and what starts work.
#include "instrument_commands.hpp"

#include <limits>

#include "emax/app/base/version.hpp"
#include "emax/app/instrument/self_test.hpp"
#include "emax/base/elementary.hpp"

#include "instrument_table.hpp"

namespace emax::app {
namespace {

constexpr double kPercent = 100.0;

}  // namespace

void InstrumentCommands::report(const ErrorWords& words, Call& call) noexcept {
  if (words) {
    call.fail(words.code, words.words, words.subject);
  }
}

void InstrumentCommands::identify_instrument(Instrument& i, Call& call) noexcept {
  call.answer().word("emax").word(i.board().name).word(i.board().serial).word(kVersion);
}

void InstrumentCommands::reset(Instrument& i, Call& /*call*/) noexcept { i.reset(); }

void InstrumentCommands::clear(Instrument& i, Call& call) noexcept {
  scpi::clear_status(call);
  i.forget_completion();
}

void InstrumentCommands::operation_complete(Instrument& i, Call& call) noexcept {
  if (!call.is_query()) {
    i.complete_operation();
    return;
  }
  if (i.is_working()) {
    call.wait();
    return;
  }
  call.answer().integer(1);
}

void InstrumentCommands::wait(Instrument& i, Call& call) noexcept {
  if (i.is_working()) {
    call.wait();
  }
}

void InstrumentCommands::progress(Instrument& i, Call& call) noexcept {
  const double percent = floor(kPercent * i.sequencer().progress());
  call.answer().integer(static_cast<std::int64_t>(percent));
  const char* name = i.sequencer().stage_name();
  std::size_t length = 0;
  while (name[length] != '\0') {
    ++length;
  }
  call.answer().string(Span<const char>(name, length));
}

void InstrumentCommands::abort(Instrument& i, Call& /*call*/) noexcept { i.abort_command(); }

void InstrumentCommands::initiate_sweep(Instrument& i, Call& call) noexcept {
  report(i.initiate_sweep(), call);
}

void InstrumentCommands::self_test(Instrument& i, Call& call) noexcept {
  if (i.is_working()) {
    call.wait();
    return;
  }
  std::uint32_t failed = run_self_test(i.sequencer().borrow<SelfTestWorkspace>());
  if (failed == 0 && i.board().check_hardware != nullptr) {
    failed = i.board().check_hardware();
  }
  call.answer().integer(failed);
}

void InstrumentCommands::conversion(Instrument& i, Call& call) noexcept {
  double conversion_s = std::numeric_limits<double>::quiet_NaN();
  if (i.board().measure_conversion_s != nullptr) {
    if (i.is_working()) {
      call.wait();
      return;
    }
    conversion_s = i.board().measure_conversion_s();
  }
  call.answer().number(conversion_s);
}

namespace {

constexpr auto kRows = scpi::rows_of(kCommands.rows);

}  // namespace

scpi::Table<Instrument> Instrument::rows() noexcept { return scpi::Table<Instrument>(kRows.rows); }

}  // namespace emax::app
