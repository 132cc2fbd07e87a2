// The grid of a certificate, what its cells cost, and Phi on them.
#include "emax/bound/certificate_grid.hpp"

#include <limits>

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

// Into how many parts a cell is split by how far its middle is from the next switch, in widths.
constexpr double kNear = 0.75;
constexpr double kFar = 2.0;
constexpr std::size_t kNearParts = 6;
constexpr std::size_t kFarParts = 2;

/// The distance of a time from the nearest switch.
double distance_s(Span<const double> switches_s, double time_s) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const double switch_s : switches_s) {
    const double distance = abs(switch_s - time_s);
    least = distance < least ? distance : least;
  }
  return least;
}

std::size_t parts_of(Span<const double> switches_s, double middle_s, double width_s) noexcept {
  const double distance = distance_s(switches_s, middle_s);
  if (distance < kNear * width_s) {
    return kNearParts;
  }
  return distance < kFar * width_s ? kFarParts : 1;
}

}  // namespace

std::size_t coarsest_certificate(const ModalModel& model, double duration_s) noexcept {
  const double wanted = 10.0 * duration_s * model.grid_hz();
  const double most = static_cast<double>(kMaxCertificateCells + 1);
  const auto cells = static_cast<std::size_t>(wanted < most ? wanted + 1.0 : most);
  return cells > kMinCertificateCells ? cells : kMinCertificateCells;
}

Status lay_out_cells(double duration_s, std::size_t wanted, Span<const double> switches_s,
                     CertificateGrid& grid) noexcept {
  if (!(duration_s > 0.0) || !is_finite(duration_s) || wanted < kMinCertificateCells) {
    return Status::kInvalidArgument;
  }
  const double width_s = duration_s / static_cast<double>(wanted);
  std::size_t cells = 0;
  for (std::size_t i = 0; i < wanted; ++i) {
    const double middle_s = (static_cast<double>(i) + 0.5) * width_s;
    const std::size_t parts = parts_of(switches_s, middle_s, width_s);
    if (cells + parts > kMaxCertificateCells) {
      return Status::kTooManyCells;
    }
    for (std::size_t part = 0; part < parts; ++part) {
      const double offset = static_cast<double>(part) / static_cast<double>(parts);
      grid.edges_s[cells++] = (static_cast<double>(i) + offset) * width_s;
    }
  }
  grid.edges_s[cells] = duration_s;
  grid.cells = cells;
  return Status::kOk;
}

void raise_costs(const KernelBounds& bounds, double margin, CertificateGrid& grid) noexcept {
  for (std::size_t cell = 0; cell < grid.cells; ++cell) {
    const double from_s = grid.edges_s[cell];
    const double to_s = grid.edges_s[cell + 1];
    const double width_s = to_s - from_s;
    const double rest = width_s * (bounds.filter_slope() / kPi) * (bounds.filter_slope() / kPi);
    const double cost = margin * (0.5 * bounds.bound(from_s, to_s) + rest) * width_s * width_s;
    grid.costs[cell] = cost > grid.costs[cell] ? cost : grid.costs[cell];
  }
}

void fill_certificate_phi(const ModalModel& model, const CertificateGrid& grid, Span<double> matrix,
                          Span<double> scratch) noexcept {
  const Span<const Mode> modes = model.modes();
  const std::size_t cells = grid.cells;
  const double duration_s = grid.edges_s[cells];
  // For cells i < j: Re sum r_p early_p(i) e^(p d) late_p(j), d from the end of i to the start of
  // j.
  const auto early = [&](std::size_t mode, std::size_t cell) -> double* {
    return &scratch[4 * (mode * cells + cell)];
  };
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const double width_s = grid.edges_s[cell + 1] - grid.edges_s[cell];
    const double left_s = duration_s - grid.edges_s[cell];
    for (std::size_t p = 0; p < modes.size(); ++p) {
      const Complex pole = modes[p].pole;
      const Complex once = width_s * phi1(width_s * pole);
      // Integral over the cell of e^(p (s - start)) U_p(T - s).
      const auto part = [&](Complex other) {
        const Complex decay = exp(left_s * (pole + other) - width_s * other);
        return decay * (width_s * phi1(width_s * other)) - once;
      };
      Complex late;
      for (std::size_t q = 0; q < modes.size(); ++q) {
        late = late + modes[q].residue * model.gramian(p, q) * part(modes[q].pole);
        late = late +
               conj(modes[q].residue) * model.conjugate_gramian(p, q) * part(conj(modes[q].pole));
      }
      double* const numbers = early(p, cell);
      numbers[0] = once.re;
      numbers[1] = once.im;
      numbers[2] = 0.5 * late.re;
      numbers[3] = 0.5 * late.im;
    }
    matrix[cell * cells + cell] = pulse_energy(model, left_s, width_s);
  }
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t j = i + 1; j < cells; ++j) {
      const double distance_s = grid.edges_s[j] - grid.edges_s[i + 1];
      double sum = 0.0;
      for (std::size_t p = 0; p < modes.size(); ++p) {
        const double* const from = early(p, i);
        const double* const to = early(p, j);
        const Complex first = modes[p].residue * Complex{from[0], from[1]};
        sum += real_of_product(first * exp(distance_s * modes[p].pole), Complex{to[2], to[3]});
      }
      matrix[i * cells + j] = sum;
      matrix[j * cells + i] = sum;
    }
  }
}

void fill_row_sizes(const ModalModel& model, const CertificateGrid& grid, Span<double> sizes,
                    Span<double> scratch) noexcept {
  const Span<const Mode> modes = model.modes();
  const std::size_t cells = grid.cells;
  const double duration_s = grid.edges_s[cells];
  const auto size = [](Complex z) { return sqrt(norm(z)); };
  // Sizes of early_p(i) r_p and of late_p(i), as in the matrix.
  const auto early = [&](std::size_t p, std::size_t i) -> double& {
    return scratch[2 * (p * cells + i)];
  };
  const auto late = [&](std::size_t p, std::size_t i) -> double& {
    return scratch[2 * (p * cells + i) + 1];
  };
  for (std::size_t i = 0; i < cells; ++i) {
    const double width_s = grid.edges_s[i + 1] - grid.edges_s[i];
    const double left_s = duration_s - grid.edges_s[i];
    sizes[i] = 0.0;
    for (std::size_t p = 0; p < modes.size(); ++p) {
      const Complex pole = modes[p].pole;
      const double once = width_s * size(phi1(width_s * pole));
      double both = 0.0;
      double during = 0.0;
      for (std::size_t q = 0; q < modes.size(); ++q) {
        const double other = width_s * size(phi1(width_s * modes[q].pole));
        const double decay =
            exp(left_s * (pole.re + modes[q].pole.re) - width_s * modes[q].pole.re);
        const double weight = 0.5 * size(modes[q].residue) *
                              (size(model.gramian(p, q)) + size(model.conjugate_gramian(p, q)));
        both += weight * (decay * other + once);
        during += weight * (other + width_s + 2.0 * (decay * other + once));
      }
      early(p, i) = once * size(modes[p].residue);
      late(p, i) = both;
      sizes[i] += size(modes[p].residue) * size(model.inverse_pole(p)) * during;
    }
  }
  for (std::size_t p = 0; p < modes.size(); ++p) {
    double from_before = 0.0;
    double from_behind = 0.0;
    const auto decay = [&](std::size_t i) {
      return exp((grid.edges_s[i + 1] - grid.edges_s[i]) * modes[p].pole.re);
    };
    for (std::size_t i = 0; i < cells; ++i) {
      sizes[i] += late(p, i) * from_before;
      from_before = from_before * decay(i) + early(p, i);
      const std::size_t back = cells - 1 - i;
      sizes[back] += early(p, back) * from_behind;
      from_behind = from_behind * decay(back) + late(p, back);
    }
  }
}

}  // namespace emax
