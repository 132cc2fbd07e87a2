// Where the console of `emax scpi` comes from: a byte stream that a loop can wait for.
#pragma once

#include <chrono>

#include "emax/hal/byte_stream.hpp"

namespace emax::host {

/// The console with what the host's loop needs to know beside the bytes.
class ConsolePort : public hal::ByteStream {
 public:
  /// What a wait ends for, beside its time.
  struct Wishes {
    bool to_read = false;
    bool to_write = false;
  };

  /// Sleeps until a wish can be met, at most for this long.
  virtual void wait(std::chrono::microseconds time, Wishes wishes) = 0;

  /// @returns True once no more bytes can come, and none wait to be read.
  virtual bool input_ended() const noexcept = 0;

  /// The instrument has nothing left to do for what came before the end of the input.
  ///
  /// @returns Whether the program is to go on, for another peer.
  virtual bool end_session() noexcept = 0;

  /// @returns Whether there may be another peer when this one has gone.
  virtual bool serves_others() const noexcept { return false; }

  /// @returns True if nobody waits for an answer that is still being computed, or others wait for
  /// the end of a session that has no more to say.
  virtual bool is_left() noexcept = 0;

 protected:
  ConsolePort() noexcept = default;
  ~ConsolePort() = default;
};

}  // namespace emax::host
