// Bytes between the program and the interrupts of a UART.
#include "emax/board/console_rings.hpp"

#include <limits>

namespace emax::board {
namespace {

// Where the break was. Control-C is a device clear itself, should two of them be there.
constexpr char kMark = '\x03';

}  // namespace

std::size_t ConsoleRings::read(Span<char> bytes) noexcept {
  std::size_t count = 0;
  while (count < bytes.size() && receive_.take(bytes[count])) {
    ++count;
  }
  return count;
}

std::size_t ConsoleRings::write(Span<const char> bytes) noexcept {
  std::size_t count = 0;
  while (count < bytes.size() && transmit_.put(bytes[count])) {
    ++count;
  }
  return count;
}

std::uint32_t ConsoleRings::take_lost_count() noexcept {
  const std::uint32_t told_count = told_count_.load(std::memory_order_relaxed);
  const std::uint32_t lost_count = lost_count_.load(std::memory_order_acquire);
  told_count_.store(lost_count, std::memory_order_release);
  return lost_count - told_count;
}

void ConsoleRings::received(char byte) noexcept {
  if (!receive_.put(byte)) {
    lose();
  }
}

// Without room for the mark all that has come in is from before it.
void ConsoleRings::broken() noexcept {
  (void)receive_.put(kMark);
  is_broken_.store(true, std::memory_order_release);
}

bool ConsoleRings::take_break() noexcept {
  if (!is_broken_.load(std::memory_order_acquire)) {
    return false;
  }
  is_broken_.store(false, std::memory_order_relaxed);
  char byte = 0;
  for (std::size_t i = 0; i < kReceiveRoom && byte != kMark && receive_.take(byte); ++i) {
  }
  return true;
}

void ConsoleRings::lose() noexcept {
  const std::uint32_t lost_count = lost_count_.load(std::memory_order_relaxed);
  const std::uint32_t untold_count = lost_count - told_count_.load(std::memory_order_acquire);
  if (untold_count != std::numeric_limits<std::uint32_t>::max()) {
    lost_count_.store(lost_count + 1, std::memory_order_release);
  }
}

}  // namespace emax::board
