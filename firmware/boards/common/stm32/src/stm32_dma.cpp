// What channels and streams have in common.
#include "emax/board/stm32_dma.hpp"

#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kCount = 0x04;
constexpr std::uintptr_t kPeripheral = 0x08;
constexpr std::uintptr_t kMemory = 0x0C;
constexpr std::uint32_t kOn = 1U << 0;

// A stream ends the word that is under way.
constexpr std::uint32_t kMostEnd_us = 100;

}  // namespace

bool Stm32Dma::start(std::uintptr_t peripheral, std::uint32_t memory, std::uint32_t words,
                     bool interrupts) const noexcept {
  const std::uintptr_t base = settings_.registers;
  stop();
  if (!wait_for([=] { return (reg(base) & kOn) == 0; }, kMostEnd_us)) {
    return false;
  }
  reg(settings_.clear) = settings_.all;
  reg(settings_.request_at) = settings_.request;
  reg(base + kCount) = words;
  reg(base + kPeripheral) = static_cast<std::uint32_t>(peripheral);
  reg(base + kMemory) = memory;
  const std::uint32_t control = settings_.control | (interrupts ? settings_.interrupts : 0);
  reg(base) = control;
  reg(base) = control | kOn;
  return true;
}

void Stm32Dma::hold() const noexcept { reg(settings_.registers) &= ~kOn; }

// Its interrupts may be switched off while it is on.
void Stm32Dma::stop() const noexcept { reg(settings_.registers) &= ~(kOn | settings_.interrupts); }

std::uint32_t Stm32Dma::left() const noexcept { return reg(settings_.registers + kCount); }

std::uint32_t Stm32Dma::take_halves() const noexcept {
  const std::uint32_t flags = reg(settings_.status) & (settings_.half | settings_.end);
  reg(settings_.clear) = flags;
  return ((flags & settings_.half) != 0 ? 1U : 0U) + ((flags & settings_.end) != 0 ? 1U : 0U);
}

bool Stm32Dma::has_failed() const noexcept {
  return (reg(settings_.status) & settings_.error) != 0;
}

}  // namespace emax::board
