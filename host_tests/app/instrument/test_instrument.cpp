// The commands of the instrument: each with its answer, its wrong input, and what it makes stale.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/app/report/report.hpp"

#include "support/evaluations.hpp"
#include "support/instrument_bench.hpp"
#include "support/json_reader.hpp"
#include "support/string_sink.hpp"
#include "support/table1.hpp"

namespace emax {
namespace {

using test::InstrumentBench;

constexpr char kPaperModel[] = "CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004";

std::string error_of(InstrumentBench& i, const std::string& command) {
  EXPECT_EQ(i.ask(command), "");
  const std::string error = i.ask("SYST:ERR?");
  EXPECT_EQ(i.ask("SYST:ERR?"), "0,\"No error\"") << "after " << error;
  return error;
}

TEST(Instrument, SaysWhatItIs) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("*IDN?"), "emax,test,4711,0.1.0");
  EXPECT_EQ(i.ask("SYST:VERS?"), "1999.0");
  EXPECT_EQ(i.ask("*ESR?"), "128");  // Power on.
  EXPECT_EQ(i.ask("*TST?"), "0");
  EXPECT_EQ(i.ask("DIAG:MEM?"), "0,0,0");
  EXPECT_EQ(i.ask("DIAG:CONV?"), "9.91E37");
  EXPECT_EQ(i.ask("SYST:PROG?"), "100,\"idle\"");
  EXPECT_EQ(i.errors(), "");
}

// Each setting: command, value to set, its answer, the default's answer, and a value that is
// refused. Defaults are those of the options of `emax report`.
struct SettingCase {
  const char* command;
  const char* value;
  const char* answer;
  const char* by_default;
  const char* refused;
};

constexpr SettingCase kSettings[] = {
    {"CALC:FILT:ORD", "15", "15", "10", "16"},
    {"CALC:FILT:FREQ", "2 KHZ", "2000", "1000", "0"},
    {"CALC:FILT:GAIN", "1.5", "1.5", "AUTO", "-1"},
    {"CALC:FILT:GAIN", "TRACK", "TRAC", "AUTO", "MANUAL"},
    {"CALC:ENER:TIME", "4ms", "4.0E-3", "2.0E-3", "0"},
    {"CALC:ENER:LIM", "2", "2", "AUTO", "0"},
    {"CALC:ENER:CRIT", "DIFFERENCE", "DIFF", "ISE", "BOTH"},
    {"CALC:ENER:METH", "pap", "PAP", "BEST", "WORST"},
    {"CALC:ENER:STEP", "4US", "4.0E-6", "2.0E-6", "-1US"},
    {"CALC:ENER:ITER", "31", "31", "30", "1001"},
    {"CALC:MCAR:TRI", "5000", "5000", "200000", "999"},
    {"CALC:MCAR:SEED", "1,2,3,4", "1,2,3,4", "123456789,345678901,567890123,789012345", "0,1,1,1"},
    {"CALC:MCAR:PROB", "0.99", "9.9E-1", "9.5E-1", "1"},
    {"CALC:MCAR:DIST", "NORM", "NORM", "BOX", "LOG"},
    {"CALC:MCAR:ADAP", "ON", "1", "0", "MAYBE"},
    {"CALC:MCAR:BIRG", "1", "1", "0", "MAYBE"},
    {"CALC:MCAR:GEN", "WH1982", "WH1982", "WH2006", "WH2007"},
    {"SENS:REF:SENS", "0.2,1", "2.0E-1,1", "1.0E-1,5.0E-1", "0.1,51"},
    {"SWE:FREQ", "100,1KHZ,5e3", "100,1000,5000", "200,1000,2500,4000,5500", "1000,100,200"},
    {"SWE:CYCL", "5", "5", "3", "0"},
    {"SWE:SETT", "20 MS", "2.0E-2", "1.0E-2", "11"},
    {"SOUR:LEV", "2", "2", "1", "0"},
    {"SOUR:LIM", "30 M/S2", "30", "20", "0"},
    {"SOUR:SLEW", "200000", "200000", "100000", "1"},
    {"SOUR:LIM:VOLT", "4", "4", "5", "11"},
    {"SOUR:FULL", "8", "8", "0", "4"},
    {"SWE:REP", "4", "4", "3", "17"},
    {"SWE:CHEC", "80 HZ", "80", "160", "50KHZ"},
    {"REF:GAIN", "20,0.25", "20,2.5E-1", "10,0", "0"},
    {"DEV:SENS", "0.25", "2.5E-1", "1.02", "-1"},
    {"REF:FULL", "12", "12", "0", "-1"},
    {"DEV:FULL", "12", "12", "0", "-1"},
    {"CLOC:UNC", "25", "25", "0", "-1"},
    {"CROS:UNC", "0.5", "5.0E-1", "0", "51"},
    {"LIN:UNC", "0.5", "5.0E-1", "0", "51"},
    {"CORR:RAT", "1.25,0.5", "1.25,5.0E-1", "1,0", "11"},
};

TEST(Instrument, SetsAnswersAndRefusesEachSetting) {
  for (const SettingCase& one : kSettings) {
    SCOPED_TRACE(one.command);
    InstrumentBench i;
    const std::string command = one.command;
    EXPECT_EQ(i.ask(command + "?"), one.by_default);
    EXPECT_EQ(i.ask(command + " " + one.value), "");
    EXPECT_EQ(i.ask(command + "?"), one.answer);
    const std::string error = error_of(i, command + " " + one.refused);
    EXPECT_EQ(error.substr(0, 1), "-") << error;
    EXPECT_EQ(i.ask(command + "?"), one.answer) << "a refused value changes nothing";
    EXPECT_EQ(i.ask("*RST"), "");
    EXPECT_EQ(i.ask(command + "?"), one.by_default);
    EXPECT_EQ(i.errors(), "");
  }
}

// The value itself, of those that are answered with their uncertainty.
std::string first_of(const std::string& answer) { return answer.substr(0, answer.find(',')); }

TEST(Instrument, KnowsTheLimitsOfEverySettingThatIsANumber) {
  InstrumentBench i;
  for (const auto& row : app::Instrument::commands()) {
    if ((row.flags & app::scpi::kQueryLimits) == 0) {
      continue;
    }
    SCOPED_TRACE(row.pattern);
    std::string command;
    for (const char* c = row.pattern; *c != '\0'; ++c) {
      command += *c == '[' || *c == ']' ? "" : std::string(1, *c);
    }
    const std::vector<double> least = i.numbers(command + "? MIN");
    const std::vector<double> most = i.numbers(command + "? MAX");
    const std::string by_default = i.ask(command + "? DEF");
    ASSERT_EQ(least.size() + most.size(), 2U);
    EXPECT_LT(least[0], most[0]);
    EXPECT_EQ(first_of(i.ask(command + "?")), by_default);
    if (by_default != "AUTO") {
      EXPECT_LE(least[0], std::stod(by_default));
      EXPECT_LT(std::stod(by_default), most[0]);
    }
    EXPECT_EQ(first_of(i.ask(command + " MAX;:" + command + " DEF;:" + command + "?")), by_default);
    // A maximum is one that can be set; that of the probability needs more trials.
    const std::string errors = i.errors();
    EXPECT_TRUE(errors.empty() || command == "CALCulate:MCARlo:PROBability") << errors;
  }
}

// MINimum and MAXimum are what can be set now, beside the other settings. By hand: the converter's
// full scale is 10 V and its rate 1e5/s; the drive comes to zero within 256 frames, with 1e-6 to
// spare.
TEST(Instrument, TakesTheLimitsThatOtherSettingsLeave) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("SOUR:LEV? MAX;LEV MAX;LEV?"), "20;20");
  EXPECT_EQ(i.ask("SOUR:LIM 30;:SOUR:LEV MAXIMUM;LEV?;LIM? MIN"), "30;30");
  EXPECT_EQ(i.ask("SOUR:LEV 2;LIM MIN;LIM?;LEV? MAX;LEV MIN;LEV?"), "2;2;1.0E-9");
  EXPECT_EQ(i.ask("SOUR:LIM:VOLT? MAX;VOLT MAX;VOLT?"), "10;10");
  EXPECT_EQ(i.ask("SOUR:LIM:VOLT 5;:SOUR:FULL 8;LIM:VOLT? MAX"), "8");
  EXPECT_NEAR(i.numbers("SOUR:SLEW? MIN")[0], 5.0 / 256.0 * 1e5 * (1.0 + 1e-6), 1e-9);
  EXPECT_EQ(i.ask("SOUR:SLEW MIN;:SWE:CHEC MAX;:SWE:CHEC MIN;CHEC?"), "1.0E-1");
  EXPECT_LT(i.numbers("SWE:CHEC? MAX")[0], 4e4);
  EXPECT_GT(i.numbers("SWE:CHEC? MAX")[0], 4e4 - 1e-6);
  EXPECT_EQ(i.errors(), "");
}

TEST(Instrument, TakesTheDefaultsOfTheSweepFromTheBoard) {
  InstrumentBench i;
  i.sweep.level_mps2 = 3.0;
  i.sweep.settle_s = 0.5;
  i.sweep.cycles = 7;
  i.sweep.reference.sensitivity[0] = 0.25;
  EXPECT_EQ(
      i.ask("SOUR:LEV DEF;LEV?;LEV? DEF;:SWE:SETT DEF;SETT?;CYCL DEF;CYCL?;:REF:SENS DEF;SENS?"),
      "3;3;5.0E-1;7;2.5E-1,5.0E-1");
  EXPECT_EQ(i.ask("*RST;:SOUR:LEV?;:SWE:CYCL?"), "3;7");
}

TEST(Instrument, KeepsAnUncertaintyThatIsNotGiven) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("CORR:RAT 1.5,0.25;RAT 1.25;RAT?"), "1.25,2.5E-1");
  EXPECT_EQ(i.ask("CORR:RAT DEF,DEF;RAT?;RAT? MAX"), "1,0;10");
  EXPECT_EQ(error_of(i, "CORR:RAT 1.5,51"), "-222,\"Data out of range;51\"");
  EXPECT_EQ(i.ask("CORR:RAT?"), "1,0");
  EXPECT_EQ(i.numbers("DEV:GAIN?"), (std::vector<double>{1.0, 0.1}));
  EXPECT_EQ(i.ask("DEV:GAIN 0.5"), "");
  EXPECT_EQ(i.numbers("DEV:GAIN?"), (std::vector<double>{0.5, 0.1}));
  EXPECT_EQ(i.numbers("CORR:SKEW?"), (std::vector<double>{1.25e-6, 0.0}));
  EXPECT_EQ(i.ask("CORR:SKEW 3 US,2 NS"), "");
  const std::vector<double> skew = i.numbers("CORR:SKEW?");
  ASSERT_EQ(skew.size(), 2U);
  EXPECT_NEAR(skew[0], 3e-6, 1e-21);  // A multiplier rounds.
  EXPECT_NEAR(skew[1], 2e-9, 1e-24);
  EXPECT_EQ(error_of(i, "CORR:SKEW 2MS"), "-222,\"Data out of range;2MS\"");
  EXPECT_EQ(i.numbers("MOUN:UNC?"), std::vector<double>{0.2});
  EXPECT_EQ(i.ask("MOUN:UNC 0.5 PCT;UNC?"), "5.0E-1");
}

TEST(Instrument, TakesTheReferenceOverFrequency) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("REF:TABL 10,0.25,1000,0.5,5000,0.75;SENS?"), "2.5E-1,5.0E-1");
  EXPECT_EQ(i.ask("REF:TABL:CLE;:REF:TABL?"), "0,2.5E-1");
  EXPECT_EQ(i.ask("REF:TABL 10,0.25,1000,0.5;TABL 0,0.125;TABL?"),
            "0,1.25E-1");  // As it is answered.
  EXPECT_EQ(i.ask("REF:TABL 0,0.25;TABL?"), "0,2.5E-1");
  // On a board half as many.
  const char* kExpected = emax::kMaxPoints > 64
                              ? "-109,\"Missing parameter;2 to 64 pairs of Hz and V/(m/s2)\""
                              : "-109,\"Missing parameter;2 to 32 pairs of Hz and V/(m/s2)\"";
  EXPECT_EQ(error_of(i, "REF:TABL 10,0.25,1000"), kExpected);
  EXPECT_EQ(error_of(i, "REF:TABL 10,0.25"), kExpected);
  EXPECT_EQ(error_of(i, "REF:TABL 10,0.25,1000,0"),
            "-221,\"Settings conflict;reference sensitivity: above 0, in V/(m/s^2)\"");
  EXPECT_EQ(i.ask("REF:TABL?"), "0,2.5E-1");
}

// As the command line refuses it, and the table of before stays.
TEST(Instrument, RefusesATableOfTheReferenceThatIsNone) {
  const struct {
    const char* table;
    const char* error;
  } cases[] = {
      {"100,0.25,100,0.5",
       "-221,\"Settings conflict;reference table: frequencies in ascending order, each one once\""},
      {"100,0.25,50,0.5",
       "-221,\"Settings conflict;reference table: frequencies in ascending order, each one once\""},
      {"0,0.25,50,0.5", "-221,\"Settings conflict;reference table: frequencies above 0 Hz\""},
      {"-10,0.25,50,0.5", "-222,\"Data out of range;-10\""},
      {"10,0.25,50,-0.5", "-222,\"Data out of range;-0.5\""},
      {"10,0.25,50,1E10", "-222,\"Data out of range;1E10\""},
      {"10,0.25,50,NAN", "-222,\"Data out of range;NAN\""},
      {"10,0,50,0.5", "-221,\"Settings conflict;reference sensitivity: above 0, in V/(m/s^2)\""},
  };
  InstrumentBench i;
  EXPECT_EQ(i.ask("REF:TABL 10,0.25,1000,0.5"), "");
  for (const auto& one : cases) {
    EXPECT_EQ(error_of(i, std::string("REF:TABL ") + one.table), one.error);
    EXPECT_EQ(i.ask("REF:TABL?;SENS?"), "10,2.5E-1,1000,5.0E-1;2.5E-1,5.0E-1") << one.table;
  }
  // One value is the reference at all frequencies: it takes the place of the table.
  EXPECT_EQ(i.ask("REF:SENS 0.3,1;TABL?"), "0,3.0E-1");
  EXPECT_EQ(i.errors(), "");
}

const std::string kMostCells = std::to_string(kMaxCells);

TEST(Instrument, NamesTheSettingThatIsInConflict) {
  InstrumentBench i;
  EXPECT_EQ(error_of(i, "SOUR:LEV 21"),
            "-221,\"Settings conflict;acceleration limit: at least the level, in m/s^2\"");
  EXPECT_EQ(
      error_of(i, "SOUR:SLEW 1"),
      "-221,\"Settings conflict;slew: enough to lead the drive limit to zero within 256 frames, "
      "in V/s\"");
  EXPECT_EQ(error_of(i, "CALC:MCAR:PROB MIN"),
            "-221,\"Settings conflict;probability: larger, so that its share of the trials is at "
            "least one of them\"");
  EXPECT_EQ(error_of(i, "CALC:MCAR:SEED 4294967295,1,1,1"),
            "-221,\"Settings conflict;seed: four whole numbers from 1 to 2147483578, 2147483542, "
            "2147483422 and 2147483122\"");
  // 50000 cells of 2 us, which a board has no room for at all.
  EXPECT_EQ(
      error_of(i, std::string(kPaperModel) + ";ENER:METH PAP;TIME 100ms;:CALC:MCAR?"),
      kMaxCells < 50000
          ? "-221,\"Settings conflict;T needs over " + kMostCells + " cells: shorten it\""
          : "-221,\"Settings conflict;The trials of the paper's method have no room for so many "
            "cells; shorten the time, take a longer step, or give no uncertainties.\"");
}

TEST(Instrument, TakesUnitsWhereverANumberHasOne) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("CALC:MOD 1,4KHZ,0.3,0.01,10HZ,0.001;MOD?").substr(0, 7), "1,4000,");
  EXPECT_EQ(i.ask("TRAC:FRES:DATA 1KHZ,1,-10DEG,0.01,500 MDEG"), "");
  const std::vector<double> point = i.numbers("FETC:FRES?");
  ASSERT_EQ(point.size(), 6U);
  EXPECT_EQ(point[1], 1000.0);
  EXPECT_NEAR(point[3], -10.0, 1e-12);  // Through radians and back.
  EXPECT_NEAR(point[5], 0.25, 1e-12);
  EXPECT_EQ(error_of(i, "CALC:MOD 1V,4000,0.3"), "-138,\"Suffix not allowed;1V\"");
}

// A query that fails answers nothing, not the part before the failure.
TEST(Instrument, ChecksAllTimesBeforeItAnswersTheFirst) {
  InstrumentBench i;
  ASSERT_EQ(i.ask(kPaperModel), "");
  EXPECT_EQ(error_of(i, "CALC:IMP? 1ms,-1"), "-222,\"Data out of range;-1\"");
  EXPECT_EQ(error_of(i, "CALC:IMP? 1ms,2ms,"), "-109,\"Missing parameter\"");
  EXPECT_EQ(i.numbers("CALC:IMP? 1ms,2ms").size(), 2U);
}

TEST(Instrument, SaysThatTheAbsoluteErrorIsOutOfReach) {
  InstrumentBench i;
  ASSERT_EQ(i.ask(kPaperModel), "");
  const std::vector<double> at_one_second = i.numbers("CALC:ENER:TIME 1;:CALC:AERR?");
  ASSERT_EQ(at_one_second.size(), 1U);
  EXPECT_GT(at_one_second[0], 1.0);
  EXPECT_EQ(error_of(i, "CALC:ENER:TIME 100;:CALC:AERR?"),
            "-221,\"Settings conflict;k moves too often for so long a T: shorten it\"");
}

// A peer leaves in the moment in which its fixed point is done: the next one asks for another.
TEST(Instrument, DoesNotAnswerTheFixedPointOfAnother) {
  InstrumentBench i;
  const std::string mine = ";:CALC:FILT:ORD 5;:CALC:ENER:FPA?";
  const std::string answer = i.ask(kPaperModel + mine);
  int polls = 0;
  const auto ask_for_another = [&i] {
    (void)i.ask("CALC:FILT:ORD 10;:CALC:MOD?");
    i.send("CALC:ENER:FPA?");
  };
  for (ask_for_another(); !i.instrument->is_settled() || polls < 2; ++polls) {
    i.poll();
  }
  (void)i.console.receive();
  for (int after = 1; after < polls; ++after) {
    ask_for_another();
    i.poll(after);
    i.console.connect(false);
    i.poll();
    i.console.connect(true);
    (void)i.console.receive();
    ASSERT_EQ(i.ask(kPaperModel + mine), answer) << "after " << after << " of " << polls;
  }
}

// The table is what DESIGN promises to others who script against it.
TEST(Instrument, HasEveryCommandInBothForms) {
  InstrumentBench i;
  for (const auto& row : app::Instrument::commands()) {
    SCOPED_TRACE(row.pattern);
    std::string long_form;
    for (const char* c = row.pattern; *c != '\0'; ++c) {
      long_form += *c == '[' || *c == ']' ? "" : std::string(1, *c);
    }
    std::string short_form;
    for (const char c : long_form) {
      short_form += c >= 'a' && c <= 'z' ? "" : std::string(1, c);
    }
    for (const std::string& form : {long_form, short_form}) {
      // One parameter too many tells a known header from an unknown one without any effect.
      std::string wrong = form + (row.has_set() ? "" : "?");
      wrong += " 'a','b','c','d','e','f','g','h'";
      (void)i.ask(wrong);
      const std::string errors = i.errors();
      EXPECT_EQ(errors.find("-113"), std::string::npos) << errors;
    }
  }
}

TEST(Instrument, NamesWhatIsMissing) {
  InstrumentBench i;
  const char* const queries[] = {"CALC:ENER?",  "CALC:MCAR?",     "CALC:TREN? 1ms,2ms",
                                 "CALC:REP?",   "CALC:AERR?",     "CALC:SETT?",
                                 "CALC:IMP? 0", "CALC:ENER:FPA?", "CALC:ENER:EVAL?",
                                 "CALC:MOD?",   "CALC:MCAR:HIST?"};
  for (const char* query : queries) {
    EXPECT_EQ(error_of(i, query), "-230,\"Data corrupt or stale;no device: CALC:MOD, or INIT:SWE\"")
        << query;
  }
  const char* const of_points[] = {"FETC:FRES?", "CALC:IDEN?", "CALC:IDEN:COV?"};
  for (const char* query : of_points) {
    EXPECT_EQ(error_of(i, query),
              "-230,\"Data corrupt or stale;no points: INIT:SWE or TRAC:FRES:DATA\"")
        << query;
  }
  EXPECT_EQ(error_of(i, "INIT:ENER"),
            "-230,\"Data corrupt or stale;no device: CALC:MOD, or INIT:SWE\"");
  EXPECT_EQ(i.ask("CALC:MOD 1,4000,0.3"), "");
  EXPECT_EQ(error_of(i, "CALC:MCAR?"),
            "-230,\"Data corrupt or stale;no uncertainties: CALC:MOD with uS,..\"");
  EXPECT_EQ(error_of(i, "INIT:MCAR;*WAI"),
            "-230,\"Data corrupt or stale;no uncertainties: CALC:MOD with uS,..\"");
}

// The paper's device: numbers from enumeration and high precision, outside this code.
TEST(Instrument, AnswersWhatThePapersDeviceGives) {
  InstrumentBench i;
  ASSERT_EQ(i.ask(kPaperModel), "");
  EXPECT_EQ(i.ask("CALC:MOD?"), "1.037,4073,3.182E-1,3.0E-3,6,4.0E-4");
  const std::vector<double> energy = i.numbers("CALC:ENER?");
  ASSERT_EQ(energy.size(), 5U);
  EXPECT_NEAR(energy[0], 0.005115251359876, 1e-15);
  EXPECT_NEAR(energy[1], 0.005115251359876 / (1.037 * 1.037 * 0.002), 1e-12);
  EXPECT_GT(energy[2], 0.005134);  // No bound is below the proven one.
  EXPECT_LT(energy[2], 0.00587);
  EXPECT_EQ(energy[3], 1.0);
  EXPECT_NEAR(energy[4], 1.0474909417558e-3, 1e-12);
  EXPECT_NEAR(i.numbers("CALC:ENER:EVAL?")[0], 0.00110693771864, 1e-14);
  EXPECT_NEAR(i.numbers("CALC:ENER:EVAL? 0.68ms,1.49ms")[0], 0.00399063106536, 1e-14);
  EXPECT_NEAR(i.numbers("CALC:SETT?")[0], 1.453582e-3, 1e-9);
  const std::vector<double> k = i.numbers("CALC:IMP? 10us,50us,100us,500us,1ms,2ms");
  const double expected[] = {6199.1624,   17451.1509,  8133.60891,
                             -259.559968, -1744.33268, 424.175752};
  ASSERT_EQ(k.size(), 6U);
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_NEAR(k[n], expected[n], 1e-4);  // The table's last digit.
  }
  const std::vector<double> fixed_point = i.numbers("CALC:ENER:FPA?");
  ASSERT_EQ(fixed_point.size(), 8U);
  EXPECT_EQ(fixed_point[0], 6.0);
  EXPECT_NEAR(fixed_point[1], 0.00381585783775, 1e-14);
  EXPECT_NEAR(fixed_point[7], 0.00448654991209, 1e-14);
  EXPECT_EQ(i.errors(), "");
}

TEST(Instrument, FollowsTheFixedPointAsFarAsItMay) {
  InstrumentBench i;
  ASSERT_EQ(i.ask(std::string(kPaperModel) + ";:CALC:ENER:TIME 10ms"), "");
  const std::vector<double> energies = i.numbers("CALC:ENER:FPA?");
  ASSERT_EQ(energies.size(), 32U);  // The number of iterations, and E_0 to E_30.
  EXPECT_EQ(energies[0], 30.0);
  EXPECT_NEAR(energies[31], 0.0375854265552, 1e-12);
  for (std::size_t n = 2; n < energies.size(); ++n) {
    EXPECT_GE(energies[n], energies[n - 1]) << "integral-square errors never fall";
  }
  ASSERT_EQ(i.ask("CALC:ENER:ITER 2"), "");
  const std::vector<double> short_run = i.numbers("CALC:ENER:FPA?");
  ASSERT_EQ(short_run.size(), 4U);
  EXPECT_EQ(short_run[3], energies[3]);
  EXPECT_EQ(error_of(i, "CALC:ENER:STEP 0.1us;:CALC:ENER:FPA?"),
            "-221,\"Settings conflict;T/step > " + kMostCells + ": shorten T or longer STEP\"");
}

TEST(Instrument, AnswersTheTrialsAndTheTrend) {
  InstrumentBench i;
  ASSERT_EQ(i.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 2000"), "");
  const std::vector<double> trials = i.numbers("CALC:MCAR?");
  ASSERT_EQ(trials.size(), 13U);
  EXPECT_EQ(trials[0], 2000.0);
  // Over the box the maximum is at a corner, 0.0051346992, which random draws only come near.
  EXPECT_GT(trials[1], 0.00513);
  EXPECT_LT(trials[1], 0.0051346993);
  EXPECT_NEAR(trials[2], 1.040, 0.0005);
  EXPECT_LT(trials[5], 2000.0);
  EXPECT_NEAR(trials[7], 1.1e-5, 1e-6);
  EXPECT_LT(trials[8], trials[6]);
  EXPECT_LT(trials[6], trials[9]);
  EXPECT_LE(trials[11] - trials[10], (trials[9] - trials[8]) * (1.0 + 1e-12));
  EXPECT_EQ(trials[12], 0.0);
  const std::vector<double> bins = i.numbers("CALC:MCAR:HIST?");
  ASSERT_EQ(bins.size(), 66U);
  EXPECT_LT(bins[0], trials[8]);
  EXPECT_EQ(bins[1], trials[1]);
  // Each trial once; their mean within half a bin.
  double count = 0.0;
  double moment = 0.0;
  for (std::size_t k = 0; k < 64; ++k) {
    count += bins[k + 2];
    moment += bins[k + 2] * (bins[0] + (bins[1] - bins[0]) * (static_cast<double>(k) + 0.5) / 64.0);
  }
  EXPECT_EQ(count, 2000.0);
  EXPECT_NEAR(moment / count, trials[6], 0.5 * (bins[1] - bins[0]) / 64.0);
  const std::vector<double> trend = i.numbers("CALC:TREN? 2ms,10ms");
  ASSERT_EQ(trend.size(), 4U);
  EXPECT_NEAR(trend[2], 0.005115251359876, 1e-15);
  EXPECT_NEAR(trend[3], 0.03809122131476, 1e-13);
  EXPECT_NEAR(trend[0], (trend[3] - trend[2]) / 0.008, 1e-9);
  EXPECT_EQ(i.numbers("CALC:TREN?"), trend);
  const std::vector<double> shorter = i.numbers("CALC:TREN? 2ms,4ms");
  ASSERT_EQ(shorter.size(), 4U);
  EXPECT_EQ(shorter[2], trend[2]);
  EXPECT_LT(shorter[3], trend[3]);
  EXPECT_EQ(i.errors(), "");
}

TEST(Instrument, DrawsThePublishedNumbersAndGoesOnFromThere) {
  InstrumentBench i;
  const std::vector<double> first = i.numbers("DIAG:RAND? 3");
  ASSERT_EQ(first.size(), 3U);
  EXPECT_NEAR(first[0], 0.75099757068263173, 1e-15);
  EXPECT_NEAR(first[2], 0.32888922619308092, 1e-15);
  EXPECT_NEAR(i.numbers("DIAG:RAND? 1")[0], 0.11645956405699120, 1e-15);
  ASSERT_EQ(i.ask("CALC:MCAR:SEED 123456789,345678901,567890123,789012345"), "");
  const std::vector<double> many = i.numbers("DIAG:RAND? 1000");
  ASSERT_EQ(many.size(), 1000U);
  EXPECT_NEAR(many[99], 0.73211169856915226, 1e-15);
  EXPECT_NEAR(many[999], 0.71003348258806565, 1e-15);
  EXPECT_EQ(error_of(i, "DIAG:RAND? 1000001"), "-222,\"Data out of range;1000001\"");
}

std::string table1_commands() {
  std::string commands;
  for (const std::string& line : test::table1_lines()) {
    commands += "TRAC:FRES:DATA " + line + "\n";
  }
  return commands;
}

// A fit of Table 1 outside this code: S = 1.0079, f0 = 4057.3 Hz, beta = 0.2462, chi-square 8595
// for 81 degrees of freedom.
TEST(Instrument, IdentifiesPointsFromElsewhere) {
  InstrumentBench i;
  i.send(table1_commands());
  ASSERT_TRUE(i.settle());
  EXPECT_EQ(i.ask("TRAC:FRES:POIN?"), "42");
  const std::vector<double> device = i.numbers("CALC:IDEN?");
  ASSERT_EQ(device.size(), 8U);
  EXPECT_NEAR(device[0], 1.00791, 5e-6);
  EXPECT_NEAR(device[1], 4057.25, 5e-3);
  EXPECT_NEAR(device[2], 0.24618, 5e-6);
  EXPECT_NEAR(device[3], 0.00113, 5e-6);
  EXPECT_NEAR(device[4], 2.85, 5e-3);
  EXPECT_NEAR(device[6], 8595.0, 0.5);
  EXPECT_EQ(device[7], 81.0);
  const std::vector<double> covariance = i.numbers("CALC:IDEN:COV?");
  ASSERT_EQ(covariance.size(), 9U);
  EXPECT_NEAR(std::sqrt(covariance[4]), device[4], 1e-12);
  EXPECT_EQ(covariance[1], covariance[3]);
  // Such a fit is questionable.
  EXPECT_EQ(i.ask("STAT:QUES:COND?"), "256");
  const std::vector<double> points = i.numbers("FETC:FRES?");
  ASSERT_EQ(points.size(), 1U + 42 * 5);
  const auto first = test::table1_numbers().front();
  EXPECT_EQ(points[1], first[0]);
  EXPECT_EQ(points[2], first[1]);
  EXPECT_NEAR(points[3], first[2], 1e-12);
  EXPECT_NEAR(points[4], first[3] / 2.0, 1e-12);  // Expanded in, standard out.
  EXPECT_NEAR(points[5], first[4] / 2.0, 1e-12);
}

/// Asks for all points in the form that TRACe takes, and gives them back in pieces of five.
void hand_back(InstrumentBench& i, const std::string& points, const std::string& percent) {
  EXPECT_EQ(i.ask("TRAC:FRES:CLE;:CALC:REF:UNC " + percent), "");
  std::stringstream fields(points);
  std::string field;
  std::string message;
  for (int n = 0; std::getline(fields, field, ','); ++n) {
    message += (n % 5 == 0 ? "TRAC:FRES:DATA " : ",") + field;
    if (n % 5 == 4) {
      EXPECT_EQ(i.ask(message), "");
      message.clear();
    }
  }
}

// A phase that nobody measured is the one of a table of magnitudes, to the last bit, whatever
// degrees its uncertainty comes in.
TEST(Instrument, TakesAnUnknownPhaseAsItIs) {
  InstrumentBench i;
  (void)i.ask("TRAC:FRES:DATA 100,1,0,0.01,114591559.02616465");
  (void)i.ask("TRAC:FRES:DATA 200,1,0,0.01,2e8");
  (void)i.ask("TRAC:FRES:DATA 300,1,0,0.01,360");
  EXPECT_EQ(i.errors(), "");
  const Span<const ResponsePoint> points = i.instrument->sequencer().points().points();
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].u_phase_rad, kUnknownPhase_rad);
  EXPECT_EQ(points[1].u_phase_rad, kUnknownPhase_rad);
  EXPECT_DOUBLE_EQ(points[2].u_phase_rad, std::acos(-1.0));
}

// What FETCh:TRACe? answers is the same device again, with CALC:REF:UNC? or without: what the
// points share is not taken for something that their number makes smaller.
TEST(Instrument, TakesItsOwnPointsBack) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("CLOC:UNC 20;:CORR:SKEW 1.25E-6,1E-8;:CROS:UNC 0.01;:LIN:UNC 0.01"), "");
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  const std::vector<double> measured = i.numbers("CALC:IDEN?");
  ASSERT_EQ(measured.size(), 8U);
  EXPECT_GT(measured[4], 1e-5 * measured[1]) << "the clock's 20 ppm (k = 2) at least";
  EXPECT_GT(measured[3], 0.0025 * measured[0]) << "the reference's 0.5 % (k = 2) at least";
  const std::string points = i.ask("FETC:TRAC?");
  const std::vector<double> fetched = i.numbers("FETC:FRES?");
  const std::vector<double> traced = i.numbers("FETC:TRAC?");
  ASSERT_EQ(traced.size() + 1, fetched.size());
  for (std::size_t k = 0; k < traced.size(); ++k) {
    EXPECT_EQ(traced[k], (k % 5 < 3 ? 1.0 : 2.0) * fetched[k + 1]);
  }
  const std::string percent = i.ask("CALC:REF:UNC?");
  EXPECT_EQ(error_of(i, "CALC:REF:UNC 1").substr(0, 4), "-221") << "it is that of the sweep";
  hand_back(i, points, percent);
  EXPECT_EQ(i.ask("CALC:REF:UNC?"), percent);
  const std::vector<double> again = i.numbers("CALC:IDEN?");
  ASSERT_EQ(again.size(), 8U);
  for (std::size_t k = 0; k < 8; ++k) {
    // A root of a difference of squares, of which the common part is nearly all: 1e-16 times 1e4.
    EXPECT_NEAR(again[k], measured[k], 1e-9 * measured[k]) << k;
  }
  const std::vector<double> back = i.numbers("FETC:TRAC?");
  ASSERT_EQ(back.size(), traced.size());
  for (std::size_t k = 0; k < back.size(); ++k) {
    EXPECT_NEAR(back[k], traced[k], 1e-12 * std::abs(traced[k])) << k;
  }
  // Without it, or given afterwards, it is the same.
  hand_back(i, points, "0");
  EXPECT_EQ(i.ask("CALC:REF:UNC?"), percent);
  const std::vector<double> without = i.numbers("CALC:IDEN?");
  EXPECT_EQ(i.ask("CALC:REF:UNC " + percent), "");
  const std::vector<double> afterwards = i.numbers("CALC:IDEN?");
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_NEAR(without[k], measured[k], 1e-9 * measured[k]) << k;
    EXPECT_NEAR(afterwards[k], measured[k], 1e-9 * measured[k]) << k;
  }
  EXPECT_EQ(error_of(i, "CALC:REF:UNC 20"),
            "-222,\"Data out of range;a point has a smaller U(A)\"");
  EXPECT_EQ(i.ask("CALC:REF:UNC?"), percent);
  EXPECT_EQ(error_of(i, "TRAC:FRES:DATA 9000,1,-90,1e-5,1"),
            "-222,\"Data out of range;U(A) must be above CALC:REF:UNC\"");
  EXPECT_EQ(i.ask("*RST;:CALC:REF:UNC?"), "0");
}

// By hand: 1 % in all and 0.6 % in common leave 0.8 % for each point.
TEST(Instrument, TakesTheCommonPartOutOfPoints) {
  InstrumentBench i;
  (void)i.ask("CALC:REF:UNC 0.6 PCT;:TRAC:FRES:DATA 100,2,-1,0.02,1,200,2,-2,0.02,1");
  const std::vector<double> points = i.numbers("FETC:FRES?");
  ASSERT_EQ(points.size(), 11U);
  EXPECT_NEAR(points[4], 0.01, 1e-15) << "standard, with the common part";
  const FrequencyResponse& table = i.instrument->sequencer().points();
  EXPECT_NEAR(table.points()[0].u_amplitude, 0.008, 1e-15);
  EXPECT_NEAR(table.common()[0], 0.003, 1e-15);
}

TEST(Instrument, SetsEverythingAgainByWhatLrnAnswers) {
  InstrumentBench i;
  const std::string defaults = i.ask("*LRN?");
  EXPECT_LE(defaults.size(), 4096U) << "it must fit into one message";
  EXPECT_EQ(i.ask(":SENS:REF:SENS 0.3,0.7;TABL 10,0.3,1000,0.5;:SENS:SWE:CYCL 4;:SOUR:LEV "
                  "3;:CALC:FILT:GAIN 1.1;"
                  ":CALC:ENER:CRIT BAND;LIM 2;DEL NONE;:CALC:MCAR:SEED 1,2,3,4;ADAP ON;"
                  ":CALC:TREN:TIME 0.001,0.002,0.003;:SENS:SWE:FREQ 100,200,300,400"),
            "");
  EXPECT_EQ(i.errors(), "");
  const std::string changed = i.ask("*LRN?");
  EXPECT_NE(changed, defaults);
  EXPECT_NE(changed.find(";:SENS:SWE:FREQ 100,200,300,400"), std::string::npos) << changed;
  EXPECT_NE(changed.find(";:SENS:REF:TABL 10,3.0E-1,1000,5.0E-1;"), std::string::npos) << changed;
  EXPECT_EQ(i.ask("*RST"), "");
  EXPECT_EQ(i.ask("*LRN?"), defaults);
  EXPECT_EQ(i.ask(changed), "");
  EXPECT_EQ(i.errors(), "");
  EXPECT_EQ(i.ask("*LRN?"), changed);
}

TEST(Instrument, ListsItsHeaders) {
  InstrumentBench i;
  const std::string answer = i.ask("SYST:HELP:HEAD?");
  ASSERT_EQ(answer.substr(0, 2), "#4");
  const std::string lines = answer.substr(6);
  EXPECT_EQ(answer.substr(2, 4), std::to_string(lines.size()));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'),
            static_cast<std::ptrdiff_t>(app::Instrument::commands().size()));
  for (const char* line :
       {"*CLS/nquery/", "*IDN?/qonly/", "*ESE", ":ABORt/nquery/", ":SYSTem:HELP:HEADers?/qonly/",
        ":SOURce:LEVel", "[SENSe:]SWEep:FREQuency"}) {
    EXPECT_NE(("\n" + lines).find(std::string("\n") + line + "\n"), std::string::npos) << line;
  }
}

TEST(Instrument, AnswersAllErrorsAtOnce) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("SYST:ERR:ALL?"), "0,\"No error\"");
  EXPECT_EQ(i.ask("SYST:ERR:CODE:ALL?"), "0");
  (void)i.ask("NO\nSOUR:LEV 0\n*ESE");
  EXPECT_EQ(i.ask("SYST:ERR:CODE:ALL?"), "-113,-222,-109");
  EXPECT_EQ(i.ask("SYST:ERR:CODE?"), "0");
  (void)i.ask("NO\n*ESE");
  EXPECT_EQ(i.ask("SYST:ERR:CODE?"), "-113");
  EXPECT_EQ(i.ask("SYST:ERR:CODE:NEXT?"), "-109");
  EXPECT_EQ(i.ask("SYST:ERR:COUN?"), "0");
  (void)i.ask("NO\n*ESE");
  EXPECT_EQ(i.ask("SYST:ERR:ALL?"), "-113,\"Undefined header;NO\",-109,\"Missing parameter;*ESE\"");
  EXPECT_EQ(i.ask("SYST:ERR:COUN?"), "0");
}

TEST(Instrument, HasTheOtherNamesOfTheSweep) {
  for (const char* start : {"INIT", "INIT:IMM", "INIT:ALL", "INIT:SWE", "INIT:IMM:ALL",
                            "INITIATE:IMMEDIATE:SWEEP", "*TRG"}) {
    InstrumentBench i;
    EXPECT_EQ(i.ask(start), "");
    EXPECT_TRUE(i.instrument->is_sweeping()) << start;
    EXPECT_EQ(i.ask("*OPC?;:TRAC:FRES:POIN?"), "1;5") << start;
    EXPECT_EQ(i.errors(), "") << start;
  }
  InstrumentBench i;
  const std::string points = i.ask("READ:FRES?");
  EXPECT_EQ(points.substr(0, 6), "5,200,");
  EXPECT_EQ(i.ask("FETC:FRES?"), points);
  const std::string others = i.ask("READ:FRES?");
  EXPECT_NE(others, points) << "measured anew";
  EXPECT_EQ(i.ask("*OPT?;:SYST:CAP?"), "SIM;(SENSE&SOURCE&CALCULATE&TRACE)");
  EXPECT_EQ(i.errors(), "");
}

TEST(Instrument, KeepsTheTimesOfTheTrend) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("CALC:TREN:TIME?"), "2.0E-3,4.0E-3,6.0E-3,8.0E-3,1.0E-2");
  EXPECT_EQ(i.ask("CALC:TREN:TIME 1ms,2 MS;TIME?"), "1.0E-3,2.0E-3");
  (void)i.ask(kPaperModel);
  EXPECT_EQ(i.numbers("CALC:TREN?").size(), 4U);
  EXPECT_EQ(error_of(i, "CALC:TREN:TIME 1").substr(0, 4), "-221");
  EXPECT_EQ(i.ask("CALC:TREN:TIME?"), "1.0E-3,2.0E-3");
}

// As results.json has it: what points determine that were not measured here.
TEST(Instrument, TellsInJsonWhatThePointsDetermine) {
  InstrumentBench i;
  const std::string all = "\"determined\": \"all\"";
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  const std::string points = i.ask("FETC:TRAC?");
  (void)i.ask("CALC:IDEN?");
  EXPECT_EQ(i.ask("FETC:JSON?").find(all), std::string::npos);
  (void)i.ask("TRAC:FRES:CLE");
  (void)i.ask("TRAC:FRES:DATA " + points);
  (void)i.ask("CALC:IDEN?");
  EXPECT_NE(i.ask("FETC:JSON?").find(all), std::string::npos);
  EXPECT_EQ(i.errors(), "");
}

// Of trials that the settings have made stale there are neither numbers nor warnings.
TEST(Instrument, WarnsInJsonOfWhatIsThere) {
  InstrumentBench i;
  const std::string few = "\"about\": \"monte_carlo\"";
  (void)i.ask("CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;:CALC:MCAR:TRI 1000");
  (void)i.ask("CALC:MCAR?");
  EXPECT_NE(i.ask("FETC:JSON?").find(few), std::string::npos);
  (void)i.ask("CALC:MCAR:TRI 2000");
  EXPECT_EQ(i.ask("FETC:JSON?").find(few), std::string::npos);
  EXPECT_EQ(i.errors(), "");
}

// The numbers are those of the other queries; what is not there is null.
TEST(Instrument, FetchesEverythingAsJson) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("INIT;*OPC?"), "1");
  const auto fetch = [&i] {
    const std::string answer = i.ask("FETC:JSON?");
    const auto digits = static_cast<std::size_t>(answer[1] - '0');
    EXPECT_EQ(std::stoul(answer.substr(2, digits)), answer.size() - 2 - digits);
    return test::JsonReader(answer.substr(2 + digits));
  };
  const test::JsonReader before = fetch();
  EXPECT_TRUE(before.valid());
  EXPECT_EQ(before.at("model"), "null");
  EXPECT_EQ(before.at("energy"), "null");
  const std::vector<double> fit = i.numbers("CALC:IDEN?");
  const std::vector<double> energy = i.numbers("CALC:ENER?");
  const std::vector<double> points = i.numbers("FETC:TRAC?");
  const test::JsonReader json = fetch();
  EXPECT_TRUE(json.valid());
  EXPECT_EQ(json.number("model.S"), fit[0]);
  EXPECT_EQ(json.number("model.uf0"), fit[4]);
  EXPECT_EQ(json.number("energy.E"), energy[0]);
  EXPECT_EQ(json.number("bench.points"), 5.0);
  EXPECT_EQ(json.at("points[]"), "5");
  EXPECT_EQ(json.number("points[4].f_hz"), points[20]);
  EXPECT_EQ(json.number("points[4].u_amplitude"), points[23]);
  EXPECT_EQ(json.number("sweep.settings.level"), 1.0);
  EXPECT_EQ(json.at("sweep.rows[]"), "5");
  EXPECT_EQ(json.at("monte_carlo"), "null");
}

TEST(Instrument, RefusesPointsAndKeepsTheTable) {
  InstrumentBench i;
  ASSERT_EQ(i.ask("TRAC:FRES:DATA 100,1,0,0.01,1,200,1,-1,0.01,1"), "");
  struct Case {
    const char* numbers;
    const char* error;
  };
  constexpr Case kCases[] = {
      {"300,1,0,0.01", "-109,\"Missing parameter;five numbers for each point\""},
      {"#210aaaaaaaaaa", "-168,\"Block data not allowed;#210aaaaaaaaaa\""},
      {"100,#44000", "-168,\"Block data not allowed;#44000\""},
      {"200,1,0,0.01,1", "-222,\"Data out of range;frequency not above the last one\""},
      {"300,1,0,0,1", "-222,\"Data out of range;uncertainties must be above 0\""},
      {"300,-1,0,0.01,1", "-222,\"Data out of range;frequency, amplitude must be above 0\""},
      {"300,1,361,0.01,1", "-222,\"Data out of range;phase: -360 to 360 degrees\""},
      {"300,1,0,0.01,1,250,1,0,0.01,1",
       "-222,\"Data out of range;frequency not above the last one\""},
  };
  for (const Case& one : kCases) {
    EXPECT_EQ(error_of(i, std::string("TRAC:FRES:DATA ") + one.numbers), one.error);
    EXPECT_EQ(i.ask("TRAC:FRES:POIN?"), "2") << one.numbers;
  }
  EXPECT_EQ(i.ask("TRAC:FRES:CLE;POIN?"), "0");
}

TEST(Instrument, RefusesADeviceThatCannotBe) {
  InstrumentBench i;
  ASSERT_EQ(i.ask(kPaperModel), "");
  for (const char* wrong : {"0,4000,0.3", "1,4000,1", "1,-1,0.3", "1,4000,0.00001"}) {
    EXPECT_EQ(error_of(i, std::string("CALC:MOD ") + wrong),
              "-222,\"Data out of range;S > 0, f0 0.001 to 1E9, beta 1E-4 to < 1\"");
  }
  EXPECT_EQ(error_of(i, "CALC:MOD 1,4000,0.3,-1,0,0"),
            "-222,\"Data out of range;uncertainties must be 0 or more\"");
  EXPECT_EQ(error_of(i, "CALC:MOD 1,4000,0.3,0.1"),
            "-109,\"Missing parameter;three numbers or six\"");
  EXPECT_EQ(error_of(i, "CALC:MOD 1,2,0.3,0,0,0,0"),
            "-108,\"Parameter not allowed;1,2,0.3,0,0,0,0\"");
  EXPECT_EQ(error_of(i, "CALC:MOD #44000"), "-168,\"Block data not allowed;#44000\"");
  EXPECT_EQ(i.numbers("CALC:MOD?")[1], 4073.0);
  // Parameters that only the settings or the method cannot take are the evaluation's to refuse.
  EXPECT_EQ(error_of(i, "CALC:ENER:TIME 2;:CALC:ENER?"),
            "-221,\"Settings conflict;T needs over " + kMostCells + " cells: shorten it\"");
  EXPECT_EQ(error_of(i, "*RST;:CALC:MOD 1,4000,0.3,1,0,0;:CALC:MCAR?"),
            "-221,\"Settings conflict;uncertainties too large for the trials\"");
  EXPECT_EQ(error_of(i, "CALC:MOD 1,4000,0.3;:CALC:TREN? 1ms,2"),
            "-221,\"Settings conflict;a trend time needs over " + kMostCells + " cells\"");
}

TEST(Instrument, SaysWhyPointsGiveNoDevice) {
  struct Case {
    const char* points;
    const char* error;
  };
  constexpr Case kCases[] = {
      {"100,1,0,0.01,1", "-230,\"Data corrupt or stale;a fit needs 3 points or more\""},
      {"100,1,180,0.01,1,1000,1,180,0.01,1,2000,1.1,180,0.01,1",
       "-200,\"Execution error;inverted polarity: add 180 degrees\""},
  };
  for (const Case& one : kCases) {
    InstrumentBench i;
    EXPECT_EQ(error_of(i, std::string("TRAC:FRES:DATA ") + one.points + ";:CALC:IDEN?"), one.error);
    EXPECT_EQ(error_of(i, "CALC:ENER?"), one.error);
  }
}

// Which results a command makes stale; a query of a stale one takes a run of its own.
TEST(Instrument, ForgetsJustWhatAChangeTouches) {
  struct Case {
    const char* command;
    bool energy;
    bool trials;
    bool trend;
  };
  constexpr Case kCases[] = {
      {"CALC:MCAR:TRI 1001", false, true, false},
      {"CALC:MCAR:SEED 1,2,3,4", false, true, false},
      {"CALC:MCAR:PROB 0.9", false, true, false},
      {"CALC:MCAR:DIST NORM", false, true, false},
      {"CALC:MCAR:BIRG ON", false, true, false},
      {"CALC:MCAR:GEN WH1982", false, true, false},
      {"CALC:FILT:ORD 9", true, true, true},
      {"CALC:FILT:FREQ 900", true, true, true},
      {"CALC:FILT:GAIN 1", true, true, true},
      {"CALC:ENER:TIME 2.5ms", true, true, true},
      {"CALC:ENER:LIM 1", true, true, true},
      {"CALC:ENER:CRIT DIFF", true, true, true},
      {"CALC:ENER:METH PAP", true, true, true},
      {"CALC:MOD 1,4000,0.3,0.01,1,0.001", true, true, true},
      {"CALC:MCAR:TRI 1000", false, false, false},  // As it is.
      {"CALC:ENER:STEP 3us", false, false, false},  // Of the other method.
      {"CALC:ENER:ITER 20", false, false, false},
      {"SWE:CYCL 4", false, false, false},
      {"SOUR:LEV 0.5", false, false, false},
      {"*CLS", false, false, false},
  };
  for (const Case& one : kCases) {
    SCOPED_TRACE(one.command);
    InstrumentBench i;
    (void)i.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000;:CALC:TREN? 1ms,1.5ms;MCAR?");
    ASSERT_EQ(i.ask(one.command), "");
    const auto runs = [&i](const char* command) {
      i.send(command);
      i.poll(4);  // A result that is there takes no work.
      const bool works = i.instrument->is_working();
      EXPECT_TRUE(i.finish());
      return works;
    };
    EXPECT_EQ(runs("INIT:ENER"), one.energy);
    EXPECT_EQ(runs("INIT:TREN"), one.trend);
    EXPECT_EQ(runs("INIT:MCAR"), one.trials);
    EXPECT_EQ(i.errors(), "");
  }
}

TEST(Instrument, FirstTrialsThenEnergyIsTheSameAsTheOtherWayRound) {
  InstrumentBench a;
  (void)a.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000");
  const std::string trials = a.ask("CALC:MCAR?");
  const std::string energy = a.ask("CALC:ENER?");
  InstrumentBench b;
  (void)b.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000");
  EXPECT_EQ(b.ask("CALC:ENER?"), energy);
  EXPECT_EQ(b.ask("CALC:MCAR?"), trials);
  EXPECT_EQ(b.ask("CALC:MCAR:TRI 2000;*WAI;TRI 1000;:CALC:MCAR?"), trials);
}

TEST(Instrument, SendsTheReportAsABlock) {
  InstrumentBench i;
  const std::string block =
      i.ask(std::string(kPaperModel) + ";:CALC:MCAR:TRI 1000;:CALC:TREN? 2ms,3ms;REP?");
  const std::size_t at = block.find(";#");
  ASSERT_NE(at, std::string::npos);
  app::Settings settings = emax::app::kDefaultSettings;
  settings.trials = 1000;
  settings.trend_s = {0.002, 0.003};
  settings.trend_count = 2;
  const app::EvaluationResults& evaluation = test::evaluated(test::kTable2, settings);
  test::StringSink sink;
  app::TextWriter out(sink);
  write_report(evaluation, app::ReportContext{}, out);
  EXPECT_EQ(block.substr(at + 1), "#4" + std::to_string(sink.text().size()) + sink.text());
}

TEST(Instrument, KeepsSettingsInFourSlots) {
  InstrumentBench i;
  for (int slot = 0; slot < 4; ++slot) {
    EXPECT_EQ(error_of(i, "*RCL " + std::to_string(slot)),
              "-230,\"Data corrupt or stale;empty or damaged slot: *SAV first\"");
  }
  ASSERT_EQ(i.ask("CALC:ENER:TIME 3ms;LIM 2;:SOUR:LEV 0.7;:CALC:MCAR:SEED 9,8,7,6;*SAV 3"), "");
  ASSERT_EQ(i.ask("*RST;:CALC:FILT:ORD 3;*SAV 0"), "");
  i.switch_on();
  EXPECT_EQ(i.ask("CALC:ENER:TIME?;LIM?;:SOUR:LEV?;:CALC:MCAR:SEED?;:CALC:FILT:ORD?"),
            "2.0E-3;AUTO;1;123456789,345678901,567890123,789012345;10");
  ASSERT_EQ(i.ask("*RCL 3"), "");
  EXPECT_EQ(i.ask("CALC:ENER:TIME?;LIM?;:SOUR:LEV?;:CALC:MCAR:SEED?;:CALC:FILT:ORD?"),
            "3.0E-3;2;7.0E-1;9,8,7,6;10");
  EXPECT_EQ(i.ask("*RCL 0;:CALC:FILT:ORD?"), "3");
  const double energy = i.numbers(std::string(kPaperModel) + ";:CALC:ENER?")[0];
  ASSERT_EQ(i.ask("*RCL 3"), "");
  EXPECT_NE(i.numbers("CALC:ENER?")[0], energy) << "that was with other settings";
  EXPECT_EQ(error_of(i, "*SAV 4"), "-222,\"Data out of range;4\"");
  EXPECT_EQ(error_of(i, "*RCL"), "-109,\"Missing parameter;*RCL\"");
}

// The settings of before are better than none, but must not pass for those of the last *SAV.
TEST(Instrument, SaysThatTheNewestSettingsAreDamaged) {
  InstrumentBench i;
  ASSERT_EQ(i.ask("CALC:ENER:TIME 3ms;*SAV 1;:CALC:ENER:TIME 4ms;*SAV 1"), "");
  i.store.at(3, 30) ^= 1U;
  EXPECT_EQ(error_of(i, "*RCL 1"),
            "-314,\"Save/recall memory lost;a copy is damaged: this one may be older\"");
  EXPECT_EQ(i.ask("CALC:ENER:TIME?"), "3.0E-3");
  ASSERT_EQ(i.ask("*SAV 1;*RST;*RCL 1;:CALC:ENER:TIME?"), "3.0E-3");
  EXPECT_EQ(i.ask("SYST:ERR:COUN?"), "0") << "a new *SAV ends it";
}

TEST(Instrument, AnswersTheInBandErrorAndTheUncertaintyOfTheEnergy) {
  InstrumentBench i;
  ASSERT_EQ(i.ask("CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;:CALC:MCAR:TRI 1000"), "");
  // Nine digits of the energy are known, four of the percentage: half a unit of the last.
  const std::vector<double> matched = i.numbers("CALC:ENER:BAND?");
  ASSERT_GE(matched.size(), 6U);
  EXPECT_NEAR(matched[0], 3.30567639e-7, 0.5e-15);
  EXPECT_NEAR(matched[1], 1.196, 5e-4);
  ASSERT_EQ(i.ask("CALC:ENER:DEL NONE"), "");
  const std::vector<double> plain = i.numbers("CALC:ENER:BAND?");
  ASSERT_EQ(plain.size(), 5U);
  EXPECT_NEAR(plain[0], 7.66114200e-6, 0.5e-14);
  EXPECT_NEAR(plain[4], 0.639919e-3, 0.5e-9);
  const std::vector<double> known = i.numbers("CALC:UNC?");
  ASSERT_EQ(known.size(), 7U);
  EXPECT_EQ(known[1], 2.0 * known[0]);
  EXPECT_LT(known[2], known[3]);
}

TEST(Instrument, KnowsTheLastIdentificationAfterPowerOff) {
  InstrumentBench i;
  i.send(table1_commands());
  ASSERT_TRUE(i.settle());
  const std::string device = i.ask("CALC:IDEN?");
  const std::string covariance = i.ask("CALC:IDEN:COV?");
  const std::string energy = i.ask("CALC:ENER?");
  i.switch_on();
  EXPECT_EQ(i.ask("CALC:IDEN?"), device);
  EXPECT_EQ(i.ask("CALC:IDEN:COV?"), covariance);
  EXPECT_EQ(i.ask("CALC:ENER?"), energy);
  EXPECT_EQ(i.ask("TRAC:FRES:POIN?"), "0");
  // Its Birge ratio is known to a fit only: no trials as if it were 1.
  const char* const needs_fit =
      "-230,\"Data corrupt or stale;BIRG needs the points of the fit: INIT:SWE\"";
  EXPECT_EQ(i.ask("CALC:MCAR:TRI 1000;DIST NORM;:CALC:MCAR?").substr(0, 5), "1000,");
  EXPECT_EQ(error_of(i, "CALC:MCAR:DIST BOX;BIRG 1;:INIT:REP"), needs_fit);
  EXPECT_EQ(i.ask("CALC:MCAR:BIRG 0;:CALC:MCAR?").substr(0, 5), "1000,");
  ASSERT_EQ(i.ask("*RST"), "");
  EXPECT_EQ(error_of(i, "CALC:IDEN?"),
            "-230,\"Data corrupt or stale;no points: INIT:SWE or TRAC:FRES:DATA\"");
}

TEST(Instrument, SaysThatTheLastIdentificationIsDamaged) {
  InstrumentBench i;
  i.send(table1_commands());
  ASSERT_TRUE(i.settle());
  const std::string device = i.ask("CALC:IDEN?");
  const std::string energy = i.ask("CALC:ENER?");
  ASSERT_EQ(i.ask("*RST"), "");
  i.send(table1_commands());
  ASSERT_TRUE(i.settle());
  ASSERT_EQ(i.ask("CALC:ENER?"), energy);
  const std::uint32_t first = 2 * app::kIdentificationRecord;
  i.store.at(first + 1, 30) ^= 1U;
  i.switch_on();
  EXPECT_EQ(i.errors(), "-311,\"Memory error;a copy is damaged: the fit may be older\"\n");
  EXPECT_EQ(i.ask("CALC:IDEN?"), device);
  i.store.at(first, 30) ^= 1U;
  i.switch_on();
  EXPECT_EQ(i.errors(), "-311,\"Memory error;the fit that was kept is damaged: lost\"\n");
  EXPECT_EQ(error_of(i, "CALC:IDEN?"),
            "-230,\"Data corrupt or stale;no points: INIT:SWE or TRAC:FRES:DATA\"");
}

TEST(Instrument, SaysThatTheStoreFails) {
  InstrumentBench i;
  i.store.cut_power_after(10);
  EXPECT_EQ(error_of(i, "*SAV 1"), "-311,\"Memory error;the store refuses: another slot\"");
  i.store.restore_power();
  EXPECT_EQ(error_of(i, "*RCL 1"),
            "-230,\"Data corrupt or stale;empty or damaged slot: *SAV first\"");
}

TEST(Instrument, CountsErrorsUpToTheQueuesEnd) {
  InstrumentBench i;
  for (int n = 0; n < 1000; ++n) {
    i.send("NOSUCH:THING");
    ASSERT_TRUE(i.settle());
  }
  EXPECT_EQ(i.ask("SYST:ERR:COUN?"), "16");
  const std::string errors = i.errors();
  EXPECT_EQ(errors.substr(0, 35), "-113,\"Undefined header;NOSUCH:THING");
  EXPECT_NE(errors.find("-350,\"Queue overflow\"\n"), std::string::npos);
  EXPECT_EQ(i.ask("*IDN?"), "emax,test,4711,0.1.0");
}

TEST(Instrument, TakesCompoundLinesAndStaysAtTheNode) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("CALC:ENER:TIME 3 MS;STEP 5us;TIME?;STEP?;*IDN?;ITER?;:CALC:FILT:ORD?"),
            "3.0E-3;5.0E-6;emax,test,4711,0.1.0;30;10");
  EXPECT_EQ(i.ask("calculate:filter:order 7;frequency 2khz;:calc:filt:freq?"), "2000");
  EXPECT_EQ(i.errors(), "");
}

}  // namespace
}  // namespace emax
