// What runs in the background: overlapped commands, ABORt, faults of the bench, and peers that
// misbehave.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "emax/app/instrument/instrument.hpp"

#include "support/instrument_bench.hpp"

namespace emax {
namespace {

using test::InstrumentBench;
using test::ManualWatchdog;

constexpr char kPaperModel[] = "CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004";

// Each kind of work: what starts it, and the bits of STATus:OPERation while it runs.
struct WorkCase {
  const char* setup;
  const char* start;
  const char* condition;
  const char* stage;

  friend void PrintTo(const WorkCase& work, std::ostream* out) { *out << work.start; }
};

constexpr WorkCase kWork[] = {
    {"*CLS", "INIT", "24", "\"sweep\""},
    {"CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;ENER:TIME 10ms", "INIT:ENER", "256", "\"energy\""},
    {"CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;ENER?", "INIT:MCAR", "256", "\"Monte Carlo\""},
    {"CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;ENER?", "INIT:TREN", "256", "\"trend\""},
};

class InstrumentWork : public testing::TestWithParam<WorkCase> {
 protected:
  /// Something runs, and *ESR? has been read.
  void start(InstrumentBench& i) {
    (void)i.ask(GetParam().setup);
    (void)i.ask("*CLS");
    EXPECT_EQ(i.ask(GetParam().start), "");
    i.poll(20);
    ASSERT_TRUE(i.instrument->is_working());
  }
};

INSTANTIATE_TEST_SUITE_P(All, InstrumentWork, testing::ValuesIn(kWork),
                         [](const auto& one) { return std::to_string(one.index); });

TEST_P(InstrumentWork, AnswersStatusAndProgressAtOnce) {
  InstrumentBench i;
  start(i);
  EXPECT_EQ(i.ask("STAT:OPER:COND?"), GetParam().condition);
  EXPECT_EQ(i.ask("SYST:ERR?;*ESR?;*STB?"), "0,\"No error\";0;16");
  EXPECT_TRUE(i.instrument->is_working()) << "none of them waits";
  std::string progress;
  while (i.instrument->is_working() && progress.find(GetParam().stage) == std::string::npos) {
    progress = i.ask("SYST:PROG?");
  }
  EXPECT_NE(progress.find(GetParam().stage), std::string::npos) << progress;
  ASSERT_TRUE(i.finish());
  EXPECT_EQ(i.ask("STAT:OPER:COND?"), "0");
  EXPECT_EQ(i.ask("STAT:OPER?"), GetParam().condition) << "the event is remembered";
  EXPECT_EQ(i.errors(), "");
}

TEST_P(InstrumentWork, CompletesOperations) {
  InstrumentBench i;
  start(i);
  EXPECT_EQ(i.ask("*OPC;*ESR?"), "0");
  ASSERT_TRUE(i.finish());
  EXPECT_EQ(i.ask("*ESR?"), "1");
  EXPECT_EQ(i.ask("*OPC;*ESR?"), "1") << "at once if nothing runs";
}

TEST_P(InstrumentWork, HoldsForOpcQueryAndWai) {
  for (const auto& [held, answer] :
       {std::pair{"*OPC?", "1\n"}, {"*WAI;*IDN?", "emax,test,4711,0.1.0\n"}}) {
    InstrumentBench i;
    start(i);
    i.send(held);
    i.poll(20);
    EXPECT_TRUE(i.instrument->is_held());
    EXPECT_EQ(i.console.receive(), "");
    ASSERT_TRUE(i.finish());
    EXPECT_EQ(i.console.receive(), answer);
  }
}

TEST_P(InstrumentWork, RefusesASecondStart) {
  InstrumentBench i;
  start(i);
  for (const char* second : {"INIT", "INIT:ENER", "INIT:MCAR", "INIT:TREN", "INIT:REP"}) {
    EXPECT_EQ(i.ask(second), "");
    EXPECT_EQ(i.ask("SYST:ERR?"), "-213,\"Init ignored;running: ABOR or *WAI first\"");
  }
  EXPECT_TRUE(i.instrument->is_working());
}

TEST_P(InstrumentWork, EndsAtOnceOnAbort) {
  InstrumentBench i;
  start(i);
  (void)i.ask("*OPC");
  i.send("ABOR");
  i.poll(2);
  EXPECT_FALSE(i.instrument->is_working());
  EXPECT_TRUE(i.drive_is_at_zero());
  EXPECT_EQ(i.ask("STAT:OPER:COND?;*ESR?"), "0;1");
  EXPECT_EQ(i.errors(), "") << "it was asked for";
  // And it can be started again.
  EXPECT_EQ(i.ask(GetParam().start), "");
  i.poll(5);
  EXPECT_TRUE(i.instrument->is_working());
  EXPECT_TRUE(i.finish());
  EXPECT_EQ(i.errors(), "");
}

TEST_P(InstrumentWork, EndsAtOnceOnReset) {
  InstrumentBench i;
  start(i);
  EXPECT_EQ(i.ask("*OPC;*RST;*OPC?;*ESR?"), "1;0") << "what *OPC waited for was not completed";
  EXPECT_FALSE(i.instrument->is_working());
  EXPECT_TRUE(i.drive_is_at_zero());
}

// Settings that the work uses are not changed under it; those of the other kind are.
TEST_P(InstrumentWork, RefusesChangesOfWhatItUses) {
  InstrumentBench i;
  start(i);
  const bool is_sweep = i.instrument->is_sweeping();
  const std::vector<std::string> of_sweep = {"SOUR:LEV 2", "SWE:FREQ 100,200,300", "SWE:FREQ:DEF",
                                             "REF:SENS 0.2"};
  const std::vector<std::string> of_evaluation = {"CALC:FILT:ORD 5", "CALC:ENER:TIME 3ms",
                                                  "CALC:MCAR:TRI 3000", "CALC:TREN? 1ms,7ms"};
  const std::vector<std::string> of_both = {"CALC:MOD 1,4000,0.3", "TRAC:FRES:CLE",
                                            "TRAC:FRES:DATA 1,1,1,1,1", "*RCL 0"};
  const auto is_refused = [&i](const std::string& command) {
    (void)i.ask(command);
    return i.errors().substr(0, 4) == "-221";
  };
  for (const std::string& command : of_both) {
    EXPECT_TRUE(is_refused(command)) << command;
  }
  for (const std::string& command : is_sweep ? of_sweep : of_evaluation) {
    EXPECT_TRUE(is_refused(command)) << command;
  }
  EXPECT_TRUE(i.instrument->is_working());
  if (is_sweep) {
    EXPECT_EQ(i.ask("CALC:FILT:ORD 5;ORD?"), "5");
  } else {
    EXPECT_EQ(i.ask("SOUR:LEV 2;LEV?"), "2");
  }
  EXPECT_TRUE(i.finish());
}

TEST_P(InstrumentWork, GoesOnForAPeerThatNeverReads) {
  InstrumentBench i({}, 64);  // Room for 64 bytes each way.
  (void)i.ask(GetParam().setup);
  i.console.receive();
  i.poll(100'000);
  i.console.receive();
  i.send(GetParam().start);
  i.poll(10);
  ASSERT_TRUE(i.instrument->is_working());
  for (int n = 0; n < 200; ++n) {
    i.console.send("*IDN?\n");
    i.poll(1);
  }
  ASSERT_TRUE(i.instrument->is_working());
  EXPECT_FALSE(i.watchdog.bitten());
  i.console.send("ABOR\n");
  // The memory for commands is full of queries that cannot be answered: that is given up after a
  // second, and then the command is reached.
  for (int n = 0; n < 1000 && i.instrument->is_working(); ++n) {
    i.poll(100);
    i.console.send("ABOR\n");
  }
  EXPECT_FALSE(i.instrument->is_working());
  EXPECT_TRUE(i.drive_is_at_zero());
  EXPECT_FALSE(i.watchdog.bitten());
}

TEST_P(InstrumentWork, SurvivesAPeerThatGoesAway) {
  InstrumentBench i;
  start(i);
  i.send("*OPC?");
  i.send("*IDN?");
  i.poll(20);
  i.console.connect(false);
  i.poll(20);
  EXPECT_TRUE(i.instrument->is_working()) << "what INITiate began goes on";
  i.console.connect(true);
  i.poll(20);
  EXPECT_EQ(i.console.receive(), "") << "answers of the one before";
  EXPECT_EQ(i.ask("*IDN?"), "emax,test,4711,0.1.0");
  EXPECT_TRUE(i.finish());
  EXPECT_EQ(i.errors(), "");
}

TEST(InstrumentQueries, WaitForTheSweepAndForWhatTheyBegin) {
  InstrumentBench i;
  i.console.send("INIT\nFETC:FRES?\nCALC:ENER?\nSYST:ERR?\n");
  ASSERT_TRUE(i.settle());
  const std::string answers = i.console.receive();
  EXPECT_EQ(answers.substr(0, 6), "5,200,") << "all points";
  EXPECT_NE(answers.find("E-3,"), std::string::npos) << answers;
  EXPECT_EQ(answers.substr(answers.size() - 13), "0,\"No error\"\n");
}

TEST(InstrumentQueries, AnswerWhatIsThereWhileOtherWorkRuns) {
  InstrumentBench i;
  (void)i.ask(kPaperModel);
  const std::string energy = i.ask("CALC:ENER?");
  (void)i.ask("INIT:MCAR");
  i.poll(5);
  EXPECT_EQ(i.ask("CALC:ENER?"), energy);
  EXPECT_NE(i.ask("CALC:AERR?"), "");
  EXPECT_TRUE(i.instrument->is_working());
}

TEST(InstrumentQueries, EndWithoutAnAnswerOnAbort) {
  InstrumentBench i;
  (void)i.ask(kPaperModel);
  i.console.send("CALC:MCAR?;*IDN?\n");
  i.poll(20);
  EXPECT_TRUE(i.instrument->is_held());
  i.send("SYST:PROG?");
  i.poll(5);
  EXPECT_NE(i.console.receive().find(",\""), std::string::npos) << "that one overtakes";
  EXPECT_TRUE(i.instrument->is_held());
  i.send("SYST:ERR?");
  i.send("ABOR");
  i.poll(10);
  EXPECT_FALSE(i.instrument->is_working());
  ASSERT_TRUE(i.settle());
  EXPECT_EQ(i.console.receive(), "emax,test,4711,0.1.0\n-200,\"Execution error;aborted\"\n");
  // What was complete by then is still there, and the rest is computed anew.
  EXPECT_EQ(i.ask("CALC:MCAR:TRI 1000;:CALC:MCAR?").substr(0, 5), "1000,");
}

TEST(InstrumentQueries, EndOnAMessageThatOnlyBeginsWithAbort) {
  InstrumentBench i;
  (void)i.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000000");
  i.send("CALC:MCAR?");
  i.poll(20);
  ASSERT_TRUE(i.instrument->is_held());
  i.send("ABOR;*CLS;*RST;:CALC:MCAR:TRI?");
  i.poll(20);
  EXPECT_FALSE(i.instrument->is_working());
  EXPECT_EQ(i.console.receive(), "200000\n");
  EXPECT_EQ(i.errors(), "");
}

TEST(InstrumentQueries, StopForAPeerThatGoesAway) {
  InstrumentBench i;
  (void)i.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000000");
  i.send("CALC:MCAR?");
  i.poll(20);
  ASSERT_TRUE(i.instrument->is_working());
  i.console.connect(false);
  i.poll();
  EXPECT_FALSE(i.instrument->is_working()) << "nobody waits for it";
  i.console.connect(true);
  EXPECT_EQ(i.ask("*IDN?"), "emax,test,4711,0.1.0");
}

TEST(InstrumentQueries, AreAnsweredInPiecesOfAnySize) {
  InstrumentBench i({}, 64);
  std::string answer;
  i.send("DIAG:RAND? 2000");
  for (int n = 0; n < 100'000 && (answer.empty() || answer.back() != '\n'); ++n) {
    i.poll();
    answer += i.console.receive();
  }
  EXPECT_EQ(std::count(answer.begin(), answer.end(), ','), 1999);
  EXPECT_EQ(answer.substr(0, 22), "7.509975706826317E-1,5");
}

// A long answer ends with its line: what is asked next is answered on one of its own.
TEST(InstrumentQueries, AbortEndsRandomNumbersWithoutEnd) {
  InstrumentBench i({}, 64);
  i.send("DIAG:RAND? 1000000");
  std::string answer;
  for (int n = 0; n < 50; ++n) {
    i.poll();
    answer += i.console.receive();
  }
  EXPECT_FALSE(i.instrument->is_settled());
  i.send("ABOR");
  for (int n = 0; n < 100; ++n) {
    i.poll();
    answer += i.console.receive();
  }
  EXPECT_TRUE(i.instrument->is_settled());
  EXPECT_EQ(answer.back(), '\n');
  EXPECT_LT(std::count(answer.begin(), answer.end(), ','), 1000);
  EXPECT_EQ(i.errors(), "-200,\"Execution error;aborted\"\n");
  EXPECT_EQ(i.numbers("DIAG:RAND? 2").size(), 2U) << "the next one is not ended";
}

// IEEE 488.2, 5.8: what answers or is computed for a query ends, input and output are empty; what
// INITiate began goes on, settings and errors stay.
TEST(InstrumentDeviceClear, EndsWhatAnswersAndEmptiesInputAndOutput) {
  for (const char* clear : {"\x03", "SOUR:LEV 5\x03", "\x03\n"}) {
    InstrumentBench i({}, 64);
    (void)i.ask("SOUR:LEV 2\nNO:SUCH");
    i.send("DIAG:RAND? 1000000");
    i.poll(50);
    i.send("*RST");
    i.console.send(clear);
    i.poll(2);
    const std::string answer = i.console.receive();
    i.poll(20);
    EXPECT_TRUE(i.instrument->is_settled());
    EXPECT_EQ(answer.substr(0, 2), "7.");
    EXPECT_EQ(i.console.receive(), "\n") << "the line that was sent in part ends";
    EXPECT_EQ(i.ask("SOUR:LEV?"), "2");
    EXPECT_EQ(i.errors(), "-113,\"Undefined header;NO:SUCH\"\n");
  }
}

TEST(InstrumentDeviceClear, EndsAComputationThatOnlyAQueryWants) {
  InstrumentBench i;
  (void)i.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000000");
  i.send("CALC:MCAR?");
  i.poll(20);
  ASSERT_TRUE(i.instrument->is_held());
  i.console.send("\x03");
  i.poll(2);
  EXPECT_FALSE(i.instrument->is_working());
  EXPECT_EQ(i.console.receive(), "");
  EXPECT_EQ(i.errors(), "");
  (void)i.ask("INIT:MCAR;*OPC");
  i.console.send("\x03");
  i.poll(2);
  EXPECT_TRUE(i.instrument->is_working()) << "what INITiate began goes on";
  (void)i.ask("ABOR");
  EXPECT_EQ(i.ask("*ESR?"), "128") << "*OPC does not wait any more: power on only";
}

TEST(InstrumentDeviceClear, ComesAsABreakOfTheLine) {
  InstrumentBench i;
  i.console.send("INIT;*OPC?\nSOUR:LEV 1");
  i.poll(20);
  i.console.send_break();
  i.console.send("0\nSYST:VERS?\n");
  ASSERT_TRUE(i.settle());
  EXPECT_EQ(i.console.receive(), "1999.0\n");
  EXPECT_EQ(i.errors().substr(0, 5), "-110,") << "what is left of that message is none";
  EXPECT_EQ(i.ask("SOUR:LEV?"), "1");
}

// IEEE 488.2, 10.18: only power on, device clear, *CLS and *RST end what *OPC waits for.
TEST(InstrumentConnections, DoNotEndWhatOpcWaitsFor) {
  InstrumentBench i;
  (void)i.ask("*CLS;INIT;*OPC");
  i.console.connect(false);
  i.poll(20);
  i.console.connect(true);
  ASSERT_TRUE(i.instrument->is_working());
  EXPECT_EQ(i.ask("*ESR?"), "0");
  ASSERT_TRUE(i.finish());
  EXPECT_EQ(i.ask("*ESR?"), "1");
}

// What its sender has left without an end.
TEST(InstrumentConnections, HalfAMessageIsNotExecuted) {
  InstrumentBench i;
  i.console.send("SOUR:LEV 10");
  i.poll(20);
  i.console.connect(false);
  i.poll(2);
  i.console.connect(true);
  i.poll(20);
  EXPECT_EQ(i.ask("SOUR:LEV?"), "1");
  EXPECT_EQ(i.errors(), "");
}

TEST(InstrumentQueries, AreKeptForAReaderThatPauses) {
  InstrumentBench i({}, 64);
  i.console.wait_for_reader();
  std::string expected;
  std::string sent;
  for (int n = 0; n < 1500; ++n) {
    sent += "*IDN?\n";
    expected += "emax,test,4711,0.1.0\n";
  }
  std::string answer;
  for (int n = 0; n < 100'000 && answer.size() < expected.size(); ++n) {
    sent.erase(0, i.console.send_what_fits(sent));
    i.poll();
    answer += n > 50'000 ? i.console.receive() : "";  // For the first 5 s nothing is read.
  }
  EXPECT_EQ(answer, expected);
  EXPECT_EQ(i.errors(), "");
}

TEST(InstrumentQueries, CanBeDroppedWhenNobodyReads) {
  InstrumentBench i({}, 64);
  i.send("DIAG:RAND? 1000000");
  for (std::size_t n = 0; n < app::scpi::InputBuffer::kCapacity / 4; ++n) {
    i.console.send("*ESR?\n*CLS\n");  // More than the memory holds, and nobody takes it.
    i.poll(20);
  }
  i.poll(20'000);
  i.console.receive();
  for (int n = 0; n < 10'000; ++n) {
    i.poll(20);
    i.console.receive();
  }
  i.send("*CLS");
  EXPECT_EQ(i.ask("*IDN?"), "emax,test,4711,0.1.0");
}

TEST(InstrumentSweep, KeepsPointsOnAbort) {
  InstrumentBench i;
  (void)i.ask("INIT");
  for (int n = 0; n < 1'000'000 && i.ask("SYST:PROG?").substr(0, 2) < "50"; ++n) {
  }
  (void)i.ask("ABOR");
  EXPECT_TRUE(i.drive_is_at_zero());
  const std::vector<double> points = i.numbers("FETC:FRES?");
  ASSERT_GE(points.size(), 6U);
  EXPECT_LT(points[0], 5.0);
  EXPECT_EQ(points.size(), 1U + 5 * static_cast<std::size_t>(points[0]));
  EXPECT_EQ(points[1], 200.0);
  if (points[0] >= 3.0) {
    EXPECT_NE(i.ask("CALC:IDEN?"), "");
    EXPECT_EQ(i.errors(), "-230,\"Data corrupt or stale;fit of a sweep that ended early\"\n");
  }
  (void)i.ask(kPaperModel);
  EXPECT_EQ(i.numbers("FETC:FRES?"), points) << "they stay beside a device from elsewhere";
  EXPECT_EQ(i.ask("TRAC:FRES:CLE;POIN?"), "0");
  EXPECT_EQ(i.ask("FETC:FRES?"), "");
  EXPECT_EQ(i.errors(), "-230,\"Data corrupt or stale;no points: INIT:SWE or TRAC:FRES:DATA\"\n");
}

TEST(InstrumentSweep, ShowsItsPointsWhileItRuns) {
  InstrumentBench i;
  (void)i.ask("INIT");
  for (int n = 0; n < 1'000'000 && i.ask("TRAC:FRES:POIN?") < "2"; ++n) {
  }
  ASSERT_TRUE(i.instrument->is_sweeping());
  const std::vector<double> second = i.numbers("FETC:FRES:POIN? 2");
  EXPECT_EQ(i.ask("FETC:FRES:POIN? 5"), "");
  EXPECT_EQ(i.ask("FETC:FRES:POIN? 0"), "");
  EXPECT_EQ(i.errors().substr(0, 66),
            "-230,\"Data corrupt or stale;no such point: TRAC:FRES:POIN?\"\n-222,\"");
  EXPECT_TRUE(i.instrument->is_sweeping()) << "nothing of it waits or disturbs";
  ASSERT_TRUE(i.finish());
  const std::vector<double> all = i.numbers("FETC:FRES?");
  ASSERT_EQ(all.size(), 26U);
  ASSERT_EQ(second.size(), 5U);
  for (const std::size_t field : {0U, 1U, 2U}) {
    EXPECT_EQ(second[field], all[6 + field]) << "only the uncertainties come at the end";
  }
  EXPECT_EQ(i.numbers("FETC:FRES:POIN? 2"), std::vector<double>(&all[6], &all[11]));
}

TEST(InstrumentSweep, FindsTheDeviceOfTheBench) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  const std::vector<double> device = i.numbers("CALC:IDEN?");
  ASSERT_EQ(device.size(), 8U);
  // Within four of its own standard uncertainties.
  EXPECT_NEAR(device[0], 1.037, 4.0 * device[3]);
  EXPECT_NEAR(device[1], 4073.0, 4.0 * device[4]);
  EXPECT_NEAR(device[2], 0.3182, 4.0 * device[5]);
  // Points of a sweep and others do not mix.
  (void)i.ask("TRAC:FRES:DATA 6000,1,-90,0.1,1");
  EXPECT_EQ(i.errors(), "-221,\"Settings conflict;points of a sweep: TRAC:FRES:CLE first\"\n");
  // A device given by its parameters takes over, and the points stay.
  const std::string points = i.ask("FETC:FRES?");
  EXPECT_EQ(i.ask("CALC:MOD 2,4000,0.3;MOD?").substr(0, 7), "2,4000,");
  EXPECT_EQ(i.ask("TRAC:FRES:POIN?"), "5");
  EXPECT_EQ(i.ask("FETC:FRES?"), points) << "with the part of u that is common to all of them";
  EXPECT_EQ(i.numbers("CALC:IDEN?"), device);
  EXPECT_EQ(i.numbers("CALC:MOD?")[0], device[0]);
}

struct FaultCase {
  sim::FaultKind kind;
  const char* error;
  const char* questionable;
  std::uint64_t at_frame = 40'000;  ///< One point has been measured by then, at 200 Hz.

  friend void PrintTo(const FaultCase& fault, std::ostream* out) {
    *out << sim::name_of(fault.kind);
  }
};

constexpr FaultCase kFaults[] = {
    {sim::FaultKind::kLostBlock, "-240,\"Hardware error;lost block: ", "4"},
    {sim::FaultKind::kLateBlock, "-240,\"Hardware error;late block: ", "4"},
    {sim::FaultKind::kStuckChannel, "-240,\"Hardware error;stuck channel: ", "1"},
    {sim::FaultKind::kSaturation, "-240,\"Hardware error;saturated channel: ", "1"},
    {sim::FaultKind::kUnpluggedReference, "-240,\"Hardware error;no reference: ", "1"},
    {sim::FaultKind::kUnpluggedDevice, "-240,\"Hardware error;no device: ", "1"},
    {sim::FaultKind::kSwappedChannels, "-240,\"Hardware error;swapped channels: ", "256"},
    {sim::FaultKind::kInvertedPolarity, "-240,\"Hardware error;inverted polarity: ", "64", 60'000},
    {sim::FaultKind::kDcDrift, "-240,\"Hardware error;DC drift: ", "1"},
};

class InstrumentFaults : public testing::TestWithParam<FaultCase> {};

INSTANTIATE_TEST_SUITE_P(All, InstrumentFaults, testing::ValuesIn(kFaults),
                         [](const auto& one) { return std::to_string(one.index); });

TEST_P(InstrumentFaults, AreErrorsWithTheDriveAtZero) {
  sim::BenchSettings settings;
  settings.fault = {GetParam().kind, GetParam().at_frame};
  InstrumentBench i(settings);
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  EXPECT_TRUE(i.drive_is_at_zero());
  const std::string error = i.ask("SYST:ERR?");
  EXPECT_EQ(error.substr(0, std::string(GetParam().error).size()), GetParam().error);
  EXPECT_EQ(i.errors(), "") << "one fault, one error";
  EXPECT_EQ(i.ask("STAT:QUES:COND?"), GetParam().questionable);
  const std::vector<double> points = i.numbers("FETC:FRES?");
  ASSERT_GE(points.size(), 6U) << "what was measured before stays";
  EXPECT_EQ(points[1], 200.0);
  const bool has_fit = points[0] >= 3.0;
  EXPECT_EQ(i.ask("CALC:IDEN?").empty(), !has_fit);
  EXPECT_EQ(i.errors(), has_fit ? "-230,\"Data corrupt or stale;fit of a sweep that ended early\"\n"
                                : "-230,\"Data corrupt or stale;a fit needs 3 points or more\"\n");
}

// Hum at the check frequency, by which all points are judged, ends the sweep.
TEST(InstrumentSweep, NamesHum) {
  sim::BenchSettings settings;
  settings.hum_v = 0.05;
  settings.hum_hz = 50.0;
  InstrumentBench i(settings);
  EXPECT_EQ(i.ask("SWE:CHEC 50;:INIT;*OPC?"), "1");
  EXPECT_EQ(i.errors(), "-240,\"Hardware error;mains hum: change SWE:FREQ, CHEC, CYCL\"\n");
  EXPECT_EQ(i.ask("STAT:QUES:COND?"), "256");
}

// The fit of what was measured before the fault is that of the same points from elsewhere, with one
// warning, and the fault stays in question.
TEST(InstrumentSweep, FitsThePointsBeforeAFault) {
  sim::BenchSettings settings;
  settings.fault = {sim::FaultKind::kUnpluggedDevice, 60'000};
  InstrumentBench i(settings);
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  EXPECT_EQ(i.errors(), "-240,\"Hardware error;no device: check its cable\"\n");
  const std::vector<double> points = i.numbers("FETC:FRES?");
  ASSERT_GE(points[0], 3.0);
  const std::vector<double> fit = i.numbers("CALC:IDEN?");
  ASSERT_EQ(fit.size(), 8U);
  EXPECT_EQ(fit[7], 2.0 * points[0] - 3.0) << "two equations for each point, three parameters";
  EXPECT_NEAR(fit[0], 1.037, 4.0 * fit[3]);
  EXPECT_NEAR(fit[1], 4073.0, 4.0 * fit[4]);
  EXPECT_EQ(i.errors(), "-230,\"Data corrupt or stale;fit of a sweep that ended early\"\n");
  EXPECT_EQ(i.ask("STAT:QUES:COND?"), "1");
  EXPECT_NE(i.ask("CALC:ENER?"), "");
  EXPECT_EQ(i.errors(), "") << "one warning is enough";
}

// A sweep that ends well and yet cannot be right: -230 by itself, bit 8, and a line in the JSON.
struct DoubtCase {
  const char* setup;
  sim::Fault fault;
  const char* error;  ///< Its first word; null if there is no doubt.
  const char* json;
};

constexpr const char* kOffSheet = "the device is 20 % or more off its data sheet";
constexpr const char* kHasChanged = "the check's ratio has changed";
constexpr sim::Fault kLateGainStep = {sim::FaultKind::kGainStep, 70'000};

constexpr DoubtCase kDoubts[] = {
    {"*CLS", {}, nullptr, nullptr},
    {"REF:SENS 0.05", {}, "S is ", kOffSheet},
    {"REF:SENS 0.2", {}, "S is ", kOffSheet},
    {"DEV:GAIN 2", {}, "S is ", kOffSheet},
    {"REF:SENS 0.05;:DEV:SENS 0", {}, nullptr, nullptr},  // Nothing to contradict.
    {"*CLS", kLateGainStep, "check's ", kHasChanged},
    {"DEV:SENS 0", kLateGainStep, "check's ", kHasChanged},
};

TEST(InstrumentSweep, SaysByItselfWhatCannotBeRight) {
  constexpr const char* kStale = "-230,\"Data corrupt or stale;";
  for (const DoubtCase& doubt : kDoubts) {
    SCOPED_TRACE(doubt.setup);
    sim::BenchSettings settings;
    settings.fault = doubt.fault;
    InstrumentBench i(settings);
    EXPECT_EQ(i.ask(doubt.setup), "");
    EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
    const std::string errors = i.errors();
    const std::string expected = doubt.error != nullptr ? kStale + std::string(doubt.error) : "";
    EXPECT_EQ(errors.substr(0, expected.empty() ? errors.size() : expected.size()), expected);
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), doubt.error != nullptr ? 1 : 0);
    EXPECT_EQ(i.ask("STAT:QUES:COND?"), doubt.error != nullptr ? "256" : "0");
    EXPECT_EQ(i.ask("STAT:QUES?"), doubt.error != nullptr ? "256" : "0") << "an event, too";
    const std::string json = i.ask("FETC:JSON?");
    for (const char* words : {kOffSheet, kHasChanged}) {
      EXPECT_EQ(json.find(words) != std::string::npos, words == doubt.json) << words;
    }
  }
}

// The next sweep is judged by itself.
TEST(InstrumentSweep, TakesItsDoubtBack) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("DEV:GAIN 2;:INIT;*OPC?;:STAT:QUES:COND?"), "1;256");
  EXPECT_EQ(i.ask("*CLS;:DEV:GAIN 1;:INIT;*OPC?;:STAT:QUES:COND?"), "1;0");
  EXPECT_NE(i.ask("CALC:IDEN?"), "");
  EXPECT_EQ(i.errors(), "");
}

// Points that differ by more than is stated: the sweep cannot know, the fit of its points does.
// 0.5 % of the device's voltage in the other channel, of which nothing is stated, is 100 times what
// the points of a quiet bench are uncertain by.
TEST(InstrumentSweep, SaysByItselfThatTheFitIsPoor) {
  sim::BenchSettings settings;
  settings.noise_v = 1e-4;
  settings.crosstalk_expanded_percent = 1.0;
  InstrumentBench i(settings);
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  EXPECT_EQ(i.errors(), "");
  EXPECT_EQ(i.ask("STAT:QUES:COND?"), "0");
  const std::vector<double> fit = i.numbers("CALC:IDEN?");
  ASSERT_EQ(fit.size(), 8U);
  ASSERT_GT(fit[6], 100.0 * fit[7]) << "chi-square of a bench that shows it";
  const std::string error = i.ask("SYST:ERR?");
  EXPECT_EQ(error.substr(0, 44), "-230,\"Data corrupt or stale;chi2 is high: an") << error;
  EXPECT_EQ(i.ask("STAT:QUES:COND?"), "256");
  EXPECT_NE(i.ask("CALC:ENER?"), "");
  EXPECT_EQ(i.errors(), "") << "once is enough";
  EXPECT_NE(i.ask("FETC:JSON?").find("chi2/dof is above what one fit in a hundred exceeds"),
            std::string::npos);
}

// A shaker that was stopped in mid-sweep swings on its suspension for a while: that is neither a
// drift nor noise.
TEST(InstrumentSweep, BeginsAnewRightAfterAnAbort) {
  for (const int polls : {700, 850, 1000, 1100}) {
    SCOPED_TRACE(polls);
    InstrumentBench i;
    EXPECT_EQ(i.ask("SOUR:LEV 15;:INIT;*OPC?"), "1");
    const double noise_v = i.instrument->sequencer().sweep().inputs.silent_reference.noise_v;
    EXPECT_EQ(i.ask("INIT"), "");
    i.poll(polls);
    ASSERT_TRUE(i.instrument->is_sweeping());
    EXPECT_GT(std::abs(i.instrument->sequencer().sweep().check_before.re), 0.0) << "it is driven";
    EXPECT_EQ(i.ask("ABOR;:INIT;*OPC?"), "1");
    EXPECT_EQ(i.errors(), "");
    EXPECT_NEAR(i.instrument->sequencer().sweep().inputs.silent_reference.noise_v, noise_v,
                0.1 * noise_v);
  }
}

TEST(InstrumentSweep, RefusesWhatTheBenchCannotDo) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("SWE:FREQ 100,200,39999"), "");
  EXPECT_EQ(i.ask("SWE:FREQ 100,200,40000"), "");
  EXPECT_EQ(i.errors(),
            "-221,\"Settings conflict;sweep frequencies: above 0 and below the sample rate over "
            "2.5\"\n");
  EXPECT_EQ(i.ask("SOUR:LEV 21"), "");
  EXPECT_EQ(i.errors().substr(0, 4), "-221");
  // A period of 10 s is the longest that is recorded.
  EXPECT_EQ(i.ask("SWE:CHEC 0.1"), "");
  EXPECT_EQ(i.errors(), "");
  EXPECT_EQ(i.ask("SWE:CHEC 0.0999"), "");
  EXPECT_EQ(i.errors().substr(0, 4), "-222");
  EXPECT_EQ(i.ask("SWE:CHEC?"), "1.0E-1");
}

TEST(InstrumentWatchdog, IsKickedByEveryPoll) {
  InstrumentBench i;
  i.poll(5000);
  EXPECT_TRUE(i.watchdog.running());
  EXPECT_FALSE(i.watchdog.bitten());
}

TEST(InstrumentWatchdog, ThatDoesNotStartIsToldAndNothingIsMeasured) {
  const char* const words =
      "-240,\"Hardware error;the watchdog does not start: no sweep; switch the board off and "
      "on\"\n";
  InstrumentBench i;
  ManualWatchdog dead(100'000);
  dead.break_down();
  i.other_watchdog = &dead;
  i.switch_on();
  EXPECT_EQ(i.errors(), words);
  EXPECT_EQ(i.ask("INIT"), "");
  EXPECT_FALSE(i.instrument->is_working());
  EXPECT_EQ(i.errors(), words);
  EXPECT_EQ(i.ask("*TST?"), "0");
}

TEST(InstrumentWatchdog, ThatIsNotThereForbidsNoSweep) {
  InstrumentBench i;
  ManualWatchdog none(0);
  i.other_watchdog = &none;
  i.switch_on();
  EXPECT_EQ(i.errors(), "");
  (void)i.ask("INIT");
  EXPECT_TRUE(i.instrument->is_working());
}

TEST(InstrumentWatchdog, ThatHasResetTheBoardIsTold) {
  InstrumentBench i;
  ManualWatchdog after_reset(100'000, true);
  i.other_watchdog = &after_reset;
  i.switch_on();
  EXPECT_EQ(
      i.errors(),
      "-310,\"System error;the watchdog has reset the board: its program hung, or had stopped "
      "in a fault\"\n");
}

// The reset leads the drive to zero, and the shaker swings on as after an abort.
TEST(InstrumentWatchdog, SweepAfterItsResetWaitsForRest) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("SOUR:LEV 15;:INIT;*OPC?"), "1");
  const double noise_v = i.instrument->sequencer().sweep().inputs.silent_reference.noise_v;
  EXPECT_EQ(i.ask("INIT"), "");
  i.poll(850);
  ASSERT_TRUE(i.instrument->is_sweeping());
  EXPECT_GT(std::abs(i.instrument->sequencer().sweep().check_before.re), 0.0) << "it is driven";
  (void)i.bench.stop();
  ManualWatchdog after_reset(100'000, true);
  i.other_watchdog = &after_reset;
  i.switch_on();
  EXPECT_EQ(i.errors().substr(0, 4), "-310");
  EXPECT_EQ(i.ask("SOUR:LEV 15;:INIT;*OPC?"), "1");
  EXPECT_EQ(i.errors(), "");
  EXPECT_NEAR(i.instrument->sequencer().sweep().inputs.silent_reference.noise_v, noise_v,
              0.1 * noise_v);
}

}  // namespace
}  // namespace emax
