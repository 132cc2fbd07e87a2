// Counts the instructions of a piece of work on an emulated core, exactly and the same every time.
#pragma once

#include <cstdint>

namespace emax::cost {

/// A moment, in units of the counter.
using Ticks = std::uint64_t;

/// Switches the counter on. Once, first of all.
void start_counter() noexcept;

/// Exact only in an emulator that counts instructions.
Ticks now() noexcept;

/// @returns The units from one moment to a later one. A counter of 32 bits starts over: there, less
/// than 2^32 of them.
Ticks passed(Ticks from, Ticks to) noexcept;

/// @returns The instructions of so many units, to the nearest.
std::uint64_t instructions_of(Ticks ticks) noexcept;

/// Runs the work and counts; what the counting itself takes is taken off.
template <typename Work>
Ticks ticks_of(const Work& work) noexcept {
  const Ticks begin = now();
  const Ticks idle_end = now();
  work();
  const Ticks end = now();
  const Ticks idle = passed(begin, idle_end);
  const Ticks all = passed(idle_end, end);
  return all > idle ? all - idle : 0;
}

template <typename Work>
std::uint64_t instructions_in(const Work& work) noexcept {
  return instructions_of(ticks_of(work));
}

}  // namespace emax::cost
