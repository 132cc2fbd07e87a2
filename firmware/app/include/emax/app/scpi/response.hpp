// Answers: fields and separators of the standard on their way out, in a small fixed memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/scpi/error_queue.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// The output queue.
///
/// Fields are separated by commas, the answers of one program message by semicolons; a line feed
/// ends the message. Nothing waits: a handler may put at most `kAnswerRoom` characters at a time,
/// for which there is always room when it is called. 0.6 KiB.
class Response {
 public:
  static constexpr std::size_t kCapacity = 512;
  /// What a handler may put in one call: 15 numbers of 24 characters and a comma.
  static constexpr std::size_t kAnswerRoom = 384;
  /// What the answer of an immediate command may take at most.
  static constexpr std::size_t kImmediateRoom = 128;

  /// The fewest digits that read back as this number: from 1 on as they are, "42" or "4072.97",
  /// below 1 and beyond 17 places with an exponent, "1.0E-1" (IEEE 488.2, 8.7.2 to 8.7.4).
  /// Infinities are 9.9E37 and -9.9E37, a NaN is 9.91E37 (SCPI-99, 7.2.1). At most 24 characters.
  /// Stack below 1.1 KiB.
  Response& number(double value) noexcept;
  Response& integer(std::int64_t value) noexcept;
  Response& boolean(bool value) noexcept { return integer(value ? 1 : 0); }
  /// Character data, as it is: "ISE", or an identity with commas of its own.
  Response& word(const char* word) noexcept;
  Response& word(Span<const char> word) noexcept;
  /// The word's short form: "DIFF" of "DIFFerence".
  Response& short_form(const char* pattern) noexcept;
  /// String data: in double quotes, those inside doubled.
  Response& string(Span<const char> text) noexcept;
  /// An error's string: "<text>", "<text>;<context>", "<text>;<words>" or
  /// "<text>;<subject>: <words>".
  Response& error(const ErrorEntry& entry) noexcept;
  /// A definite-length block, #<digits><length><bytes>, as the last field of an answer.
  ///
  /// The bytes are not copied: they must stay as they are until `Session::holds_block()` is false.
  Response& block(Span<const char> bytes) noexcept;
  /// The header of a definite-length block whose bytes follow by `piece()`.
  Response& block_header(std::size_t length) noexcept;
  /// Characters without a separator before them.
  Response& piece(Span<const char> characters) noexcept;
  Response& piece(const char* characters) noexcept;
  /// The next field follows without a separator.
  void join() noexcept { joins_ = true; }

  /// @returns The characters that wait, as far as they are in one piece; empty if none do.
  Span<const char> pending() const noexcept;
  /// @param[in] count Characters of `pending()` that were sent.
  void consume(std::size_t count) noexcept;
  /// @returns Characters that can be put now.
  std::size_t room() const noexcept { return kCapacity + begin_ - end_; }
  bool empty() const noexcept { return begin_ == end_ && block_.empty(); }
  /// @returns True while the memory of a block is still being sent.
  bool holds_block() const noexcept { return !block_.empty(); }
  /// @returns True between the first field of a message and its line feed.
  bool is_open() const noexcept { return open_; }

  // The rest is for the session.

  /// Starts the answer of one unit of at most `limit` characters; `drop_answer()` goes back to
  /// here.
  void begin_answer(std::size_t limit) noexcept;
  /// The same for a further part of it.
  void begin_item(std::size_t limit) noexcept;
  void drop_answer() noexcept;
  /// @returns False if more was put than there is room for; the answer must then be dropped.
  bool fits() const noexcept { return fits_; }
  /// Ends the message by a line feed if it has answers.
  void end_message() noexcept;
  /// Forgets what was not sent. Of an answer that was sent in part, the line ends here: the next
  /// one must not look like its rest.
  void drop_unsent() noexcept;
  /// Forgets all, for a new peer.
  void clear() noexcept;
  bool consistent() const noexcept;

 private:
  void put(const char* characters, std::size_t count) noexcept;
  void put_number(std::uint64_t value) noexcept;
  void put_quoted(Span<const char> text) noexcept;
  void put_quoted(const char* text) noexcept;
  void separate() noexcept;

  char text_[kCapacity] = {};
  Span<const char> block_;
  std::uint16_t begin_ = 0;
  std::uint16_t end_ = 0;
  std::uint16_t mark_ = 0;
  std::uint16_t limit_ = 0;
  bool open_ = false;
  bool was_open_ = false;
  bool has_field_ = false;
  bool had_field_ = false;
  bool had_block_ = false;
  bool joins_ = false;
  bool fits_ = true;
  bool line_is_open_ = false;  ///< The last character that was sent is no line feed.
};

static_assert(std::is_trivially_copyable_v<Response>);

}  // namespace emax::app::scpi
