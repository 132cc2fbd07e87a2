// What clients expect of any instrument: its headers, its settings as a message, its options.
#include "emax/app/scpi/pattern.hpp"

#include "instrument_commands.hpp"

namespace emax::app {
namespace {

using InstrumentRow = scpi::Row<Instrument>;

constexpr char kQueryOnly[] = "?/qonly/\n";
constexpr char kNoQuery[] = "/nquery/\n";

std::size_t length_of(const char* text) noexcept {
  std::size_t length = 0;
  while (text[length] != '\0') {
    ++length;
  }
  return length;
}

/// The end of a header's line (SCPI-99, volume 2, chapter 21).
const char* line_end_of(const InstrumentRow& row) noexcept {
  if (!row.has_set()) {
    return kQueryOnly;
  }
  return row.has_query() ? "\n" : kNoQuery;
}

const char* line_begin_of(const InstrumentRow& row) noexcept {
  return row.pattern[0] == '*' || row.pattern[0] == '[' ? "" : ":";
}

std::size_t length_of_line(const InstrumentRow& row) noexcept {
  return length_of(line_begin_of(row)) + length_of(row.pattern) + length_of(line_end_of(row));
}

/// What *LRN? tells: all that can be set and asked for, but for status and parameters of a device.
bool is_learned(const InstrumentRow& row) noexcept {
  return row.handler != nullptr && (row.flags & kLearned) != 0;
}

/// "[SENSe:]SWEep:CYCLes" as "SENS:SWE:CYCL".
void put_short_header(const char* pattern, scpi::Response& out) noexcept {
  for (; *pattern != '\0'; ++pattern) {
    const bool is_part = *pattern == ':' || (*pattern >= 'A' && *pattern <= 'Z');
    out.piece(Span<const char>(pattern, is_part ? 1 : 0));
  }
}

// What comes first: settings that limit others, at values that go with all there can be. The limits
// of a setting come behind it in the table, so that all are told from the last to the first.
constexpr char kFreeSettings[] =
    ":SOUR:LEV MIN;LIM:VOLT MIN;:SOUR:SLEW MAX;:CALC:ENER:METH BEST;TIME MAX;"
    ":CALC:MCAR:PROB 0.5;ADAP 0;TRI MAX;SEED 1,1,1,1;:CALC:REF:UNC ";

// The number of that index in the table of the reference and, behind it, the frequencies.
void learn_list(const Instrument& i, scpi::Call& call, std::size_t index) noexcept {
  const ReferenceCalibration& reference = i.sweep_settings().reference;
  const std::size_t pairs = 2 * reference.count;
  if (index == 0 || index == pairs) {
    call.answer().piece(index == 0 ? ";:SENS:REF:TABL " : ";:SENS:SWE:FREQ ");
    call.answer().join();
  }
  if (index >= pairs) {
    call.answer().number(i.sweep_settings().frequency_hz[index - pairs]);
  } else {
    call.answer().number(index % 2 == 0 ? reference.frequency_hz[index / 2]
                                        : reference.sensitivity[index / 2]);
  }
}

}  // namespace

void InstrumentCommands::options(Instrument& i, Call& call) noexcept {
  call.answer().word(i.board().simulated != nullptr ? "SIM" : "0");
}

void InstrumentCommands::capability(Instrument& /*i*/, Call& call) noexcept {
  call.answer().word("(SENSE&SOURCE&CALCULATE&TRACE)");
}

void InstrumentCommands::headers(Instrument& /*i*/, Call& call) noexcept {
  const scpi::Table<Instrument> rows = Instrument::rows();
  if (call.stage() == Call::Stage::kItem) {
    const InstrumentRow& row = rows[call.item()];
    call.answer().piece(line_begin_of(row)).piece(row.pattern).piece(line_end_of(row));
    return;
  }
  std::size_t length = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    length += length_of_line(rows[k]);
  }
  call.answer().block_header(length);
  call.answer_items(rows.size());
}

// The reference's table and the sweep's frequencies come last, one number after the other, for they
// do not fit into one piece of an answer.
void InstrumentCommands::learn(Instrument& i, Call& call) noexcept {
  const bool is_item = call.stage() == Call::Stage::kItem;
  if (is_item && call.item() == 0) {
    call.answer().word(kFreeSettings);
    call.answer().join();
    call.answer().number(i.common_percent());
    return;
  }
  const scpi::Table<Instrument> rows = Instrument::rows();
  std::size_t learned = 1;
  for (std::size_t k = rows.size(); k-- > 0;) {
    if (!is_learned(rows[k])) {
      continue;
    }
    if (is_item && learned == call.item()) {
      call.answer().piece(";:");
      put_short_header(rows[k].pattern, call.answer());
      call.answer().piece(" ");
      call.answer().join();
      rows[k].handler(i, call);
      return;
    }
    ++learned;
  }
  if (is_item) {
    learn_list(i, call, call.item() - learned);
    return;
  }
  const SweepSettings& sweep = i.sweep_settings();
  call.answer_items(learned + 2 * sweep.reference.count + sweep.frequency_count);
}

}  // namespace emax::app
