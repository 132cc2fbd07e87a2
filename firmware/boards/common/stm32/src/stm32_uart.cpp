// Both FIFOs of a USART against the rings of the console.
#include "emax/board/stm32_uart.hpp"

#include "emax/board/registers.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kControl1 = 0x00;
constexpr std::uintptr_t kControl2 = 0x04;
constexpr std::uintptr_t kControl3 = 0x08;
constexpr std::uintptr_t kBaudRate = 0x0C;
constexpr std::uintptr_t kStatus = 0x1C;
constexpr std::uintptr_t kClear = 0x20;
constexpr std::uintptr_t kReceiveData = 0x24;
constexpr std::uintptr_t kTransmitData = 0x28;

constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kReceiver = 1U << 2;
constexpr std::uint32_t kTransmitter = 1U << 3;
constexpr std::uint32_t kReceiveInterrupt = 1U << 5;
constexpr std::uint32_t kTransmitInterrupt = 1U << 7;
constexpr std::uint32_t kFifos = 1U << 29;

// The same bits tell of an error and clear it.
constexpr std::uint32_t kParityError = 1U << 0;
constexpr std::uint32_t kFramingError = 1U << 1;
constexpr std::uint32_t kNoise = 1U << 2;
constexpr std::uint32_t kOverrun = 1U << 3;
constexpr std::uint32_t kErrorsOfByte = kParityError | kFramingError | kNoise;
constexpr std::uint32_t kErrors = kErrorsOfByte | kOverrun;
constexpr std::uint32_t kReceived = 1U << 5;
constexpr std::uint32_t kSent = 1U << 6;
constexpr std::uint32_t kRoomToSend = 1U << 7;

constexpr std::uint32_t kByte = 0xFF;
// More than a FIFO holds: an interrupt ends, whatever the flags say.
constexpr unsigned kMostBytes = 32;
// Looks at the UART until a byte is given up: longer than a byte takes at 9600 baud and 400 MHz.
constexpr std::uint32_t kMaxLooks = 1'000'000;

}  // namespace

void Stm32Uart::start(std::uint32_t clock_hz, std::uint32_t baud) noexcept {
  const std::uint64_t scaled_hz = std::uint64_t{clock_hz} * (kind_ == UartKind::kLpuart ? 256 : 1);
  reg(base_ + kControl1) = 0;
  reg(base_ + kControl2) = 0;
  reg(base_ + kControl3) = 0;
  reg(base_ + kBaudRate) = static_cast<std::uint32_t>((scaled_hz + baud / 2) / baud);
  reg(base_ + kControl1) = kFifos;
  reg(base_ + kControl1) = kFifos | kReceiver | kTransmitter | kEnable;
  reg(base_ + kClear) = kErrors;
  // Should something wait to go out, its interrupt takes it now.
  reg(base_ + kControl1) =
      kFifos | kReceiver | kTransmitter | kEnable | kReceiveInterrupt | kTransmitInterrupt;
}

void Stm32Uart::on_interrupt() noexcept {
  receive();
  transmit();
}

void Stm32Uart::receive() noexcept {
  for (unsigned count = 0; count < kMostBytes; ++count) {
    const std::uint32_t status = reg(base_ + kStatus);
    if ((status & kErrors) != 0) {
      // Also where there is no byte: an overrun that stays would interrupt for ever.
      reg(base_ + kClear) = status & kErrors;
    }
    if ((status & kOverrun) != 0) {
      rings_.lose();
    }
    if ((status & kReceived) == 0) {
      return;
    }
    const auto byte = static_cast<char>(reg(base_ + kReceiveData) & kByte);
    if ((status & kErrorsOfByte) == 0) {
      rings_.received(byte);
    } else if (byte != '\0') {
      rings_.lose();
    } else {
      rings_.broken();  // A zero without a stop bit.
    }
  }
}

void Stm32Uart::transmit() noexcept {
  if ((reg(base_ + kControl1) & kTransmitInterrupt) == 0) {
    return;
  }
  for (unsigned count = 0; count < kMostBytes && can_take(); ++count) {
    char byte = 0;
    if (!rings_.take_next(byte)) {
      reg(base_ + kControl1) &= ~kTransmitInterrupt;
      return;
    }
    reg(base_ + kTransmitData) = static_cast<unsigned char>(byte);
  }
}

std::size_t Stm32Uart::do_write(Span<const char> bytes) noexcept {
  const std::size_t count = rings_.write(bytes);
  // Only the interrupt takes bytes from the ring. Should it come within this, it takes them too,
  // and comes once more for nothing.
  reg(base_ + kControl1) |= kTransmitInterrupt;
  return count;
}

bool Stm32Uart::sent() const noexcept {
  return rings_.sent() && (reg(base_ + kStatus) & kSent) != 0;
}

bool Stm32Uart::can_take() const noexcept { return (reg(base_ + kStatus) & kRoomToSend) != 0; }

void Stm32Uart::write_polled(Span<const char> text) noexcept {
  reg(base_ + kControl1) &= ~kTransmitInterrupt;
  char byte = 0;
  while (rings_.take_next(byte)) {
    put_polled(byte);
  }
  for (const char next : text) {
    put_polled(next);
  }
  // A reset that follows would take what is still in the FIFO.
  wait_until(kSent);
}

void Stm32Uart::put_polled(char byte) noexcept {
  wait_until(kRoomToSend);
  if (can_take()) {
    reg(base_ + kTransmitData) = static_cast<unsigned char>(byte);
  }
}

void Stm32Uart::wait_until(std::uint32_t flag) const noexcept {
  for (std::uint32_t look = 0; look < kMaxLooks; ++look) {
    if ((reg(base_ + kStatus) & flag) != 0) {
      return;
    }
  }
}

}  // namespace emax::board
