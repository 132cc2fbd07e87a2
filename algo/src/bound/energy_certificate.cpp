// A certificate from its grid to its bound: gradient steps on the multipliers, y, the
// factorisation.
#include "emax/bound/energy_certificate.hpp"

#include <limits>

#include "emax/base/elementary.hpp"

#include "violated_triangles.hpp"

namespace emax {
namespace {

constexpr std::size_t kRank = kCertificateRank;
constexpr double kUnitsPerOne = 1073741824.0;  // 2^30
/// Costs are this much larger than what has been shown, so that a check that finds them by a mesh
/// of its own confirms them.
constexpr double kCostMargin = 1.02;
/// Of the scaled matrix: what has to be left on the diagonal when it is factorised, beside the
/// rounding of the matrix. That of a factorisation of 1000 cells is below 1000^2 times 2^-53 times
/// the largest y, 1.2e-10.
constexpr double kFactorMargin = 2e-10;
constexpr double kFirstDecay = 0.9;
constexpr double kSecondDecay = 0.99;
constexpr double kFirstStep = 0.001;
constexpr double kLastStep = 1e-6;
constexpr double kDisturbance = 1e-4;
/// Sweeps end when 16 of them change nothing by more than this, relative.
constexpr double kSettled = 1e-12;
constexpr std::size_t kLastSweeps = 5000;
/// Of the augmented Lagrangian, in units of the mean diagonal.
constexpr double kPenalty = 0.5;
/// In the table of keys; others are a multiplier's number plus one.
constexpr std::uint32_t kNoEntry = 0;

/// Pseudo-random numbers within +-1/2, the same every time.
void set_numbers(double* numbers, std::size_t count) noexcept {
  std::uint32_t state = 12345;
  for (std::size_t i = 0; i < count; ++i) {
    state = state * 1664525u + 1013904223u;
    numbers[i] = static_cast<double>(state >> 8) / 16777216.0 - 0.5;
  }
}

/// Moves every vector a little along one axis, in either direction. Vectors that all lie in a few
/// dimensions would never leave them, although the relaxation may ask for more.
void disturb(double* vectors, std::size_t count, std::size_t axis, double size,
             std::uint32_t& state) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    state = state * 1664525u + 1013904223u;
    vectors[i * kRank + axis] += size * (static_cast<double>(state >> 8) / 8388608.0 - 1.0);
  }
}

double power_of_two_above(double value) noexcept {
  double power = 1.0;
  while (power < value) {
    power *= 2.0;
  }
  while (power >= 2.0 * value && power > 1e-300) {
    power *= 0.5;
  }
  return power;
}

std::uint32_t key_of(std::size_t i, std::size_t j, std::size_t k, std::size_t kind) noexcept {
  return static_cast<std::uint32_t>((((i * 1009 + j) * 1009 + k) * 4 + kind) * 2654435761u);
}

}  // namespace

Status EnergyCertificate::take_workspace(const CertificateWorkspace& workspace,
                                         std::size_t intervals) noexcept {
  const std::size_t hash = workspace.hash.size();
  const bool is_enough = workspace.duals.size() >= grid_.cells && !workspace.violated.empty() &&
                         hash >= 2 * workspace.multipliers.size() && hash > 0 &&
                         workspace.numbers.size() >= certificate_numbers(grid_.cells, intervals);
  if (!is_enough || (hash & (hash - 1)) != 0) {
    return Status::kBufferTooSmall;
  }
  memory_ = workspace;
  return Status::kOk;
}

Status EnergyCertificate::start(const ModalModel& model, double duration_s, std::size_t cells,
                                Span<const double> switches_s,
                                const CertificateWorkspace& workspace) noexcept {
  return start(Span<const ModalModel>(&model, 1), duration_s, cells, switches_s, workspace);
}

Status EnergyCertificate::start(Span<const ModalModel> models, double duration_s, std::size_t cells,
                                Span<const double> switches_s,
                                const CertificateWorkspace& workspace) noexcept {
  *this = {};
  if (models.empty()) {
    return Status::kInvalidArgument;
  }
  Status status = lay_out_cells(duration_s, cells, switches_s, grid_);
  if (status != Status::kOk) {
    return status;
  }
  std::size_t intervals = 0;
  for (const ModalModel& model : models) {
    const std::size_t wanted = mesh_intervals(model, duration_s);
    intervals = wanted > intervals ? wanted : intervals;
  }
  status = take_workspace(workspace, intervals);
  if (status != Status::kOk) {
    return status;
  }
  models_ = models;
  // All are tried, the first one last.
  for (std::size_t left = models.size(); left > 0 && status == Status::kOk; --left) {
    status = kernel_.start(models[left - 1], duration_s, workspace.numbers);
  }
  return status;
}

Status EnergyCertificate::start(Span<const double> matrix, std::size_t cells,
                                const CertificateWorkspace& workspace) noexcept {
  *this = {};
  if (cells < 2 || cells > kMaxCertificateCells || matrix.size() != cells * cells) {
    return Status::kInvalidArgument;
  }
  grid_.cells = cells;
  const Status status = take_workspace(workspace, 0);
  if (status != Status::kOk) {
    return status;
  }
  lay_out_memory();
  for (std::size_t i = 0; i < cells * cells; ++i) {
    phi_[i] = matrix[i];
  }
  for (std::size_t i = 0; i < cells; ++i) {
    margins_[i] = 0.0;
  }
  begin();
  return Status::kOk;
}

void EnergyCertificate::prepare() noexcept {
  if (!kernel_.done()) {
    kernel_.step();
    return;
  }
  raise_costs(kernel_, kCostMargin, grid_);
  ++prepared_;
  if (prepared_ < models_.size()) {
    const double duration_s = grid_.edges_s[grid_.cells];
    (void)kernel_.start(models_[prepared_], duration_s, memory_.numbers);  // As tried before.
    return;
  }
  // The mesh of the kernel is no longer needed; its place is taken.
  lay_out_memory();
  fill_phi(models_[0], 1.0);
  for (std::size_t cell = 0; cell < grid_.cells; ++cell) {
    costs_ += grid_.costs[cell];
  }
  begin();
}

// Phi less the costs, in units of `scale`.
void EnergyCertificate::fill_phi(const ModalModel& model, double scale) noexcept {
  const std::size_t cells = grid_.cells;
  fill_certificate_phi(model, grid_, Span<double>(phi_, cells * cells),
                       Span<double>(spare_, 4 * kMaxModes * cells));
  for (std::size_t cell = 0; cell < cells; ++cell) {
    phi_[cell * cells + cell] -= grid_.costs[cell];
  }
  for (std::size_t i = 0; i < cells * cells; ++i) {
    phi_[i] /= scale;
  }
  fill_row_sizes(model, grid_, Span<double>(margins_, cells),
                 Span<double>(spare_, 4 * kMaxModes * cells));
  for (std::size_t cell = 0; cell < cells; ++cell) {
    margins_[cell] *= kCertificateRounding / scale;
  }
}

void EnergyCertificate::lay_out_memory() noexcept {
  const std::size_t cells = grid_.cells;
  Span<double> left = memory_.numbers;
  const auto take = [&left](std::size_t count) {
    double* const taken = left.data();
    left = left.from(count);
    return taken;
  };
  phi_ = take(cells * cells);
  matrix_ = take(cells * cells);
  scratch_ = take(cells * cells);
  vectors_ = take(kRank * cells);
  columns_ = take(kRank * cells);
  dual_ = take(cells);
  margins_ = take(cells);
  spare_ = take(4 * kMaxModes * cells);
  for (double** const own : {&point_, &trial_, &gradient_, &next_gradient_, &direction_}) {
    *own = take(unknowns());
  }
  for (std::size_t i = 0; i < kHistory; ++i) {
    history_.steps[i] = take(unknowns());
    history_.changes[i] = take(unknowns());
  }
}

// With phi_ filled: the scale, from a first relaxation.
void EnergyCertificate::begin() noexcept {
  const std::size_t cells = grid_.cells;
  for (std::uint32_t& entry : memory_.hash) {
    entry = kNoEntry;
  }
  set_numbers(point_, unknowns());
  normalise_point();
  take_vectors(point_);
  set_matrix();
  double value = 0.0;
  for (int i = 0; i < 20; ++i) {
    value = sweep();
  }
  scale_ = power_of_two_above(value);
  unit_ = scale_ / kUnitsPerOne;
  mean_diagonal_ = value / scale_ / static_cast<double>(cells);
  costs_ /= scale_;
  penalty_ = kPenalty * mean_diagonal_;
  for (std::size_t i = 0; i < cells * cells; ++i) {
    phi_[i] /= scale_;
  }
  for (std::size_t i = 0; i < cells; ++i) {
    margins_[i] /= scale_;
    point_[kRank * cells + i] = 0.1;
    for (std::size_t r = 0; r < kRank; ++r) {
      point_[i * kRank + r] = vectors_[i * kRank + r];
    }
  }
  estimate_ = value + costs_ * scale_;
  ready_ = true;
}

bool EnergyCertificate::add_multiplier(std::size_t i, std::size_t j, std::size_t k,
                                       std::size_t kind) noexcept {
  if (multiplier_count_ == memory_.multipliers.size()) {
    return false;
  }
  const std::size_t mask = memory_.hash.size() - 1;
  std::size_t slot = key_of(i, j, k, kind) & mask;
  while (memory_.hash[slot] != kNoEntry) {
    const TriangleMultiplier& other = memory_.multipliers[memory_.hash[slot] - 1];
    if (other.i == i && other.j == j && other.k == k && other.kind == kind) {
      return false;
    }
    slot = (slot + 1) & mask;
  }
  TriangleMultiplier& added = memory_.multipliers[multiplier_count_++];
  added = {};
  added.i = static_cast<std::uint16_t>(i);
  added.j = static_cast<std::uint16_t>(j);
  added.k = static_cast<std::uint16_t>(k);
  added.kind = static_cast<std::uint8_t>(kind);
  memory_.hash[slot] = static_cast<std::uint32_t>(multiplier_count_);
  return true;
}

// Those that are zero and hold by far; the table of keys is made anew.
void EnergyCertificate::forget_unused_multipliers() noexcept {
  constexpr float kIdle = -0.3F;
  const std::size_t count = multiplier_count_;
  for (std::uint32_t& entry : memory_.hash) {
    entry = kNoEntry;
  }
  multiplier_count_ = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const TriangleMultiplier kept = memory_.multipliers[n];
    const bool is_idle = !(kept.value > 0.0) && kept.mean < kIdle;
    if (!is_idle && add_multiplier(kept.i, kept.j, kept.k, kept.kind)) {
      memory_.multipliers[multiplier_count_ - 1] = kept;
    }
  }
}

/// s . X - 1 with the products in scratch_.
double EnergyCertificate::slope(const TriangleMultiplier& multiplier) const noexcept {
  const std::size_t cells = grid_.cells;
  const std::int8_t* const signs = kTriangleSigns[multiplier.kind];
  const double* const row = scratch_ + multiplier.i * cells;
  return signs[0] * row[multiplier.j] + signs[1] * scratch_[multiplier.j * cells + multiplier.k] +
         signs[2] * row[multiplier.k] - 1.0;
}

// matrix_ loses amount * s / 2 at each of the three pairs.
void EnergyCertificate::apply(const TriangleMultiplier& multiplier, double amount) noexcept {
  const std::size_t cells = grid_.cells;
  const std::int8_t* const signs = kTriangleSigns[multiplier.kind];
  const double half = 0.5 * amount;
  const std::size_t i = multiplier.i;
  const std::size_t j = multiplier.j;
  const std::size_t k = multiplier.k;
  const double ij = half * signs[0];
  const double jk = half * signs[1];
  const double ik = half * signs[2];
  matrix_[i * cells + j] -= ij;
  matrix_[j * cells + i] -= ij;
  matrix_[j * cells + k] -= jk;
  matrix_[k * cells + j] -= jk;
  matrix_[i * cells + k] -= ik;
  matrix_[k * cells + i] -= ik;
}

// Two sums beside one another, so that an addition need not wait for the one before.
void EnergyCertificate::multiply_row(std::size_t i, double (&g)[kRank]) const noexcept {
  const std::size_t cells = grid_.cells;
  const double* const row = matrix_ + i * cells;
  double even[kRank] = {};
  double odd[kRank] = {};
  std::size_t j = 0;
  for (; j + 1 < cells; j += 2) {
    const double* const v = vectors_ + j * kRank;
    for (std::size_t r = 0; r < kRank; ++r) {
      even[r] += row[j] * v[r];
      odd[r] += row[j + 1] * v[kRank + r];
    }
  }
  for (; j < cells; ++j) {
    for (std::size_t r = 0; r < kRank; ++r) {
      even[r] += row[j] * vectors_[j * kRank + r];
    }
  }
  for (std::size_t r = 0; r < kRank; ++r) {
    g[r] = even[r] + odd[r];
  }
}

// The mixing method: each vector in turn takes its best place, of length 1 or less.
double EnergyCertificate::sweep() noexcept {
  const std::size_t cells = grid_.cells;
  double value = 0.0;
  for (std::size_t i = 0; i < cells; ++i) {
    const double* const row = matrix_ + i * cells;
    double g[kRank];
    multiply_row(i, g);
    double* const own = vectors_ + i * kRank;
    double square = 0.0;
    for (std::size_t r = 0; r < kRank; ++r) {
      g[r] -= row[i] * own[r];
      square += g[r] * g[r];
    }
    // 2 g v + q v^2 is largest at length 1, or inside if q is far below 0.
    const double length = sqrt(square);
    const double y = length + row[i];
    dual_[i] = y > 0.0 ? y : 0.0;
    value += y > 0.0 ? y : length * length / -row[i];
    const double scale = y > 0.0 ? 1.0 / length : -1.0 / row[i];
    for (std::size_t r = 0; r < kRank && length > 0.0; ++r) {
      own[r] = g[r] * scale;
    }
  }
  return value;
}

void EnergyCertificate::polish(double progress) noexcept {
  if (!is_polishing_) {
    is_polishing_ = true;
    set_matrix();
    take_vectors(point_);
    for (std::size_t n = 0; n < multiplier_count_; ++n) {
      TriangleMultiplier& own = memory_.multipliers[n];
      own.mean = 0.0F;
      apply(own, own.value);
    }
  }
  const double part = progress < 1.0 ? progress : 1.0;
  disturb(vectors_, grid_.cells, iteration_ % kRank, kDisturbance, random_);
  double value = sweep();
  step_multipliers(kFirstStep * exp(log(kLastStep / kFirstStep) * part) * mean_diagonal_);
  ++iteration_;
  for (const TriangleMultiplier& multiplier : multipliers()) {
    value += multiplier.value;
  }
  estimate_ = (value + costs_) * scale_;
}

// Adam, by A (V V') - 1; leaves V V' in scratch_, above the diagonal.
void EnergyCertificate::step_multipliers(double length) noexcept {
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t r = 0; r < kRank; ++r) {
      columns_[r * cells + i] = vectors_[i * kRank + r];
    }
  }
  fill_products();
  first_power_ *= kFirstDecay;
  second_power_ *= kSecondDecay;
  const double first_weight = length / (1.0 - first_power_);
  const double second_weight = 1.0 / (1.0 - second_power_);
  for (std::size_t n = 0; n < multiplier_count_; ++n) {
    TriangleMultiplier& own = memory_.multipliers[n];
    const double ascent = slope(own);
    const double mean = kFirstDecay * static_cast<double>(own.mean) + (1.0 - kFirstDecay) * ascent;
    const double square =
        kSecondDecay * static_cast<double>(own.square) + (1.0 - kSecondDecay) * ascent * ascent;
    own.mean = static_cast<float>(mean);
    own.square = static_cast<float>(square);
    const double before = own.value;
    const double after = before + first_weight * mean / (sqrt(square * second_weight) + 1e-3);
    own.value = after > 0.0 ? after : 0.0;
    if (own.value > before || own.value < before) {
      apply(own, own.value - before);
    }
  }
}

// To whole units, and the matrix anew from them.
void EnergyCertificate::fix_multipliers() noexcept {
  set_matrix();
  constant_ = costs_;
  for (std::size_t n = 0; n < multiplier_count_; ++n) {
    TriangleMultiplier& own = memory_.multipliers[n];
    own.units = static_cast<std::int32_t>(floor(own.value * kUnitsPerOne + 0.5));
    const double amount = static_cast<double>(own.units) / kUnitsPerOne;
    apply(own, amount);
    constant_ += amount;
  }
}

std::size_t EnergyCertificate::used_multipliers() const noexcept {
  std::size_t used = 0;
  for (const TriangleMultiplier& multiplier : multipliers()) {
    used += multiplier.units != 0 ? 1u : 0u;
  }
  return used;
}

// Cholesky's factorisation of Diag(y) - Q', four rows at a time; scratch_ holds the upper triangle.
bool EnergyCertificate::is_semidefinite() noexcept {
  const std::size_t size = grid_.cells;
  double* const factor = scratch_;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = i; j < size; ++j) {
      factor[i * size + j] = -matrix_[i * size + j];
    }
    factor[i * size + i] +=
        static_cast<double>(memory_.duals[i]) / kUnitsPerOne - (kFactorMargin + margins_[i]);
  }
  constexpr std::size_t kPanel = 4;
  for (std::size_t first = 0; first < size; first += kPanel) {
    const std::size_t end = first + kPanel < size ? first + kPanel : size;
    for (std::size_t k = first; k < end; ++k) {
      double* const row = factor + k * size;
      for (std::size_t above = first; above < k; ++above) {
        const double* const other = factor + above * size;
        const double weight = other[k];
        for (std::size_t j = k; j < size; ++j) {
          row[j] -= weight * other[j];
        }
      }
      if (!(row[k] > 0.0)) {
        return false;
      }
      const double scale = 1.0 / sqrt(row[k]);
      for (std::size_t j = k; j < size; ++j) {
        row[j] *= scale;
      }
    }
    if (end - first < kPanel) {
      break;
    }
    const double* const a = factor + first * size;
    const double* const b = a + size;
    const double* const c = b + size;
    const double* const d = c + size;
    for (std::size_t i = end; i < size; ++i) {
      double* const row = factor + i * size;
      const double wa = a[i];
      const double wb = b[i];
      const double wc = c[i];
      const double wd = d[i];
      for (std::size_t j = i; j < size; ++j) {
        row[j] -= (wa * a[j] + wb * b[j]) + (wc * c[j] + wd * d[j]);
      }
    }
  }
  return true;
}

// Sweeps until they rest.
void EnergyCertificate::settle() noexcept {
  for (std::size_t axis = 0; axis < kRank; ++axis) {
    disturb(vectors_, grid_.cells, axis, kDisturbance, random_);
  }
  double value = sweep();
  for (std::size_t i = 1; i < kLastSweeps; ++i) {
    const double next = sweep();
    if (i % 16 == 0 && abs(next - value) < kSettled * next) {
      break;
    }
    value = next;
  }
}

bool EnergyCertificate::set_duals(double raise) noexcept {
  for (std::size_t i = 0; i < grid_.cells; ++i) {
    const double units = (dual_[i] + raise * mean_diagonal_) * kUnitsPerOne + 1.0;
    memory_.duals[i] = units < 2147483647.0 ? static_cast<std::int32_t>(units)
                                            : std::numeric_limits<std::int32_t>::max();
  }
  return is_semidefinite();
}

bool EnergyCertificate::prove() noexcept {
  fix_multipliers();
  if (!is_polishing_) {
    take_vectors(point_);
  }
  return find_bound();
}

bool EnergyCertificate::prove(std::size_t model) noexcept {
  fill_phi(models_[model], scale_);
  set_matrix();
  for (const TriangleMultiplier& own : multipliers()) {
    apply(own, static_cast<double>(own.units) / kUnitsPerOne);
  }
  return find_bound();
}

bool EnergyCertificate::find_bound() noexcept {
  settle();
  double low = 0.0;
  double high = 1e-7;
  while (!set_duals(high)) {
    low = high;
    high *= 4.0;
    if (high > 100.0) {
      return false;
    }
  }
  for (int i = 0; i < 5 && low > 0.0; ++i) {
    const double middle = 0.5 * (low + high);
    (set_duals(middle) ? high : low) = middle;
  }
  if (!set_duals(high)) {
    return false;
  }
  double sum = constant_;
  for (std::size_t i = 0; i < grid_.cells; ++i) {
    sum += static_cast<double>(memory_.duals[i]) / kUnitsPerOne;
  }
  bound_ = sum * scale_ * (1.0 + 1e-12);
  return true;
}

}  // namespace emax
