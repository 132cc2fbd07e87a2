// Every signal within the limit replaced by its means over cells, at a bounded price in energy.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/bound/kernel_bounds.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The number of cells beyond which a certificate's matrices are not filled.
inline constexpr std::size_t kMaxCertificateCells = 1000;
/// Fewer resolve no response.
inline constexpr std::size_t kMinCertificateCells = 32;

/// Energies below are for a = 1.
///
/// For every |x| <= 1 on [0, T] there are numbers -1 <= v_i <= 1, one for each cell, with
///
///     E(x) <= v' Phi v + sum over cells i of cost[i] (1 - v_i^2).
///
/// v_i is the mean of x over cell i. Let g = Phi x and e = x - v, so E(x) = E(v) + 2 <g, e> - E(e).
/// On each cell, F(t) = integral of e from its start to t is 0 at both ends, so <g, e> = -<g', F>,
/// and |g'| <= m_1 (`KernelBounds`). F rises by at most 1 - v_i and falls by at most 1 + v_i per
/// unit of time: between two of its zeros at a distance l the integral of |F| is at most that of a
/// tent, (1 - v_i^2) l^2/4, and the sum of the l^2 is at most the square of the cell's width h. So
/// cost = m_1 h^2/2.
///
/// E(e) is not negative where E is a square. For the energy difference it is at least -||Kf e||^2,
/// and Kf e = (s Kf) F with ||F|| <= (h/pi) ||e|| on each cell and ||e||^2 <= h (1 - v_i^2): the
/// cost is h (h max|s Kf|/pi)^2 more.
struct CertificateGrid {
  static constexpr std::size_t kEdges = kMaxCertificateCells + 1;

  std::size_t cells = 0;
  double edges_s[kEdges] = {};              ///< Ascending from 0 to T; cells + 1 of them.
  double costs[kMaxCertificateCells] = {};  ///< Of each cell.
};

static_assert(std::is_trivially_copyable_v<CertificateGrid>);

/// Lays out about `wanted` cells on [0, T], equal ones but for narrower ones about the switches of
/// a good signal: what a cell costs counts only where signals near the best one switch.
///
/// @param[in] switches_s Ascending; may be empty.
/// @returns
/// * kOk: Edges and their number are set, and nothing else.
/// * kTooManyCells: More than kMaxCertificateCells.
/// * kInvalidArgument: Fewer than kMinCertificateCells, or no duration.
Status lay_out_cells(double duration_s, std::size_t wanted, Span<const double> switches_s,
                     CertificateGrid& grid) noexcept;

/// The number of cells of at most 1/10 of a period of the faster of sensor and filter; coarser ones
/// cost too much.
std::size_t coarsest_certificate(const ModalModel& model, double duration_s) noexcept;

/// Raises what cells cost to what bounds that are done ask for; no cost becomes lower, so that
/// costs can cover several models.
///
/// @param[in] margin Every cost is taken this many times as large, 1 or a little more, so that a
///   check with bounds of its own, found in another way, can confirm it.
void raise_costs(const KernelBounds& bounds, double margin, CertificateGrid& grid) noexcept;

/// Phi of the cells, row by row, symmetric: cells^2 numbers.
///
/// @param scratch At least 4 kMaxModes cells numbers.
void fill_certificate_phi(const ModalModel& model, const CertificateGrid& grid, Span<double> matrix,
                          Span<double> scratch) noexcept;

/// What the rounding of each row of Phi, summed over its elements, is relative to: the sizes of all
/// terms of their closed forms. `kCertificateRounding` of it covers a check in ball arithmetic too.
///
/// @param[out] sizes One for each cell.
/// @param scratch As above.
void fill_row_sizes(const ModalModel& model, const CertificateGrid& grid, Span<double> sizes,
                    Span<double> scratch) noexcept;

/// A check has been seen to need 17 to 66 times 2^-53.
inline constexpr double kCertificateRounding = 128.0 * 0x1p-53;

}  // namespace emax
