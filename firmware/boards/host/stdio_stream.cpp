// The console on standard input and standard output.
#include "stdio_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <poll.h>
#include <unistd.h>

namespace emax::host {

namespace {

// Whether a call would not wait. Files are always ready.
bool is_ready(int file, short events) noexcept {
  pollfd one = {file, events, 0};
  return ::poll(&one, 1, 0) == 1;
}

}  // namespace

StdioStream::StdioStream() noexcept { std::signal(SIGPIPE, SIG_IGN); }

std::size_t StdioStream::do_read(Span<char> bytes) noexcept {
  if (input_ended_ || !is_ready(STDIN_FILENO, POLLIN)) {
    return 0;
  }
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count > 0) {
    const char last = bytes[static_cast<std::size_t>(count) - 1];
    line_is_open_ = last != '\n' && last != '\r';
    return static_cast<std::size_t>(count);
  }
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) {
    return 0;
  }
  input_ended_ = true;
  if (!line_is_open_) {
    return 0;
  }
  bytes[0] = '\n';
  return 1;
}

// A pipe that is ready takes PIPE_BUF bytes at once.
std::size_t StdioStream::do_write(Span<const char> bytes) noexcept {
  if (!is_ready(STDOUT_FILENO, POLLOUT)) {
    return 0;
  }
  const std::size_t most = std::min<std::size_t>(bytes.size(), PIPE_BUF);
  const ssize_t count = ::write(STDOUT_FILENO, bytes.data(), most);
  if (count >= 0) {
    return static_cast<std::size_t>(count);
  }
  if (errno != EINTR && errno != EAGAIN) {
    error_ = errno;
  }
  return 0;
}

void StdioStream::wait(std::chrono::microseconds time, Wishes wishes) {
  pollfd both[] = {{wishes.to_read && !input_ended_ ? STDIN_FILENO : -1, POLLIN, 0},
                   {wishes.to_write ? STDOUT_FILENO : -1, POLLOUT, 0}};
  const timespec timeout = {static_cast<time_t>(time.count() / 1'000'000),
                            static_cast<long>(time.count() % 1'000'000 * 1000)};
  (void)::ppoll(both, 2, &timeout, nullptr);
}

bool StdioStream::is_left() noexcept {
  pollfd output = {STDOUT_FILENO, 0, 0};
  if (::poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0) {
    error_ = EPIPE;
  }
  return error_ != 0;
}

}  // namespace emax::host
