// Registers as in the Cortex-M System Design Kit Technical Reference Manual (DDI 0479), 4.3.
#include "emax/board/cmsdk_uart.hpp"

#include "emax/board/cortex_m.hpp"
#include "emax/board/registers.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kData = 0x00;
constexpr std::uintptr_t kState = 0x04;
constexpr std::uintptr_t kControl = 0x08;
constexpr std::uintptr_t kInterruptStatus = 0x0C;
constexpr std::uintptr_t kBaudDivider = 0x10;

constexpr std::uint32_t kTransmitFull = 1U << 0;
constexpr std::uint32_t kReceiveFull = 1U << 1;
constexpr std::uint32_t kTransmitAndReceive = 0x3;
constexpr std::uint32_t kInterruptsOfBoth = 0xC;
constexpr std::uint32_t kTransmitInterrupt = 1U << 0;
constexpr std::uint32_t kReceiveInterrupt = 1U << 1;

// Looks at the UART until a byte is given up: longer than a byte takes at 9600 baud.
constexpr std::uint32_t kMaxLooks = 1'000'000;

}  // namespace

void CmsdkUart::start(std::uint32_t clock_hz, std::uint32_t baud) noexcept {
  reg(base_ + kBaudDivider) = clock_hz / baud;
  reg(base_ + kControl) = kTransmitAndReceive | kInterruptsOfBoth;
}

void CmsdkUart::on_receive() noexcept {
  reg(base_ + kInterruptStatus) = kReceiveInterrupt;
  if ((reg(base_ + kState) & kReceiveFull) != 0) {
    rings_.received(static_cast<char>(reg(base_ + kData)));
  }
}

void CmsdkUart::on_transmit() noexcept {
  reg(base_ + kInterruptStatus) = kTransmitInterrupt;
  char byte = 0;
  while (can_take() && rings_.take_next(byte)) {
    reg(base_ + kData) = static_cast<unsigned char>(byte);
  }
}

std::size_t CmsdkUart::do_write(Span<const char> bytes) noexcept {
  const std::size_t count = rings_.write(bytes);
  // Only the interrupt takes bytes from the ring, so it has to be there for the first one too.
  trigger_interrupt(transmit_interrupt_);
  return count;
}

bool CmsdkUart::sent() const noexcept { return rings_.sent() && can_take(); }

bool CmsdkUart::can_take() const noexcept { return (reg(base_ + kState) & kTransmitFull) == 0; }

void CmsdkUart::write_polled(Span<const char> text) noexcept {
  char byte = 0;
  while (rings_.take_next(byte)) {
    put_polled(byte);
  }
  for (const char next : text) {
    put_polled(next);
  }
}

void CmsdkUart::put_polled(char byte) noexcept {
  for (std::uint32_t look = 0; look < kMaxLooks; ++look) {
    if (can_take()) {
      reg(base_ + kData) = static_cast<unsigned char>(byte);
      return;
    }
  }
}

}  // namespace emax::board
