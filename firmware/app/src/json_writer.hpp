// JSON, one value after the other.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/text_writer.hpp"

namespace emax::app {

/// Members and elements with their commas, indented by two blanks per level.
class JsonWriter {
 public:
  explicit JsonWriter(TextWriter& out) noexcept : out_(out) {}

  void open(const char* name, char bracket = '{') noexcept {
    begin(name);
    write(bracket);
    ++depth_;
    is_first_ = true;
  }

  void close(char bracket = '}') noexcept {
    --depth_;
    if (!is_first_ && !in_row_) {
      new_line();
    }
    write(bracket);
    is_first_ = false;
  }

  /// An array of plain values in one line.
  void open_row(const char* name) noexcept {
    open(name, '[');
    in_row_ = true;
  }

  void close_row() noexcept {
    close(']');
    in_row_ = false;
  }

  void number(const char* name, double value) noexcept {
    begin(name);
    out_.exact(value);
  }

  void integer(const char* name, std::uint64_t value) noexcept {
    begin(name);
    out_.integer(value);
  }

  void null(const char* name) noexcept {
    begin(name);
    out_.text("null");
  }

  void words(const char* name, const char* value) noexcept {
    begin(name);
    escaped(value);
  }

  void pair(const char* name, double first, double second) noexcept {
    open_row(name);
    number(nullptr, first);
    number(nullptr, second);
    close_row();
  }

 private:
  void write(char character) noexcept { out_.text(Span<const char>(&character, 1)); }

  void new_line() noexcept { out_.line().spaces(2 * depth_); }

  void begin(const char* name) noexcept {
    if (!is_first_) {
      write(',');
    }
    if (in_row_) {
      out_.text(is_first_ ? "" : " ");
    } else if (depth_ > 0) {
      new_line();
    }
    is_first_ = false;
    if (name != nullptr) {
      escaped(name);
      out_.text(": ");
    }
  }

  void escaped(const char* value) noexcept {
    constexpr char kHex[] = "0123456789abcdef";
    write('"');
    for (; *value != '\0'; ++value) {
      const auto byte = static_cast<unsigned char>(*value);
      if (byte == '"' || byte == '\\') {
        write('\\');
        write(*value);
      } else if (byte < 0x20 || byte >= 0x7F) {
        // One character per byte: a name need not be UTF-8, JSON must be.
        const char escape[] = {'\\', 'u', '0', '0', kHex[byte >> 4U], kHex[byte & 0xFU]};
        out_.text(Span<const char>(escape));
      } else {
        write(*value);
      }
    }
    write('"');
  }

  TextWriter& out_;
  std::size_t depth_ = 0;
  bool is_first_ = true;
  bool in_row_ = false;
};

}  // namespace emax::app
