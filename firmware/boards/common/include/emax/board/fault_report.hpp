// The end of a program that cannot go on: drive to zero, one line of numbers, stop.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::board {

/// A register of the processor at the moment of a fault.
struct FaultNumber {
  const char* name;  ///< "pc" and so on.
  std::uint32_t value;
};

/// What a test image that ends in a fault gives its emulator as exit status.
inline constexpr int kFaultStatus = 70;

/// Room enough for a line of ten numbers.
inline constexpr std::size_t kFaultLineRoom = 256;

/// Writes "fault: bus, drive at zero, pc=0x00001234 lr=0x00001200" with a line feed in front and at
/// the end, or "DRIVE NOT AT ZERO"; what finds no room is left out.
///
/// @returns The number of characters.
std::size_t format_fault_line(const char* kind, bool drive_is_at_zero,
                              Span<const FaultNumber> numbers, Span<char> text) noexcept;

/// Leads the drive to zero, then puts the line on the console, by looking at the UART and not by
/// its interrupts. A fault on the way there comes back here: the second time it leaves the drive
/// alone, the third time it does nothing.
void report_fault(const char* kind, Span<const FaultNumber> numbers) noexcept;

/// Of the board: leads the drive to zero along the permitted slope, in whatever state the program
/// is. @returns Whether it is there.
bool lead_drive_to_zero() noexcept;

/// Of the board: puts a text on the console behind what waits there, without interrupts. Gives up a
/// byte that the UART does not take in a bounded time.
void write_polled(Span<const char> text) noexcept;

/// Of the image: a product waits for ever, or until its watchdog resets it; a test image ends its
/// emulator with this status.
[[noreturn]] void stop(int status) noexcept;

}  // namespace emax::board
