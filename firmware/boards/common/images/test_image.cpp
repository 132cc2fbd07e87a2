// The way out of a test image.
#include "test_image.hpp"

#include "emax/board/board.hpp"
#include "emax/board/semihosting.hpp"
#include "emax/board/stack_mark.hpp"

namespace emax::board {
namespace {

/// Text for the emulator's own console.
class EmulatorSink final : public app::TextSink {
 public:
  void write(Span<const char> text) noexcept override {
    for (const char character : text) {
      const char one[] = {character, '\0'};
      tell_emulator(one);
    }
  }
};

}  // namespace

void finish(int status) noexcept {
  while (!console_sent()) {
  }
  const std::size_t used = used_stack_bytes(stack());
  EmulatorSink sink;
  app::TextWriter out(sink);
  out.text("stack: ").integer(used).text(" of ").integer(stack().size() * 4).text(" bytes used\n");
  end_emulation(status);
}

}  // namespace emax::board
