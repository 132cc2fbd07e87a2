// Standard output and standard error.
#include "desk/cli/console.hpp"

#include <cerrno>
#include <cstring>

#include "emax/app/base/utf8.hpp"

#include "desk/cli/stop_request.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxPrintable = 200;

}  // namespace

void FileSink::write(Span<const char> text) noexcept {
  if (error_ != 0 || text.empty()) {
    return;
  }
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    error_ = errno != 0 ? errno : EIO;
  }
}

void FileSink::flush() noexcept {
  errno = 0;
  if (error_ == 0 && std::fflush(file_) != 0) {
    error_ = errno != 0 ? errno : EIO;
  }
}

std::string printable(std::string_view text) {
  const std::string words(text);
  std::string line;
  std::size_t shown = 0;
  for (std::size_t at = 0; at < words.size(); ++shown) {
    if (shown == kMaxPrintable) {
      return line + "...";
    }
    const app::Character next = app::first_character(&words[at]);
    const bool is_fit = next.code != app::kReplacement && app::is_printable(next.code);
    line += is_fit ? words.substr(at, next.length) : "?";
    at += next.length > 0 ? next.length : 1;  // A zero may stand in the text of others.
  }
  return line;
}

std::size_t characters_in(const std::string& name) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < name.size(); at += app::first_character(&name[at]).length) {
    ++count;
  }
  return count;
}

int finish(const Problem& problem) {
  if (!problem.line.empty()) {
    const std::string line = "emax: " + problem.line + "\n";
    std::fputs(line.c_str(), stderr);
  }
  return static_cast<int>(problem.status);
}

Problem check_output(FileSink& output) {
  output.flush();
  if (output.error() == 0) {
    return {};
  }
  if (stop_requested()) {
    return stopped();
  }
  if (output.error() == EPIPE) {
    return fault("");
  }
  return fault(std::string("standard output: ") + std::strerror(output.error()) +
               "; not all of the output has been written");
}

}  // namespace emax::desk
