// A console: bytes in and out, never waiting.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::hal {

/// Bytes of a serial line or a socket, in the order of sending, unchanged in both directions.
///
/// No function waits. Bytes are `char`, as text has them; all 256 values pass.
class ByteStream {
 public:
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// Takes the bytes that have come in, as many as there is room for. Bytes that came before a peer
  /// went away can still be read.
  ///
  /// @param[out] bytes Filled from its front; untouched behind the count returned.
  /// @returns The number of bytes taken: 0 if nothing has come in or `bytes` is empty.
  std::size_t read(Span<char> bytes) noexcept;

  /// Hands over as many bytes from the front as there is room for now.
  ///
  /// @returns The number of bytes accepted; they go out without another call. 0 if there is no
  ///          room, no peer, or nothing to send. The caller keeps the rest and tries again later.
  std::size_t write(Span<const char> bytes) noexcept;

  /// @returns False if no peer is connected; true on a line that cannot tell.
  bool connected() const noexcept { return do_connected(); }

  /// @returns How many bytes came in and found no room since this was last asked. The count stays
  ///          at its greatest value instead of starting over.
  std::uint32_t take_lost_count() noexcept { return do_take_lost_count(); }

  /// @returns True if the line had a break since this was last asked: device clear. What came in
  ///          before it is not to be read any more.
  bool take_break() noexcept { return do_take_break(); }

  /// @returns True where who reads is not who sends, as with pipes: a reader that pauses holds up
  ///          nothing but its own answers, and none of them may be dropped.
  bool waits_for_reader() const noexcept { return do_waits_for_reader(); }

 protected:
  constexpr ByteStream() noexcept = default;
  ~ByteStream() = default;

 private:
  /// As `read()`; `bytes` is not empty.
  virtual std::size_t do_read(Span<char> bytes) noexcept = 0;

  /// As `write()`; `bytes` is not empty and there is a peer.
  virtual std::size_t do_write(Span<const char> bytes) noexcept = 0;

  virtual bool do_connected() const noexcept = 0;
  virtual std::uint32_t do_take_lost_count() noexcept = 0;
  virtual bool do_take_break() noexcept { return false; }
  virtual bool do_waits_for_reader() const noexcept { return false; }
};

}  // namespace emax::hal
