// Standard output and standard error: text that is checked, and complaints of one line.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Text into a file of the C library. Errors are kept and asked for afterwards.
class FileSink final : public app::TextSink {
 public:
  explicit FileSink(std::FILE* file) noexcept : file_(file) {}

  void write(Span<const char> text) noexcept override;
  /// Hands everything over to the system.
  void flush() noexcept;
  /// @returns errno of the first write that failed, 0 if none did.
  int error() const noexcept { return error_; }

 private:
  std::FILE* file_;
  int error_ = 0;
};

/// Text into a string.
class StringSink final : public app::TextSink {
 public:
  void write(Span<const char> text) noexcept override { text_.append(text.data(), text.size()); }
  const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

/// @returns Text of others that is fit for a line of ours, as valid UTF-8: what is not, and what
/// does not stand in a line as it is, becomes '?'; what goes beyond 200 characters becomes "...".
std::string printable(std::string_view text);

/// @param[in] name What `printable()` returns.
/// @returns How many columns it takes in a table.
std::size_t characters_in(const std::string& name);

/// Says why the program ends, in one line on standard error, and returns the exit status for it.
int finish(const Problem& problem);

/// Checks what became of text for standard output. A reader that went away is no matter for words.
Problem check_output(FileSink& output);

}  // namespace emax::desk
