// The contract of the byte stream, checked once for all boards.
#include "emax/hal/byte_stream.hpp"

#include <algorithm>

namespace emax::hal {

std::size_t ByteStream::read(Span<char> bytes) noexcept {
  return bytes.empty() ? 0 : std::min(do_read(bytes), bytes.size());
}

std::size_t ByteStream::write(Span<const char> bytes) noexcept {
  return bytes.empty() || !connected() ? 0 : std::min(do_write(bytes), bytes.size());
}

}  // namespace emax::hal
