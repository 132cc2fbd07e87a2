// The text of a whole file or of standard input.
#include "desk/files/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"

namespace emax::desk {

namespace {

constexpr int kPollInterval = 100;  // In milliseconds.

// A file that is open for reading, or -1 and errno.
class InputFile final {
 public:
  explicit InputFile(const std::string& path)
      : file_(path == "-" ? STDIN_FILENO : open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() {
    if (file_ > STDIN_FILENO) {
      close(file_);
    }
  }

  bool is_open() const noexcept { return file_ >= 0; }

  // As read(), but a stop request ends the wait for somebody who types.
  ssize_t read_some(char* data, std::size_t size) const noexcept {
    pollfd ready = {file_, POLLIN, 0};
    while (poll(&ready, 1, kPollInterval) == 0 && !stop_requested()) {
    }
    if (stop_requested()) {
      errno = EINTR;
      return -1;
    }
    return read(file_, data, size);
  }

 private:
  int file_;
};

}  // namespace

std::string name_of_input(const std::string& path) {
  return path == "-" ? "standard input" : printable(path);
}

Problem read_text_file(const std::string& path, std::size_t most, const char* expectation,
                       std::string& text) {
  const auto unreadable = [&](const char* reason) {
    return stop_requested() ? stopped()
                            : bad_input(name_of_input(path) + ": " + reason + "; " + expectation);
  };
  const InputFile file(path);
  if (!file.is_open()) {
    return unreadable(std::strerror(errno));
  }
  text.resize(most + 1);
  std::size_t size = 0;
  ssize_t count = 1;
  while (count > 0 && size < text.size()) {
    count = file.read_some(&text[size], text.size() - size);
    size += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  if (count < 0) {
    return unreadable(std::strerror(errno));
  }
  text.resize(size);
  if (size > most) {
    return unreadable(("larger than " + std::to_string(most >> 20) + " MiB").c_str());
  }
  return {};
}

}  // namespace emax::desk
