// The checksum of stored records: CRC-32 as of Ethernet, ZIP and PNG.
#pragma once

#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::app {

/// CRC-32 of IEEE 802.3: polynomial 0x04C11DB7, bits reflected, begins and ends inverted. Of the
/// nine characters "123456789" it is 0xCBF43926. It finds every error within 32 bits in a row, and
/// any three flipped bits of 11 KiB (Koopman, DSN 2002).
///
/// Bytes may come in pieces. Two table look-ups per byte, 64 bytes of table.
class Crc32 {
 public:
  void add(Span<const std::uint8_t> bytes) noexcept;

  /// @returns The checksum of all bytes so far.
  std::uint32_t value() const noexcept { return ~register_; }

 private:
  std::uint32_t register_ = 0xFFFFFFFF;
};

}  // namespace emax::app
