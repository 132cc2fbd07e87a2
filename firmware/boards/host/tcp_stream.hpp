// The console on a TCP port of this machine.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "emax/base/span.hpp"

#include "console_port.hpp"
#include "desk/cli/problem.hpp"

namespace emax::host {

/// Listens on an address of this machine and serves one client after the other.
///
/// A client that comes while another one is served is refused: its connection is closed without a
/// word, which it would take for an answer. Where the other one has closed its side already, the
/// new one waits until it is done with, unless that one has read nothing of its answers for a
/// second. What a client has left without the end of a line is not executed.
class TcpStream final : public ConsolePort {
 public:
  TcpStream() noexcept = default;
  ~TcpStream();

  /// @param[in] host Of IPv4, in numbers: 127.0.0.1 for this machine alone, 0.0.0.0 for all.
  /// @param[in] port 0 for one that the system chooses.
  /// @returns Why the port cannot be had, if so.
  desk::Problem listen(const std::string& host, std::uint16_t port);
  std::uint16_t port() const noexcept { return port_; }

  void wait(std::chrono::microseconds time, Wishes wishes) override;
  bool input_ended() const noexcept override { return client_ >= 0 && input_ended_; }
  bool end_session() noexcept override;
  bool serves_others() const noexcept override { return true; }
  bool is_left() noexcept override;

 private:
  using SteadyClock = std::chrono::steady_clock;

  std::size_t do_read(Span<char> bytes) noexcept override;
  std::size_t do_write(Span<const char> bytes) noexcept override;
  bool do_connected() const noexcept override { return client_ >= 0; }
  std::uint32_t do_take_lost_count() noexcept override { return 0; }

  bool is_about_to_end(Wishes wishes) const noexcept;
  void accept_client() noexcept;
  void drop_client() noexcept;

  int listener_ = -1;
  int client_ = -1;
  std::uint16_t port_ = 0;
  SteadyClock::time_point last_transfer_;
  bool was_dropped_ = false;
  bool input_ended_ = false;
};

}  // namespace emax::host
