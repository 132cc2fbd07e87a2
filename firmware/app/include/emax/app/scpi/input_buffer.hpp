// Bytes to program messages: complete ones wait here, in order, for their turn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// Finds the ends of program messages and of their parts, one byte at a time.
///
/// LF or CR ends a message, whatever it is made of: a lost quote or a stray '#' must not swallow
/// what comes next, such as ABORt. A '#' with a digit begins a block, which goes on to the end of
/// the message and may hold any other byte. Commas inside parentheses are part of one parameter.
class MessageScanner {
 public:
  enum class Event : std::uint8_t {
    kMore,       ///< Part of a unit.
    kSeparator,  ///< The comma between two parameters.
    kUnitEnd,    ///< The semicolon between two units.
    kEnd,        ///< The byte after the message's last one.
    kInvalid,    ///< A byte that cannot be part of a message.
  };

  /// Starts in front of a message.
  constexpr MessageScanner() noexcept = default;
  /// @returns One that starts in front of a parameter.
  static constexpr MessageScanner at_parameter() noexcept {
    MessageScanner scanner;
    scanner.state_ = State::kElement;
    return scanner;
  }

  Event next(char byte) noexcept;

 private:
  enum class State : std::uint8_t {
    kBeforeHeader,
    kHeader,
    kElement,    ///< Where a parameter may begin.
    kInElement,  ///< Inside a number or a word, or behind a string.
    kString,     ///< Inside quotes.
    kQuote,      ///< After a quote that may be the first of two.
    kHash,       ///< After '#'.
    kBlock,      ///< Inside a block, up to the end of the message.
  };

  Event next_of_text(char byte) noexcept;
  Event next_of_element(char byte) noexcept;

  State state_ = State::kBeforeHeader;
  char quote_ = '\0';
  std::uint16_t parentheses_ = 0;  ///< That are open.
};

/// A complete message in the input.
struct MessageText {
  Span<const char> text;  ///< Without its end; empty if the message was too long to be kept.
  bool is_complete = false;
  bool is_valid = false;  ///< False if its last byte cannot be part of a message.
};

/// Holds what came in: complete messages and the beginning of the next. 4.1 KiB,
/// on a PC 32 KiB.
///
/// Of a message that is longer than the memory only its place in the order is kept. Of one with a
/// byte that cannot be part of a message only the beginning, with that byte, is kept. What is left
/// of both is dropped up to the next LF or CR. The work is proportional to the bytes.
class InputBuffer {
 public:
  /// Characters of the longest message: all settings in one, as *LRN? tells them, with as many
  /// frequencies as a PC takes.
  static constexpr std::size_t kCapacity = kMaxPoints > 64 ? 32768 : 4096;

  /// @returns How many bytes `add()` takes.
  std::size_t room() const noexcept;
  /// @param[in] bytes At most `room()`.
  void add(Span<const char> bytes) noexcept;

  /// @param[in] offset 0, or where a message ends.
  MessageText message_at(std::size_t offset) const noexcept;
  /// @returns The offset behind the complete messages.
  std::size_t complete() const noexcept { return complete_; }
  Span<const char> text(std::size_t offset, std::size_t length) const noexcept {
    return {bytes_ + offset, length};
  }
  /// Removes the complete message of this length at this offset; what is behind it moves forward.
  void remove(std::size_t offset, std::size_t length) noexcept;
  void clear() noexcept;
  bool consistent() const noexcept;

 private:
  void take(char byte) noexcept;
  void end_message() noexcept;
  void drop_rest() noexcept;

  // Each message has its end behind it, and an invalid byte takes a place of its own.
  static constexpr std::size_t kMemory = kCapacity + 2;

  char bytes_[kMemory] = {};
  std::uint16_t size_ = 0;
  std::uint16_t complete_ = 0;
  MessageScanner scanner_;
  bool drops_ = false;  ///< Until the next end of a line.
};

static_assert(std::is_trivially_copyable_v<InputBuffer>);

}  // namespace emax::app::scpi
