// The fixed-point algorithm of the paper: x <- a sgn(Phi x) until it rests.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/phi_buffer.hpp"
#include "emax/phi_operator.hpp"
#include "emax/span.hpp"
#include "emax/status.hpp"

namespace emax {

inline constexpr std::size_t kMaxIterations = 1000;

/// How a run of the fixed-point algorithm went. Energies are for a = 1.
struct FixedPointResult {
  double energy = 0.0;         ///< The largest of all iterates: x'Phi x of the pattern returned.
  std::size_t iterations = 0;  ///< Iterates made beyond the starting one, J at most.
  std::size_t best = 0;        ///< The number of the iterate that is returned.
  bool at_rest = false;  ///< The last iterate reproduces itself: it satisfies paper equation (16).
};

/// Runs paper equation (19) on the pattern in `signs`, at most `max_iterations` times; Fig. 2.
///
/// For the criterion of the integral-square error Phi is positive semidefinite and the energy never
/// falls. For the energy difference the plain iteration may fall and may end in a cycle of two; the
/// best iterate is kept, and a `shift` c > 0 iterates with Phi + c I instead, which climbs again if
/// c is at least minus the lowest eigenvalue. A cell with (Phi x) of exactly zero keeps its sign.
///
/// @tparam Phi PhiMatrix or PhiOperator.
/// @param[in,out] signs   The starting pattern, then the best iterate. `cells()` elements of +1 or
///   -1.
/// @param[out]    best    Memory for one more pattern.
/// @param[out]    product Memory for Phi x; afterwards Phi times the pattern returned.
/// @param[out]    trace   The energies of the iterates 0, 1, ... as far as it has room; may be
///   empty. One product with Phi for each iterate.
template <typename Phi>
FixedPointResult run_fixed_point(const Phi& phi, std::size_t max_iterations, double shift,
                                 Span<std::int8_t> signs, Span<std::int8_t> best,
                                 Span<double> product, Span<double> trace) noexcept;

/// The starting pattern of paper equation (18): the signs of column `cell` of Phi. A zero counts as
/// +1.
template <typename Phi>
void signs_of_column(const Phi& phi, std::size_t cell, Span<std::int8_t> signs,
                     Span<double> product) noexcept;

/// x'y for a pattern of signs: the energy if y is Phi x.
double dot(Span<const std::int8_t> signs, Span<const double> product) noexcept;

}  // namespace emax
