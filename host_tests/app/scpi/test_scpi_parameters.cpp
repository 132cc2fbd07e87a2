// Parameters of every kind, what is wrong with them, and the fields of answers.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

#include "emax/app/scpi/response.hpp"

#include "support/toy_instrument.hpp"

namespace emax::app::scpi {
namespace {

using test::ToyConsole;

/// The error number of a command that must not answer and must have exactly one error; 0 for none.
int error_of(ToyConsole& console, const std::string& command) {
  EXPECT_EQ(console.ask(command + "\n"), "") << command;
  const std::string answer = console.error();
  EXPECT_EQ(console.error(), "0,\"No error\"\n") << command << ": " << answer;
  return std::stoi(answer);
}

int error_of(const std::string& command) {
  ToyConsole console;
  return error_of(console, command);
}

/// What the time becomes, in s, with "1" before the test.
double time_of(const std::string& parameter) {
  ToyConsole console;
  console.toy.time_s = 1.0;
  EXPECT_EQ(error_of(console, "CALC:ENER:TIME " + parameter), 0) << parameter;
  return console.toy.time_s;
}

double frequency_of(const std::string& parameter) {
  ToyConsole console;
  EXPECT_EQ(error_of(console, "SWE:FREQ " + parameter), 0) << parameter;
  return console.toy.frequencies_hz[0];
}

// IEEE 488.2, 7.7.2.
TEST(ScpiNumbers, Decimal) {
  EXPECT_EQ(time_of("0"), 0.0);
  EXPECT_EQ(time_of("12"), 12.0);
  EXPECT_EQ(time_of("+12"), 12.0);
  EXPECT_EQ(time_of("-12.5"), -12.5);
  EXPECT_EQ(time_of(".5"), 0.5);
  EXPECT_EQ(time_of("5."), 5.0);
  EXPECT_EQ(time_of("00012"), 12.0);
  EXPECT_EQ(time_of("1e-3"), 1e-3);
  EXPECT_EQ(time_of("1E+3"), 1e3);
  EXPECT_EQ(time_of("1.5 E 3"), 1.5e3);
  EXPECT_EQ(time_of("1.5E -3"), 1.5e-3);
  EXPECT_EQ(time_of("   7\t"), 7.0);
  EXPECT_EQ(time_of("0.002"), 0.002);
  EXPECT_EQ(time_of("-0"), 0.0);
  EXPECT_TRUE(std::signbit(time_of("-0.0")));
}

// Rounded once, on the value with its multiplier: the decimal literal of the compiler is the same.
TEST(ScpiNumbers, CorrectlyRounded) {
  EXPECT_EQ(time_of("0.1 US"), 0.1e-6);
  EXPECT_EQ(time_of("20 us"), 20e-6);
  EXPECT_EQ(time_of("1.0474909417558 MS"), 1.0474909417558e-3);
  EXPECT_EQ(time_of("9007199254740993"), 9007199254740992.0);
  EXPECT_EQ(time_of("9007199254740993.0000000000000000000000001"), 9007199254740994.0);
  EXPECT_EQ(time_of("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(time_of("1e-400"), 0.0);
  EXPECT_EQ(time_of("1e-32000"), 0.0);
  EXPECT_EQ(time_of("0." + std::string(300, '0') + "125"), 0.125e-300);
  EXPECT_EQ(time_of(std::string(300, '0') + "125"), 125.0);
  EXPECT_EQ(time_of("0e32000"), 0.0);
}

// IEEE 488.2, 7.7.3: MHZ is mega, M elsewhere milli.
TEST(ScpiNumbers, UnitsAndMultipliers) {
  const struct {
    const char* text;
    double value_s;
  } times[] = {{"3 S", 3.0},   {"3S", 3.0},     {"3 MS", 3e-3},  {"3 ms", 3e-3},  {"3 US", 3e-6},
               {"3 NS", 3e-9}, {"3 PS", 3e-12}, {"3 FS", 3e-15}, {"3 AS", 3e-18}, {"3 KS", 3e3},
               {"3 MAS", 3e6}, {"3 GS", 3e9},   {"3 TS", 3e12},  {"3 PES", 3e15}, {"3 EXS", 3e18},
               {"3E2MS", 0.3}, {"3EXS", 3e18},  {"3e1exs", 3e19}};
  for (const auto& entry : times) {
    EXPECT_EQ(time_of(entry.text), entry.value_s) << entry.text;
  }
  const struct {
    const char* text;
    double value_hz;
  } frequencies[] = {{"30 HZ", 30.0},   {"4.073KHZ", 4073.0}, {"0.5 MHZ", 5e5},
                     {"0.5 MAHZ", 5e5}, {"1 hz", 1.0},        {"900000 UHZ", 0.9}};
  for (const auto& entry : frequencies) {
    EXPECT_EQ(frequency_of(entry.text), entry.value_hz) << entry.text;
  }
  EXPECT_EQ(error_of("CALC:ENER:TIME 3 MHZ"), -131);
  ToyConsole console;
  EXPECT_EQ(console.ask("SOUR:LEV 3 M/S2;LEV?\n"), "3\n");
  EXPECT_EQ(console.ask("SOUR:LEV 4000 MM/S2;LEV?\n"), "4\n");
  // The quotient as a product.
  EXPECT_EQ(console.ask("SOUR:LEV 3M.S-2;LEV?;LEV 5 m.s-2;LEV?;LEV 6000 MM.S-2;LEV?\n"), "3;5;6\n");
  for (const char* unit : {"M.S2", "M.S-1", "M.S", "M/S-2", "M.K-2", "M.S+2", "M.S-22", "M", ".S-2",
                           "S-2.M", "M/S^2"}) {
    EXPECT_EQ(error_of(console, std::string("SOUR:LEV 3 ") + unit), unit[0] == '.' ? -103 : -131)
        << unit;
  }
}

// IEEE 488.2, 7.7.4.
TEST(ScpiNumbers, Nondecimal) {
  EXPECT_EQ(time_of("#H1F"), 31.0);
  EXPECT_EQ(time_of("#hff"), 255.0);
  EXPECT_EQ(time_of("#Q17"), 15.0);
  EXPECT_EQ(time_of("#B101"), 5.0);
  EXPECT_EQ(time_of("#HFFFFFFFFFFFFFFFF"), 18446744073709551615.0);
  for (const char* text : {"#", "#H", "#H1G", "#Q8", "#B2", "#X1", "#H 1", "#H1 F", "#H-1"}) {
    EXPECT_EQ(error_of(std::string("CALC:ENER:TIME ") + text), -121) << text;
  }
  EXPECT_EQ(error_of("CALC:ENER:TIME #H10000000000000000"), -124);
}

// SCPI-99, volume 1, 7.2.1: 9.9E37 is infinity, 9.91E37 not a number.
TEST(ScpiNumbers, SpecialValues) {
  EXPECT_EQ(error_of("CALC:ENER:TIME INF"), -222);
  EXPECT_EQ(error_of("CALC:ENER:TIME NINFinity"), -222);
  EXPECT_EQ(error_of("CALC:ENER:TIME NAN"), -222);
  EXPECT_EQ(error_of("CALC:ENER:TIME 9.9E37"), -222);
  EXPECT_EQ(error_of("CALC:ENER:TIME 9.91E37"), -222);
  EXPECT_EQ(error_of("CALC:ENER:TIME -9.9E37"), -222);
  EXPECT_EQ(error_of("CALC:ENER:TIME 1e999"), -222);
  EXPECT_EQ(time_of("9.8E37"), 9.8e37);
}

TEST(ScpiNumbers, MinMaxDef) {
  ToyConsole console;
  EXPECT_EQ(console.ask("SOUR:LEV MIN;LEV?;LEV MAXimum;LEV?;LEV def;LEV?\n"), "5.0E-1;20;2\n");
  EXPECT_EQ(console.ask("SOUR:LEV 3;LEV? MIN;LEV? MAX;LEV? DEFAULT;LEV?\n"), "5.0E-1;20;2;3\n");
  EXPECT_EQ(console.ask("CALC:FILT:ORD MAX;ORD?;ORD? MIN;ORD? DEF\n"), "15;1;10\n");
  EXPECT_EQ(error_of(console, "CALC:ENER:TIME DEF"), -224);
  EXPECT_EQ(error_of(console, "CALC:FILT:ORD? 5"), -128);
  EXPECT_EQ(error_of(console, "CALC:FILT:ORD? ISE"), -224);
  EXPECT_EQ(error_of(console, "CALC:FILT:ORD? MIN,MAX"), -108);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT? MIN"), -108);
}

// The offending text of each error is that of the parameter.
TEST(ScpiNumbers, Errors) {
  const struct {
    const char* parameter;
    int code;
  } expected[] = {
      {"ABC", -141},
      {"1.2.3", -121},
      {"1..2", -121},
      {"--1", -121},
      {"+", -121},
      {".", -121},
      {"-A", -121},
      {"$5", -121},
      {"1$", -121},
      {"1 2", -103},
      {"1 .5", -103},
      {"1 HZ", -131},
      {"1 MM", -131},
      {"1 S$", -131},
      {"1 S 2", -103},
      {"1 E", -131},
      {"1E+", -131},
      {"1e32001", -123},
      {"1e-32001", -123},
      {"1e99999999999", -123},
      {"1 SSSSSSSSSSSSS", -134},
      {"\"1\"", -158},
      {"'1'", -158},
      {"#11a", -168},
      {"ABCDEFGHIJKL", -141},
      {"1 ABCDEFGHIJKL", -131},
      {"A_1", -141},
      {"(1)", -178},
      {"ABCDEFGHIJKLM", -144},
      {"A$", -141},
      {"A B", -103},
      {"MINI", -141},
      {"1S2", -131},
      {"1/S", -131},
  };
  for (const auto& entry : expected) {
    ToyConsole console;
    console.toy.time_s = 1.0;
    EXPECT_EQ(console.ask(std::string("CALC:ENER:TIME ") + entry.parameter + "\n"), "");
    std::string quoted = entry.parameter;
    for (std::size_t i = 0; i < quoted.size(); i += quoted[i] == '"' ? 2U : 1U) {
      if (quoted[i] == '"') {
        quoted.insert(i, "\"");
      }
    }
    const std::string error = console.error();
    EXPECT_EQ(std::stoi(error), entry.code) << entry.parameter << ": " << error;
    EXPECT_NE(error.find(";" + quoted + "\""), std::string::npos) << error;
    EXPECT_EQ(console.toy.time_s, 1.0);
  }
  EXPECT_EQ(error_of("CALC:FILT:ORD 5 HZ"), -138);
  EXPECT_EQ(error_of("CALC:ENER:TIME " + std::string(256, '1')), -124);
  EXPECT_EQ(error_of("CALC:ENER:TIME 0." + std::string(256, '1')), -124);
  EXPECT_EQ(error_of("CALC:ENER:TIME 1" + std::string(254, '1') + "E-300"), 0);
}

// What a NaN must not pass.
TEST(ScpiNumbers, Range) {
  EXPECT_EQ(error_of("SOUR:LEV 0.4999"), -222);
  EXPECT_EQ(error_of("SOUR:LEV 20.001"), -222);
  EXPECT_EQ(error_of("SOUR:LEV NAN"), -222);
  EXPECT_EQ(error_of("SOUR:LEV 0.5"), 0);
  EXPECT_EQ(error_of("SOUR:LEV 20"), 0);
}

// IEEE 488.2: what needs a whole number rounds.
TEST(ScpiNumbers, WholeNumbers) {
  ToyConsole console;
  const struct {
    const char* text;
    int value;
  } expected[] = {{"5", 5},    {"5.4", 5},  {"5.5", 6},     {"0.5", 1},
                  {"1e1", 10}, {"#HA", 10}, {"15.499", 15}, {"4.5", 5}};
  for (const auto& entry : expected) {
    EXPECT_EQ(error_of(console, std::string("CALC:FILT:ORD ") + entry.text), 0);
    EXPECT_EQ(console.toy.order, entry.value) << entry.text;
  }
  for (const char* text : {"0", "0.49", "16", "15.5", "-1", "1e30", "INF", "NAN", "1e999"}) {
    EXPECT_EQ(error_of(console, std::string("CALC:FILT:ORD ") + text), -222) << text;
  }
  EXPECT_EQ(console.toy.order, 5);
}

// SCPI-99, volume 1, 7.3.
TEST(ScpiParameters, Booleans) {
  ToyConsole console;
  EXPECT_EQ(console.ask("OUTP?;OUTP ON;OUTP?;OUTP OFF;OUTP?\n"), "0;1;0\n");
  EXPECT_EQ(console.ask("OUTP 1;OUTP?;OUTP 0;OUTP?;OUTP on;OUTP?\n"), "1;0;1\n");
  EXPECT_EQ(console.ask("OUTP 0.4;OUTP?;OUTP 0.5;OUTP?;OUTP -2;OUTP?\n"), "0;1;1\n");
  EXPECT_EQ(console.ask("OUTP -0.4;OUTP?;OUTP -0.5;OUTP?\n"), "0;1\n");
  EXPECT_EQ(error_of(console, "OUTP YES"), -224);
  EXPECT_EQ(error_of(console, "OUTP \"ON\""), -158);
  EXPECT_EQ(error_of(console, "OUTP 1 S"), -138);
  EXPECT_EQ(error_of(console, "OUTP 1,0"), -108);
  EXPECT_EQ(console.ask("OUTP?\n"), "1\n");
}

TEST(ScpiParameters, Choices) {
  ToyConsole console;
  EXPECT_EQ(console.ask("CALC:ENER:CRIT?;CRIT DIFF;CRIT?;CRIT ise;CRIT?;CRIT Difference;CRIT?\n"),
            "ISE;DIFF;ISE;DIFF\n");
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT DIFFE"), -224);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT 1"), -128);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT #H1"), -128);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT 'ISE'"), -158);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT #13ISE"), -168);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT (ISE)"), -178);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT ISE$"), -141);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT ISE DIFF"), -103);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT DIFFERENCEDIFF"), -144);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT"), -109);
  EXPECT_EQ(error_of(console, "CALC:ENER:CRIT ISE,ISE"), -108);
}

// What the caller does with a new value must happen for a new value only.
TEST(ScpiParameters, SettingsTellWhetherThereIsANewValue) {
  for (const char* good : {"SOUR:LEV 3", "CALC:FILT:ORD 3", "CALC:ENER:CRIT DIFF", "OUTP ON",
                           "OUTP 1", "SOUR:LEV MIN", "CALC:FILT:GAIN 3", "CALC:FILT:GAIN AUTO"}) {
    ToyConsole console;
    EXPECT_EQ(error_of(console, good), 0) << good;
    EXPECT_EQ(console.toy.stored, 1) << good;
  }
  for (const char* other :
       {"SOUR:LEV 30", "SOUR:LEV X", "CALC:FILT:ORD 30", "CALC:FILT:ORD X", "CALC:ENER:CRIT X",
        "OUTP X", "OUTP 1 S", "SOUR:LEV?", "SOUR:LEV? MIN", "CALC:FILT:ORD?", "CALC:FILT:ORD? MIN",
        "CALC:FILT:GAIN?", "CALC:FILT:GAIN? MIN", "CALC:FILT:GAIN X", "CALC:ENER:CRIT?", "OUTP?"}) {
    ToyConsole console;
    (void)console.ask(std::string(other) + "\n");
    EXPECT_EQ(console.toy.stored, 0) << other;
  }
}

TEST(ScpiParameters, NumberOrWord) {
  ToyConsole console;
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN AUTO"), 0);
  EXPECT_EQ(console.toy.gain_word, 0U);
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN track"), 0);
  EXPECT_EQ(console.toy.gain_word, 1U);
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN 1.037"), 0);
  EXPECT_EQ(console.toy.gain_word, 2U);
  EXPECT_EQ(console.toy.gain, 1.037);
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN MAX"), 0);
  EXPECT_EQ(console.toy.gain, 100.0);
  EXPECT_EQ(console.ask("CALC:FILT:GAIN?;GAIN? MIN;GAIN? MAX;GAIN? DEF\n"), "100;0;100;AUTO\n");
  EXPECT_EQ(console.ask("CALC:FILT:GAIN TRAC;GAIN?;GAIN DEF;GAIN?\n"), "TRAC;AUTO\n");
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN? 5"), -128);
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN 100"), 0);
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN TRA"), -141);
  EXPECT_EQ(error_of(console, "CALC:FILT:GAIN 101"), -222);
  EXPECT_EQ(console.toy.gain, 100.0);
}

TEST(ScpiParameters, Lists) {
  ToyConsole console;
  EXPECT_EQ(console.ask("SWE:FREQ 1, 2.5 ,3KHZ;FREQ?\n"), "1,2.5,3000\n");
  EXPECT_EQ(console.ask("SWE:FREQ 1,2,3,4,5,6,7,8;FREQ?\n"), "1,2,3,4,5,6,7,8\n");
  EXPECT_EQ(error_of(console, "SWE:FREQ 1,2,3,4,5,6,7,8,9"), -223);
  EXPECT_EQ(error_of(console, "SWE:FREQ"), -109);
  EXPECT_EQ(error_of(console, "SWE:FREQ 1,,2"), -109);
  EXPECT_EQ(error_of(console, "SWE:FREQ 1,"), -109);
  EXPECT_EQ(error_of(console, "SWE:FREQ ,"), -109);
  EXPECT_EQ(error_of(console, "SWE:FREQ 1,-1"), -222);
  EXPECT_EQ(console.ask("SWE:FREQ?\n"), "1,2,3,4,5,6,7,8\n");
}

TEST(ScpiParameters, CountIsCheckedBeforeTheCall) {
  ToyConsole console;
  EXPECT_EQ(console.ask("CALC:MOD 1,2,3\nCALC:MOD 1,2,3,4,5,6\nCALC:MOD 1,2,3,4\n"), "");
  EXPECT_EQ(console.toy.log, "364");
  EXPECT_EQ(error_of(console, "CALC:MOD 1,2"), -109);
  EXPECT_EQ(error_of(console, "CALC:MOD 1,2,3,4,5,6,7"), -108);
  EXPECT_EQ(error_of(console, "*RST 1"), -108);
  EXPECT_EQ(error_of(console, "*ESE"), -109);
  EXPECT_EQ(console.toy.log, "364");
  EXPECT_EQ(console.ask("*IDN? 12\n"), "");
  EXPECT_EQ(console.error(), "-108,\"Parameter not allowed;12\"\n");
}

// IEEE 488.2, 7.7.5: either quote, doubled inside.
TEST(ScpiParameters, Strings) {
  ToyConsole console;
  EXPECT_EQ(console.ask("DISP:TEXT \"a;b, 'c'\";TEXT?\n"), "\"a;b, 'c'\"\n");
  EXPECT_EQ(console.ask("DISP:TEXT 'say \"no\"';TEXT?\n"), "\"say \"\"no\"\"\"\n");
  EXPECT_EQ(console.ask("DISP:TEXT '';TEXT?\n"), "\"\"\n");
  EXPECT_EQ(console.ask("DISP:TEXT 'it''s';TEXT?\n"), "\"it''s\"\n");
  EXPECT_EQ(error_of(console, "DISP:TEXT \"a"), -151);
  EXPECT_EQ(error_of(console, "DISP:TEXT \"a\"b"), -151);
  EXPECT_EQ(error_of(console, "DISP:TEXT \"a\"\""), -151);
  EXPECT_EQ(error_of(console, "DISP:TEXT \""), -151);
  EXPECT_EQ(error_of(console, "DISP:TEXT a"), -148);
  EXPECT_EQ(error_of(console, "DISP:TEXT 1"), -128);
  EXPECT_EQ(error_of(console, "DISP:TEXT #11a"), -168);
  EXPECT_EQ(error_of(console, "DISP:TEXT \"a\",\"b\""), -108);
}

// No command takes a block: it is refused at its '#' (-168), and what follows its line is heard.
TEST(ScpiParameters, Blocks) {
  for (const char* block :
       {"#44000", "#12ab", "#0a;b", "#3", "#10", "#9999999999abc", "#15a,b,c"}) {
    ToyConsole console;
    EXPECT_EQ(error_of(console, std::string("SOUR:LEV ") + block), -168) << block;
    EXPECT_EQ(error_of(console, std::string("DISP:TEXT ") + block), -168) << block;
    EXPECT_EQ(error_of(console, std::string("CALC:ENER:CRIT ") + block), -168) << block;
    EXPECT_EQ(console.ask("ABOR\n*IDN?\n"), "maker,toy,0,1.0\n") << block;
    EXPECT_EQ(console.toy.log, "A") << block;
  }
  EXPECT_EQ(error_of("*CLS #44000"), -108);
  EXPECT_EQ(error_of("#44000"), -101);
}

// IEEE 488.2, 7.7.7: an expression is one parameter, commas and all.
TEST(ScpiParameters, Expressions) {
  for (const char* text : {"(1,2)", "(@1,2:5)", "(1+(2,3),(4))", "(1,2", "((1),2"}) {
    EXPECT_EQ(error_of(std::string("SOUR:LEV ") + text), -178) << text;
    EXPECT_EQ(error_of(std::string("SWE:FREQ 1,") + text), -178) << text;
  }
  EXPECT_EQ(error_of("SOUR:LEV (1),2"), -108);
  EXPECT_EQ(error_of("SOUR:LEV 1)"), -121);
  ToyConsole console;
  EXPECT_EQ(console.ask("SOUR:LEV (1,2\nSOUR:LEV 3;LEV?\n"), "3\n") << "it ends with its line";
}

std::string text_of(const Response& response) {
  return std::string(response.pending().data(), response.pending().size());
}

/// The answer of one unit.
template <typename Put>
std::string answer(const Put& put) {
  Response response;
  response.begin_answer(Response::kAnswerRoom);
  put(response);
  EXPECT_TRUE(response.fits());
  return text_of(response);
}

std::string number_text(double value) {
  return answer([value](Response& out) { out.number(value); });
}

// IEEE 488.2, 8.7.2 to 8.7.4: whole numbers, fixed point, and with an exponent a point and a
// capital E. By hand; the last four digits of 2^-44 and its neighbours are those that Python
// prints.
TEST(ScpiResponse, Numbers) {
  const struct {
    double value;
    const char* text;
  } expected[] = {
      {0.0, "0"},
      {-0.0, "0"},
      {1.0, "1"},
      {-1.0, "-1"},
      {0.1, "1.0E-1"},
      {-0.3, "-3.0E-1"},
      {0.1 + 0.2, "3.0000000000000004E-1"},
      {0.005115251359876, "5.115251359876E-3"},
      {1.0 / 3.0, "3.333333333333333E-1"},
      {1.037, "1.037"},
      {4072.9724, "4072.9724"},
      {20.0, "20"},
      {123456789.0, "123456789"},
      {9007199254740993.0, "9007199254740992"},
      {1e16, "10000000000000000"},
      {1e17, "1.0E+17"},
      {1e22, "1.0E+22"},
      {1.5e300, "1.5E+300"},
      {0x1p-44, "5.684341886080802E-14"},
      {-0x1p-44, "-5.684341886080802E-14"},
      {0x1p-1074, "5.0E-324"},
      {0x1p-1022, "2.2250738585072014E-308"},
      {-1.7976931348623157e308, "-1.7976931348623157E+308"},
  };
  for (const auto& entry : expected) {
    EXPECT_EQ(number_text(entry.value), entry.text);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(answer([=](Response& out) { out.number(infinity).number(-infinity); }),
            "9.9E37,-9.9E37");
  EXPECT_EQ(answer([](Response& out) { out.number(std::nan("")).number(-std::nan("")); }),
            "9.91E37,9.91E37");
}

/// Significant digits in the text of a number.
int digits_in(const std::string& text) {
  int digits = 0;
  int zeros = 0;
  for (const char c : text.substr(0, text.find('E'))) {
    const bool counts = c >= '1' || (c == '0' && digits > 0);
    digits += counts ? 1 : 0;
    zeros = c == '0' ? zeros + 1 : c == '.' ? zeros : 0;
  }
  return digits - (digits > zeros ? zeros : 0);
}

// Each reads back as itself by the C library, and no number of fewer digits does.
TEST(ScpiResponse, ShortestNumbers) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 20000; ++i) {
    std::uint64_t bits = random();
    bits = i % 4 == 0 ? bits & 0xFFF0000000000000U : bits;  // Powers of two.
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value) || value == 0.0) {
      continue;
    }
    const std::string text = number_text(value);
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
    EXPECT_LE(text.size(), 24U) << text;
    const int digits = digits_in(text);
    ASSERT_GE(digits, 1) << text;
    if (digits > 1) {
      // The nearest number with a digit less, and its neighbours on both sides.
      char fewer[40];
      (void)std::snprintf(fewer, sizeof fewer, "%.*e", digits - 2, value);
      const double nearest = std::strtod(fewer, nullptr);
      const double step = std::pow(10.0, std::floor(std::log10(std::fabs(value))) - (digits - 2));
      EXPECT_NE(nearest, value) << text;
      for (const double other : {nearest - step, nearest + step}) {
        (void)std::snprintf(fewer, sizeof fewer, "%.*e", digits - 2, other);
        EXPECT_NE(std::strtod(fewer, nullptr), value) << text << " " << fewer;
      }
    }
  }
}

TEST(ScpiResponse, IntegersAndWords) {
  EXPECT_EQ(answer([](Response& out) {
              out.integer(0).integer(-7).integer(INT64_MAX).integer(INT64_MIN).boolean(true);
            }),
            "0,-7,9223372036854775807,-9223372036854775808,1");
  EXPECT_EQ(answer([](Response& out) { out.word("ISE").short_form("DIFFerence").boolean(false); }),
            "ISE,DIFF,0");
  EXPECT_EQ(answer([](Response& out) { out.string(Span<const char>("a\"b", 3)).integer(1); }),
            "\"a\"\"b\",1");
}

// SCPI-99, volume 2, 21.8.1: the standard's text, a semicolon, and what the instrument adds.
TEST(ScpiResponse, Errors) {
  ErrorEntry entry;
  entry.code = ErrorCode::kSettingsConflict;
  EXPECT_EQ(answer([&](Response& out) { out.error(entry); }), "\"Settings conflict\"");
  entry.words = "as \"fast\" as it goes";
  EXPECT_EQ(answer([&](Response& out) { out.error(entry); }),
            "\"Settings conflict;as \"\"fast\"\" as it goes\"");
  const std::string words(200, 'w');
  entry.words = words.c_str();
  entry.subject = "slew";
  EXPECT_EQ(answer([&](Response& out) { out.error(entry); }),
            "\"Settings conflict;slew: " + words + "\"");
}

// IEEE 488.2, 8.7.9.
TEST(ScpiResponse, Blocks) {
  EXPECT_EQ(answer([](Response& out) { out.block_header(0); }), "#10");
  EXPECT_EQ(answer([](Response& out) { out.block_header(9); }), "#19");
  EXPECT_EQ(answer([](Response& out) { out.block_header(12345); }), "#512345");
  Response response;
  response.begin_answer(Response::kAnswerRoom);
  response.integer(1).block(Span<const char>("abc", 3));
  EXPECT_TRUE(response.holds_block());
  EXPECT_EQ(text_of(response), "1,#13");
  response.consume(5);
  EXPECT_EQ(text_of(response), "abc");
  response.consume(1);
  EXPECT_EQ(text_of(response), "bc");
  response.consume(2);
  EXPECT_FALSE(response.holds_block());
  EXPECT_TRUE(response.empty());
  response.end_message();
  EXPECT_EQ(text_of(response), "\n");
}

TEST(ScpiResponse, TooMuchIsDropped) {
  Response response;
  response.begin_answer(Response::kAnswerRoom);
  response.integer(1);
  response.begin_answer(10);
  response.integer(12345678);
  EXPECT_TRUE(response.fits());
  response.integer(9);
  EXPECT_FALSE(response.fits());
  response.drop_answer();
  EXPECT_EQ(text_of(response), "1");
  EXPECT_TRUE(response.fits());
  response.end_message();
  EXPECT_EQ(text_of(response), "1\n");
}

}  // namespace
}  // namespace emax::app::scpi
