// The image to be flashed, as it is: boot, console, sweep, faults, store, watchdog, in the virtual
// chip.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iomanip>
#include <regex>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "chip/real_image.hpp"

namespace emax::chip {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// What a fault may take: found within two blocks of 64, then at zero within 256 frames.
constexpr double kFramesToZero = 2 * 64 + 256;

TEST_F(RealImage, BootsToItsNameWithTheUniqueId) {
  board->chip.set_unique_id({0x00112233, 0x44556677, 0x8899AABB});
  boot();
  const std::string name = ask("*IDN?");
  EXPECT_EQ(name.find(std::string("emax,") + Tested::kName + ",00112233445566778899AABB,"), 0U)
      << name;
  EXPECT_EQ(ask("*TST?"), "0");
  EXPECT_EQ(error(), 0);
  EXPECT_EQ(led_changes(4.5), 4U);  // A flash every two seconds.
  EXPECT_EQ(board->chip.clocks.cpu_hz, Tested::kCpu_hz);
  EXPECT_EQ(board->chip.findings.text(), "");
}

// The proof of the stack relies on it (EMAX_STM32_INTERRUPT_LEVELS in stm32.cmake): console, output
// and clock never interrupt one another, and the watchdog's timer interrupts all three.
TEST_F(RealImage, HasTwoLevelsOfInterrupts) {
  boot();
  std::vector<unsigned> ordinary;
  std::vector<unsigned> first;
  Nvic& nvic = board->chip.processor().nvic();
  for (unsigned line = 0; line < kInterruptLines; ++line) {
    if (nvic.enabled(interrupt(line))) {
      (nvic.priority(interrupt(line)) == 0 ? first : ordinary).push_back(line);
      EXPECT_EQ(nvic.priority(interrupt(line)) & ~0x80U, 0U) << line;
    }
  }
  constexpr unsigned kTim7 = 55;  // RM0440 table 97 and RM0433 table 150.
  EXPECT_EQ(first, std::vector<unsigned>{kTim7});
  EXPECT_EQ(ordinary.size(), 3U);
}

TEST_F(RealImage, TheDrivePinRestsUntilASweepBegins) {
  boot();
  EXPECT_EQ(ask("*TST?"), "0");
  board->chip.reset_pin();
  EXPECT_TRUE(answers(1.0));
  EXPECT_EQ(board->analog.greatest_excursion_v(), 0.0);
}

// The device that the simulated bench drew, K(jw) of second order, times the gains it drew.
TEST_F(RealImage, ASweepRecoversTheTruthWithinItsUncertainty) {
  boot();
  ask("SENS:SWE:FREQ 100,300,900,2500,5000;*OPC?");
  EXPECT_EQ(ask("INIT;*OPC?", 60.0), "1");
  EXPECT_EQ(error(), 0);
  const std::vector<double> points = numbers(ask("FETC:FRES?"));
  ASSERT_EQ(points.size(), 1U + 5 * 5);
  const sim::BenchTruth& truth = bench.bench().truth();
  for (std::size_t i = 0; i < 5; ++i) {
    const double* const point = points.data() + 1 + 5 * i;
    const double x = point[0] / truth.device.natural_frequency_hz;
    const std::complex<double> k =
        truth.apparent_sensitivity /
        std::complex<double>(1.0 - x * x, 2.0 * truth.device.damping * x);
    // Five amplitudes and five phases: four standard uncertainties fail once in 1600 seeds.
    EXPECT_NEAR(point[1], std::abs(k), 4.0 * point[3]) << point[0];
    EXPECT_NEAR(point[2], std::arg(k) * 180.0 / kPi, 4.0 * point[4]) << point[0];
  }
  EXPECT_EQ(board->chip.findings.text(), "");
  EXPECT_LE(driving_v(), kCode_v);
}

struct SweepFault {
  const char* name;
  void (*strike)(Tested::Chip&);
  const char* told;  ///< What the error says.
};

void lose_a_block(Tested::Chip& chip) { chip.requests.lose(chip.adc.dma_request(), 64); }
void stop_the_converters(Tested::Chip& chip) { chip.adc.set_dead(true); }
void fail_the_response(Tested::Chip& chip) { chip.dma1.fail_next(0), chip.dma2.fail_next(0); }
void fail_the_drive(Tested::Chip& chip) { chip.dma1.fail_next(1), chip.dma2.fail_next(1); }

class FaultOfTheSweep : public RealImage, public testing::WithParamInterface<SweepFault> {};

TEST_P(FaultOfTheSweep, EndsWithAnErrorAndTheDriveAtZero) {
  boot();
  start_sweep();
  const Time struck = board->chip.events.now();
  GetParam().strike(board->chip);
  board->chip.run_for(0.05);
  EXPECT_LE(driving_v(), kCode_v);
  EXPECT_LE(frames(struck, last_driven()), kFramesToZero);
  const std::string error = ask("SYST:ERR?");
  EXPECT_EQ(error.find(std::string("-240,\"Hardware error;") + GetParam().told), 0U) << error;
  EXPECT_EQ(ask("*IDN?").substr(0, 5), "emax,");
}

INSTANTIATE_TEST_SUITE_P(
    Chip, FaultOfTheSweep,
    testing::Values(SweepFault{"lost_block", lose_a_block, "lost block"},
                    SweepFault{"dead_converters", stop_the_converters, "late block"},
                    SweepFault{"response_dma", fail_the_response, "converter fault"},
                    SweepFault{"drive_dma", fail_the_drive, "converter fault"}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(RealImage, AnAbortBringsTheDriveToZero) {
  boot();
  start_sweep();
  board->chip.console.send("ABOR\n");
  board->chip.run_for(0.1);
  EXPECT_LE(driving_v(), kCode_v);
  EXPECT_EQ(error(), 0);
  EXPECT_EQ(board->chip.findings.text(), "");
}

TEST_F(RealImage, WithoutACrystalItTalksAndRefusesToMeasure) {
  board->chip.rcc.set_hse_dead(true);
  board->chip.power_on();
  ASSERT_TRUE(answers(1.0));
  ask("INIT;*OPC?", 0.5);
  EXPECT_EQ(error(), -240);
  EXPECT_EQ(led_changes(2.0), 20U);
  EXPECT_EQ(board->analog.greatest_excursion_v(), 0.0);
  EXPECT_EQ(board->chip.findings.text(), "");
}

TEST_F(RealImage, ACrystalThatStopsEndsTheSweepWithTheDriveAtZero) {
  provoked.insert("adc_trigger_during_conversion");  // One that began at a tenth of the clock.
  boot();
  start_sweep();
  const Time struck = board->chip.events.now();
  board->chip.rcc.set_hse_dead(true);
  board->chip.run_for(0.3);
  EXPECT_FALSE(board->chip.findings.has("clock_lost"));
  EXPECT_LE(driving_v(), kCode_v);
  // The stream's clock is ten times as slow now.
  EXPECT_LE(seconds(last_driven() - struck), 0.2);
  EXPECT_EQ(error(), -240);
}

class FlagThatNeverComes : public RealImage, public testing::WithParamInterface<HeldFlag> {};

// Whatever does not come, the console answers in the end, and the drive rests.
TEST_P(FlagThatNeverComes, IsWaitedForWithinBounds) {
  const HeldFlag& flag = GetParam();
  board->chip.hold(flag.block, flag.register_name, flag.bits, flag.value);
  board->chip.power_on();
  ASSERT_TRUE(answers(3.0));
  ask("SENS:SWE:FREQ 200,500,1000;*OPC?");
  ask("INIT;*OPC?", 3.0);
  EXPECT_LE(driving_v(), kCode_v);
  EXPECT_TRUE(answers(3.0));
}

// Its period is not certain then, so it is kicked, and nothing is driven.
TEST_F(RealImage, AWatchdogThatDoesNotTakeItsSettingsIsToldAndNothingIsDriven) {
  board->chip.hold("IWDG", "SR", 7, 7);
  board->chip.power_on();
  ASSERT_TRUE(answers(1.0));
  EXPECT_EQ(error(), -240);
  ask("SENS:SWE:FREQ 200,500,1000;*OPC?");
  EXPECT_EQ(ask("INIT;*OPC?", 1.0), "1");
  EXPECT_EQ(
      ask("SYST:ERR?"),
      "-240,\"Hardware error;the watchdog does not start: no sweep; switch the board off and on\"");
  EXPECT_EQ(led_changes(2.0), 20U);
  board->chip.run_for(30.0);
  EXPECT_EQ(board->chip.resets(), 1U);
  EXPECT_EQ(error(), 0);
  EXPECT_EQ(ask("*TST?"), "0");
  EXPECT_EQ(board->analog.greatest_excursion_v(), 0.0);
  EXPECT_EQ(board->chip.findings.text(), "");
}

INSTANTIATE_TEST_SUITE_P(Chip, FlagThatNeverComes, testing::ValuesIn(Tested::flags()),
                         [](const auto& flag) {
                           return std::string(flag.param.block) + "_" + flag.param.register_name +
                                  "_" + std::to_string(flag.param.bits);
                         });

/// Every so many operations of a save, beginning with one of them, so that tests share the work.
class PowerCutAt : public RealImage, public testing::WithParamInterface<unsigned> {};

constexpr unsigned kShares = 6;

TEST_P(PowerCutAt, LeavesTheOldOrTheNewSettings) {
  boot();
  ask("SENS:SWE:CYCL 11;*SAV 1;*OPC?");
  const unsigned before = board->chip.flash.operations();
  ask("SENS:SWE:CYCL 12;*SAV 1;*OPC?");
  const unsigned operations = board->chip.flash.operations() - before;
  ASSERT_GT(operations, 1U);
  std::string kept = "12";
  int next = 13;
  for (unsigned operation = GetParam(); operation < operations; operation += kShares) {
    // Within each one; before and after it now and then, as nothing is torn there.
    std::vector<PowerCut> ways = {PowerCut::kWithin};
    if (operation % 16 == 0 || operation + 1 == operations) {
      ways = {PowerCut::kBefore, PowerCut::kWithin, PowerCut::kAfter};
    }
    for (const PowerCut how : ways) {
      const std::string wanted = std::to_string(next++);
      board->chip.flash.cut_power_at(operation, how);
      ask("SENS:SWE:CYCL " + wanted + ";*SAV 1;*OPC?", 1.0);
      ASSERT_TRUE(board->chip.power_failed()) << operation;
      boot();
      const std::string found = ask("*RCL 1;SENS:SWE:CYCL?");
      ASSERT_TRUE(found == kept || found == wanted) << found << " after a cut at " << operation;
      // A copy that is torn may have been the newer one, and that is told.
      const int told = error();
      ASSERT_TRUE(told == 0 || (told == -314 && found == kept)) << told << " at " << operation;
      kept = found;
    }
  }
  ask("SENS:SWE:CYCL 7;*SAV 1;*OPC?");
  boot();
  EXPECT_EQ(ask("*RCL 1;SENS:SWE:CYCL?"), "7");
  EXPECT_EQ(board->chip.findings.text(), "");
}

INSTANTIATE_TEST_SUITE_P(Chip, PowerCutAt, testing::Range(0U, kShares));

/// A pseudo terminal that stands for the serial line between a program of the PC and the board.
class SerialLine {
 public:
  SerialLine() : board_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    if (board_ < 0 || grantpt(board_) != 0 || unlockpt(board_) != 0) {
      return;
    }
    name_ = ptsname(board_);
    // Held open and raw: the line is there before and after its program.
    program_ = open(name_.c_str(), O_RDWR | O_NOCTTY);
    termios line = {};
    tcgetattr(program_, &line);
    cfmakeraw(&line);
    tcsetattr(program_, TCSANOW, &line);
  }
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;
  ~SerialLine() {
    close(program_);
    close(board_);
  }
  const std::string& name() const { return name_; }

  /// Hands over what both sides have sent.
  void carry(Uart& console) const {
    char bytes[256];
    const ssize_t count = read(board_, bytes, sizeof bytes);
    if (count > 0) {
      console.send(std::string(bytes, static_cast<std::size_t>(count)));
    }
    const std::string sent = console.take_sent();
    if (!sent.empty()) {
      ASSERT_EQ(write(board_, sent.data(), sent.size()), static_cast<ssize_t>(sent.size()));
    }
  }

 private:
  int board_;
  int program_ = -1;
  std::string name_;
};

// The program on the PC is the front end of the board: it sets it up, has it measure, and
// evaluates.
TEST_F(RealImage, MeasuresForTheReportOfThePc) {
  if (!std::ifstream(EMAX_CHIP_PROGRAM)) {
    GTEST_SKIP() << "no " EMAX_CHIP_PROGRAM;
  }
  boot();
  ASSERT_TRUE(answers(1.0));
  const SerialLine line;
  const std::string command = std::string(EMAX_CHIP_PROGRAM " report --instrument ") + line.name() +
                              " --frequencies 900,2500,5000 --trials 1000 --trend none 2>&1";
  std::string output;
  int status = -1;
  std::atomic<bool> has_ended = false;
  std::thread program([&] {
    FILE* const pipe = popen(command.c_str(), "r");
    char bytes[256];
    for (std::size_t count = 1; pipe != nullptr && count > 0;) {
      count = fread(bytes, 1, sizeof bytes, pipe);
      output.append(bytes, count);
    }
    status = pipe != nullptr ? pclose(pipe) : -1;
    has_ended = true;
  });
  while (!has_ended) {
    board->chip.run_for(1e-3);
    line.carry(board->chip.console);
  }
  program.join();
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << output;
  EXPECT_NE(output.find("3 points"), std::string::npos) << output;
  EXPECT_EQ(output.find("simulat"), std::string::npos) << "it cannot know what is connected";
  // What the board says of the points that it has measured.
  const std::vector<double> fit = numbers(ask("CALC:IDEN?"));
  ASSERT_EQ(fit.size(), 8U);
  EXPECT_NEAR(fit[1], bench.bench().truth().device.natural_frequency_hz, 4.0 * fit[4]);
  EXPECT_EQ(board->chip.findings.text(), "");
}

// A wire from the drive to both inputs: what the acceptance test of a board must answer. A
// converter of 12 bits has steps of 0.8 mV, and half of the drive limit is some 0.8 V.
TEST_F(RealImage, ALoopbackFindsAWireAndItsLatency) {
  Wire wire;
  put_on_bench(wire);
  boot();
  ASSERT_TRUE(answers(1.0));
  const std::vector<double> found = numbers(ask("DIAG:LOOP?", 30.0));
  ASSERT_EQ(found.size(), 11U) << ask("SYST:ERR:ALL?");
  EXPECT_NEAR(found[0], Tested::kLatencyFrames, 0.05) << "frames, as the stream states";
  EXPECT_NEAR(found[3], 1.0, 5e-3);
  EXPECT_NEAR(found[4], 1.0, 5e-3);
  EXPECT_NEAR(found[5], 1.0, 1e-4) << "both inputs see the same";
  EXPECT_NEAR(found[6], 0.0, 1e-9) << "at the same instant";
  EXPECT_EQ(found[10], 0.0);
  EXPECT_EQ(error(), 0);
  EXPECT_EQ(board->chip.findings.text(), "");
}

// A break is a device clear: half a message is forgotten.
TEST_F(RealImage, ABreakClearsTheDevice) {
  boot();
  ASSERT_TRUE(answers(1.0));
  board->chip.console.send("SENS:SWE:CYCL 1");
  board->chip.run_for(0.01);
  board->chip.console.spoil_next(LineFault::kFraming);
  board->chip.console.send(std::string(1, '\0'));
  board->chip.run_for(0.01);
  EXPECT_EQ(ask("SENS:SWE:CYCL?"), "3");
  EXPECT_EQ(error(), 0);
  EXPECT_EQ(board->chip.findings.text(), "");
}

TEST_F(RealImage, NoiseAndFramingErrorsAreSurvived) {
  boot();
  for (const LineFault fault : {LineFault::kNoise, LineFault::kFraming}) {
    board->chip.console.spoil_next(fault);
    ask("*IDN?", 0.05);
    ask("*CLS;*OPC?", 0.05);
    EXPECT_EQ(ask("*IDN?").substr(0, 5), "emax,");
  }
  EXPECT_EQ(board->chip.findings.text(), "");
}

TEST_F(RealImage, AnOverrunIsSurvived) {
  boot();
  board->chip.processor().nvic().enable(interrupt(Tested::kConsoleInterrupt), false);
  board->chip.console.send("*IDN?*IDN?*IDN?*IDN?");  // More than 16 bytes, the largest FIFO.
  board->chip.run_for(0.01);
  EXPECT_GT(board->chip.console.lost(), 0U);
  board->chip.processor().nvic().enable(interrupt(Tested::kConsoleInterrupt), true);
  board->chip.run_for(0.01);
  ask("", 0.1);
  ask("*CLS;*OPC?", 0.5);
  EXPECT_EQ(ask("*IDN?").substr(0, 5), "emax,");
  EXPECT_EQ(board->chip.findings.text(), "");
}

/// An image in which a function has become a loop without end, until the reset.
class Hang : public RealImage {
 protected:
  void put_in(const std::string& name, std::vector<std::uint16_t> code) {
    std::uint8_t* const at = board->chip.flash.bytes() + (function(name) - kFlashBase);
    std::vector<std::uint16_t> old(code.size());
    std::memcpy(old.data(), at, 2 * old.size());
    std::memcpy(at, code.data(), 2 * code.size());
    board->chip.processor().engine().forget_code();
    name_ = name;
    old_ = old;
  }
  /// Waits for the reset, and mends the image. @returns False if there is none.
  bool is_reset(double most_s) {
    const bool reset =
        board->chip.run_until([&] { return board->chip.resets() > 1; }, most_s, 1e-3);
    put_in(name_, old_);
    return reset;
  }

 private:
  std::string name_;
  std::vector<std::uint16_t> old_;
};

TEST_F(Hang, IsToldAndEndsWithAReset) {
  boot();
  put_in("Watchdog4kick", {0xE7FE});
  EXPECT_TRUE(is_reset(30.0));
  // The whole line, although the reset comes right behind it: the console's last character is out.
  const std::string told = board->chip.console.take_sent();
  std::ostringstream pc;
  pc << "0x" << std::hex << std::setw(8) << std::setfill('0') << function("Watchdog4kick");
  EXPECT_TRUE(std::regex_match(
      told, std::regex("\nfault: watchdog, drive at zero, exception=0x00000047 pc=" + pc.str() +
                       "( [a-z]+=0x[0-9a-f]{8}){7}\n")))
      << told;
  EXPECT_TRUE(answers(1.0));
  EXPECT_EQ(error(), -310);
  EXPECT_EQ(board->analog.greatest_excursion_v(), 0.0);
}

TEST_F(Hang, OfASweepBringsTheDriveToZeroBeforeTheReset) {
  boot();
  start_sweep();
  put_in("Watchdog4kick", {0xE7FE});
  EXPECT_TRUE(is_reset(30.0));
  // The last step was a small one, and the converter's output went off in the middle.
  const auto& record = board->analog.drive_record();
  const auto off = std::find_if(record.begin() + 2, record.end(),
                                [](const DriveSample& sample) { return !sample.on; });
  ASSERT_NE(off, record.end());
  EXPECT_LE(std::fabs((off - 1)->pin_v - kMiddle_v), kCode_v);
  EXPECT_TRUE(answers(1.0));
  EXPECT_EQ(error(), -310);
}

TEST_F(Hang, WithoutInterruptsIsEndedByTheOtherWatchdog) {
  boot();
  start_sweep();
  put_in("Watchdog4kick", {0xB672, 0xE7FE});  // cpsid i
  EXPECT_TRUE(is_reset(30.0));
  EXPECT_TRUE(board->chip.was_reset_by_watchdog());
  EXPECT_TRUE(answers(1.0));
  EXPECT_EQ(error(), -310);
  EXPECT_LE(driving_v(), kCode_v);
}

}  // namespace
}  // namespace emax::chip
