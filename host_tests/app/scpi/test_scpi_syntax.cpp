// Patterns, the ends of messages, and the forms that a header may have.
#include <gtest/gtest.h>
#include <string>

#include "emax/app/scpi/command.hpp"
#include "emax/app/scpi/input_buffer.hpp"
#include "emax/app/scpi/pattern.hpp"
#include "emax/app/scpi/program_unit.hpp"

#include "support/toy_instrument.hpp"

namespace emax::app::scpi {
namespace {

using test::ToyConsole;

Span<const char> view(const std::string& text) { return {text.data(), text.size()}; }

std::string text_of(Span<const char> text) { return std::string(text.data(), text.size()); }

HeaderMatch match(const char* pattern, const std::string& header) {
  return match_header(pattern, view(header), "", 0).match;
}

// SCPI-99, volume 1, 6.2.1: short form and long form only, in any case.
TEST(ScpiPattern, ShortAndLongForm) {
  for (const char* header : {"CALC:FILT:ORD", "CALCulate:FILTer:ORDer", "calc:filter:Ord"}) {
    EXPECT_EQ(match("CALCulate:FILTer:ORDer", header), HeaderMatch::kYes) << header;
  }
  for (const char* header :
       {"CALCU:FILT:ORD", "CALC:FILT:ORDE", "CALC:FILT", "CALC:FILT:ORD:X", "CAL:FILT:ORD", "CALC",
        "FILT:ORD", "CALC:ORD", "CALC:FILT:ORDE1", "CAL1:FILT:ORD", "CALC:12:ORD"}) {
    EXPECT_EQ(match("CALCulate:FILTer:ORDer", header), HeaderMatch::kNo) << header;
  }
}

// SCPI-99: nodes in brackets may be left out.
TEST(ScpiPattern, OptionalNodes) {
  for (const char* header : {"INIT", "INIT:SWE", "INITIATE:SWEEP"}) {
    EXPECT_EQ(match("INITiate[:SWEep]", header), HeaderMatch::kYes) << header;
  }
  for (const char* header : {"SENS:SWE:FREQ", "SWE:FREQ", "SWEEP:FREQUENCY"}) {
    EXPECT_EQ(match("[SENSe:]SWEep:FREQuency", header), HeaderMatch::kYes) << header;
  }
  for (const char* header : {"OUTP", "OUTP:STAT", "OUTP:MAIN", "OUTP:MAIN:STAT"}) {
    EXPECT_EQ(match("OUTPut[:MAIN][:STATe]", header), HeaderMatch::kYes) << header;
  }
  for (const char* header : {"SENS:FREQ", "FREQ", "SENS:SENS:SWE:FREQ", "SWE:SENS:FREQ"}) {
    EXPECT_EQ(match("[SENSe:]SWEep:FREQuency", header), HeaderMatch::kNo) << header;
  }
  EXPECT_EQ(match("OUTPut[:MAIN][:STATe]", "OUTP:STAT:MAIN"), HeaderMatch::kNo);
}

// A path leads to rows that share all its nodes.
TEST(ScpiPattern, RelativeToAPath) {
  const auto relative = [](const char* pattern, const char* path, std::uint16_t nodes) {
    return match_header(pattern, Span<const char>("TIME", 4), path, nodes);
  };
  EXPECT_EQ(relative("CALCulate:ENERgy:TIME", "CALCulate:ENERgy:STEP", 2).match, HeaderMatch::kYes);
  EXPECT_EQ(relative("CALCulate:ENERgy:TIME", "CALCulate:ENERgy:STEP", 2).nodes, 2);
  EXPECT_EQ(relative("CALCulate:ENERgy:TIME", "CALCulate:STEP", 1).match, HeaderMatch::kNo);
  EXPECT_EQ(relative("CALCulate:TIME", "CALCulate:ENERgy:STEP", 1).match, HeaderMatch::kYes);
  EXPECT_EQ(relative("CALCulate:ENERgy:TIME", "CALCulate:SNERgy:STEP", 2).match, HeaderMatch::kNo);
  EXPECT_EQ(relative("CALCulate:ENERgy:TIME", "CALCulate:ENERg:STEP", 2).match, HeaderMatch::kNo);
  EXPECT_EQ(relative("[SENSe:]SWEep:TIME", "[SENSe:]SWEep:STEP", 2).nodes, 2);
}

TEST(ScpiPattern, NumericSuffix) {
  const char* pattern = "ROUTe:CHANnel[1]:CLOSe";
  for (const char* header : {"ROUT:CHAN:CLOS", "ROUT:CHAN1:CLOS", "ROUTE:CHANNEL1:CLOSE"}) {
    EXPECT_EQ(match(pattern, header), HeaderMatch::kYes) << header;
  }
  for (const char* header : {"ROUT:CHAN2:CLOS", "ROUT:CHAN0:CLOS", "ROUT:CHAN11:CLOS"}) {
    EXPECT_EQ(match(pattern, header), HeaderMatch::kSuffixOutOfRange) << header;
  }
  EXPECT_EQ(match(pattern, "ROUT:CHA1:CLOS"), HeaderMatch::kNo);
  // 1 is what is meant where no number is told.
  EXPECT_EQ(match("[SENSe:]SWEep:FREQuency", "SENS1:SWE1:FREQ1"), HeaderMatch::kYes);
  EXPECT_EQ(match("[SENSe:]SWEep:FREQuency", "SWE1:FREQ"), HeaderMatch::kYes);
  EXPECT_EQ(match("[SENSe:]SWEep:FREQuency", "SENS2:SWE:FREQ"), HeaderMatch::kSuffixOutOfRange);
  EXPECT_EQ(match("[SENSe:]SWEep:FREQuency", "SENS01:SWE:FREQ"), HeaderMatch::kSuffixOutOfRange);
  EXPECT_EQ(match("*RST", "*RST1"), HeaderMatch::kNo);
  EXPECT_EQ(match(pattern, "ROUT:CHAN2"), HeaderMatch::kNo);
}

TEST(ScpiPattern, NumberOfParameters) {
  const struct {
    const char* parameters;
    int min;
    int max;
  } expected[] = {
      {"", 0, 0},
      {"<n>", 1, 1},
      {"<S>,<f0>,<beta>[,<uS>,<uf0>,<ubeta>]", 3, 6},
      {"<V/(m/s2)>[,<u>]", 1, 2},
      {"ISE|DIFFerence", 1, 1},
      {"<g>|AUTO|TRACk", 1, 1},
      {"<f1>,<f2>,...", 1, 0xFFFF},
      {"<t1>,...", 1, 0xFFFF},
      {"[<t1>,...]", 0, 0xFFFF},
      {"[<n>]", 0, 1},
      {"<a,b>", 1, 1},
  };
  for (const auto& entry : expected) {
    const Arity arity = arity_of(entry.parameters);
    EXPECT_TRUE(arity.is_well_formed) << entry.parameters;
    EXPECT_EQ(arity.min, entry.min) << entry.parameters;
    EXPECT_EQ(arity.max, entry.max) << entry.parameters;
  }
  for (const char* parameters : {"[<n>", "<n>]", "<n", "n>", "[[<n>]]", "<<n>>"}) {
    EXPECT_FALSE(arity_of(parameters).is_well_formed) << parameters;
  }
}

TEST(ScpiPattern, RowsThatAreNotWellFormed) {
  for (const char* pattern :
       {"*ESE", "ABORt", "INITiate[:SWEep]", "[SENSe:]SWEep:FREQuency", "ROUTe:CHANnel[1]:CLOSe",
        "SYSTem:ERRor[:NEXT]", "OUTPut[:MAIN][:STATe]"}) {
    EXPECT_TRUE(is_well_formed(pattern, "")) << pattern;
  }
  for (const char* pattern :
       {"", "abort", "ABORt?", "INITiate[:SWEep", "INITiate:SWEep]", "[INITiate]", "A B",
        "CALCulatealways", "A:*B", "INITiate[:SWEep:FAST]", "CHANnel[2]", "A::B", "A:", ":A"}) {
    EXPECT_FALSE(is_well_formed(pattern, "")) << pattern;
  }
  EXPECT_FALSE(is_well_formed("*ESE", "<n"));
  using test::Toy;
  static constexpr Command<Toy> kTwice[] = {{"ABORt", Forms::kSet, "", "", 0, test::toy::abort},
                                            {"*RST", Forms::kSet, "", "", 0, test::toy::reset},
                                            {"ABORt", Forms::kQuery, "", "", 0, test::toy::abort}};
  EXPECT_EQ(first_bad_row(kTwice), 2U);
}

/// The complete messages in the buffer, each followed by '|', or '!' if it is not valid; "(long)"
/// for one that was too long.
std::string messages(const InputBuffer& buffer) {
  std::string all;
  for (std::size_t offset = 0;;) {
    const MessageText message = buffer.message_at(offset);
    if (!message.is_complete) {
      return all;
    }
    all += message.text.empty() ? "(long)" : text_of(message.text);
    all += message.is_valid ? "|" : "!";
    offset += message.text.size() + 1;
  }
}

void add(InputBuffer& buffer, const std::string& bytes) {
  for (const char& byte : bytes) {
    EXPECT_GE(buffer.room(), 1U);
    buffer.add(Span<const char>(&byte, 1));
    EXPECT_TRUE(buffer.consistent());
  }
}

std::string messages_of(const std::string& bytes) {
  InputBuffer at_once;
  at_once.add(view(bytes));
  InputBuffer one_by_one;
  add(one_by_one, bytes);
  EXPECT_EQ(messages(at_once), messages(one_by_one));
  return messages(at_once);
}

TEST(ScpiInput, EndsOfLines) {
  EXPECT_EQ(messages_of("*IDN?\n"), "*IDN?|");
  EXPECT_EQ(messages_of("*IDN?\r"), "*IDN?|");
  EXPECT_EQ(messages_of("*IDN?\r\n"), "*IDN?|");
  EXPECT_EQ(messages_of("A\r\nB\rC\nD"), "A|B|C|");
  EXPECT_EQ(messages_of("\n\r\n\r\r\n\nA\n\n"), "A|");
  EXPECT_EQ(messages_of(" \t\n"), " \t|");
}

// What looks like a block goes on to the end of its line, whatever length it states and whatever
// is in it: a stray '#' must not swallow the next message.
TEST(ScpiInput, BlocksEndWithTheLine) {
  EXPECT_EQ(messages_of("D #44000\nE\n"), "D #44000|E|");
  EXPECT_EQ(messages_of("D #15a\nb\rc\nE\n"), "D #15a|b|c|E|");
  EXPECT_EQ(messages_of("D 1, #14;\",(\nE\n"), "D 1, #14;\",(|E|");
  EXPECT_EQ(messages_of(std::string("D #14\0\xFF;\nE\n", 11)), std::string("D #14\0\xFF;|E|", 11));
  EXPECT_EQ(messages_of("D #0ab\xFF;\"c\nE\n"), "D #0ab\xFF;\"c|E|");
  EXPECT_EQ(messages_of("#44000\nE\n"), "#44000|E|");
  // Only where a parameter may begin.
  EXPECT_EQ(messages_of("D#15\xFF\nE\n"), "D#15\xFF!E|");
  EXPECT_EQ(messages_of("D 5#15\xFF\nE\n"), "D 5#15\xFF!E|");
  EXPECT_EQ(messages_of("D \"#15\"\nE\n"), "D \"#15\"|E|");
  EXPECT_EQ(messages_of("D #H15\nE\n"), "D #H15|E|");
}

// A lost quote costs its own message only.
TEST(ScpiInput, StringsEndWithTheLine) {
  EXPECT_EQ(messages_of("D \"a;b\"\nE\n"), "D \"a;b\"|E|");
  EXPECT_EQ(messages_of("D \"ab\nABOR\n"), "D \"ab|ABOR|");
  EXPECT_EQ(messages_of("D 'ab\nABOR\n"), "D 'ab|ABOR|");
}

TEST(ScpiInput, NoiseEndsAMessage) {
  EXPECT_EQ(messages_of("*ID\x7FN?\nA\n"), "*ID\x7F!A|");
  EXPECT_EQ(messages_of("\xFF\xFE;;\"\nA\n"), "\xFF!A|");
  EXPECT_EQ(messages_of("D \"\x80\"\nA\n"), "D \"\x80!A|");
  EXPECT_EQ(messages_of("\x80\n\xFE\n\x7F\n"), "\x80!\xFE!\x7F!");
}

// IEEE 488.2, 7.4.1.2: 0 to 9 and 11 to 32. Carriage return ends a line, for those who type.
TEST(ScpiInput, WhiteSpace) {
  for (char blank = '\0'; blank <= ' '; ++blank) {
    if (blank == '\n' || blank == '\r') {
      continue;
    }
    const std::string text = std::string("*ESE") + blank + "5" + blank;
    EXPECT_EQ(messages_of(text + "\n"), text + "|") << int{blank};
    const std::string padded = blank + text;
    std::size_t position = 0;
    const ProgramUnit unit = cut_unit(view(padded), position);
    EXPECT_EQ(text_of(unit.parameters), std::string("5") + blank) << int{blank};
    EXPECT_EQ(text_of(unit.header), "*ESE") << int{blank};
  }
}

TEST(ScpiInput, LongestMessage) {
  InputBuffer buffer;
  const std::string longest(InputBuffer::kCapacity, 'A');
  add(buffer, longest);
  add(buffer, "\n");
  EXPECT_EQ(messages(buffer), longest + "|");
  EXPECT_EQ(buffer.room(), 0U);
  buffer.remove(0, longest.size());
  EXPECT_EQ(messages(buffer), "");
  EXPECT_GE(buffer.room(), InputBuffer::kCapacity);
  add(buffer, longest + "A");
  add(buffer, std::string(10000, 'B'));
  add(buffer, "\nC\n");
  EXPECT_EQ(messages(buffer), "(long)|C|");
}

TEST(ScpiInput, NoiseAtTheEndOfTheMemory) {
  InputBuffer buffer;
  add(buffer, std::string(InputBuffer::kCapacity - 1, 'A') + "\x80");
  EXPECT_EQ(messages(buffer), std::string(InputBuffer::kCapacity - 1, 'A') + "\x80!");
  buffer.clear();
  buffer.add(view("A\n" + std::string(InputBuffer::kCapacity - 2, 'B') + "\x80"));
  EXPECT_TRUE(buffer.consistent());
  EXPECT_EQ(buffer.room(), 0U);
  buffer.remove(0, 1);
  EXPECT_EQ(messages(buffer), std::string(InputBuffer::kCapacity - 2, 'B') + "\x80!");
}

TEST(ScpiInput, HoldsBackTheSender) {
  InputBuffer buffer;
  std::size_t taken = 0;
  while (buffer.room() >= 4) {
    add(buffer, "ABC\n");
    taken += 4;
  }
  EXPECT_EQ(taken, InputBuffer::kCapacity);
  EXPECT_EQ(buffer.room(), 0U);
  buffer.remove(4, 3);
  EXPECT_EQ(buffer.room(), 4U);
  EXPECT_EQ(messages(buffer).size(), taken - 4);
}

ProgramUnit unit_of(const std::string& text) {
  std::size_t position = 0;
  ProgramUnit unit = cut_unit(view(text), position);
  EXPECT_EQ(position, text.size());
  // The views end with the text: keep only what does not need it.
  unit.header = {};
  unit.name = {};
  unit.parameters = {};
  return unit;
}

TEST(ScpiUnit, Parts) {
  const std::string text = " :CALC:FILT:ORD?\t MAX , 2 ";
  std::size_t position = 0;
  const ProgramUnit unit = cut_unit(view(text), position);
  EXPECT_EQ(text_of(unit.header), ":CALC:FILT:ORD?");
  EXPECT_EQ(text_of(unit.name), "CALC:FILT:ORD");
  EXPECT_EQ(text_of(unit.parameters), "MAX , 2 ");
  EXPECT_EQ(unit.count, 2U);
  EXPECT_TRUE(unit.is_query);
  EXPECT_TRUE(unit.is_absolute);
  EXPECT_FALSE(unit.is_common);
  EXPECT_EQ(unit.error, ErrorCode::kNoError);
}

TEST(ScpiUnit, SeveralInAMessage) {
  const std::string text = "A 1;*B?;; \"C;\" ;D \"14;;;;\",\";\";E #12;F";
  std::size_t position = 0;
  std::string headers;
  while (position < text.size()) {
    const ProgramUnit unit = cut_unit(view(text), position);
    headers += text_of(unit.header) + std::to_string(unit.count) + "|";
  }
  EXPECT_EQ(headers, "A1|*B?0|0|\"C0|\"0|D2|E1|");
}

TEST(ScpiUnit, CountsParameters) {
  EXPECT_EQ(unit_of("A").count, 0U);
  EXPECT_EQ(unit_of("A ").count, 0U);
  EXPECT_EQ(unit_of("A 1").count, 1U);
  EXPECT_EQ(unit_of("A ,").count, 2U);
  EXPECT_EQ(unit_of("A 'x,y',(1,(2,3)),\"a,\"\"b\",3").count, 4U);
  EXPECT_EQ(unit_of("A 1,#12,,,").count, 2U);
}

TEST(ScpiUnit, HeadersThatAreNotWellFormed) {
  const struct {
    const char* text;
    ErrorCode error;
  } expected[] = {
      {"SETUP&", ErrorCode::kInvalidCharacter},  // The example of SCPI-99.
      {"$", ErrorCode::kInvalidCharacter},
      {"A:&", ErrorCode::kInvalidCharacter},
      {"*&", ErrorCode::kInvalidCharacter},
      {"_A", ErrorCode::kInvalidCharacter},
      {"*IDN?&", ErrorCode::kInvalidCharacter},
      {"12", ErrorCode::kCommandHeaderError},
      {"::A", ErrorCode::kCommandHeaderError},
      {"A::B", ErrorCode::kCommandHeaderError},
      {"A:", ErrorCode::kCommandHeaderError},
      {":", ErrorCode::kCommandHeaderError},
      {"*", ErrorCode::kCommandHeaderError},
      {"?", ErrorCode::kCommandHeaderError},
      {":*IDN", ErrorCode::kCommandHeaderError},
      {"*IDN:A", ErrorCode::kCommandHeaderError},
      {"*GMC\"MACRO\"", ErrorCode::kHeaderSeparatorError},  // The same.
      {"A,1", ErrorCode::kHeaderSeparatorError},
      {"A#H1", ErrorCode::kHeaderSeparatorError},
      {"A??", ErrorCode::kHeaderSeparatorError},
      {"A?MAX", ErrorCode::kHeaderSeparatorError},
      {"ABCDEFGHIJKLM", ErrorCode::kProgramMnemonicTooLong},
      {"A:ABCDEFGHIJKLM?", ErrorCode::kProgramMnemonicTooLong},
      {"ABCDEFGHIJKL:ABCDEFGHIJK1", ErrorCode::kNoError},
      {"A_1", ErrorCode::kNoError},
  };
  for (const auto& entry : expected) {
    EXPECT_EQ(unit_of(entry.text).error, entry.error) << entry.text;
  }
}

}  // namespace
}  // namespace emax::app::scpi
