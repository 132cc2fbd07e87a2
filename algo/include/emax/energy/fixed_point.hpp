// The fixed-point algorithm of the paper: x <- a sgn(Phi x) until it rests.
#pragma once

#include <cstddef>

#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/phi_operator.hpp"

namespace emax {

inline constexpr std::size_t kMaxIterations = 1000;

/// How a run of the fixed-point algorithm went. Energies are for a = 1.
struct FixedPointResult {
  double energy = 0.0;         ///< The largest of all iterates: x'Phi x of the pattern returned.
  std::size_t iterations = 0;  ///< Iterates made beyond the starting one, J at most.
  std::size_t best = 0;        ///< The number of the iterate that is returned.
  bool at_rest = false;  ///< The last iterate reproduces itself: it satisfies paper equation (16).
};

/// One iteration: x <- sgn(y + c x) with y = Phi x, the `product`. A cell of zero keeps its sign.
///
/// @returns Whether any sign changed.
bool take_signs(Span<const double> product, double shift, Signs signs) noexcept;

/// Runs paper equation (19) on a pattern of signs, Fig. 2, one product with Phi at a time.
///
///     run.start(max_iterations, shift);
///     while (!run.done()) {
///       run.step(phi, signs, best, product, trace);
///     }
///
/// For the criterion of the integral-square error Phi is positive semidefinite and the energy never
/// falls. For the energy difference the plain iteration may fall and may end in a cycle of two; the
/// best iterate is kept, and a `shift` c > 0 iterates with Phi + c I instead, which climbs again if
/// c is at least minus the lowest eigenvalue. A cell with (Phi x) of exactly zero keeps its sign.
class FixedPoint {
 public:
  void start(std::size_t max_iterations, double shift) noexcept;

  /// Makes one iterate, or finds that there is none to make.
  ///
  /// @tparam Phi PhiMatrix or PhiOperator, the same one in each step.
  /// @param[in,out] signs   The starting pattern, then the iterate; at the end the best one.
  /// @param[out]    best    Memory for one more pattern.
  /// @param[out]    product Memory for Phi x; at the end Phi times the pattern returned.
  /// @param[out]    trace   The energies of the iterates 0, 1, ... as far as it has room; may be
  ///   empty.
  /// All belong to the run until it is done. One product with Phi.
  template <typename Phi>
  void step(const Phi& phi, Signs signs, Signs best, Span<double> product,
            Span<double> trace) noexcept;

  bool done() const noexcept { return done_; }
  /// @returns With `done()`, how the run went.
  const FixedPointResult& result() const noexcept { return result_; }

 private:
  void take_energy(Signs signs, Signs best, Span<const double> product,
                   Span<double> trace) noexcept;

  FixedPointResult result_ = {};
  std::size_t max_iterations_ = 0;
  double shift_ = 0.0;
  bool begun_ = false;
  bool done_ = false;
};

/// A whole run of `FixedPoint`, at most `max_iterations` iterates beyond the first.
template <typename Phi>
FixedPointResult run_fixed_point(const Phi& phi, std::size_t max_iterations, double shift,
                                 Signs signs, Signs best, Span<double> product,
                                 Span<double> trace) noexcept;

/// The starting pattern of paper equation (18): the signs of column `cell` of Phi. A zero counts as
/// +1.
template <typename Phi>
void signs_of_column(const Phi& phi, std::size_t cell, Signs signs, Span<double> product) noexcept;

/// x'y for a pattern of signs: the energy if y is Phi x.
double dot(Signs signs, Span<const double> product) noexcept;

}  // namespace emax
