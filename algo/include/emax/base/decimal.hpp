// Numbers to decimal text and back, correctly rounded, without heap, locale or stdio.
//
// Both directions compute exactly, in whole numbers of at most 84 limbs, and round once: to
// nearest, ties to even on the exact binary value, as glibc does. Nothing is terminated by a zero:
// the length is returned.
#pragma once

#include <cstddef>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {

/// As printf("%.*g", significant_digits, value).
///
/// The bytes of glibc, except that a NaN is "nan" whatever its sign: processors disagree about the
/// sign of a NaN they make. Infinities are "inf" and "-inf", zeros "0" and "-0".
///
/// @param[in]  significant_digits 1 to 17; with 17 `parse_decimal()` gives the same double back.
/// @param[out] text               24 characters are always enough.
/// @returns The characters written; 0, with nothing written, if the text is too short or the number
/// of digits outside its range. Stack below 0.7 KiB; time grows with the square of the exponent,
/// and near 1 is that of about 20 multiplications and 20 divisions of integers.
std::size_t format_general(double value, int significant_digits, Span<char> text) noexcept;

/// As printf("%.*f", decimals, value); otherwise as `format_general()`.
///
/// @param[in]  decimals 0 to 17.
/// @param[out] text     Needs decimals + 3 characters for values below 10 and one more for every
///                      further power of ten, at most 328.
/// @returns The characters written; 0, with nothing written, if the text is too short or `decimals`
/// outside its range. Stack below 0.7 KiB.
std::size_t format_fixed(double value, int decimals, Span<char> text) noexcept;

/// As printf("%.*e", decimals, value); otherwise as `format_general()`.
///
/// @param[in]  decimals 0 to 17.
/// @param[out] text     decimals + 8 characters are always enough.
/// @returns The characters written; 0, with nothing written, if the text is too short or `decimals`
/// outside its range. Stack below 0.7 KiB.
std::size_t format_scientific(double value, int decimals, Span<char> text) noexcept;

struct ParsedNumber {
  Status status = Status::kSyntax;
  double value = 0.0;
  std::size_t length = 0;  ///< Characters used.
};

/// The longest decimal number at the start of the text, as strtod would read it in the C locale.
///
/// [+-] digits [. digits] [e [+-] digits], with a digit before or after the point. An "e" without
/// digits is left unread. Not accepted, unlike strtod: leading white space, "inf", "nan",
/// hexadecimal ("0x10" is 0, one character long).
///
/// @returns
/// * kOk: The nearest double, ties to even. It may be subnormal or 0.
/// * kInvalidArgument: Too large for a finite double. The value is an infinity of that sign, and
/// the
///   length is that of the number.
/// * kSyntax: No number here; value and length are 0.
///
/// One pass over the text and, beyond 19 digits, a second one over at most 768 of them; the rest
/// only breaks ties. Up to 2^53 with powers of ten to 10^22 it is one multiplication or division.
/// Stack below 1 KiB.
ParsedNumber parse_decimal(Span<const char> text) noexcept;

}  // namespace emax
