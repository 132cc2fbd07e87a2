// Fixed points in lockstep, with AVX2 where the processor has it.
#include "desk/trials/paper_lanes.hpp"

#include <limits>

#include "emax/base/signs.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/energy/phi_operator.hpp"

// With FMA, gcc 12 fuses products and sums of vectors in spite of -ffp-contract=off, and a fused
// one has other bits. So what computes with vectors has AVX2 and no FMA, whatever the rest has.
#if defined(__x86_64__)
#define EMAX_LANES __attribute__((target("avx2,no-fma")))
#else
#define EMAX_LANES
#endif

namespace emax::desk {
namespace {

using Vector = double __attribute__((vector_size(32), may_alias));

template <typename Numbers>
EMAX_LANES inline Vector& vector_of(Numbers& numbers) noexcept {
  return *static_cast<Vector*>(static_cast<void*>(numbers.of));
}

}  // namespace

bool has_lanes() noexcept {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

PaperLanes::PaperLanes(const ModalModel& model, double duration_s, std::size_t cells,
                       std::size_t max_iterations)
    : duration_s_(duration_s),
      cells_(cells),
      max_iterations_(max_iterations),
      count_(model.modes().size()),
      signs_(cells),
      product_(cells),
      column_(cells) {
  for (Run& run : runs_) {
    run.model = model;
  }
}

void PaperLanes::run(Span<const Accelerometer> devices, Span<double> energies) {
  next_device_ = 0;
  std::size_t active = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    active += take_next_device(lane, devices, energies) ? 1U : 0U;
  }
  while (active != 0) {
    multiply();
    take_signs();
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (runs_[lane].is_active && is_finished(lane)) {
        energies[runs_[lane].device] = runs_[lane].energy;
        active -= take_next_device(lane, devices, energies) ? 0U : 1U;
      }
    }
  }
}

/// @returns False if there is none: the lane goes on with what it has, and nobody looks at it.
bool PaperLanes::take_next_device(std::size_t lane, Span<const Accelerometer> devices,
                                  Span<double> energies) {
  Run& run = runs_[lane];
  run.is_active = false;
  for (; next_device_ < devices.size() && !run.is_active; ++next_device_) {
    run.is_active = run.model.set_device(devices[next_device_]) == Status::kOk;
    run.device = next_device_;
    if (!run.is_active) {
      energies[next_device_] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  if (!run.is_active) {
    return false;
  }
  PhiOperator phi;
  (void)phi.set(run.model, duration_s_, cells_);
  const auto set = [lane](ComplexNumbers& numbers, Complex value) {
    numbers.re.of[lane] = value.re;
    numbers.im.of[lane] = value.im;
  };
  for (std::size_t m = 0; m < count_; ++m) {
    set(step_[m], phi.step(m));
    set(correlation_[m], phi.correlation(m));
    set(end_[m], phi.end(m));
  }
  diagonal_.of[lane] = phi.endless_diagonal();
  // The signs of Phi's first column.
  const Span<double> column(column_.data(), cells_);
  for (double& value : column) {
    value = 0.0;
  }
  phi.add_column(0, 1.0, column);
  for (std::size_t i = 0; i < cells_; ++i) {
    signs_[i].of[lane] = column[i] < 0.0 ? -1.0 : 1.0;
  }
  run.iterations = 0;
  run.has_energy = false;
  return true;
}

void PaperLanes::multiply() {
  go_forward();
  take_end();
  go_back();
}

/// As `PhiOperator` goes: two modes at a time.
EMAX_LANES void PaperLanes::go_forward() {
  const Vector diagonal = vector_of(diagonal_);
  for (std::size_t i = 0; i < cells_; ++i) {
    vector_of(product_[i]) = diagonal * vector_of(signs_[i]);
  }
  for (std::size_t m = 0; m < count_; m += 2) {
    const Vector a_re = vector_of(step_[m].re);
    const Vector a_im = vector_of(step_[m].im);
    const Vector b_re = vector_of(step_[m + 1].re);
    const Vector b_im = vector_of(step_[m + 1].im);
    const Vector c_re = vector_of(correlation_[m].re);
    const Vector c_im = vector_of(correlation_[m].im);
    const Vector d_re = vector_of(correlation_[m + 1].re);
    const Vector d_im = vector_of(correlation_[m + 1].im);
    Vector x_re = {};
    Vector x_im = {};
    Vector y_re = {};
    Vector y_im = {};
    for (std::size_t i = 0; i < cells_; ++i) {
      const Vector sign = vector_of(signs_[i]);
      Vector& product = vector_of(product_[i]);
      product = product + (c_re * x_re - c_im * x_im) + (d_re * y_re - d_im * y_im);
      const Vector x = a_re * x_re - a_im * x_im;
      x_im = a_re * x_im + a_im * x_re;
      x_re = x + sign;
      const Vector y = b_re * y_re - b_im * y_im;
      y_im = b_re * y_im + b_im * y_re;
      y_re = y + sign;
    }
    vector_of(state_[m].re) = x_re;
    vector_of(state_[m].im) = x_im;
    vector_of(state_[m + 1].re) = y_re;
    vector_of(state_[m + 1].im) = y_im;
  }
}

/// What is left at T, seen from each mode: lane by lane, as it is short.
void PaperLanes::take_end() {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto get = [lane](const ComplexNumbers& numbers) {
      return Complex{numbers.re.of[lane], numbers.im.of[lane]};
    };
    Complex at_end[kMaxModes];
    for (std::size_t m = 0; m < count_; ++m) {
      at_end[m] = get(end_[m]) * get(state_[m]);
    }
    for (std::size_t m = 0; m < count_; ++m) {
      const Complex back = get(end_[m]) * runs_[lane].model.gramian_row(m, at_end);
      state_[m].re.of[lane] = back.re;
      state_[m].im.of[lane] = back.im;
    }
  }
  if (count_ % 2 != 0) {
    state_[count_] = {};
  }
}

EMAX_LANES void PaperLanes::go_back() {
  for (std::size_t m = 0; m < count_; m += 2) {
    const Vector a_re = vector_of(step_[m].re);
    const Vector a_im = vector_of(step_[m].im);
    const Vector b_re = vector_of(step_[m + 1].re);
    const Vector b_im = vector_of(step_[m + 1].im);
    const Vector c_re = vector_of(correlation_[m].re);
    const Vector c_im = vector_of(correlation_[m].im);
    const Vector d_re = vector_of(correlation_[m + 1].re);
    const Vector d_im = vector_of(correlation_[m + 1].im);
    Vector x_re = vector_of(state_[m].re);
    Vector x_im = vector_of(state_[m].im);
    Vector y_re = vector_of(state_[m + 1].re);
    Vector y_im = vector_of(state_[m + 1].im);
    for (std::size_t i = cells_; i-- > 0;) {
      const Vector sign = vector_of(signs_[i]);
      Vector& product = vector_of(product_[i]);
      product = product + x_re + y_re;
      const Vector x = a_re * x_re - a_im * x_im;
      x_im = a_re * x_im + a_im * x_re + sign * c_im;
      x_re = x + sign * c_re;
      const Vector y = b_re * y_re - b_im * y_im;
      y_im = b_re * y_im + b_im * y_re + sign * d_im;
      y_re = y + sign * d_re;
    }
  }
}

/// The energies of the patterns, then x <- sgn(Phi x); a cell of zero keeps its sign.
EMAX_LANES void PaperLanes::take_signs() {
  Vector energy = {};
  Vector changes = {};
  const Vector one = {1.0, 1.0, 1.0, 1.0};
  for (std::size_t i = 0; i < cells_; ++i) {
    const Vector product = vector_of(product_[i]);
    const Vector before = vector_of(signs_[i]);
    energy = energy + before * product;
    const Vector after = product > 0.0 ? one : product < 0.0 ? -one : before;
    changes = after != before ? one : changes;
    vector_of(signs_[i]) = after;
  }
  vector_of(energy_) = energy;
  vector_of(changes_) = changes;
}

/// As `FixedPoint::step()`: takes the energy, and goes on unless the pattern rests or the
/// iterations are used up.
bool PaperLanes::is_finished(std::size_t lane) {
  Run& run = runs_[lane];
  const double energy = energy_.of[lane];
  if (!run.has_energy || energy > run.energy) {
    run.energy = energy;
  }
  run.has_energy = true;
  if (run.iterations == max_iterations_ || changes_.of[lane] == 0.0) {
    return true;
  }
  ++run.iterations;
  return false;
}

}  // namespace emax::desk
