// Registers as in the data sheet of the PC16550D.
#include "emax/board/ns16550.hpp"

#include "emax/board/registers.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kData = 0;
constexpr std::uintptr_t kDivisorLow = 0;
constexpr std::uintptr_t kInterruptEnable = 1;
constexpr std::uintptr_t kDivisorHigh = 1;
constexpr std::uintptr_t kLineControl = 3;
constexpr std::uintptr_t kLineStatus = 5;

constexpr std::uint8_t kReceiveInterrupt = 1U << 0;
constexpr std::uint8_t kTransmitInterrupt = 1U << 1;
constexpr std::uint8_t kEightBits = 0x03;
constexpr std::uint8_t kDivisorLatch = 0x80;
constexpr std::uint8_t kDataReady = 1U << 0;
constexpr std::uint8_t kBreak = 1U << 4;
constexpr std::uint8_t kTransmitEmpty = 1U << 5;

// Looks at the UART until a byte is given up: longer than a byte takes at 9600 baud.
constexpr std::uint32_t kMaxLooks = 1'000'000;

}  // namespace

void Ns16550::start(std::uint32_t clock_hz, std::uint32_t baud) noexcept {
  const std::uint32_t divisor = clock_hz / (16 * baud);
  reg<std::uint8_t>(base_ + kLineControl) = kDivisorLatch | kEightBits;
  reg<std::uint8_t>(base_ + kDivisorLow) = static_cast<std::uint8_t>(divisor & 0xFFU);
  reg<std::uint8_t>(base_ + kDivisorHigh) = static_cast<std::uint8_t>(divisor >> 8U);
  reg<std::uint8_t>(base_ + kLineControl) = kEightBits;
  reg<std::uint8_t>(base_ + kInterruptEnable) = kReceiveInterrupt;
}

void Ns16550::on_interrupt() noexcept {
  // Reading the status clears the break.
  const std::uint8_t status = reg<std::uint8_t>(base_ + kLineStatus);
  if ((status & kDataReady) != 0) {
    const auto byte = static_cast<char>(reg<std::uint8_t>(base_ + kData));
    if ((status & kBreak) != 0) {
      rings_.broken();
    } else {
      rings_.received(byte);
    }
  }
  if (!can_take()) {
    return;
  }
  char byte = 0;
  if (rings_.take_next(byte)) {
    reg<std::uint8_t>(base_ + kData) = static_cast<std::uint8_t>(byte);
  } else {
    reg<std::uint8_t>(base_ + kInterruptEnable) = kReceiveInterrupt;
  }
}

std::size_t Ns16550::do_write(Span<const char> bytes) noexcept {
  const std::size_t count = rings_.write(bytes);
  // An interrupt for the empty transmitter is there at once, and switches itself off with the ring
  // empty; only it takes bytes from the ring.
  reg<std::uint8_t>(base_ + kInterruptEnable) = kReceiveInterrupt | kTransmitInterrupt;
  return count;
}

bool Ns16550::sent() const noexcept { return rings_.sent() && can_take(); }

bool Ns16550::can_take() const noexcept {
  return (reg<std::uint8_t>(base_ + kLineStatus) & kTransmitEmpty) != 0;
}

void Ns16550::write_polled(Span<const char> text) noexcept {
  char byte = 0;
  while (rings_.take_next(byte)) {
    put_polled(byte);
  }
  for (const char next : text) {
    put_polled(next);
  }
}

void Ns16550::put_polled(char byte) noexcept {
  for (std::uint32_t look = 0; look < kMaxLooks; ++look) {
    if (can_take()) {
      reg<std::uint8_t>(base_ + kData) = static_cast<std::uint8_t>(byte);
      return;
    }
  }
}

}  // namespace emax::board
