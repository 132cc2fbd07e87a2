// A board on the desk of a test: load an image, switch on, talk to it, look at what it did.
#pragma once

#include <string>

#include "chip/analog_side.hpp"
#include "chip/elf.hpp"
#include "chip/stm32g474.hpp"
#include "chip/stm32h743.hpp"

namespace emax::chip {

///     Wire wire;
///     VirtualBoard board(image_path, wire);
///     board.chip.power_on();
///     EXPECT_EQ(board.ask("*IDN?", 1.0), "...");
///     EXPECT_EQ(board.chip.findings.text(), "");
template <typename Chip>
class VirtualBoardOf {
 public:
  VirtualBoardOf(const std::string& image_path, BenchInVolts& bench,
                 const FrontEnd& front_end = FrontEnd{})
      : analog(bench, front_end), chip(analog) {
    chip.load(read_elf(image_path));
  }

  /// Sends a line and waits for the line that answers it.
  ///
  /// @returns The answer without its end; what has come so far if there is none in this time.
  std::string ask(const std::string& question, double most_s) {
    chip.console.take_sent();
    chip.console.send(question + "\n");
    chip.run_until_text("\n", most_s);
    std::string answer = chip.console.take_sent();
    while (!answer.empty() && (answer.back() == '\n' || answer.back() == '\r')) {
      answer.pop_back();
    }
    return answer;
  }

  AnalogSide analog;
  Chip chip;
};

/// A NUCLEO-G474RE.
using VirtualBoard = VirtualBoardOf<Stm32g474>;
/// A NUCLEO-H743ZI2.
using VirtualH743 = VirtualBoardOf<Stm32h743>;

}  // namespace emax::chip
