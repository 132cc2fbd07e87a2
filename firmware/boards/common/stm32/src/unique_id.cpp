// 96 bits as text.
#include "emax/board/unique_id.hpp"

#include "emax/board/registers.hpp"

namespace emax::board {

UniqueIdText read_unique_id(std::uintptr_t address) noexcept {
  constexpr unsigned kDigitsPerWord = 8;
  UniqueIdText text = {};
  char* next = text.data();
  for (std::uintptr_t word = 0; word < 3; ++word) {
    const std::uint32_t value = reg(address + 4 * word);
    for (unsigned digit = kDigitsPerWord; digit > 0; --digit) {
      *next = "0123456789ABCDEF"[(value >> (4 * (digit - 1))) & 0xFU];
      ++next;
    }
  }
  return text;
}

}  // namespace emax::board
