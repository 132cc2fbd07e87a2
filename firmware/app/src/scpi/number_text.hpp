// Numeric parameters as IEEE 488.2 and SCPI write them: decimal with unit, hexadecimal, octal,
// binary.
#pragma once

#include "emax/app/scpi/error_code.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

struct NumberText {
  double value = 0.0;
  ErrorCode error = ErrorCode::kNoError;
};

/// Reads all of the text, which begins with a digit, a sign or a point: "1.5", "20 us", "1 E3 MHZ".
///
/// The value is that of the digits times the power of ten of exponent and multiplier, rounded once;
/// beyond the range of a double it is an infinity.
///
/// @param[in] unit Null if there must be none.
/// @returns One of -103, -121, -123, -124, -131, -134, -138 if it is not a number. Stack below
/// 1.6 KiB.
NumberText read_decimal(Span<const char> text, const char* unit) noexcept;

/// Reads all of the text, which begins with '#': "#H1F", "#Q17", "#B101". Rounded above 2^53.
NumberText read_nondecimal(Span<const char> text) noexcept;

}  // namespace emax::app::scpi
