// The console on a TCP port of this machine.
#include "tcp_stream.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include "desk/cli/console.hpp"

namespace emax::host {

namespace {

constexpr int kBacklog = 4;
// A client that has closed its side and takes no answers for so long may be there for ever.
constexpr std::chrono::seconds kPatience{1};

bool is_ready(int socket, short events) noexcept {
  pollfd one = {socket, events, 0};
  return ::poll(&one, 1, 0) == 1;
}

bool is_temporary(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

// Whether the peer has closed its side; bytes may still wait to be read.
bool has_closed(int socket) noexcept { return is_ready(socket, POLLRDHUP | POLLHUP | POLLERR); }

}  // namespace

TcpStream::~TcpStream() {
  drop_client();
  if (listener_ >= 0) {
    ::close(listener_);
  }
}

desk::Problem TcpStream::listen(const std::string& host, std::uint16_t port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  if (::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    return desk::bad_input("--tcp: " + desk::printable(host) +
                           " is no address; expected one of IPv4 in numbers, such as 127.0.0.1");
  }
  socklen_t length = sizeof address;
  const int yes = 1;
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (listener_ < 0 || ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(listener_, generic, length) != 0 || ::listen(listener_, kBacklog) != 0 ||
      ::getsockname(listener_, generic, &length) != 0) {
    return desk::bad_input("--tcp: port " + std::to_string(port) + " of " + host + ": " +
                           std::strerror(errno) + "; expected a free port, or 0 for any");
  }
  port_ = ntohs(address.sin_port);
  return {};
}

void TcpStream::accept_client() noexcept {
  const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (socket < 0) {
    return;
  }
  if (client_ >= 0) {
    ::close(socket);
    return;
  }
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  client_ = socket;
  last_transfer_ = SteadyClock::now();
  input_ended_ = false;
}

void TcpStream::drop_client() noexcept {
  if (client_ >= 0) {
    ::close(client_);
    client_ = -1;
    was_dropped_ = true;
  }
}

bool TcpStream::end_session() noexcept {
  drop_client();
  return true;
}

bool TcpStream::is_left() noexcept {
  return client_ >= 0 && has_closed(client_) && is_ready(listener_, POLLIN);
}

// Whether a new client may wait for the end of this connection, so that none is turned away for one
// that has gone.
bool TcpStream::is_about_to_end(Wishes wishes) const noexcept {
  const bool is_stuck = wishes.to_write && SteadyClock::now() - last_transfer_ > kPatience;
  return has_closed(client_) && !is_stuck;
}

void TcpStream::wait(std::chrono::microseconds time, Wishes wishes) {
  if (was_dropped_) {
    was_dropped_ = false;  // The instrument sees that nobody is there before the next client comes.
    return;
  }
  const bool listens = client_ < 0 || !is_about_to_end(wishes);
  const auto client_events = static_cast<short>((wishes.to_read && !input_ended_ ? POLLIN : 0) |
                                                (wishes.to_write ? POLLOUT : 0));
  pollfd both[] = {{listens ? listener_ : -1, POLLIN, 0}, {client_, client_events, 0}};
  const timespec timeout = {static_cast<time_t>(time.count() / 1'000'000),
                            static_cast<long>(time.count() % 1'000'000 * 1000)};
  if (::ppoll(both, 2, &timeout, nullptr) <= 0) {
    return;
  }
  // Where reading goes on, it finds out by itself.
  const bool is_reading = wishes.to_read && !input_ended_;
  if (!is_reading && (both[1].revents & (POLLHUP | POLLERR)) != 0) {
    drop_client();  // It takes no answers any more.
    return;
  }
  if ((both[0].revents & POLLIN) != 0 && (client_ < 0 || !is_about_to_end(wishes))) {
    accept_client();
  }
}

std::size_t TcpStream::do_read(Span<char> bytes) noexcept {
  if (client_ < 0 || input_ended_) {
    return 0;
  }
  const ssize_t count = ::recv(client_, bytes.data(), bytes.size(), 0);
  if (count > 0) {
    last_transfer_ = SteadyClock::now();
    return static_cast<std::size_t>(count);
  }
  if (count < 0) {
    if (!is_temporary(errno)) {
      drop_client();
    }
    return 0;
  }
  input_ended_ = true;
  return 0;
}

std::size_t TcpStream::do_write(Span<const char> bytes) noexcept {
  const ssize_t count = ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (count >= 0) {
    last_transfer_ = SteadyClock::now();
    return static_cast<std::size_t>(count);
  }
  if (!is_temporary(errno)) {
    drop_client();
  }
  return 0;
}

}  // namespace emax::host
