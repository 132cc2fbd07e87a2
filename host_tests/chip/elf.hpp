// A program file as the linker leaves it: 32 bits, little endian, for Arm.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace emax::chip {

struct ElfSegment {
  std::uint32_t address = 0;  ///< Where it is loaded, not where it runs.
  std::vector<std::uint8_t> bytes;
};

struct Elf {
  std::vector<ElfSegment> segments;
  std::map<std::string, std::uint32_t> symbols;
};

/// @throws std::runtime_error What is wrong with the file.
Elf read_elf(const std::string& path);

}  // namespace emax::chip
