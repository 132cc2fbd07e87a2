// The grid of a certificate, the price of rounding a signal to it, and Phi on its cells.
#include "emax/bound/certificate_grid.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"

namespace emax {
namespace {

/// A check on a mesh of its own sees runs only to a step of the mesh.
constexpr double kRunMargins = 1.5;

double larger(double a, double b) noexcept { return a > b ? a : b; }
double smaller(double a, double b) noexcept { return a < b ? a : b; }

/// What the cell widths at both ends are multiples of: 1 us for a sensor of 4 kHz.
double width_unit_s(const ModalModel& model) noexcept { return 0.004 / model.grid_hz(); }

/// The width of the cell that starts `before_s` before T, for cells of `width_s` elsewhere.
double width_before_end_s(double before_s, double unit_s, double width_s) noexcept {
  return smaller(width_s, larger(2.0 * unit_s, 0.22 * before_s));
}

/// Edges for cells of this width, from T backwards to 0.
///
/// @returns The number of cells, beyond kMaxCertificateCells if there are too many.
std::size_t lay_out(double duration_s, double unit_s, double width_s,
                    CertificateGrid& grid) noexcept {
  const double first_s[] = {0.3 * width_s, 0.6 * width_s};
  double narrow_s = 0.0;
  std::size_t narrow = 0;
  // The narrow cells, by their edges' distances from T.
  double distance_s[64] = {};
  while (narrow < 63 && narrow_s < 0.25 * duration_s) {
    const double next_s = width_before_end_s(narrow_s, unit_s, width_s);
    if (!(next_s < width_s)) {
      break;
    }
    narrow_s += next_s;
    distance_s[++narrow] = narrow_s;
  }
  const double equal_s = duration_s - narrow_s - first_s[0] - first_s[1];
  const double count = floor(equal_s / width_s) + 1.0;
  if (!(count < static_cast<double>(kMaxCertificateCells))) {
    return kMaxCertificateCells + 1;
  }
  const auto equal = static_cast<std::size_t>(count);
  const std::size_t cells = 2 + equal + narrow;
  if (cells > kMaxCertificateCells) {
    return cells;
  }
  grid.edges_s[0] = 0.0;
  grid.edges_s[1] = first_s[0];
  for (std::size_t i = 0; i <= equal; ++i) {
    grid.edges_s[2 + i] =
        first_s[0] + first_s[1] + equal_s * static_cast<double>(i) / static_cast<double>(equal);
  }
  for (std::size_t i = 0; i < narrow; ++i) {
    grid.edges_s[cells - i] = duration_s - distance_s[i];
  }
  grid.edges_s[cells] = duration_s;  // Without rounding, also if no cell is narrow.
  grid.cells = cells;
  return cells;
}

struct Middle {
  double before_s;  ///< Of the cell that ends at an edge.
  double after_s;   ///< Of the cell that starts there.
};

Middle middles(const CertificateGrid& grid, std::size_t edge) noexcept {
  const double edge_s = grid.edges_s[edge];
  return {0.5 * (grid.edges_s[edge - 1] + edge_s), 0.5 * (edge_s + grid.edges_s[edge + 1])};
}

/// The distance below which no two zeros can be, the first of them between `from_s` and `to_s`.
double shortest_run_s(const ModalModel& model, const KernelBounds& bounds, double duration_s,
                      double from_s, double to_s, double longest_s) noexcept {
  constexpr double kSteps = 160.0;
  const double step_s = longest_s / kSteps;
  const double left_s = duration_s - to_s;
  // |K pulse| / w changes by at most half the norm of k' times the change of w.
  const double change = 0.5 * bounds.slope_norm() * step_s;
  double before = sqrt(pulse_energy(model, left_s, 1e-3 * step_s)) / (1e-3 * step_s) - change;
  for (double n = 1.0; n <= kSteps; n += 1.0) {
    const double width_s = n * step_s;
    if (width_s > left_s) {
      return width_s - step_s;
    }
    const double now = sqrt(pulse_energy(model, left_s, width_s)) / width_s;
    const double least = 0.5 * (before + now - change);
    const double largest = bounds.bound(2, from_s, to_s + width_s);
    if (!(least > 0.0 && least * least > 1.0000001 * largest * width_s / 12.0)) {
      return width_s - step_s;
    }
    before = now;
  }
  return longest_s;
}

}  // namespace

std::size_t coarsest_certificate(const ModalModel& model, double duration_s) noexcept {
  const double wanted = 10.0 * duration_s * model.grid_hz();
  const double most = static_cast<double>(kMaxCertificateCells + 1);
  const auto cells = static_cast<std::size_t>(wanted < most ? wanted + 1.0 : most);
  return cells > kMinCertificateCells ? cells : kMinCertificateCells;
}

Status lay_out_cells(const ModalModel& model, double duration_s, std::size_t wanted,
                     CertificateGrid& grid) noexcept {
  if (!(duration_s > 0.0) || !is_finite(duration_s) || wanted < kMinCertificateCells) {
    return Status::kInvalidArgument;
  }
  const double unit_s = width_unit_s(model);
  const double width_s = duration_s / static_cast<double>(wanted);
  return lay_out(duration_s, smaller(unit_s, 0.5 * width_s), width_s, grid) > kMaxCertificateCells
             ? Status::kTooManyCells
             : Status::kOk;
}

void fill_costs(const ModalModel& model, const KernelBounds& bounds, double margin,
                CertificateGrid& grid) noexcept {
  const double duration_s = grid.edges_s[grid.cells];
  const double longest_s = 0.5 / model.grid_hz();
  const double run_margin = 1.0 + kRunMargins * (margin - 1.0);
  grid.free_from = grid.cells;
  for (std::size_t edge = grid.cells - 1; edge >= 1; --edge) {
    const Middle here = middles(grid, edge);
    const double shortest_s =
        shortest_run_s(model, bounds, duration_s, here.before_s, here.after_s, longest_s) /
        run_margin;
    if (!(here.after_s - here.before_s < shortest_s)) {
      grid.free_from = edge;
    }
    std::size_t end = edge;
    while (end < grid.free_from && middles(grid, end).after_s - here.before_s < shortest_s) {
      ++end;
    }
    grid.run_end[edge] = static_cast<std::uint16_t>(end);
  }
  const auto half_cell_cost = [&](double from_s, double to_s) {
    return 2.0 * margin * bounds.bound(1, from_s, to_s) * (to_s - from_s) * (to_s - from_s);
  };
  for (std::size_t edge = 1; edge < grid.cells; ++edge) {
    grid.switch_cost[edge] = 0.0;
    if (edge >= grid.free_from) {
      grid.run_end[edge] = 0;
      continue;
    }
    const Middle here = middles(grid, edge);
    grid.switch_cost[edge] = larger(half_cell_cost(here.before_s, grid.edges_s[edge]),
                                    half_cell_cost(grid.edges_s[edge], here.after_s));
  }
  grid.constant = half_cell_cost(0.0, 0.5 * grid.edges_s[1]);
  const double free_s = grid.edges_s[grid.free_from];
  grid.constant += half_cell_cost(0.5 * (grid.edges_s[grid.free_from - 1] + free_s), free_s);
  for (std::size_t cell = grid.free_from; cell < grid.cells; ++cell) {
    const double from_s = grid.edges_s[cell];
    const double to_s = grid.edges_s[cell + 1];
    const double width_s = to_s - from_s;
    grid.constant +=
        margin * width_s *
        smaller(2.0 * bounds.bound(0, from_s, to_s), width_s * bounds.bound(1, from_s, to_s));
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

}  // namespace emax
