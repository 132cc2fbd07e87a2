// The relaxation with triangle inequalities by an augmented Lagrangian over vectors.
#include "emax/base/elementary.hpp"
#include "emax/bound/energy_certificate.hpp"

#include "violated_triangles.hpp"

namespace emax {
namespace {

constexpr std::size_t kRank = kCertificateRank;
/// From so many cells on, a minimum takes longer to reach.
constexpr std::size_t kManyCells = 400;
constexpr std::size_t kMaxSteps = 40;
constexpr std::size_t kMaxStepsOfMany = 80;
constexpr std::size_t kMaxHalvings = 12;
constexpr double kSufficient = 1e-4;
/// Of the largest element of the gradient, in units of the mean diagonal.
constexpr double kFlat = 1e-5;
constexpr double kDisturbance = 1e-3;
constexpr double kLeastViolation = 0.003;
/// A round is the last one if nothing is violated by more and the value moves by less.
constexpr double kRestViolation = 2e-3;
constexpr double kRestChange = 2e-7;

double inner(const double* a, const double* b, std::size_t count) noexcept {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (std::size_t n = 0; n < 4; ++n) {
      sums[n] += a[i + n] * b[i + n];
    }
  }
  for (; i < count; ++i) {
    sums[0] += a[i] * b[i];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void add_multiple(double factor, const double* from, std::size_t count, double* to) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    to[i] += factor * from[i];
  }
}

double largest_of(const double* values, std::size_t count) noexcept {
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    largest = abs(values[i]) > largest ? abs(values[i]) : largest;
  }
  return largest;
}

}  // namespace

// A point has kRank components for each cell, row by row, and then one more for each: with that the
// vectors have length 1, without it 1 or less, as v_i^2 <= 1 asks.
void EnergyCertificate::take_vectors(const double* point) noexcept {
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < cells; ++i) {
    const double* const own = point + i * kRank;
    const double slack = point[kRank * cells + i];
    double square = slack * slack;
    for (std::size_t r = 0; r < kRank; ++r) {
      square += own[r] * own[r];
    }
    const double scale = 1.0 / sqrt(square);
    for (std::size_t r = 0; r < kRank; ++r) {
      vectors_[i * kRank + r] = own[r] * scale;
      columns_[r * cells + i] = own[r] * scale;
    }
  }
}

/// Products of each pair of vectors above the diagonal of scratch_.
void EnergyCertificate::fill_products() noexcept {
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < cells; ++i) {
    double* const row = scratch_ + i * cells;
    const double* const own = vectors_ + i * kRank;
    for (std::size_t j = i; j < cells; ++j) {
      double sum = 0.0;
      for (std::size_t r = 0; r < kRank; ++r) {
        sum += own[r] * columns_[r * cells + j];
      }
      row[j] = sum;
    }
  }
}

void EnergyCertificate::set_matrix() noexcept {
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < cells * cells; ++i) {
    matrix_[i] = phi_[i];
  }
}

// -<Q, X> + sum over inequalities of [max(0, mu + rho c)^2 - mu^2]/(2 rho), c = s . X - 1.
double EnergyCertificate::lagrangian(const double* point, double* gradient) noexcept {
  const std::size_t cells = grid_.cells;
  take_vectors(point);
  fill_products();
  set_matrix();
  double value = 0.0;
  const double half = 0.5 / penalty_;
  for (std::size_t n = 0; n < multiplier_count_; ++n) {
    const TriangleMultiplier& own = memory_.multipliers[n];
    const double violation = slope(own);
    const double force = own.value + penalty_ * violation;
    value -= half * own.value * own.value;
    if (force > 0.0) {
      value += half * force * force - force * (violation + 1.0);
      apply(own, force);
    }
  }
  for (std::size_t i = 0; i < cells; ++i) {
    double g[kRank];
    multiply_row(i, g);
    double along = 0.0;
    double square = point[kRank * cells + i] * point[kRank * cells + i];
    for (std::size_t r = 0; r < kRank; ++r) {
      along += g[r] * vectors_[i * kRank + r];
      square += point[i * kRank + r] * point[i * kRank + r];
    }
    value -= along;
    // The gradient by the unit vector is -2 g, 0 for the component more; its part across counts.
    const double scale = 1.0 / sqrt(square);
    for (std::size_t r = 0; r < kRank; ++r) {
      gradient[i * kRank + r] = -2.0 * scale * (g[r] - along * vectors_[i * kRank + r]);
    }
    gradient[kRank * cells + i] = 2.0 * scale * along * scale * point[kRank * cells + i];
  }
  return value;
}

// The two loops of L-BFGS.
void EnergyCertificate::find_direction(const double* gradient, double* direction) noexcept {
  const std::size_t count = unknowns();
  for (std::size_t i = 0; i < count; ++i) {
    direction[i] = -gradient[i];
  }
  double weights[kHistory] = {};
  for (std::size_t back = 0; back < history_.count; ++back) {
    const std::size_t at = (history_.newest + kHistory - back) % kHistory;
    weights[at] = inner(history_.steps[at], direction, count) / history_.curvatures[at];
    add_multiple(-weights[at], history_.changes[at], count, direction);
  }
  if (history_.count > 0) {
    const double* const change = history_.changes[history_.newest];
    const double scale = history_.curvatures[history_.newest] / inner(change, change, count);
    for (std::size_t i = 0; i < count; ++i) {
      direction[i] *= scale;
    }
  }
  for (std::size_t back = history_.count; back-- > 0;) {
    const std::size_t at = (history_.newest + kHistory - back) % kHistory;
    const double other = inner(history_.changes[at], direction, count) / history_.curvatures[at];
    add_multiple(weights[at] - other, history_.steps[at], count, direction);
  }
}

double EnergyCertificate::minimise(double value) noexcept {
  const std::size_t count = unknowns();
  const std::size_t most = grid_.cells < kManyCells ? kMaxSteps : kMaxStepsOfMany;
  history_.count = 0;
  for (std::size_t step = 0; step < most; ++step) {
    if (largest_of(gradient_, count) < kFlat * mean_diagonal_) {
      break;
    }
    find_direction(gradient_, direction_);
    double descent = inner(direction_, gradient_, count);
    if (!(descent < 0.0)) {
      history_.count = 0;
      find_direction(gradient_, direction_);
      descent = inner(direction_, gradient_, count);
    }
    double length = history_.count > 0 ? 1.0 : 0.1 / largest_of(direction_, count);
    double next = value;
    bool is_lower = false;
    for (std::size_t halving = 0; halving < kMaxHalvings && !is_lower; ++halving) {
      for (std::size_t i = 0; i < count; ++i) {
        trial_[i] = point_[i] + length * direction_[i];
      }
      next = lagrangian(trial_, next_gradient_);
      is_lower = next <= value + kSufficient * length * descent;
      length *= is_lower ? 1.0 : 0.4;
    }
    if (!is_lower) {
      break;
    }
    const std::size_t at = (history_.newest + 1) % kHistory;
    for (std::size_t i = 0; i < count; ++i) {
      history_.steps[at][i] = trial_[i] - point_[i];
      history_.changes[at][i] = next_gradient_[i] - gradient_[i];
      point_[i] = trial_[i];
      gradient_[i] = next_gradient_[i];
    }
    value = next;
    const double curvature = inner(history_.steps[at], history_.changes[at], count);
    if (curvature > 1e-10 * inner(history_.changes[at], history_.changes[at], count)) {
      history_.curvatures[at] = curvature;
      history_.newest = at;
      history_.count += history_.count < kHistory ? 1 : 0;
    }
  }
  return value;
}

// Vectors that all lie in a few dimensions would never leave them.
void EnergyCertificate::disturb_point() noexcept {
  for (std::size_t i = 0; i < unknowns(); ++i) {
    random_ = random_ * 1664525u + 1013904223u;
    point_[i] += kDisturbance * (static_cast<double>(random_ >> 8) / 8388608.0 - 1.0);
  }
}

void EnergyCertificate::normalise_point() noexcept {
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < cells; ++i) {
    double& slack = point_[kRank * cells + i];
    double square = slack * slack;
    for (std::size_t r = 0; r < kRank; ++r) {
      square += point_[i * kRank + r] * point_[i * kRank + r];
    }
    const double scale = 1.0 / sqrt(square);
    slack *= scale;
    for (std::size_t r = 0; r < kRank; ++r) {
      point_[i * kRank + r] *= scale;
    }
  }
}

/// @returns The largest violation.
double EnergyCertificate::update_multipliers() noexcept {
  double largest = 0.0;
  for (std::size_t n = 0; n < multiplier_count_; ++n) {
    TriangleMultiplier& own = memory_.multipliers[n];
    const double violation = slope(own);
    const double force = own.value + penalty_ * violation;
    own.value = force > 0.0 ? force : 0.0;
    own.mean = static_cast<float>(violation);
    largest = violation > largest ? violation : largest;
  }
  return largest;
}

double EnergyCertificate::add_violated() noexcept {
  ViolatedTriangles violated(memory_.violated, kLeastViolation);
  violated.search(scratch_, grid_.cells);
  double largest = 0.0;
  for (const ViolatedTriangle& found : violated.found()) {
    const bool is_new = add_multiplier(found.i, found.j, found.k, found.kind);
    largest = is_new && found.violation > largest ? found.violation : largest;
  }
  return largest;
}

void EnergyCertificate::relax() noexcept {
  const double before = estimate_;
  disturb_point();
  normalise_point();
  const double value = minimise(lagrangian(point_, gradient_));
  (void)lagrangian(point_, gradient_);  // Products at the point, not at the last trial.
  double largest = update_multipliers();
  forget_unused_multipliers();
  const double added = add_violated();
  largest = added > largest ? added : largest;
  estimate_ = (costs_ - value) * scale_;
  at_rest_ = largest < kRestViolation && abs(estimate_ - before) < kRestChange * estimate_;
}

}  // namespace emax
