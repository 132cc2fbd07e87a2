// A console in memory: a peer puts bytes in and takes bytes out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "emax/hal/byte_stream.hpp"

namespace emax::test {

/// Both directions hold `room` bytes. Nothing moves but by the calls of either side.
class MemoryByteStream final : public hal::ByteStream {
 public:
  explicit MemoryByteStream(std::size_t room) : room_(room) {}

  /// The peer sends; what finds no room is lost.
  void send(const std::string& bytes) {
    const std::size_t count = std::min(bytes.size(), room_ - input_.size());
    input_.append(bytes, 0, count);
    const std::uint64_t lost = std::uint64_t{lost_} + (bytes.size() - count);
    lost_ = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(lost, std::numeric_limits<std::uint32_t>::max()));
  }

  /// The same for what finds room.
  ///
  /// @returns How many bytes that are.
  std::size_t send_what_fits(const std::string& bytes) {
    const std::size_t count = std::min(bytes.size(), room_ - input_.size());
    input_.append(bytes, 0, count);
    return count;
  }

  /// The line has a break: what came before it is gone.
  void send_break() {
    input_.clear();
    has_break_ = true;
  }

  /// From here on a pipe: who reads is not who sends.
  void wait_for_reader() { waits_for_reader_ = true; }

  /// The peer takes up to `count` of the bytes that were written.
  std::string receive(std::size_t count = std::string::npos) {
    const std::string taken = output_.substr(0, count);
    output_.erase(0, taken.size());
    return taken;
  }

  void connect(bool connected) { connected_ = connected; }

  MemoryByteStream& stream() { return *this; }

 private:
  std::size_t do_read(Span<char> bytes) noexcept override {
    const std::size_t count = input_.copy(bytes.data(), bytes.size());
    input_.erase(0, count);
    return count;
  }

  std::size_t do_write(Span<const char> bytes) noexcept override {
    const std::size_t count = std::min(bytes.size(), room_ - output_.size());
    output_.append(bytes.data(), count);
    return count;
  }

  bool do_connected() const noexcept override { return connected_; }

  std::uint32_t do_take_lost_count() noexcept override {
    const std::uint32_t lost = lost_;
    lost_ = 0;
    return lost;
  }

  bool do_take_break() noexcept override {
    const bool has_break = has_break_;
    has_break_ = false;
    return has_break;
  }

  bool do_waits_for_reader() const noexcept override { return waits_for_reader_; }

  std::size_t room_;
  std::string input_;
  std::string output_;
  std::uint32_t lost_ = 0;
  bool connected_ = true;
  bool has_break_ = false;
  bool waits_for_reader_ = false;
};

}  // namespace emax::test
