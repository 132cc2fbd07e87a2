// Messages of the kinds that the tests of two open parsers send, with what is answered here. Where
// that differs from what they expect, the clause of IEEE 488.2 or SCPI-99 that decides is named.
//
// The parsers are scpi-parser (https://github.com/j123b567/scpi-parser, "C", its test_parser.c and
// test_lexer_parser.c) and scpi-rs (https://github.com/Atmelfan/scpi-rs, "Rust", its tokenizer's
// tests and test_commands.rs). The messages are written for the toy's commands.
//
// The clauses are those that public texts quote: the error list of SCPI-99, 21.8, which many
// manuals and both parsers reproduce with its references to IEEE 488.2. Of what no such text
// quotes, only the chapter is named.
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>

#include "support/toy_instrument.hpp"

namespace emax::app::scpi {
namespace {

using test::ToyConsole;

struct Conformance {
  const char* message;
  const char* answer;  ///< Of the whole message, without its line feed.
  int error;           ///< The first one; 0 for none.
  const char* others;  ///< What the parsers do otherwise, with the clause; empty for the same.
};

constexpr Conformance kCases[] = {
    // Headers and their forms.
    {"*IDN?", "maker,toy,0,1.0", 0, ""},
    {" \t *IDN? ", "maker,toy,0,1.0", 0, ""},
    {"*idn?", "maker,toy,0,1.0", 0, ""},
    {"*IDN? 12", "", -108,
     "C: answers all the same. SCPI-99, 21.8: a command error, and no answer"},
    {"IDN?", "", -113, ""},
    {"*ESE", "", -109, ""},
    {":*IDN?", "", -110, "C: an incomplete header, as here"},
    {":SOUR::LEV?", "", -110, ""},
    {"*", "", -110, ""},
    {"*?", "", -110, ""},
    {"]]", "", -101, ""},
    {"SOURce:LEVel?", "1", 0, ""},
    {"sour:LEVEL?", "1", 0, ""},
    {"SOUR:LEVE?", "", -113, ""},
    {"SWE:CYCL?;:SENS:SWE:CYCL?", "10;10", 0, ""},
    {"SOUR:LEV 2;LEV?", "2", 0, ""},
    {"SOUR:LEV 2;:SOUR:LEV?;LEV?", "2;2", 0, ""},
    {"SOUR:LEV 2;*ESE?;LEV?", "0;2", 0, ""},
    {"SOUR:LEV 2;SOUR:LEV?", "", -113, ""},
    {"*CLS;*ESE 32;*ESE?", "32", 0, ""},
    {"*ESE #H20;*ESE?", "32", 0, ""},
    {"*SRE #HFF;*SRE?", "191", 0, "C: 255. 488.2, chapter 11: bit 6 is ignored"},
    {"*ESE 0x20", "", -138, "C, early: hexadecimal. 488.2, 7.7.4: #H only"},
    {";;*ESE?;", "0", 0, ""},
    {"ROUT:CHAN1:CLOS;:ROUT:CHAN:CLOS", "", 0, ""},
    {"ROUT:CHAN7:CLOS", "", -114, ""},
    // Numbers.
    {"CALC:ENER:TIME 10 ;TIME?", "10", 0, ""},
    {"CALC:ENER:TIME -10.5;TIME?", "-10.5", 0, ""},
    {"CALC:ENER:TIME +.5;TIME?", "5.0E-1", 0, "Rust: 0.5. 488.2, 8.7.4: NR3 is a number, too"},
    {"CALC:ENER:TIME -.", "", -121, ""},
    {"CALC:ENER:TIME -1 e 3;TIME?", "-1000", 0, ""},
    {"CALC:ENER:TIME -1 e", "", -131,
     "C: a number with the suffix e. 488.2, 7.7.3.2: no such unit"},
    {"CALC:ENER:TIME 1.5E12;TIME?", "1500000000000", 0, ""},
    {"CALC:ENER:TIME 1.5E12 V", "", -131, ""},
    {"CALC:FILT:ORD #B101;ORD?;ORD #Q17;ORD?;ORD #hA;ORD?", "5;15;10", 0, ""},
    {"CALC:FILT:ORD #B2", "", -121, ""},
    {"SOUR:LEV MAX;LEV?;LEV MINIMUM;LEV?;LEV DEF;LEV?", "20;5.0E-1;2", 0, ""},
    {"SOUR:LEV UP", "", -141, "Rust: a step up. SCPI-99, 7.2.1: only where documented"},
    {"SOUR:LEV INF", "", -222, ""},
    {"SOUR:LEV NAN", "", -222, ""},
    {"SOUR:LEV 21", "", -222, ""},
    {"SOUR:LEV 'STRING'", "", -158, "Rust: -104. SCPI-99, 21.8: the more specific code"},
    {"SOUR:LEV INVALID", "", -141, "Rust: -104. The same"},
    {"SOUR:LEV 3 M/S2;LEV?", "3", 0, ""},
    {"SOUR:LEV 3 M.S-2;LEV?", "3", 0, ""},
    {"SOUR:LEV 3 A.H", "", -131, ""},
    {"CALC:FILT:ORD 5 S", "", -138, ""},
    {"SWE:FREQ 1,2,", "", -109, ""},
    {"SWE:FREQ 1,,2", "", -109, ""},
    {"SWE:FREQ 1 KHZ , 2e3\t,#HBB8;FREQ?", "1000,2000,3000", 0, ""},
    // Words and truth values.
    {"CALC:ENER:CRIT DIFF;CRIT?", "DIFF", 0, ""},
    {"CALC:ENER:CRIT 'DIFF'", "", -158, ""},
    {"CALC:ENER:CRIT 1.0", "", -128, "Rust: -104. SCPI-99, 21.8: the more specific code"},
    {"OUTP ON;:OUTP:STAT?;:OUTP 0;:OUTP?", "1;0", 0, ""},
    {"OUTP 2.7;:OUTP?", "1", 0, ""},
    // Strings.
    {"DISP:TEXT \"ahoj\";TEXT?", "\"ahoj\"", 0, ""},
    {"DISP:TEXT 'ahoj' ;TEXT?", "\"ahoj\"", 0, ""},
    {"DISP:TEXT 'a,b;c';TEXT?", "\"a,b;c\"", 0, ""},
    {"DISP:TEXT '';TEXT?", "\"\"", 0, ""},
    {"DISP:TEXT 'abcd", "", -151, ""},
    {"DISP:TEXT 'abcd\"", "", -151, ""},
    {"DISP:TEXT CHRDATA", "", -148, "Rust: -104. SCPI-99, 21.8: the more specific code"},
    {"DISP:TEXT '\xFA\xF0'", "", -101, ""},
    // Blocks and expressions, which no command takes.
    {"SOUR:LEV #12AB", "", -168, "C, Rust: blocks are data of the commands that take them"},
    {"SOUR:LEV #13AB", "", -168, "C: waits for the third byte. Here a block ends with its line"},
    {"SOUR:LEV #02AB", "", -168, "C: unknown. 488.2, 7.7.6.2: an indefinite block"},
    {"SOUR:LEV ( 1 + 2 )", "", -178, ""},
    {"SOUR:LEV ( 1 + 2 ", "", -178, "C: unknown"},
    {"SOUR:LEV (@1,2:5)", "", -178, "Rust: a list of channels, where a command takes one"},
    {"SWE:FREQ (1,2,3)", "", -178, ""},
    // Status.
    {"ABCD", "", -113, ""},
    {"*ESR?", "128", 0, "C, Rust: 0. 488.2, 11.5.1: power on is bit 7"},
    {"*STB?", "0", 0, ""},
    {"*IDN?;*STB?", "maker,toy,0,1.0;16", 0, "C: 0. 488.2, chapter 11: an answer is available"},
    {"SYST:ERR?", "0,\"No error\"", 0, ""},
    {"SYST:VERS?", "1999.0", 0, ""},
    {"*OPC;*ESR?", "129", 0, ""},
    {"*OPC?", "1", 0, ""},
};

class ScpiConformance : public testing::TestWithParam<Conformance> {};

INSTANTIATE_TEST_SUITE_P(All, ScpiConformance, testing::ValuesIn(kCases),
                         [](const auto& one) { return std::to_string(one.index); });

TEST_P(ScpiConformance, AnswersAsTheStandardHasIt) {
  const Conformance& one = GetParam();
  for (const char* end : {"\n", "\r\n"}) {
    ToyConsole console;
    std::string answer = console.ask(std::string(one.message) + end);
    if (!answer.empty()) {
      EXPECT_EQ(answer.back(), '\n');
      answer.pop_back();
    }
    EXPECT_EQ(answer, one.answer) << one.message << " " << one.others;
    EXPECT_EQ(std::atoi(console.error().c_str()), one.error) << one.message << " " << one.others;
    EXPECT_EQ(console.ask("*IDN?\n"), "maker,toy,0,1.0\n") << "after " << one.message;
  }
}

}  // namespace
}  // namespace emax::app::scpi
