// Messages from bytes to answers: paths, errors, waiting, overtaking, peers that do not read.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "emax/app/scpi/session.hpp"

#include "support/toy_instrument.hpp"

namespace emax::app::scpi {
namespace {

using test::ToyConsole;

constexpr char kIdentity[] = "maker,toy,0,1.0\n";

// The share of the static memory that is the console's.
static_assert(sizeof(Session) <= InputBuffer::kCapacity + 3 * 1024);

TEST(ScpiSession, SaysNothingUnlessAsked) {
  ToyConsole console;
  EXPECT_EQ(console.ask(""), "");
  EXPECT_EQ(console.ask("\n\r\n \n;\n;;\n"), "");
  EXPECT_EQ(console.ask("*RST\n*CLS\nINIT\n"), "");
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
  EXPECT_TRUE(console.session.is_idle());
}

TEST(ScpiSession, EndsOfLines) {
  for (const char* end : {"\n", "\r", "\r\n"}) {
    ToyConsole console;
    EXPECT_EQ(console.ask(std::string("*IDN?") + end + "*idn?" + end),
              std::string(kIdentity) + kIdentity);
    EXPECT_EQ(console.error(), "0,\"No error\"\n");
  }
}

// SCPI-99, volume 1, 6.2.4, and the programming guides of many: ";" stays at the node, ":" goes to
// the root, common commands keep the path, a new message starts at the root.
TEST(ScpiSession, CompoundPaths) {
  ToyConsole console;
  EXPECT_EQ(console.ask("CALC:FILT:ORD 5;GAIN 2;ORD?;GAIN?\n"), "5;2\n");
  EXPECT_EQ(console.ask("CALC:FILT:ORD 6;:CALC:ENER:TIME 3;TIME?;:CALC:FILT:ORD?\n"), "3;6\n");
  EXPECT_EQ(console.ask("CALC:FILT:ORD 7;*IDN?;ORD?\n"), "maker,toy,0,1.0;7\n");
  EXPECT_EQ(console.ask(":CALC:FILT:ORD 8;*ESE 4;ORD?;*ESE?;ORD?\n"), "8;4;8\n");
  EXPECT_EQ(console.ask("SWE:FREQ 1,2;CYCL 9;FREQ?;CYCL?\n"), "1,2;9\n");
  EXPECT_EQ(console.ask("SENS:SWE:FREQ 3;CYCL 4;:SWE:FREQ?;CYCL?\n"), "3;4\n");
  EXPECT_EQ(console.ask("SYST:ERR?;VERS?\n"), "0,\"No error\";1999.0\n");
  EXPECT_EQ(console.ask("SYST:ERR:NEXT?;COUN?;:SYST:VERS?\n"), "0,\"No error\";0;1999.0\n");
  EXPECT_EQ(console.ask("*ESE?;SYST:VERS?;*ESE?;VERS?\n"), "4;1999.0;4;1999.0\n");
  // Down the tree from where the path is.
  EXPECT_EQ(console.ask("CALC:SER? 1;FILT:ORD?;GAIN?\n"), "1,0;4;2\n");
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
}

TEST(ScpiSession, PathsThatLeadNowhere) {
  const struct {
    const char* message;
    const char* error;
  } expected[] = {
      {"CALC:FILT:ORD 5;CALC:FILT:ORD 6", "-113,\"Undefined header;CALC:FILT:ORD\"\n"},
      {"CALC:FILT:ORD 5;TIME 6", "-113,\"Undefined header;TIME\"\n"},
      {"CALC:FILT:ORD 5\nORD 6", "-113,\"Undefined header;ORD\"\n"},
      {"INIT:SWE;SENS:SWE:FREQ 1", "-113,\"Undefined header;SENS:SWE:FREQ\"\n"},
      {"ABCD", "-113,\"Undefined header;ABCD\"\n"},
      {"abcd:efg? 12", "-113,\"Undefined header;abcd:efg?\"\n"},
      {"*IDN", "-113,\"Undefined header;*IDN\"\n"},
      {"*RST?", "-113,\"Undefined header;*RST?\"\n"},
      {"*ABC", "-113,\"Undefined header;*ABC\"\n"},
      {"CALC", "-113,\"Undefined header;CALC\"\n"},
      {"ROUT:CHAN2:CLOS", "-114,\"Header suffix out of range;ROUT:CHAN2:CLOS\"\n"},
      {"STAT2:PRES", "-114,\"Header suffix out of range;STAT2:PRES\"\n"},
      {"*ESE", "-109,\"Missing parameter;*ESE\"\n"},
      {"::ABOR", "-110,\"Command header error;::ABOR\"\n"},
      {"*ESE,5", "-111,\"Header separator error;*ESE,5\"\n"},
      {"ABCDEFGHIJKLM", "-112,\"Program mnemonic too long;ABCDEFGHIJKLM\"\n"},
      {"SETUP&", "-101,\"Invalid character;SETUP&\"\n"},
  };
  for (const auto& entry : expected) {
    ToyConsole console;
    EXPECT_EQ(console.ask(std::string(entry.message) + "\n"), "") << entry.message;
    EXPECT_EQ(console.error(), entry.error) << entry.message;
    EXPECT_EQ(console.error(), "0,\"No error\"\n") << entry.message;
    EXPECT_EQ(console.ask("*IDN?\n"), kIdentity) << entry.message;
  }
}

TEST(ScpiSession, SuffixOne) {
  ToyConsole console;
  EXPECT_EQ(console.ask("ROUT:CHAN:CLOS;:ROUT:CHAN1:CLOS\n"), "");
  EXPECT_EQ(console.toy.log, "00");
}

// After a command error nothing more of the message is executed; after an execution error it is.
TEST(ScpiSession, WhatAnErrorStops) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*IDN?;ABCD;*IDN?\n"), kIdentity);
  EXPECT_EQ(console.error(), "-113,\"Undefined header;ABCD\"\n");
  EXPECT_EQ(console.ask("CALC:FILT:ORD 99;GAIN 3;ORD?;GAIN?\n"), "10;3\n");
  EXPECT_EQ(console.error(), "-222,\"Data out of range;99\"\n");
  EXPECT_EQ(console.ask("CALC:FILT:ORD ABC;GAIN 4;GAIN?\n"), "");
  EXPECT_EQ(console.error(), "-141,\"Invalid character data;ABC\"\n");
  EXPECT_EQ(console.ask("*IDN? 12;*IDN?\n*IDN?\n"), kIdentity);
  EXPECT_EQ(console.toy.gain, 3.0);
}

TEST(ScpiSession, AnswersOfOneMessage) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*IDN?;*ESE?;;*RST;*SRE?\n"), "maker,toy,0,1.0;0;0\n");
  // What a handler answered before its error is dropped.
  EXPECT_EQ(console.ask("*ESE?;TEST:HALF?;*SRE?\n"), "0;0\n");
  EXPECT_EQ(console.error(), "-240,\"Hardware error\"\n");
  EXPECT_EQ(console.ask("TEST:HALF?\n"), "");
  EXPECT_EQ(console.error(), "-240,\"Hardware error\"\n");
}

// Faults of a handler are reported, and harm nobody else.
TEST(ScpiSession, HandlersThatBreakTheRules) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*ESE?;TEST:FLO?;*SRE?\n"), "0;0\n");
  EXPECT_EQ(console.error(), "-310,\"System error;the answer is too long\"\n");
  EXPECT_EQ(console.ask("*ESE?;TEST:TALK;*SRE?\n"), "0;0\n");
  EXPECT_EQ(console.error(), "-310,\"System error;the answer is too long\"\n");
  console.toy.is_busy = true;
  EXPECT_EQ(console.ask("*OPC?\nTEST:WAIT?;TALK\nSYST:ERR?;:SYST:ERR?\n"),
            "-310,\"System error;an immediate command waits\""
            ";-310,\"System error;the answer is too long\"\n");
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), "1\n");
  EXPECT_EQ(console.ask("TEST:GREE 5;*ESE?\nSYST:ERR:COUN?\n"), "6\n");
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(console.error(), "-109,\"Missing parameter\"\n") << i;
  }
  EXPECT_EQ(console.toy.stored, 0);
}

TEST(ScpiSession, LongAnswers) {
  ToyConsole console;
  std::string expected = "5000";
  for (int i = 0; i < 5000; ++i) {
    expected += "," + std::to_string(i);
  }
  EXPECT_EQ(console.ask("*ESE?;:CALC:SER? 5000;*IDN?\n"), "0;" + expected + ";" + kIdentity);
  EXPECT_EQ(console.ask("CALC:SER? 0\n"), "0\n");
  EXPECT_EQ(console.ask("DATA:PIEC?;BLOC?;PIEC?\n"),
            "#223first line\nsecond line\n;#223first line\nsecond line\n;"
            "#223first line\nsecond line\n\n");
}

TEST(ScpiSession, BlockOfTheCallersMemory) {
  ToyConsole console;
  (void)console.send("DATA:BLOC?;*IDN?\n");
  console.run();
  EXPECT_TRUE(console.session.holds_block());
  EXPECT_TRUE(console.session.is_answering());
  EXPECT_EQ(console.read(4), "#223");
  EXPECT_EQ(console.read(22), "first line\nsecond line");
  console.run();
  EXPECT_TRUE(console.session.holds_block());
  EXPECT_EQ(console.read(1), "\n");
  EXPECT_FALSE(console.session.holds_block());
  EXPECT_EQ(console.ask(""), std::string(";") + kIdentity);
}

// One byte is read now and then; nothing is lost or mixed up.
TEST(ScpiSession, SlowReader) {
  ToyConsole console;
  const std::string message = "CALC:SER? 300;:DATA:BLOC?;:DATA:PIEC?;*IDN?\n*IDN?\n";
  ToyConsole quick;
  const std::string expected = quick.ask(message);
  (void)console.send(message);
  std::string answer;
  while (!console.session.is_idle()) {
    (void)console.step();
    answer += console.read(1);
    ASSERT_TRUE(console.session.consistent());
  }
  EXPECT_EQ(answer, expected);
}

// A message too long is dropped as a whole, with one error, whatever is in it.
TEST(ScpiSession, LineThatIsTooLong) {
  ToyConsole console;
  const std::string too_long = "-363,\"Input buffer overrun;a line has " +
                               std::to_string(InputBuffer::kCapacity) + " characters at most\"\n";
  const std::string noise(2 * InputBuffer::kCapacity + 2048, 'A');
  EXPECT_EQ(console.ask("*RST;" + noise + "\n*IDN?\n"), kIdentity);
  EXPECT_EQ(console.error(), too_long);
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
  EXPECT_EQ(console.toy.log, "");
  const std::string full = "*ESE " + std::string(InputBuffer::kCapacity - 6, ' ') + "4";
  EXPECT_EQ(console.ask(full + "\n*ESE?\n"), "4\n");
  EXPECT_EQ(console.ask(full + " \n*ESE?\n"), "4\n");
  EXPECT_EQ(console.error(), too_long);
}

TEST(ScpiSession, Noise) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*ID\x7FN?\n*IDN?\n"), kIdentity);
  EXPECT_EQ(console.error(), "-101,\"Invalid character;*ID.\"\n");
  EXPECT_EQ(console.ask("\x80\n"), "");
  EXPECT_EQ(console.error(), "-101,\"Invalid character;.\"\n");
  // A message with noise executes nothing, not even what is before it.
  EXPECT_EQ(console.ask("*RST;*RST \xC3\xA4;*IDN?\n*IDN?\n"), kIdentity);
  EXPECT_EQ(console.error(), "-101,\"Invalid character;*RST;*RST .\"\n");
  EXPECT_EQ(console.toy.log, "");
  // The text in the error ends with the character.
  EXPECT_EQ(console.ask(std::string(60, 'A') + "\x80\n"), "");
  EXPECT_EQ(console.error(), "-101,\"Invalid character;" + std::string(39, 'A') + ".\"\n");
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
}

TEST(ScpiSession, ControlCharactersAreBlanks) {
  ToyConsole console;
  EXPECT_EQ(console.ask(std::string("\0*ESE\0 4\x1F;\x0B*ESE?\x7\n", 18)), "4\n");
  EXPECT_EQ(console.ask("\x1\x2\x1B\n"), "");
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
}

// step() is true as long as there is something to do.
TEST(ScpiSession, StepsThroughAllThatIsThere) {
  ToyConsole console;
  (void)console.send("\x80\n;\nABCD\n*RST;;*RST;\n*IDN?\n");
  console.run();
  EXPECT_EQ(console.read(), kIdentity);
  EXPECT_EQ(console.toy.log, "RR");
  EXPECT_EQ(console.session.status().errors().size(), 2U);
  EXPECT_TRUE(console.session.is_idle());
}

// A lost quote does not swallow the next command.
TEST(ScpiSession, LostQuote) {
  ToyConsole console;
  EXPECT_EQ(console.ask("DISP:TEXT \"abc\nABOR\n"), "");
  EXPECT_EQ(console.toy.log, "A");
  EXPECT_EQ(console.error(), "-151,\"Invalid string data;\"\"abc\"\n");
}

TEST(ScpiSession, WaitsForTheOperation) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\n*IDN?\n"), "");
  EXPECT_TRUE(console.session.is_waiting());
  EXPECT_FALSE(console.step());
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), std::string("1\n") + kIdentity);
  EXPECT_FALSE(console.session.is_waiting());
  EXPECT_EQ(console.ask("INIT;*WAI;*IDN?\n"), "");
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), kIdentity);
  EXPECT_EQ(console.toy.log, "IIW");
}

TEST(ScpiSession, QueryThatIsBeingComputed) {
  ToyConsole console;
  EXPECT_EQ(console.ask("CALC:ENER?\n"), "5.0E-3,0\n");
  console.toy.is_busy = true;
  EXPECT_EQ(console.ask("*ESE?;:CALC:ENER?;*IDN?\n"), "0");
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), std::string(";5.0E-3,1;") + kIdentity);
}

// ABORt, progress, errors and status act at once; everything else keeps its order.
TEST(ScpiSession, ImmediateCommandsOvertake) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\n*RST\nSYST:PROG?\n"), "50\n");
  EXPECT_EQ(console.ask("ABCD\nSYST:ERR?\n*STB?;*ESR?\n"), "0,\"No error\"\n0;128\n");
  EXPECT_EQ(console.ask("SRE 1;*ESE 32\n"), "");
  EXPECT_EQ(console.toy.log, "I");
  EXPECT_EQ(console.ask("STAT:OPER:COND?;ENAB 16;ENAB?;*ESE?\n"), "0;16;0\n");
  EXPECT_EQ(console.ask("ABOR\n"), "1\n");
  EXPECT_EQ(console.toy.log, "IAR");
  EXPECT_EQ(console.ask("SYST:ERR?\nSYST:ERR?\n"),
            "-113,\"Undefined header;ABCD\"\n-113,\"Undefined header;SRE\"\n");
}

// A query keeps its whole message in its place, and a unit that is not immediate what is behind it.
TEST(ScpiSession, MixedMessagesDoNotOvertake) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\nSYST:PROG?;*IDN?\n;*IDN?;ABOR\nSTAT:OPER:ENAB 16;FOO\n"), "");
  EXPECT_EQ(console.session.status().operation().enable(), 0) << "what follows hangs on this path";
  EXPECT_EQ(console.toy.log, "I");
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), std::string("1\n100;") + kIdentity + kIdentity);
  EXPECT_EQ(console.toy.log, "IA");
}

// The message that waits for a result is overtaken, other queries are not: who reads the next line
// takes it for the answer to the first of them.
TEST(ScpiSession, QueriesDoNotOvertakeOrdinaryQueries) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\n*RST\nSYST:PROG?\n"), "50\n");
  EXPECT_EQ(console.ask("*IDN?\nSYST:PROG?\n"), "");
  EXPECT_EQ(console.ask("*ESE 4\n"), "") << "without an answer it may";
  EXPECT_EQ(console.session.status().event_enable(), 4);
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), std::string("1\n") + kIdentity + "100\n");
}

// Only what waits for a result is overtaken. Where answers wait for their reader, all come in the
// order of their queries; what answers nothing may still act.
TEST(ScpiSession, QueriesDoNotOvertakeAnswersThatNobodyReads) {
  ToyConsole console;
  std::string expected;
  for (int i = 0; i < 40; ++i) {
    (void)console.send("*IDN?\n");
    expected += kIdentity;
  }
  (void)console.send("SYST:PROG?\nABOR\n");
  console.run();
  EXPECT_EQ(console.toy.log, "A");
  EXPECT_EQ(console.ask(""), expected + "100\n");
}

TEST(ScpiSession, TheImmediateFrontOfAMessageOvertakes) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\n*IDN?\nABOR;*ESE 4;*IDN?;*RST\n"),
            std::string("1\n") + kIdentity + kIdentity);
  EXPECT_EQ(console.toy.log, "IAR");
  EXPECT_EQ(console.ask("INIT;*OPC?\nABOR;;NO:SUCH\n"), "1\n");
  EXPECT_EQ(console.error(), "-113,\"Undefined header;NO:SUCH\"\n");
  EXPECT_TRUE(console.session.consistent());
}

TEST(ScpiSession, LongMessagesDoNotOvertake) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\n" + std::string(252, ' ') + " ABOR\n"), "");
  EXPECT_EQ(console.toy.log, "I");
  EXPECT_EQ(console.ask(std::string(252, ' ') + "ABOR\n"), "1\n");
  EXPECT_EQ(console.toy.log, "IAA");
}

// Behind an answer that has begun only commands without answers overtake.
TEST(ScpiSession, AnswersAreNotMixed) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*IDN?;*OPC?\nSYST:PROG?\n"), "maker,toy,0,1.0");
  EXPECT_EQ(console.ask("*ESE 4\n"), "");
  EXPECT_EQ(console.session.status().event_enable(), 4);
  console.toy.is_busy = false;
  EXPECT_EQ(console.ask(""), ";1\n100\n");
}

TEST(ScpiSession, ThreeQueriesOvertakeAtMost) {
  ToyConsole console;
  EXPECT_EQ(console.ask("INIT;*OPC?\n*STB?;*STB?;*STB?\n"), "0;16;16\n");
  EXPECT_EQ(console.ask("*STB?;*STB?;*STB?;*STB?\n"), "");
  EXPECT_EQ(console.ask("ABOR\n"), "1\n0;16;16;16\n");
}

TEST(ScpiSession, OvertakesAPeerThatDoesNotRead) {
  ToyConsole console;
  console.toy.is_busy = true;
  (void)console.send("CALC:SER? 100000\nABOR\n*IDN?\n");
  console.run();
  EXPECT_EQ(console.toy.log, "A");
  EXPECT_TRUE(console.session.is_answering());
  EXPECT_EQ(console.read(8), "100000,0");
  // Nothing was put into the answer by what overtook it.
  const std::string rest = console.ask("");
  EXPECT_EQ(rest.substr(0, 6), ",1,2,3");
  EXPECT_EQ(rest.substr(rest.size() - 22), std::string("99999\n") + kIdentity);
}

// Queries pile up until the memory is full; then the sender is held back, and ABORt still acts.
TEST(ScpiSession, PeerThatNeverReads) {
  ToyConsole console;
  std::size_t sent = 0;
  for (std::size_t i = 0; i < InputBuffer::kCapacity / 4; ++i) {
    sent += console.send("*IDN?\n");
    console.run();
    ASSERT_TRUE(console.session.consistent());
  }
  EXPECT_LT(sent, 3 * InputBuffer::kCapacity / 2);
  EXPECT_EQ(console.session.room(), 0U);
  EXPECT_TRUE(console.session.is_deadlocked());
  EXPECT_EQ(console.run(), 0);
  // All of it is there for one who reads after all.
  const std::string answer = console.ask("");
  EXPECT_EQ(answer.size(), sent / 6 * (sizeof kIdentity - 1));
  EXPECT_FALSE(console.session.is_deadlocked());
}

// The deadlock of IEEE 488.2, chapter 6.
TEST(ScpiSession, BreaksADeadlock) {
  ToyConsole console;
  std::string message = "CALC:SER? 100000;*RST\n";
  while (console.session.room() > 0) {
    (void)console.send(message);
    console.run();
    message = "*IDN?\n";
  }
  ASSERT_TRUE(console.session.is_deadlocked());
  console.session.break_deadlock();
  EXPECT_TRUE(console.session.consistent());
  EXPECT_TRUE(console.session.output().empty());
  EXPECT_FALSE(console.session.is_deadlocked());
  (void)console.ask("");
  EXPECT_EQ(console.toy.log, "");
  EXPECT_EQ(console.ask("\n*CLS;*IDN?\n"), kIdentity);
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
}

// The line that was sent in part ends, so that the next answer is not taken for its rest.
TEST(ScpiSession, WhatIsDroppedDoesNotRunIntoTheNextAnswer) {
  ToyConsole console;
  (void)console.send("CALC:SER? 100000\n");
  console.run();
  EXPECT_EQ(console.read(10), "100000,0,1");
  console.session.break_deadlock();
  EXPECT_EQ(console.ask("*IDN?\n"), std::string("\n") + kIdentity);
  (void)console.send("CALC:SER? 100000\n");
  console.run();
  EXPECT_EQ(console.read(10), "100000,0,1");
  console.session.clear();
  EXPECT_EQ(console.ask("*IDN?\n"), std::string("\n") + kIdentity);
  // A new peer has not seen the line.
  (void)console.send("CALC:SER? 100000\n");
  console.run();
  EXPECT_EQ(console.read(10), "100000,0,1");
  console.session.forget_peer();
  EXPECT_EQ(console.ask("*IDN?\n"), kIdentity);
}

TEST(ScpiSession, DeadlockIsAQueryError) {
  ToyConsole console;
  (void)console.send("CALC:SER? 100000\n");
  console.run();
  console.session.break_deadlock();
  EXPECT_EQ(console.ask("*ESR?\n"), "132\n");
  EXPECT_EQ(console.error(), "-430,\"Query DEADLOCKED\"\n");
}

// A query that waits for room is a deadlock, one that waits for its result is not.
TEST(ScpiSession, WaitingIsNoDeadlock) {
  ToyConsole console;
  console.toy.is_busy = true;
  (void)console.send("CALC:ENER?\n");
  while (console.session.room() > 0) {
    (void)console.send("*RST\n");
    console.run();
  }
  EXPECT_FALSE(console.session.is_deadlocked());
  ToyConsole full;
  full.toy.is_busy = true;
  (void)full.send("*OPC?\n");
  for (int i = 0; i < 20; ++i) {
    (void)full.send("SYST:ERR?;ERR?;ERR?\n");
    full.run();
  }
  while (full.session.room() > 0) {
    (void)full.send("*RST\n");
    full.run();
  }
  EXPECT_TRUE(full.session.is_deadlocked());
  EXPECT_TRUE(full.session.is_waiting());
}

TEST(ScpiSession, DeviceClear) {
  ToyConsole console;
  EXPECT_EQ(console.ask("ABCD\nINIT;*ESE 4;*OPC?\n*IDN?\n*RS"), "");
  console.session.clear();
  EXPECT_TRUE(console.session.consistent());
  EXPECT_TRUE(console.session.is_idle());
  EXPECT_EQ(console.ask("*ESE?\n"), "4\n");
  EXPECT_EQ(console.error(), "-113,\"Undefined header;ABCD\"\n");
  (void)console.send("DATA:BLOC?\n");
  console.run();
  console.session.clear();
  EXPECT_TRUE(console.session.output().empty());
  EXPECT_EQ(console.ask("*IDN?\n"), kIdentity);
}

/// A piece of a message, right or wrong.
std::string piece(std::mt19937& random) {
  static const char* const kPieces[] = {"*IDN?",
                                        "*OPC?",
                                        "*WAI",
                                        "*CLS",
                                        "*ESE 255",
                                        "INIT",
                                        "ABOR",
                                        "SYST:ERR?",
                                        "SYST:PROG?",
                                        "ABCD",
                                        "*STB?",
                                        "CALC:SER? 40",
                                        "DATA:BLOC?",
                                        "DATA:BLOC #13a",
                                        "\n",
                                        "\r\n",
                                        ";",
                                        ":",
                                        "?",
                                        "#",
                                        "\"",
                                        " ",
                                        ",",
                                        "CALC:FILT:ORD MAX",
                                        "ORD?",
                                        "1e5 KHZ",
                                        "TEST:FLO?",
                                        "TEST:HALF?",
                                        "*STB?;*STB?;*ESR?",
                                        "#0",
                                        "CALC:ENER?",
                                        "#19",
                                        "TEST:WAIT?",
                                        "STAT:OPER:ENAB 5;ENAB?"};
  constexpr std::size_t kCount = sizeof kPieces / sizeof kPieces[0];
  const std::size_t choice = random() % (kCount + 2);
  if (choice < kCount) {
    return kPieces[choice];
  }
  return std::string(1 + random() % 3, static_cast<char>(random()));
}

// Whatever comes in and however it is read: registers stay sane, and in the end it answers again.
TEST(ScpiSession, RandomInput) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    ToyConsole console;
    for (int i = 0; i < 400; ++i) {
      std::string bytes = piece(random);
      bytes += random() % 3 == 0 ? "\n" : "";
      (void)console.send(bytes);
      console.toy.is_busy = console.toy.is_busy && random() % 8 != 0;
      console.run(static_cast<int>(random() % 20));
      (void)console.read(random() % 60);
      ASSERT_TRUE(console.session.consistent());
      if (random() % 200 == 0) {
        console.session.break_deadlock();
      }
    }
    console.toy.is_busy = false;
    (void)console.ask("");
    console.session.clear();
    EXPECT_EQ(console.ask("*CLS;*IDN?\n"), kIdentity);
    EXPECT_EQ(console.error(), "0,\"No error\"\n");
  }
}

TEST(ScpiSession, RandomBytes) {
  std::mt19937 random(8);
  ToyConsole console;
  for (int i = 0; i < 3000; ++i) {
    std::string bytes(1 + random() % 100, '\0');
    std::generate(bytes.begin(), bytes.end(), [&random] { return static_cast<char>(random()); });
    (void)console.ask(bytes);
    ASSERT_TRUE(console.session.consistent());
  }
  // A dropped line may be open.
  const std::string answer = console.ask("\n*CLS;*IDN?\n");
  EXPECT_NE(answer.find(kIdentity), std::string::npos);
}

}  // namespace
}  // namespace emax::app::scpi
