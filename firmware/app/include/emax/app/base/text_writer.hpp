// Text and numbers into any sink of characters, without buffers of its own.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::app {

/// Something that takes characters: a file, a console, a counter.
class TextSink {
 public:
  TextSink(const TextSink&) = delete;
  TextSink& operator=(const TextSink&) = delete;
  virtual void write(Span<const char> text) noexcept = 0;

 protected:
  constexpr TextSink() noexcept = default;
  ~TextSink() = default;
};

/// Writes words, numbers and columns. Numbers are correctly rounded and end on the same characters
/// on every target.
///
/// Each call but `left()` and `right()` is at least one write to the sink. A call needs up to 400
/// bytes of stack.
class TextWriter {
 public:
  constexpr explicit TextWriter(TextSink& sink) noexcept : sink_(sink) {}

  /// @param[in] words Ends with a zero; null writes nothing.
  TextWriter& text(const char* words) noexcept;
  TextWriter& text(Span<const char> words) noexcept;
  /// Words of others, UTF-8 or not, in one line: white space as blanks, '?' for what is not
  /// printable, " ..." for what goes beyond `most` characters.
  TextWriter& one_line(const char* words, std::uint32_t most) noexcept;
  /// As printf's %.*f, 0 to 17 decimals.
  TextWriter& fixed(double value, int decimals) noexcept;
  /// As %.*e, 0 to 16 decimals.
  TextWriter& scientific(double value, int decimals) noexcept;
  /// As %.*g, 1 to 17 significant digits.
  TextWriter& general(double value, int significant_digits) noexcept;
  /// 17 significant digits at most, the fewest that read back as the same number: for files that
  /// programs read. A number that is not finite is written as null.
  TextWriter& exact(double value) noexcept;
  TextWriter& integer(std::uint64_t value) noexcept;
  TextWriter& spaces(std::size_t count) noexcept;
  TextWriter& line() noexcept { return text("\n"); }

  /// Sets the next words or number flush left (or right) in a column of `width` characters; what is
  /// longer is written in full.
  TextWriter& left(std::size_t width) noexcept;
  TextWriter& right(std::size_t width) noexcept;

 private:
  void put(const char* characters, std::size_t count) noexcept;

  TextSink& sink_;
  std::size_t width_ = 0;
  bool flush_right_ = false;
};

}  // namespace emax::app
