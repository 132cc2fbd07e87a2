// Exact cell integrals of the kernel, from the last row and column to the first.
#include "emax/energy/phi_buffer.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/energy/phi_operator.hpp"

namespace emax {
namespace {

constexpr std::size_t row_start(std::size_t i, std::size_t cells) noexcept {
  return i * cells - i * (i + 1) / 2 + i;
}

/// The last column: every cell's output against that of the last cell, which is still driven until
/// T.
void fill_last_column(const PhiOperator& phi, std::size_t cells, Span<double> packed) noexcept {
  // The first row is filled last, so it can hold the column until its elements are in their places.
  const Span<double> column = packed.first(cells);
  for (double& element : column) {
    element = 0.0;
  }
  phi.add_column(cells - 1, 1.0, column);
  for (std::size_t i = cells; i-- > 0;) {
    packed[row_start(i, cells) + cells - 1 - i] = column[i];
  }
}

}  // namespace

void PhiMatrix::multiply(Signs signs, Span<double> product) const noexcept {
  for (std::size_t i = 0; i < cells_; ++i) {
    product[i] = 0.0;
  }
  const double* element = packed_.data();
  for (std::size_t i = 0; i < cells_; ++i) {
    const double sign = signs[i];
    double sum = *element++ * sign;
    for (std::size_t j = i + 1; j < cells_; ++j) {
      sum += *element * signs[j];
      product[j] += *element++ * sign;
    }
    product[i] += sum;
  }
}

void PhiMatrix::add_column(std::size_t cell, double scale, Span<double> product) const noexcept {
  for (std::size_t i = 0; i < cells_; ++i) {
    product[i] += scale * at(i, cell);
  }
}

Status fill_phi(const ModalModel& model, double duration_s, std::size_t cells,
                Span<double> packed) noexcept {
  PhiOperator phi;
  const Status status = phi.set(model, duration_s, cells);
  if (status != Status::kOk) {
    return status;
  }
  if (packed.size() < packed_size(cells)) {
    return Status::kBufferTooSmall;
  }
  fill_last_column(phi, cells, packed);

  const Span<const Mode> modes = model.modes();
  const std::size_t count = modes.size();
  const double cell_s = duration_s / static_cast<double>(cells);
  Complex step[kMaxModes];
  Complex output[kMaxModes];  // of a cell at the start of the last stretch before T
  for (std::size_t m = 0; m < count; ++m) {
    const Complex z = cell_s * modes[m].pole;
    step[m] = exp(z);
    output[m] = (cell_s * modes[m].residue) * phi1(z);
  }
  // Integrals over one cell's width of e^(p_m s) e^(p_n s), with the criterion's weight: G z
  // phi1(z) has no cancellation where G (e^z - 1) would.
  Complex pair[kMaxModes][kMaxModes];
  Complex pair_conj[kMaxModes][kMaxModes];
  for (std::size_t m = 0; m < count; ++m) {
    for (std::size_t n = 0; n < count; ++n) {
      const Complex z = cell_s * (modes[m].pole + modes[n].pole);
      const Complex z_conj = cell_s * (modes[m].pole + conj(modes[n].pole));
      pair[m][n] = 0.5 * (model.gramian(m, n) * (z * phi1(z)));
      pair_conj[m][n] = 0.5 * (model.conjugate_gramian(m, n) * (z_conj * phi1(z_conj)));
    }
  }
  for (std::size_t j = cells - 1; j-- > 0;) {
    Complex term[kMaxModes];  // of the sum that the last stretch adds to Phi(j - distance, j)
    for (std::size_t m = 0; m < count; ++m) {
      Complex integral;
      for (std::size_t n = 0; n < count; ++n) {
        integral = integral + pair[m][n] * output[n] + pair_conj[m][n] * conj(output[n]);
      }
      term[m] = output[m] * integral;
    }
    for (std::size_t i = j + 1; i-- > 0;) {
      double sum = packed[row_start(i + 1, cells) + j - i];
      for (std::size_t m = 0; m < count; ++m) {
        sum += term[m].re;
        term[m] = step[m] * term[m];
      }
      packed[row_start(i, cells) + j - i] = sum;
    }
    for (std::size_t m = 0; m < count; ++m) {
      output[m] = step[m] * output[m];
    }
  }
  return Status::kOk;
}

}  // namespace emax
