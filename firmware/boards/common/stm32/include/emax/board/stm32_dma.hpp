// One direction of DMA: a channel of an STM32G4, or a stream of an STM32H7.
#pragma once

#include <cstdint>

namespace emax::board {

/// What differs from chip to chip: which registers, and which of their bits. Control, count,
/// peripheral and memory follow each other on all of them.
struct DmaSettings {
  std::uintptr_t registers;   ///< The first of these four.
  std::uintptr_t request_at;  ///< Where DMAMUX has it,
  std::uint32_t request;      ///< and the number of who asks.
  std::uintptr_t status;      ///< Flags,
  std::uintptr_t clear;       ///< and where they are cleared.
  std::uint32_t all;          ///< Of these: its own,
  std::uint32_t half;         ///< half of the ring has gone through,
  std::uint32_t end;          ///< the second half has, too,
  std::uint32_t error;        ///< an error.
  std::uint32_t control;      ///< A ring of words of 32 bits on both sides, without interrupts.
  std::uint32_t interrupts;   ///< In control: at half and at the end.
};

/// A ring that goes round until it is stopped.
class Stm32Dma {
 public:
  constexpr explicit Stm32Dma(const DmaSettings& settings) noexcept : settings_(settings) {}

  /// @param[in] memory As `dma_address()` gives it.
  /// @returns False if one of before does not end.
  bool start(std::uintptr_t peripheral, std::uint32_t memory, std::uint32_t words,
             bool interrupts) const noexcept;

  /// No further word; also for interrupts.
  void hold() const noexcept;

  /// The same, and no further interrupt.
  void stop() const noexcept;

  /// @returns Words until the ring begins anew, from its size down to 1.
  std::uint32_t left() const noexcept;

  /// For the interrupt. @returns How many halves have gone through since the last call.
  std::uint32_t take_halves() const noexcept;

  bool has_failed() const noexcept;

 private:
  const DmaSettings settings_;
};

}  // namespace emax::board
