// JSON, one value after the other.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/base/utf8.hpp"

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

  void boolean(const char* name, bool value) noexcept {
    begin(name);
    out_.text(value ? "true" : "false");
  }

  /// UTF-8 as the characters that it says; U+FFFD for what is not valid.
  void words(const char* name, const char* value) noexcept {
    begin(name);
    quoted(value);
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
      quoted(name);
      out_.text(": ");
    }
  }

  void quoted(const char* value) noexcept {
    write('"');
    for (Character next = first_character(value); next.length > 0; next = first_character(value)) {
      write_character(next.code);
      value += next.length;
    }
    write('"');
  }

  void write_character(std::uint32_t code) noexcept {
    if (code >= 0x20 && code < 0x7F) {
      out_.text(code == '"' || code == '\\' ? "\\" : "");
      write(static_cast<char>(code));
    } else if (code < 0x10000) {
      write_unit(code);
    } else {
      write_unit(0xD800U + ((code - 0x10000U) >> 10U));
      write_unit(0xDC00U + (code & 0x3FFU));
    }
  }

  void write_unit(std::uint32_t unit) noexcept {
    constexpr char kHex[] = "0123456789abcdef";
    const char escape[] = {'\\',
                           'u',
                           kHex[(unit >> 12U) & 0xFU],
                           kHex[(unit >> 8U) & 0xFU],
                           kHex[(unit >> 4U) & 0xFU],
                           kHex[unit & 0xFU]};
    out_.text(Span<const char>(escape));
  }

  TextWriter& out_;
  std::size_t depth_ = 0;
  bool is_first_ = true;
  bool in_row_ = false;
};

}  // namespace emax::app
