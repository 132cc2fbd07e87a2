// The console of the STM32 boards over fake registers: it keeps the contract of a console, and ends
// every interrupt, whatever comes in.
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>

#include "emax/board/stm32_uart.hpp"

#include "boards/fakes/fake_uart.hpp"
#include "hal/board_conformance.hpp"

namespace emax::test {
namespace {

using board::Stm32Uart;
using board::UartKind;

constexpr std::uint32_t kBaud = 115200;

class Bench {
 public:
  explicit Bench(UartKind kind = UartKind::kLpuart) : uart_(FakeUart::kBase, kind) {
    chip_.set_interrupt([this] { uart_.on_interrupt(); });
    uart_.start(170'000'000, kBaud);
  }
  Bench(const Bench&) = delete;

  Stm32Uart& uart() { return uart_; }
  FakeUart& chip() { return chip_; }

  std::string read() {
    std::string bytes(2000, '#');
    bytes.resize(uart_.read({&bytes[0], bytes.size()}));
    return bytes;
  }
  std::size_t write(const std::string& bytes) {
    return uart_.write(Span<const char>(bytes.data(), bytes.size()));
  }

  /// For the suite: the line is a UART's, which cannot tell whether there is a peer.
  class Line final : public hal::ByteStream {
   public:
    explicit Line(Bench& bench) : bench_(bench) {}
    bool is_there = true;

   private:
    std::size_t do_read(Span<char> bytes) noexcept override { return bench_.uart_.read(bytes); }
    std::size_t do_write(Span<const char> bytes) noexcept override {
      return bench_.uart_.write(bytes);
    }
    bool do_connected() const noexcept override { return is_there; }
    std::uint32_t do_take_lost_count() noexcept override { return bench_.uart_.take_lost_count(); }
    Bench& bench_;
  };
  Line& stream() { return line_; }
  void connect(bool is_there) { line_.is_there = is_there; }
  void send(const std::string& bytes) {
    for (const char byte : bytes) {
      chip_.receive(byte);
      chip_.interrupt();
    }
  }
  std::string receive() {
    chip_.interrupt();
    return chip_.take_sent();
  }

 private:
  FakeUart chip_;
  Stm32Uart uart_;
  Line line_{*this};
};

TEST(Stm32Uart, KeepsTheContract) {
  Bench bench;
  EXPECT_TRUE(violated_by_byte_stream(bench).none());
}

TEST(Stm32Uart, DividesItsClock) {
  // 256 * 170 MHz / 115200 = 377777.8; the USART of 100 MHz 868.06.
  EXPECT_EQ(Bench().chip().baud_register(), 377778U);
  Bench usart(UartKind::kUsart);
  usart.uart().start(100'000'000, kBaud);
  EXPECT_EQ(usart.chip().baud_register(), 868U);
}

TEST(Stm32Uart, CountsWhatItsFifoHasNotTaken) {
  Bench bench;
  for (int i = 0; i < 12; ++i) {
    bench.chip().receive('a');
  }
  EXPECT_LT(bench.chip().interrupt(), 5);
  EXPECT_EQ(bench.read(), std::string(8, 'a'));
  EXPECT_EQ(bench.uart().take_lost_count(), 1U);
}

TEST(Stm32Uart, EndsTheInterruptOfAnOverrunWithoutAByte) {
  Bench bench;
  bench.chip().interrupt();
  bench.chip().raise_overrun();
  EXPECT_LT(bench.chip().interrupt(), 3);
  EXPECT_EQ(bench.read(), "");
  EXPECT_EQ(bench.uart().take_lost_count(), 1U);
}

TEST(Stm32Uart, DropsWhatIsDamagedAndCountsIt) {
  Bench bench;
  bench.chip().receive('a');
  bench.chip().receive('b', FakeUart::kNoise);
  bench.chip().receive('c', FakeUart::kFramingError);
  bench.chip().receive('d');
  EXPECT_LT(bench.chip().interrupt(), 5);
  EXPECT_EQ(bench.read(), "ad");
  EXPECT_EQ(bench.uart().take_lost_count(), 2U);
}

TEST(Stm32Uart, TellsABreak) {
  Bench bench;
  EXPECT_FALSE(bench.uart().take_break());
  bench.chip().receive('a');
  bench.chip().receive('\0', FakeUart::kFramingError);
  bench.chip().receive('*');
  EXPECT_LT(bench.chip().interrupt(), 6);
  EXPECT_TRUE(bench.uart().take_break());
  EXPECT_FALSE(bench.uart().take_break());
  EXPECT_EQ(bench.read(), "*");
  EXPECT_EQ(bench.uart().take_lost_count(), 0U);
}

TEST(Stm32Uart, AsksForNoInterruptWithNothingToSend) {
  Bench bench;
  bench.chip().interrupt();
  EXPECT_EQ(bench.chip().interrupt(), 0);
  EXPECT_TRUE(bench.uart().sent());
  EXPECT_EQ(bench.write("answer"), 6U);
  EXPECT_FALSE(bench.uart().sent());
  bench.chip().interrupt();
  EXPECT_EQ(bench.chip().take_sent(), "answer");
  EXPECT_TRUE(bench.uart().sent());
}

TEST(Stm32Uart, PutsAFaultBehindWhatWaits) {
  Bench bench;
  EXPECT_EQ(bench.write("first "), 6U);
  bench.uart().write_polled(Span<const char>("fault", 5));
  bench.chip().interrupt();
  for (int look = 0; look < 1000; ++look) {
    (void)bench.uart().sent();
  }
  EXPECT_EQ(bench.chip().take_sent(), "first fault");
}

TEST(Stm32Uart, GivesUpALineThatTakesNothing) {
  Bench bench;
  bench.chip().stop_line(true);
  bench.uart().write_polled(Span<const char>("0123456789", 10));
  bench.chip().stop_line(false);
  bench.chip().interrupt();
  for (int look = 0; look < 1000; ++look) {
    (void)bench.uart().sent();
  }
  EXPECT_EQ(bench.chip().take_sent(), "01234567");
}

TEST(Stm32Uart, GoesOnAtAnotherClock) {
  Bench bench;
  bench.uart().start(16'000'000, kBaud);
  EXPECT_EQ(bench.chip().baud_register(), 35556U);
  bench.chip().receive('x');
  bench.chip().interrupt();
  EXPECT_EQ(bench.read(), "x");
}

}  // namespace
}  // namespace emax::test
