// Sockets and serial lines of POSIX, as the line to an instrument.
#include "desk/instrument/instrument_port.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"

namespace emax::desk {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr const char* kExpected = "expected HOST:PORT, or a serial line such as /dev/ttyACM0";
constexpr InstrumentPort::Duration kConnectPatience{10'000};
// A stop request that comes just before a wait is seen after this.
constexpr InstrumentPort::Duration kLongestWait{100};
constexpr std::size_t kPiece = 4096;

Problem no_port(const std::string& name, const std::string& why) {
  return bad_input("--instrument: " + printable(name) + ": " + why + "; " + kExpected);
}

// The system takes one above 65535 for another one.
bool is_port_number(const std::string& text) noexcept {
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, port);
  return read.ec == std::errc{} && read.ptr == end && port != 0;
}

bool is_temporary(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

// Raw, 8 bits without parity at 115 200 baud; the modem lines are left alone.
bool set_up_serial(int file) noexcept {
  termios line = {};
  if (::tcgetattr(file, &line) != 0) {
    return false;
  }
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
  line.c_cc[VMIN] = 0;
  line.c_cc[VTIME] = 0;
  return ::cfsetispeed(&line, B115200) == 0 && ::cfsetospeed(&line, B115200) == 0 &&
         ::tcsetattr(file, TCSANOW, &line) == 0 && ::tcflush(file, TCIOFLUSH) == 0;
}

}  // namespace

InstrumentPort::~InstrumentPort() {
  if (file_ >= 0) {
    ::close(file_);
  }
}

Problem InstrumentPort::open(const std::string& name) {
  name_ = name;
  const std::size_t colon = name.rfind(':');
  if (name.find('/') != std::string::npos) {
    return open_serial(name);
  }
  if (colon == std::string::npos || colon == 0 || colon + 1 == name.size()) {
    return no_port(name, "no port");
  }
  if (!is_port_number(name.substr(colon + 1))) {
    return no_port(name, "the port is no number from 1 to 65535");
  }
  std::string host = name.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  return open_socket(host, name.substr(colon + 1));
}

Problem InstrumentPort::open_serial(const std::string& path) {
  file_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) {
    return no_port(path, std::strerror(errno));
  }
  if (::isatty(file_) == 0) {
    return no_port(path, "not a serial line");
  }
  // Two programs would take each other's answers.
  (void)::ioctl(file_, TIOCEXCL);
  return set_up_serial(file_) ? Problem{} : no_port(path, std::strerror(errno));
}

Problem InstrumentPort::open_socket(const std::string& host, const std::string& service) {
  addrinfo hints = {};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), service.c_str(), &hints, &found); error != 0) {
    return no_port(name_, ::gai_strerror(error));
  }
  int error = 0;
  for (const addrinfo* one = found; one != nullptr && file_ < 0; one = one->ai_next) {
    file_ = ::socket(one->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    error = 0;
    if (file_ >= 0 && ::connect(file_, one->ai_addr, one->ai_addrlen) != 0) {
      socklen_t size = sizeof error;
      error = errno;
      if (error == EINPROGRESS) {
        const bool is_there = wait(POLLOUT, after(kConnectPatience), true) == Outcome::kOk;
        error = ETIMEDOUT;
        if (is_there) {
          (void)::getsockopt(file_, SOL_SOCKET, SO_ERROR, &error, &size);
        }
      }
    }
    if (file_ >= 0 && error != 0) {
      ::close(file_);
      file_ = -1;
    }
  }
  ::freeaddrinfo(found);
  if (stop_requested()) {
    return stopped();
  }
  if (file_ < 0) {
    return no_port(name_, std::strerror(error));
  }
  const int yes = 1;
  (void)::setsockopt(file_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return {};
}

InstrumentPort::Outcome InstrumentPort::wait(short events, Deadline end, bool heeds_stop) const {
  for (;;) {
    if (heeds_stop && stop_requested()) {
      return Outcome::kStopped;
    }
    const auto left = std::chrono::duration_cast<Duration>(end - SteadyClock::now());
    pollfd one = {file_, events, 0};
    const auto slice = std::clamp(left, Duration{0}, kLongestWait);
    const int ready = ::poll(&one, 1, static_cast<int>(slice.count()));
    if (ready > 0) {
      // What has come in before a hang-up can still be read.
      return (one.revents & events) != 0 ? Outcome::kOk : Outcome::kLost;
    }
    if (left <= Duration{0}) {
      return Outcome::kTimeout;
    }
  }
}

InstrumentPort::Outcome InstrumentPort::write(std::string_view bytes, Duration patience,
                                              bool heeds_stop) {
  const Deadline end = after(patience);
  while (!bytes.empty()) {
    if (const Outcome outcome = wait(POLLOUT, end, heeds_stop); outcome != Outcome::kOk) {
      return outcome;
    }
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && !is_temporary(errno)) {
      return Outcome::kLost;
    }
    bytes.remove_prefix(count > 0 ? static_cast<std::size_t>(count) : 0);
  }
  return Outcome::kOk;
}

InstrumentPort::Outcome InstrumentPort::read(std::string& bytes, Deadline end, bool heeds_stop) {
  for (;;) {
    if (const Outcome outcome = wait(POLLIN, end, heeds_stop); outcome != Outcome::kOk) {
      return outcome;
    }
    char piece[kPiece];
    const ssize_t count = ::read(file_, piece, sizeof piece);
    if (count > 0) {
      bytes.append(piece, static_cast<std::size_t>(count));
      return Outcome::kOk;
    }
    if (count == 0 || !is_temporary(errno)) {
      return Outcome::kLost;
    }
  }
}

}  // namespace emax::desk
