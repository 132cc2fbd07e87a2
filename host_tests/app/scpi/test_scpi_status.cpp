// Status registers and error queue by the rules of IEEE 488.2 and SCPI-99.
#include <gtest/gtest.h>
#include <string>

#include "emax/app/scpi/error_code.hpp"
#include "emax/app/scpi/error_queue.hpp"
#include "emax/app/scpi/status_model.hpp"

#include "support/toy_instrument.hpp"

namespace emax::app::scpi {
namespace {

using test::ToyConsole;

std::string context_of(const ErrorEntry& entry) {
  return std::string(entry.context, entry.context_length);
}

void push(ErrorQueue& queue, int code, const std::string& context = "") {
  (void)queue.push(static_cast<ErrorCode>(code), Span<const char>(context.data(), context.size()));
}

// SCPI-99, volume 2, chapter 21: number and text of each.
TEST(ScpiErrors, TextsOfTheStandard) {
  const struct {
    int code;
    const char* text;
  } expected[] = {{0, "No error"},
                  {-100, "Command error"},
                  {-101, "Invalid character"},
                  {-102, "Syntax error"},
                  {-103, "Invalid separator"},
                  {-104, "Data type error"},
                  {-108, "Parameter not allowed"},
                  {-109, "Missing parameter"},
                  {-110, "Command header error"},
                  {-111, "Header separator error"},
                  {-112, "Program mnemonic too long"},
                  {-113, "Undefined header"},
                  {-114, "Header suffix out of range"},
                  {-120, "Numeric data error"},
                  {-121, "Invalid character in number"},
                  {-123, "Exponent too large"},
                  {-124, "Too many digits"},
                  {-128, "Numeric data not allowed"},
                  {-131, "Invalid suffix"},
                  {-134, "Suffix too long"},
                  {-138, "Suffix not allowed"},
                  {-141, "Invalid character data"},
                  {-144, "Character data too long"},
                  {-148, "Character data not allowed"},
                  {-150, "String data error"},
                  {-151, "Invalid string data"},
                  {-158, "String data not allowed"},
                  {-161, "Invalid block data"},
                  {-168, "Block data not allowed"},
                  {-178, "Expression data not allowed"},
                  {-200, "Execution error"},
                  {-213, "Init ignored"},
                  {-221, "Settings conflict"},
                  {-222, "Data out of range"},
                  {-223, "Too much data"},
                  {-224, "Illegal parameter value"},
                  {-225, "Out of memory"},
                  {-230, "Data corrupt or stale"},
                  {-240, "Hardware error"},
                  {-300, "Device-specific error"},
                  {-310, "System error"},
                  {-311, "Memory error"},
                  {-314, "Save/recall memory lost"},
                  {-330, "Self-test failed"},
                  {-350, "Queue overflow"},
                  {-363, "Input buffer overrun"},
                  {-400, "Query error"},
                  {-410, "Query INTERRUPTED"},
                  {-420, "Query UNTERMINATED"},
                  {-430, "Query DEADLOCKED"}};
  for (const auto& entry : expected) {
    EXPECT_STREQ(text_of(static_cast<ErrorCode>(entry.code)), entry.text) << entry.code;
  }
  // Others have the text of their class.
  EXPECT_STREQ(text_of(static_cast<ErrorCode>(-199)), "Command error");
  EXPECT_STREQ(text_of(static_cast<ErrorCode>(-299)), "Execution error");
  EXPECT_STREQ(text_of(static_cast<ErrorCode>(-399)), "Device-specific error");
  EXPECT_STREQ(text_of(static_cast<ErrorCode>(-499)), "Query error");
  EXPECT_STREQ(text_of(static_cast<ErrorCode>(7)), "Device-specific error");
}

// SCPI-99, volume 2, chapter 21: -1xx CME (32), -2xx EXE (16), -3xx and positive DDE (8),
// -4xx QYE (4).
TEST(ScpiErrors, ClassesOfTheStandard) {
  const struct {
    int code;
    int bit;
  } expected[] = {{-100, 32}, {-199, 32}, {-200, 16}, {-299, 16}, {-300, 8}, {-363, 8},
                  {1, 8},     {32767, 8}, {-400, 4},  {-499, 4},  {0, 0},    {-99, 0}};
  for (const auto& entry : expected) {
    EXPECT_EQ(event_of(static_cast<ErrorCode>(entry.code)), entry.bit) << entry.code;
  }
  EXPECT_TRUE(is_command_error(ErrorCode::kUndefinedHeader));
  EXPECT_FALSE(is_command_error(ErrorCode::kExecutionError));
  EXPECT_FALSE(is_command_error(ErrorCode::kNoError));
}

TEST(ScpiErrorQueue, FirstInFirstOut) {
  ErrorQueue queue;
  EXPECT_EQ(queue.pop().code, ErrorCode::kNoError);
  push(queue, -113, "ABCD");
  push(queue, -222, "1e9");
  EXPECT_EQ(queue.size(), 2U);
  const ErrorEntry first = queue.pop();
  EXPECT_EQ(first.code, ErrorCode::kUndefinedHeader);
  EXPECT_EQ(context_of(first), "ABCD");
  EXPECT_EQ(queue.pop().code, ErrorCode::kDataOutOfRange);
  EXPECT_TRUE(queue.empty());
}

// SCPI-99, volume 2, chapter 21: the last error is replaced by -350, and later ones are lost.
TEST(ScpiErrorQueue, Overflow) {
  ErrorQueue queue;
  for (int i = 0; i < 1000; ++i) {
    push(queue, -100 - i % 50, "x");
    ASSERT_TRUE(queue.consistent());
  }
  EXPECT_FALSE(queue.push(ErrorCode::kSettingsConflict, "slew", "more"));
  ASSERT_TRUE(queue.consistent());
  ASSERT_EQ(queue.size(), ErrorQueue::kCapacity);
  for (int i = 0; i < static_cast<int>(ErrorQueue::kCapacity) - 1; ++i) {
    EXPECT_EQ(static_cast<int>(queue.pop().code), -100 - i);
  }
  const ErrorEntry last = queue.pop();
  EXPECT_EQ(last.code, ErrorCode::kQueueOverflow);
  EXPECT_EQ(context_of(last), "");
  EXPECT_EQ(last.words, nullptr);
  EXPECT_TRUE(queue.empty());
  push(queue, -113);
  EXPECT_EQ(queue.pop().code, ErrorCode::kUndefinedHeader);
}

TEST(ScpiErrorQueue, GoesOnAfterOneWasRead) {
  ErrorQueue queue;
  for (std::size_t i = 0; i <= ErrorQueue::kCapacity; ++i) {
    push(queue, -101);
  }
  (void)queue.pop();
  push(queue, -102);
  for (std::size_t i = 2; i < ErrorQueue::kCapacity; ++i) {
    EXPECT_EQ(queue.pop().code, ErrorCode::kInvalidCharacter);
  }
  EXPECT_EQ(queue.pop().code, ErrorCode::kQueueOverflow);
  EXPECT_EQ(queue.pop().code, ErrorCode::kSyntaxError);
}

TEST(ScpiErrorQueue, ContextIsPrintableAndCut) {
  ErrorQueue queue;
  push(queue, -101, std::string("a\0\x1F\x7F\xFF~ b", 8));
  EXPECT_EQ(context_of(queue.pop()), "a....~ b");
  push(queue, -101, std::string(41, 'x'));
  EXPECT_EQ(context_of(queue.pop()), std::string(40, 'x'));
}

// SCPI-99: a bit that goes up or down sets its event if its filter is set.
TEST(ScpiStatusRegister, TransitionFilters) {
  StatusRegister status;
  status.set_positive_filter(0b0011);
  status.set_negative_filter(0b0110);
  status.set_condition(0b1111);
  EXPECT_EQ(status.take_event(), 0b0011);
  EXPECT_EQ(status.take_event(), 0);
  status.set_condition(0b1111);
  EXPECT_EQ(status.event(), 0);
  status.set_condition(0);
  EXPECT_EQ(status.event(), 0b0110);
  status.set_condition(0b0001);
  EXPECT_EQ(status.event(), 0b0111);
  EXPECT_EQ(status.condition(), 0b0001);
}

TEST(ScpiStatusRegister, PresetAndBit15) {
  StatusRegister status;
  status.set_enable(0xFFFF);
  status.set_positive_filter(0xFFFF);
  status.set_negative_filter(0xFFFF);
  status.set_condition(0xFFFF);
  EXPECT_EQ(status.enable(), 0x7FFF);
  EXPECT_EQ(status.positive_filter(), 0x7FFF);
  EXPECT_EQ(status.negative_filter(), 0x7FFF);
  EXPECT_EQ(status.condition(), 0x7FFF);
  EXPECT_EQ(status.event(), 0x7FFF);
  EXPECT_TRUE(status.summary());
  status.preset();
  EXPECT_EQ(status.enable(), 0);
  EXPECT_EQ(status.positive_filter(), 0x7FFF);
  EXPECT_EQ(status.negative_filter(), 0);
  EXPECT_EQ(status.event(), 0x7FFF);
  EXPECT_FALSE(status.summary());
}

// IEEE 488.2, chapter 11, and the status structure of SCPI-99.
TEST(ScpiStatusModel, SummaryBits) {
  StatusModel status;
  status.power_on();
  EXPECT_EQ(status.events(), 128);
  EXPECT_EQ(status.status_byte(false), 0);
  EXPECT_EQ(status.status_byte(true), 16);
  status.set_event_enable(128);
  EXPECT_EQ(status.status_byte(false), 32);
  EXPECT_EQ(status.take_events(), 128);
  EXPECT_EQ(status.status_byte(false), 0);
  status.report(ErrorCode::kUndefinedHeader, "ABCD");
  EXPECT_EQ(status.status_byte(false), 4);
  EXPECT_EQ(status.events(), 32);
  (void)status.take_error();
  EXPECT_EQ(status.status_byte(false), 0);
  status.operation().set_enable(16);
  status.operation().set_condition(16);
  EXPECT_EQ(status.status_byte(false), 128);
  status.questionable().set_enable(1);
  status.questionable().set_condition(1);
  EXPECT_EQ(status.status_byte(false), 128 + 8);
  // The master summary follows the enabled bits only, and bit 6 cannot be enabled.
  status.set_service_enable(255);
  EXPECT_EQ(status.service_enable(), 191);
  EXPECT_EQ(status.status_byte(false), 128 + 64 + 8);
  status.set_service_enable(4);
  EXPECT_EQ(status.status_byte(false), 128 + 8);
  status.report(ErrorCode::kSystemError);
  EXPECT_EQ(status.status_byte(false), 128 + 64 + 8 + 4);
}

// IEEE 488.2, 10.3: *CLS clears events and queue, and nothing else.
TEST(ScpiStatusModel, Clear) {
  StatusModel status;
  status.power_on();
  status.set_event_enable(1);
  status.set_service_enable(2);
  status.operation().set_enable(3);
  status.operation().set_condition(4);
  status.questionable().set_condition(5);
  status.report(ErrorCode::kUndefinedHeader);
  status.clear();
  EXPECT_EQ(status.events(), 0);
  EXPECT_TRUE(status.errors().empty());
  EXPECT_EQ(status.operation().event(), 0);
  EXPECT_EQ(status.questionable().event(), 0);
  EXPECT_EQ(status.event_enable(), 1);
  EXPECT_EQ(status.service_enable(), 2);
  EXPECT_EQ(status.operation().enable(), 3);
  EXPECT_EQ(status.operation().condition(), 4);
  EXPECT_EQ(status.questionable().condition(), 5);
  EXPECT_TRUE(status.consistent());
}

// SCPI-99, 21.8.2: 0 is no error.
TEST(ScpiStatusModel, NoErrorIsNotReported) {
  StatusModel status;
  status.report(ErrorCode::kNoError, Span<const char>("all well", 8));
  EXPECT_TRUE(status.errors().empty());
  EXPECT_EQ(status.events(), 0);
}

// -350 is a device-dependent error itself.
TEST(ScpiStatusModel, OverflowSetsItsEvent) {
  StatusModel status;
  for (std::size_t i = 0; i < ErrorQueue::kCapacity; ++i) {
    status.report(ErrorCode::kUndefinedHeader);
  }
  EXPECT_EQ(status.events(), 32);
  status.report(ErrorCode::kUndefinedHeader);
  EXPECT_EQ(status.events(), 32 + 8);
  status.report(ErrorCode::kNoError);
  EXPECT_EQ(status.errors().size(), ErrorQueue::kCapacity);
}

TEST(ScpiStatusModel, ErrorsWithWords) {
  StatusModel status;
  status.report(ErrorCode::kInitIgnored, "a sweep is running");
  status.report(ErrorCode::kInitIgnored);
  status.report(ErrorCode::kSettingsConflict, "100 V/s or more", "slew");
  EXPECT_STREQ(status.take_error().words, "a sweep is running");
  EXPECT_EQ(status.take_error().words, nullptr);
  const ErrorEntry last = status.take_error();
  EXPECT_STREQ(last.words, "100 V/s or more");
  EXPECT_STREQ(last.subject, "slew");
  EXPECT_EQ(context_of(last), "");
}

TEST(ScpiStatusCommands, EventStatus) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*ESR?\n*ESR?\n"), "128\n0\n");
  EXPECT_EQ(console.ask("*OPC;*ESR?\n"), "1\n");
  EXPECT_EQ(console.ask("*ESE 36;*ESE?\n"), "36\n");
  EXPECT_EQ(console.ask("ABCD\n*STB?\n"), "36\n");
  EXPECT_EQ(console.ask("*ESE #H20;*ESE?;*STB?;*ESR?;*STB?\n"), "32;52;32;20\n");
}

TEST(ScpiStatusCommands, ServiceRequest) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*SRE 255;*SRE?\n"), "191\n");
  EXPECT_EQ(console.ask("ABCD\n*STB?\n"), "68\n");
  EXPECT_EQ(console.ask("*SRE 32;*STB?\n"), "4\n");
  EXPECT_EQ(console.ask("*CLS;*STB?\n"), "0\n");
}

TEST(ScpiStatusCommands, MinMaxDef) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*ESE MAX;*ESE?;*ESE MIN;*ESE?;*ESE 5;*ESE DEF;*ESE?\n"), "255;0;0\n");
  EXPECT_EQ(console.ask("STAT:OPER:ENAB MAX;ENAB?;ENAB DEF;ENAB?\n"), "32767;0\n");
  EXPECT_EQ(console.ask("STAT:OPER:PTR 0;PTR DEF;PTR?;NTR 1;NTR DEF;NTR?\n"), "32767;0\n");
}

TEST(ScpiStatusCommands, MasksOutOfRange) {
  ToyConsole console;
  for (const char* command : {"*ESE 256", "*SRE -1", "STAT:OPER:ENAB 65536", "*ESE NAN"}) {
    EXPECT_EQ(console.ask(std::string(command) + "\n"), "");
    EXPECT_EQ(console.error().substr(0, 24), "-222,\"Data out of range;") << command;
  }
  EXPECT_EQ(console.ask("*ESE?;*SRE?;STAT:OPER:ENAB?\n"), "0;0;0\n");
}

// MAV: something of the same message waits to be read already.
TEST(ScpiStatusCommands, MessageAvailable) {
  ToyConsole console;
  EXPECT_EQ(console.ask("*STB?\n"), "0\n");
  ASSERT_EQ(console.send("*IDN?;*STB?\n"), 12U);
  console.run();
  EXPECT_EQ(console.read(), "maker,toy,0,1.0;16\n");
  // The first answer may have gone already, but its message has not ended.
  EXPECT_EQ(console.ask("*IDN?;*STB?\n"), "maker,toy,0,1.0;16\n");
  EXPECT_EQ(console.ask("*STB?\n"), "0\n");
}

TEST(ScpiStatusCommands, StatusSubsystem) {
  ToyConsole console;
  EXPECT_EQ(console.ask("STAT:OPER?;:STAT:OPER:COND?;ENAB?;PTR?;NTR?\n"), "0;0;0;32767;0\n");
  console.session.status().operation().set_condition(16);
  EXPECT_EQ(console.ask("STAT:OPER:COND?\n"), "16\n");
  EXPECT_EQ(console.ask("STATUS:OPERATION:EVENT?\nstat:oper?\n"), "16\n0\n");
  EXPECT_EQ(console.ask("STAT:QUES:ENAB 65535;NTR 256;PTR 0;:STAT:QUES:ENAB?;NTR?;PTR?\n"),
            "32767;256;0\n");
  console.session.status().questionable().set_condition(256);
  console.session.status().questionable().set_condition(0);
  EXPECT_EQ(console.ask("*STB?;STAT:QUES?;*STB?\n"), "8;256;16\n");
  EXPECT_EQ(console.ask("STAT:PRES;QUES:ENAB?;PTR?;NTR?\n"), "0;32767;0\n");
}

TEST(ScpiStatusCommands, ErrorQueries) {
  ToyConsole console;
  EXPECT_EQ(console.ask("SYST:ERR?\n"), "0,\"No error\"\n");
  EXPECT_EQ(console.ask("SYST:VERS?\n"), "1999.0\n");
  EXPECT_EQ(console.ask("ABCD\nEFGH?\nSYST:ERR:COUN?\n"), "2\n");
  EXPECT_EQ(console.ask("SYSTEM:ERROR:NEXT?;:syst:err?;:SYST:ERR?\n"),
            "-113,\"Undefined header;ABCD\";-113,\"Undefined header;EFGH?\";0,\"No error\"\n");
}

TEST(ScpiStatusCommands, QuotesInAnErrorAreDoubled) {
  ToyConsole console;
  EXPECT_EQ(console.ask("OUTP \"ON\"\n"), "");
  EXPECT_EQ(console.error(), "-158,\"String data not allowed;\"\"ON\"\"\"\n");
}

TEST(ScpiStatusCommands, ThousandErrorsInARow) {
  ToyConsole console;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(console.ask("ABCD" + std::to_string(i) + "\n"), "");
  }
  EXPECT_EQ(console.ask("SYST:ERR:COUN?\n"), "16\n");
  for (int i = 0; i < 15; ++i) {
    EXPECT_EQ(console.error(), "-113,\"Undefined header;ABCD" + std::to_string(i) + "\"\n");
  }
  EXPECT_EQ(console.error(), "-350,\"Queue overflow\"\n");
  EXPECT_EQ(console.error(), "0,\"No error\"\n");
  EXPECT_EQ(console.ask("*IDN?\n"), "maker,toy,0,1.0\n");
}

}  // namespace
}  // namespace emax::app::scpi
