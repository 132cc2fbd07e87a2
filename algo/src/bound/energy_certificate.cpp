// Multipliers by mixing sweeps and gradient steps, and y with its factorisation.
#include "emax/bound/energy_certificate.hpp"

#include <limits>

#include "emax/base/elementary.hpp"

#include "certificate_vectors.hpp"
#include "violated_triangles.hpp"

namespace emax {
namespace {

/// Costs are this much larger than what has been shown, so that a check that finds them by a mesh
/// of its own confirms them.
constexpr double kCostMargin = 1.02;
/// Of the scaled matrix: what has to be left on the diagonal when it is factorised. The rounding of
/// a factorisation of 640 cells is below 640^2 times 2^-53 times the largest y, 5e-11.
constexpr double kFactorMargin = 2e-10;
constexpr std::uint32_t kIterationsPerSearch = 40;
constexpr double kFirstDecay = 0.9;
constexpr double kSecondDecay = 0.99;
constexpr double kFirstStep = 0.005;
constexpr double kLastStep = 1e-5;
/// Of the time for multipliers; then none are added, and the steps shorten further.
constexpr double kSearchShare = 0.7;
constexpr double kDisturbance = 1e-4;
constexpr std::size_t kRootSweeps = 1500;
/// In the table of keys; others are a multiplier's number plus one.
constexpr std::uint32_t kNoEntry = 0;

/// Pseudo-random unit vectors, the same every time.
void set_vectors(double* vectors, std::size_t count) noexcept {
  std::uint32_t state = 12345;
  for (std::size_t i = 0; i < count; ++i) {
    double square = 0.0;
    for (std::size_t r = 0; r < kRank; ++r) {
      state = state * 1664525u + 1013904223u;
      const double value = static_cast<double>(state >> 8) / 16777216.0 - 0.5;
      vectors[i * kRank + r] = value;
      square += value * value;
    }
    for (std::size_t r = 0; r < kRank; ++r) {
      vectors[i * kRank + r] /= sqrt(square);
    }
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
  return static_cast<std::uint32_t>((((i * 641 + j) * 641 + k) * 4 + kind) * 2654435761u);
}

}  // namespace

Status EnergyCertificate::take_workspace(const CertificateWorkspace& workspace,
                                         std::size_t intervals) noexcept {
  const std::size_t cells = grid_.cells;
  const std::size_t leaves = workspace.signs.size() / cells;
  const std::size_t hash = workspace.hash.size();
  max_leaves_ = leaves < kMaxLeaves ? leaves : kMaxLeaves;
  const bool is_enough =
      max_leaves_ > 0 && workspace.duals.size() >= max_leaves_ * cells &&
      workspace.nodes.size() >= 2 && hash >= 2 * workspace.multipliers.size() && hash > 0 &&
      workspace.numbers.size() >= certificate_numbers(cells, intervals, max_leaves_);
  if (!is_enough || (hash & (hash - 1)) != 0) {
    return Status::kBufferTooSmall;
  }
  memory_ = workspace;
  return Status::kOk;
}

Status EnergyCertificate::start(const ModalModel& model, double duration_s, std::size_t cells,
                                const CertificateWorkspace& workspace) noexcept {
  *this = {};
  Status status = lay_out_cells(model, duration_s, cells, grid_);
  if (status != Status::kOk) {
    return status;
  }
  status = take_workspace(workspace, mesh_intervals(model, duration_s));
  if (status != Status::kOk) {
    return status;
  }
  model_ = &model;
  return kernel_.start(model, duration_s, workspace.numbers);
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
  begin();
  return Status::kOk;
}

void EnergyCertificate::prepare() noexcept {
  if (!kernel_.done()) {
    kernel_.step();
    return;
  }
  fill_costs(*model_, kernel_, kCostMargin, grid_);
  // The mesh of the kernel is no longer needed; its place is taken.
  lay_out_memory();
  const std::size_t cells = grid_.cells;
  fill_certificate_phi(*model_, grid_, Span<double>(phi_, cells * cells),
                       Span<double>(columns_, 4 * kMaxModes * cells));
  rounding_constant_ = grid_.constant;
  for (std::size_t edge = 1; edge < cells; ++edge) {
    const double cost = grid_.switch_cost[edge];
    phi_[(edge - 1) * cells + edge] -= 0.25 * cost;
    phi_[edge * cells + edge - 1] -= 0.25 * cost;
    rounding_constant_ += 0.5 * cost;
  }
  begin();
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
  merged_ = take(cells * cells);
  vectors_ = take(2 * kRank * cells);
  dual_ = take(cells);
  columns_ = take(4 * kMaxModes * cells);
  leaf_vectors_ = take(max_leaves_ * kRank * cells);
}

// With phi_ filled: the scale, from a first relaxation, and the multipliers of runs.
void EnergyCertificate::begin() noexcept {
  const std::size_t cells = grid_.cells;
  set_vectors(vectors_, cells);
  double value = 0.0;
  for (int i = 0; i < 20; ++i) {
    value = sweep(phi_, cells, vectors_);
  }
  for (std::size_t i = 0; i < cells; ++i) {
    value += abs(phi_[i * cells + i]);
  }
  scale_ = power_of_two_above(value);
  unit_ = scale_ / kUnitsPerOne;
  mean_diagonal_ = value / scale_ / static_cast<double>(cells);
  for (std::size_t i = 0; i < cells * cells; ++i) {
    phi_[i] /= scale_;
    matrix_[i] = phi_[i];
  }
  add_run_multipliers();
  ready_ = true;
}

void EnergyCertificate::add_run_multipliers() noexcept {
  for (std::uint32_t& entry : memory_.hash) {
    entry = kNoEntry;
  }
  for (std::size_t i = 0; i + 2 < grid_.cells; ++i) {
    for (std::size_t k = i + 2; k < grid_.cells && grid_.no_run_between(i, i + 1, k); ++k) {
      (void)add_multiplier(i, i + 1, k, 3, true);
      if (k > i + 2 && grid_.no_run_between(i, k - 1, k)) {
        (void)add_multiplier(i, k - 1, k, 3, true);
      }
    }
  }
}

bool EnergyCertificate::add_multiplier(std::size_t i, std::size_t j, std::size_t k,
                                       std::size_t kind, bool is_free) noexcept {
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
  added.is_free = is_free;
  memory_.hash[slot] = static_cast<std::uint32_t>(multiplier_count_);
  return true;
}

// Those that have come back to zero; the table of keys is made anew.
void EnergyCertificate::forget_unused_multipliers() noexcept {
  const std::size_t count = multiplier_count_;
  for (std::uint32_t& entry : memory_.hash) {
    entry = kNoEntry;
  }
  multiplier_count_ = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const TriangleMultiplier kept = memory_.multipliers[n];
    const bool is_idle = !kept.is_free && !(kept.value > 0.0F) && kept.mean < 0.0F;
    if (!is_idle && add_multiplier(kept.i, kept.j, kept.k, kept.kind, kept.is_free)) {
      memory_.multipliers[multiplier_count_ - 1] = kept;
    }
  }
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

double EnergyCertificate::sweep(const double* matrix, std::size_t size, double* vectors) noexcept {
  double value = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double* const row = matrix + i * size;
    double g[kRank] = {};
    double even[kRank] = {};
    std::size_t j = 0;
    for (; j + 1 < size; j += 2) {
      const double a = row[j];
      const double b = row[j + 1];
      const double* const v = vectors + j * kRank;
      for (std::size_t r = 0; r < kRank; ++r) {
        even[r] += a * v[r];
        g[r] += b * v[kRank + r];
      }
    }
    for (; j < size; ++j) {
      for (std::size_t r = 0; r < kRank; ++r) {
        even[r] += row[j] * vectors[j * kRank + r];
      }
    }
    double* const own = vectors + i * kRank;
    double square = 0.0;
    for (std::size_t r = 0; r < kRank; ++r) {
      g[r] += even[r] - row[i] * own[r];
      square += g[r] * g[r];
    }
    const double length = sqrt(square);
    dual_[i] = length + row[i];
    value += length;
    if (length > 0.0) {
      for (std::size_t r = 0; r < kRank; ++r) {
        own[r] = g[r] / length;
      }
    }
  }
  return value;
}

void EnergyCertificate::improve(double progress) noexcept {
  const double left = progress < 1.0 ? 1.0 - progress : 0.0;
  const double falloff = exp(log(kLastStep / kFirstStep) * (1.0 - left));
  disturb(vectors_, grid_.cells, iteration_ % kRank, kDisturbance, random_);
  double value = sweep(matrix_, grid_.cells, vectors_);
  step_multipliers(kFirstStep * falloff * mean_diagonal_);
  ++iteration_;
  if (iteration_ % kIterationsPerSearch == 0 && progress < kSearchShare) {
    forget_unused_multipliers();
    add_violated();
  }
  for (std::size_t i = 0; i < grid_.cells; ++i) {
    value += matrix_[i * grid_.cells + i];
  }
  for (const TriangleMultiplier& multiplier : multipliers()) {
    value += static_cast<double>(multiplier.value);
  }
  estimate_ = value * scale_ + rounding_constant_;
}

// Adam, by A (V V') - 1; leaves V V' in scratch_, above the diagonal.
void EnergyCertificate::step_multipliers(double length) noexcept {
  const std::size_t cells = grid_.cells;
  double* const columns = vectors_ + kRank * cells;
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t r = 0; r < kRank; ++r) {
      columns[r * cells + i] = vectors_[i * kRank + r];
    }
  }
  for (std::size_t i = 0; i < cells; ++i) {
    double* const row = scratch_ + i * cells;
    const double* const own = vectors_ + i * kRank;
    for (std::size_t j = i + 1; j < cells; ++j) {
      double sum = 0.0;
      for (std::size_t r = 0; r < kRank; ++r) {
        sum += own[r] * columns[r * cells + j];
      }
      row[j] = sum;
    }
  }
  first_power_ *= kFirstDecay;
  second_power_ *= kSecondDecay;
  const double first_weight = length / (1.0 - first_power_);
  const double second_weight = 1.0 / (1.0 - second_power_);
  for (std::size_t n = 0; n < multiplier_count_; ++n) {
    TriangleMultiplier& own = memory_.multipliers[n];
    const std::int8_t* const signs = kTriangleSigns[own.kind];
    const double* const row = scratch_ + own.i * cells;
    const double slope = signs[0] * row[own.j] + signs[1] * scratch_[own.j * cells + own.k] +
                         signs[2] * row[own.k] - 1.0;
    const double mean = kFirstDecay * static_cast<double>(own.mean) + (1.0 - kFirstDecay) * slope;
    const double square =
        kSecondDecay * static_cast<double>(own.square) + (1.0 - kSecondDecay) * slope * slope;
    own.mean = static_cast<float>(mean);
    own.square = static_cast<float>(square);
    const double before = static_cast<double>(own.value);
    double after = before + first_weight * mean / (sqrt(square * second_weight) + 1e-3);
    after = own.is_free || after > 0.0 ? after : 0.0;
    own.value = static_cast<float>(after);
    if (own.value != static_cast<float>(before)) {
      apply(own, static_cast<double>(own.value) - before);
    }
  }
}

void EnergyCertificate::add_violated() noexcept {
  ViolatedTriangles violated;
  violated.search(scratch_, grid_.cells);
  for (const ViolatedTriangle& found : violated.found()) {
    (void)add_multiplier(found.i, found.j, found.k, found.kind, false);
  }
}

// To whole units, and the matrix anew from them.
void EnergyCertificate::fix_multipliers() noexcept {
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < cells * cells; ++i) {
    matrix_[i] = phi_[i];
  }
  constant_ = rounding_constant_ / scale_;
  for (std::size_t n = 0; n < multiplier_count_; ++n) {
    TriangleMultiplier& own = memory_.multipliers[n];
    const double units = static_cast<double>(own.value) * kUnitsPerOne;
    own.units = static_cast<std::int32_t>(floor(units + 0.5));
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

// Cholesky's factorisation in place, four rows at a time; scratch_ holds the upper triangle.
bool EnergyCertificate::is_semidefinite(const double* matrix, std::size_t size,
                                        Span<const std::int32_t> duals) noexcept {
  double* const factor = scratch_;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = i; j < size; ++j) {
      factor[i * size + j] = -matrix[i * size + j];
    }
    factor[i * size + i] += static_cast<double>(duals[i]) / kUnitsPerOne - kFactorMargin;
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

// Sweeps until they rest, then the least multiple of the lengths that is proven.
bool EnergyCertificate::find_duals(const double* matrix, std::size_t size, double* vectors,
                                   std::size_t sweeps, Span<std::int32_t> duals,
                                   double& bound) noexcept {
  for (std::size_t axis = 0; axis < kRank; ++axis) {
    disturb(vectors, size, axis, kDisturbance, random_);
  }
  double value = sweep(matrix, size, vectors);
  for (std::size_t i = 1; i < sweeps; ++i) {
    const double next = sweep(matrix, size, vectors);
    if (i % 16 == 0 && next - value < 1e-9 * next) {
      break;
    }
    value = next;
  }
  const auto set = [&](double factor) {
    for (std::size_t i = 0; i < size; ++i) {
      const double units = dual_[i] * factor * kUnitsPerOne + 1.0;
      duals[i] = units < 2147483647.0 ? static_cast<std::int32_t>(units)
                                      : std::numeric_limits<std::int32_t>::max();
    }
    return is_semidefinite(matrix, size, duals.first(size));
  };
  double low = 0.0;
  double high = 1e-7;
  while (!set(1.0 + high)) {
    low = high;
    high *= 4.0;
    if (high > 8.0) {
      return false;
    }
  }
  for (int i = 0; i < 4 && low > 0.0; ++i) {
    const double middle = 0.5 * (low + high);
    (set(1.0 + middle) ? high : low) = middle;
  }
  if (!set(1.0 + high)) {
    return false;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    sum += static_cast<double>(duals[i]);
  }
  bound = sum / kUnitsPerOne;
  return true;
}

bool EnergyCertificate::prove() noexcept {
  fix_multipliers();
  const std::size_t cells = grid_.cells;
  for (std::size_t i = 0; i < kRank * cells; ++i) {
    leaf_vectors_[i] = vectors_[i];
  }
  for (std::size_t i = 0; i < cells; ++i) {
    memory_.signs[i] = 0;
  }
  memory_.signs[0] = 1;  // A pattern and its opposite have the same value.
  memory_.nodes[0] = {};
  node_count_ = 1;
  leaf_count_ = 1;
  leaves_[0].size = static_cast<std::uint16_t>(cells);
  proven_ = find_duals(matrix_, cells, vectors_of(0), kRootSweeps, memory_.duals.first(cells),
                       leaves_[0].bound);
  return proven_;
}

double EnergyCertificate::bound() const noexcept {
  double largest = 0.0;
  for (std::size_t leaf = 0; leaf < leaf_count_; ++leaf) {
    largest = leaves_[leaf].bound > largest ? leaves_[leaf].bound : largest;
  }
  return (largest + constant_) * scale_ * (1.0 + 1e-12);
}

}  // namespace emax
