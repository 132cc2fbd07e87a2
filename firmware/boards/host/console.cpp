// Standard output and standard error.
#include "console.hpp"

#include <cerrno>
#include <cstring>

#include "stop_request.hpp"

namespace emax::host {

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
  std::string line(text.substr(0, kMaxPrintable));
  for (char& c : line) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f) {
      c = '?';
    }
  }
  return text.size() > kMaxPrintable ? line + "..." : line;
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

}  // namespace emax::host
