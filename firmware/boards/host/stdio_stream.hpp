// The console on standard input and standard output.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

#include "console_port.hpp"

namespace emax::host {

/// Neither reading nor writing waits, whatever the two are: terminals, pipes or files. The end of
/// the input ends its last line, too.
class StdioStream final : public ConsolePort {
 public:
  /// From here on a reader that went away is no signal, but the end of the session.
  StdioStream() noexcept;

  void wait(std::chrono::microseconds time, Wishes wishes) override;
  bool input_ended() const noexcept override { return input_ended_; }
  bool end_session() noexcept override { return false; }
  bool is_left() noexcept override;

  /// @returns errno of the first write that failed, 0 if none did.
  int error() const noexcept { return error_; }

 private:
  std::size_t do_read(Span<char> bytes) noexcept override;
  std::size_t do_write(Span<const char> bytes) noexcept override;
  bool do_connected() const noexcept override { return error_ == 0; }
  std::uint32_t do_take_lost_count() noexcept override { return 0; }
  bool do_waits_for_reader() const noexcept override { return true; }

  int error_ = 0;
  bool input_ended_ = false;
  bool line_is_open_ = false;
};

}  // namespace emax::host
