// What all test images share: text on the console without loss, and the way out.
#pragma once

#include "emax/app/base/text_writer.hpp"
#include "emax/base/span.hpp"
#include "emax/hal/byte_stream.hpp"

namespace emax::board {

/// Text for the console; waits for room, as only a test may.
class ConsoleSink final : public app::TextSink {
 public:
  explicit ConsoleSink(hal::ByteStream& console) noexcept : console_(console) {}

  void write(Span<const char> text) noexcept override {
    while (!text.empty()) {
      text = text.from(console_.write(text));
    }
  }

 private:
  hal::ByteStream& console_;
};

/// Waits until the console has sent everything, tells the emulator how much of the stack was used,
/// and ends.
[[noreturn]] void finish(int status) noexcept;

}  // namespace emax::board
