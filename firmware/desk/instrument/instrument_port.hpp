// The line to an instrument: a socket or a serial line.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Bytes to an instrument and back, each with an end to its patience. Closed when it goes.
class InstrumentPort final {
 public:
  using Duration = std::chrono::milliseconds;
  using Deadline = std::chrono::steady_clock::time_point;
  static Deadline after(Duration patience) { return std::chrono::steady_clock::now() + patience; }

  InstrumentPort() = default;
  InstrumentPort(const InstrumentPort&) = delete;
  InstrumentPort& operator=(const InstrumentPort&) = delete;
  ~InstrumentPort();

  /// @param[in] name HOST:PORT, or the path of a serial line, which is set to 115 200 baud, 8 data
  ///                 bits, no parity, raw.
  /// @returns Bad input if it cannot be had.
  Problem open(const std::string& name);
  const std::string& name() const noexcept { return name_; }

  enum class Outcome { kOk, kTimeout, kLost, kStopped };

  /// Writes all of it.
  ///
  /// @param[in] heeds_stop Ends with kStopped on a request to stop.
  Outcome write(std::string_view bytes, Duration patience, bool heeds_stop);

  /// Reads at least one byte, after those that were read before and not taken.
  ///
  /// @param[in,out] bytes Gets what has come in behind what it holds.
  Outcome read(std::string& bytes, Deadline end, bool heeds_stop);

 private:
  Problem open_socket(const std::string& host, const std::string& service);
  Problem open_serial(const std::string& path);
  Outcome wait(short events, Deadline end, bool heeds_stop) const;

  int file_ = -1;
  std::string name_;
};

}  // namespace emax::desk
