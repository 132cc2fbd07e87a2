// Every signal within the limit rounded to a sign pattern on a grid, at a bounded price in energy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/bound/kernel_bounds.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The number of cells beyond which a certificate's matrices are not filled.
inline constexpr std::size_t kMaxCertificateCells = 640;
/// Fewer make no grid that narrows towards T.
inline constexpr std::size_t kMinCertificateCells = 32;

/// Energies below are for a = 1.
///
/// For every |x| <= 1 on [0, T] there is a sign pattern v on the cells with
///
///     E(x) <= v' Phi v + constant + sum over edges e of switch_cost[e] (1 - v_(e-1) v_e) / 2,
///
/// in which no run of equal signs between two switches at edges e < f has f < run_end[e]. It is
/// enough to see that for an x of greatest energy, which is sgn g with g = Phi x. The steps, with
/// m_n of `KernelBounds`:
///
/// * A pulse between zeros of g at a distance w cannot be turned with profit, so its energy is at
///   most w^3/12 max m_2: zeros are never closer than some distance that depends on where they are.
/// * v is the sign of x in the middle of each cell. E is convex, so E(v) >= E(x) + 2 <g, v - x>,
///   and v - x differs from 0 only in halves of cells that have a zero of g, where |g| is at most
///   m_1 times the distance from it: a half of width d costs at most 2 m_1 d^2. Between two middles
///   there is at most one zero, because two would be too close, and then v switches at the edge
///   between them: that pays. At 0 and at the first edge of the zone below it may not switch, so
///   their halves count as constants.
/// * Near T zeros may be as close as they like. There v takes the better sign in each cell of width
///   h, which costs at most min(2 integral of m_0, m_1 h^2) whatever x does.
///
/// (Such an x exists: a convex energy has a maximiser with |x| = 1, and g is zero on no set of
/// positive measure, because turning x there would gain the energy of that set's response, which is
/// not zero.)
struct CertificateGrid {
  static constexpr std::size_t kEdges = kMaxCertificateCells + 1;

  std::size_t cells = 0;
  /// Edges from this one on belong to the zone near T in which switches are not counted.
  std::size_t free_from = 0;
  double constant = 0.0;
  double edges_s[kEdges] = {};         ///< Ascending from 0 to T; cells + 1 of them.
  double switch_cost[kEdges] = {};     ///< Of edges 1 to free_from - 1; 0 elsewhere.
  std::uint16_t run_end[kEdges] = {};  ///< Of edges 1 to free_from - 1; 0 elsewhere.

  /// @returns True if no pattern has v_i = v_k and v_j different, i < j < k being cells: the run
  /// with j inside would have to start after i and end at k at the latest.
  bool no_run_between(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    for (std::size_t edge = i + 1; edge <= j; ++edge) {
      if (run_end[edge] <= k) {
        return false;
      }
    }
    return true;
  }
};

static_assert(std::is_trivially_copyable_v<CertificateGrid>);

/// Lays out about `wanted` cells on [0, T], equal ones but for narrow ones at 0 and towards T.
///
/// @returns
/// * kOk: Edges and their number are set, and nothing else.
/// * kTooManyCells: More than kMaxCertificateCells.
/// * kInvalidArgument: Fewer than kMinCertificateCells, or no duration.
Status lay_out_cells(const ModalModel& model, double duration_s, std::size_t wanted,
                     CertificateGrid& grid) noexcept;

/// The number of cells of at most 1/10 of a period of the faster of sensor and filter; coarser ones
/// pay for many roundings.
std::size_t coarsest_certificate(const ModalModel& model, double duration_s) noexcept;

/// Fills in what roundings cost and where runs cannot end, from bounds that are done.
///
/// @param[in] margin Every cost is taken this many times as large, 1 or a little more, so that a
///   check with bounds of its own, found in another way, can confirm it.
void fill_costs(const ModalModel& model, const KernelBounds& bounds, double margin,
                CertificateGrid& grid) noexcept;

/// Phi of the cells, row by row, symmetric: cells^2 numbers.
///
/// @param scratch At least 4 kMaxModes cells numbers.
void fill_certificate_phi(const ModalModel& model, const CertificateGrid& grid, Span<double> matrix,
                          Span<double> scratch) noexcept;

}  // namespace emax
