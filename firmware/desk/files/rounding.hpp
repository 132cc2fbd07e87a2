// Bounds in a few digits.
#pragma once

namespace emax::desk {

/// A proven bound in fewer digits must not fall below it.
///
/// @param[in] value    Finite.
/// @param[in] decimals 0 to 15.
/// @returns What `scientific(decimals)` and `general(decimals + 1)` show as the least number of so
/// many digits that is not below `value`.
double rounded_up(double value, int decimals);

}  // namespace emax::desk
