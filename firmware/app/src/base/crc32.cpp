// Four bits at a time.
#include "emax/app/base/crc32.hpp"

#include <array>
#include <cstddef>

namespace emax::app {
namespace {

constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320;
using Table = std::array<std::uint32_t, 16>;

constexpr Table table_of_remainders() noexcept {
  Table table = {};
  for (std::size_t i = 0; i < table.size(); ++i) {
    auto remainder = static_cast<std::uint32_t>(i);
    for (int bit = 0; bit < 4; ++bit) {
      remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kReflectedPolynomial : 0U);
    }
    table[i] = remainder;
  }
  return table;
}

constexpr Table kTable = table_of_remainders();

}  // namespace

void Crc32::add(Span<const std::uint8_t> bytes) noexcept {
  for (const std::uint8_t byte : bytes) {
    register_ ^= byte;
    register_ = (register_ >> 4U) ^ kTable[register_ & 0xFU];
    register_ = (register_ >> 4U) ^ kTable[register_ & 0xFU];
  }
}

}  // namespace emax::app
