#include "chip/elf.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace emax::chip {
namespace {

class Bytes {
 public:
  explicit Bytes(const std::string& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
    if (bytes_.size() < 52 || word(0) != 0x464C457F || half(18) != 40) {
      throw std::runtime_error(path + " is no program for Arm");
    }
  }

  std::uint32_t half(std::size_t at) const { return byte(at) | byte(at + 1) << 8; }
  std::uint32_t word(std::size_t at) const { return half(at) | half(at + 2) << 16; }
  std::vector<std::uint8_t> part(std::size_t at, std::size_t size) const {
    byte(at + size - 1);
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
    return {begin, begin + static_cast<std::ptrdiff_t>(size)};
  }
  std::string text(std::size_t at) const {
    std::string text;
    for (; byte(at) != 0; ++at) {
      text.push_back(static_cast<char>(byte(at)));
    }
    return text;
  }

 private:
  std::uint32_t byte(std::size_t at) const {
    if (at >= bytes_.size()) {
      throw std::runtime_error(path_ + " is cut off");
    }
    return static_cast<std::uint8_t>(bytes_[at]);
  }

  std::string path_;
  std::vector<char> bytes_;
};

void read_segments(const Bytes& file, Elf& elf) {
  constexpr std::uint32_t kLoad = 1;
  for (std::uint32_t i = 0; i < file.half(44); ++i) {
    const std::uint32_t header = file.word(28) + i * file.half(42);
    const std::uint32_t size = file.word(header + 16);
    if (file.word(header) == kLoad && size != 0) {
      elf.segments.push_back({file.word(header + 12), file.part(file.word(header + 4), size)});
    }
  }
}

void read_symbols(const Bytes& file, Elf& elf) {
  constexpr std::uint32_t kSymbolTable = 2;
  const std::uint32_t sections = file.word(32);
  const std::uint32_t section_size = file.half(46);
  for (std::uint32_t i = 0; i < file.half(48); ++i) {
    const std::uint32_t section = sections + i * section_size;
    if (file.word(section + 4) != kSymbolTable) {
      continue;
    }
    const std::uint32_t names = file.word(sections + file.word(section + 24) * section_size + 16);
    const std::uint32_t begin = file.word(section + 16);
    for (std::uint32_t at = begin; at < begin + file.word(section + 20); at += 16) {
      elf.symbols[file.text(names + file.word(at))] = file.word(at + 4);
    }
  }
}

}  // namespace

Elf read_elf(const std::string& path) {
  const Bytes file(path);
  Elf elf;
  read_segments(file, elf);
  read_symbols(file, elf);
  return elf;
}

}  // namespace emax::chip
