// Figures in as many digits as their uncertainty justifies.
#pragma once

#include <string>

#include "desk/files/result_file.hpp"

namespace emax::desk {

/// What a figure is called and how it is written.
struct FigureWords {
  const char* heading;  ///< Of a column: "matched %".
  const char* unit;     ///< Behind a number: " % of S a".
  const char* option;   ///< "matched".
};

const FigureWords& figure_words(FigureKind kind) noexcept;

/// @param[in] expanded U, which decides on the digits: two of its own; 0 for four digits in all.
/// @returns ASCII: percent in decimals ("1.196"), unless it is tiny; V^2 s with its power of ten
/// ("5.115e-03").
std::string number_text(double value, double expanded, FigureKind kind);

/// @returns The value in four digits or more, none of which hides that it is a bound.
std::string bound_text(const Figure& figure, FigureKind kind);

/// @returns Whether a difference or an uncertainty is no more than the rounding of a figure.
bool is_rounding(double size, double figure) noexcept;

/// @returns U; 0 where it is but the rounding of the figure.
double shown_expanded(const Figure& figure) noexcept;
/// The same as text, "-" for none.
std::string expanded_text(const Figure& figure, FigureKind kind);

/// @returns `number_text()` of the value, "-" if there is none.
std::string value_text(const Figure& figure, FigureKind kind);

/// @returns "0 to 0.024": an interval of a figure that is at one end of it, rounded outwards to two
/// digits of the far end.
std::string range_text(double low, double high);

/// @returns "1.185 to 1.207"; "-" if there is none.
std::string interval_text(const Figure& figure, FigureKind kind);

/// @returns The root of E/T in percent of S a, "-" for an energy difference below 0.
std::string paper_text(const Result& result);

}  // namespace emax::desk
