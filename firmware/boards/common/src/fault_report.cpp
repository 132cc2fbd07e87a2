// The line about a fault, and what comes before and after it.
#include "emax/board/fault_report.hpp"

namespace emax::board {
namespace {

// Text into memory of the caller, as far as there is room.
class Line {
 public:
  explicit Line(Span<char> room) noexcept : room_(room) {}

  void add(char character) noexcept {
    if (count_ < room_.size()) {
      room_[count_++] = character;
    }
  }
  void add(const char* text) noexcept {
    for (; *text != '\0'; ++text) {
      add(*text);
    }
  }
  void add_hexadecimal(std::uint32_t value) noexcept {
    add("0x");
    for (unsigned shift = 32; shift != 0;) {
      shift -= 4;
      add("0123456789abcdef"[(value >> shift) & 0xFU]);
    }
  }
  std::size_t count() const noexcept { return count_; }

 private:
  Span<char> room_;
  std::size_t count_ = 0;
};

// How many faults there have been since the board started, and whether the first one led the drive
// to zero, where nothing has moved it since.
std::uint8_t fault_count = 0;
bool is_at_zero = false;

}  // namespace

std::size_t format_fault_line(const char* kind, bool drive_is_at_zero,
                              Span<const FaultNumber> numbers, Span<char> text) noexcept {
  Line line(text);
  line.add("\nfault: ");
  line.add(kind);
  line.add(drive_is_at_zero ? ", drive at zero," : ", DRIVE NOT AT ZERO,");
  for (const FaultNumber& number : numbers) {
    line.add(' ');
    line.add(number.name);
    line.add('=');
    line.add_hexadecimal(number.value);
  }
  line.add('\n');
  return line.count();
}

void report_fault(const char* kind, Span<const FaultNumber> numbers) noexcept {
  ++fault_count;
  if (fault_count > 2) {
    return;
  }
  if (fault_count == 1) {
    is_at_zero = lead_drive_to_zero();
  }
  char text[kFaultLineRoom];
  write_polled({text, format_fault_line(kind, is_at_zero, numbers, text)});
}

}  // namespace emax::board
