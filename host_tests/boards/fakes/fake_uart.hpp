// A USART of an STM32 with its FIFOs, and a peer at the other end of the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <utility>

#include "emax/board/registers.hpp"

namespace emax::test {

class FakeUart final : public FakeChip {
 public:
  static constexpr std::uintptr_t kBase = 0x40008000;
  static constexpr std::uint32_t kFramingError = 1U << 1;
  static constexpr std::uint32_t kNoise = 1U << 2;
  static constexpr std::uint32_t kOverrun = 1U << 3;

  void set_interrupt(std::function<void()> handler) { handler_ = std::move(handler); }

  /// A byte comes in, perhaps with an error, and is dropped if the FIFO is full.
  void receive(char byte, std::uint32_t errors = 0) {
    if (received_.size() == kFifoBytes) {
      status_ |= kOverrun;
    } else {
      received_.push_back({byte, errors});
    }
  }
  /// What has gone out; the line takes some bytes at a time, and then the interrupt comes.
  std::string take_sent() { return std::exchange(sent_, {}); }
  void raise_overrun() { status_ |= kOverrun; }
  void stop_line(bool stopped) { is_line_stopped_ = stopped; }
  std::uint32_t baud_register() const { return baud_; }

  /// Lets the interrupt come as often as something asks for it. @returns How often.
  int interrupt() {
    int count = 0;
    for (; count < 10000 && asks(); ++count) {
      handler_();
      drain();
    }
    return count;
  }

  std::uint32_t read(std::uintptr_t address, unsigned /*bytes*/) override {
    switch (address - kBase) {
      case 0x00:
        return control_;
      case 0x1C:
        drain_slowly();
        return status();
      case 0x24: {
        const char byte = received_.empty() ? '\0' : received_.front().first;
        if (!received_.empty()) {
          received_.pop_front();
        }
        return static_cast<unsigned char>(byte);
      }
      default:
        return 0;
    }
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    switch (address - kBase) {
      case 0x00:
        control_ = value;
        return;
      case 0x0C:
        baud_ = value;
        return;
      case 0x20:
        status_ &= ~value;
        if (!received_.empty()) {
          received_.front().second &= ~value;
        }
        return;
      case 0x28:
        if (waiting_.size() < kFifoBytes) {
          waiting_ += static_cast<char>(value);
        }
        return;
      default:
        return;
    }
  }

 private:
  static constexpr std::size_t kFifoBytes = 8;

  std::uint32_t status() const {
    std::uint32_t value = status_;
    if (!received_.empty()) {
      value |= 1U << 5 | received_.front().second;
    }
    value |= waiting_.size() < kFifoBytes ? 1U << 7 : 0;
    value |= waiting_.empty() ? 1U << 6 : 0;
    return value;
  }

  bool asks() const {
    const std::uint32_t now = status();
    const bool is_on = (control_ & 1U) != 0;
    const bool receives = (control_ & 1U << 5) != 0 && (now & (1U << 5 | kOverrun)) != 0;
    const bool transmits = (control_ & 1U << 7) != 0 && (now & 1U << 7) != 0;
    return is_on && (receives || transmits);
  }

  void drain() {
    if (!is_line_stopped_) {
      sent_ += std::exchange(waiting_, {});
    }
  }
  // One byte for many looks.
  void drain_slowly() {
    ++looks_;
    if (!is_line_stopped_ && looks_ % 16 == 0 && !waiting_.empty()) {
      sent_ += waiting_.front();
      waiting_.erase(0, 1);
    }
  }

  std::function<void()> handler_;
  std::deque<std::pair<char, std::uint32_t>> received_;
  std::string waiting_;
  std::string sent_;
  std::uint32_t control_ = 0;
  std::uint32_t status_ = 0;
  std::uint32_t baud_ = 0;
  std::uint64_t looks_ = 0;
  bool is_line_stopped_ = false;
};

}  // namespace emax::test
