// Access to the registers of a peripheral.
#pragma once

#include <cstdint>

namespace emax::board {

/// The register at this address, as wide as T.
template <typename T = std::uint32_t>
volatile T& reg(std::uintptr_t address) noexcept {
  return *reinterpret_cast<volatile T*>(address);
}

}  // namespace emax::board
