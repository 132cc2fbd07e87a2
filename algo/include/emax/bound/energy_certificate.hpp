// An upper bound of the energy that is tight to some 1e-4, with numbers that prove it; for a PC.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/bound/certificate_grid.hpp"
#include "emax/bound/kernel_bounds.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The signs of X_ij, X_jk and X_ik in the four inequalities s . X <= 1 that the products
/// X_ij = v_i v_j of numbers within +-1 obey: each is linear in every v, and true at the signs.
inline constexpr std::int8_t kTriangleSigns[4][3] = {
    {-1, -1, -1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};

/// A multiplier of s . X <= 1 for cells i < j < k.
struct TriangleMultiplier {
  std::uint16_t i = 0;
  std::uint16_t j = 0;
  std::uint16_t k = 0;
  std::uint8_t kind = 0;
  std::int32_t units = 0;  ///< What counts, in units of `EnergyCertificate::unit()`; not negative.
  double value = 0.0;      ///< What the search has come to.
  float mean = 0.0F;       ///< Of its gradient, and below of the squares.
  float square = 0.0F;
};

/// An inequality of the cells i < j < k, of one of the four kinds in `kTriangleSigns`.
struct ViolatedTriangle {
  double violation = 0.0;  ///< By how much the sum of the three signed products is above 1.
  std::uint16_t i = 0;
  std::uint16_t j = 0;
  std::uint16_t k = 0;
  std::uint8_t kind = 0;
};

/// What a certificate works in; the caller's.
struct CertificateWorkspace {
  Span<double> numbers;  ///< At least `certificate_numbers()`.
  Span<TriangleMultiplier> multipliers;
  Span<std::uint32_t> hash;         ///< A power of two, at least twice as many as multipliers.
  Span<ViolatedTriangle> violated;  ///< As many as may come in at once; not empty.
  Span<std::int32_t> duals;         ///< One for each cell.
};

/// Dimensions of the vectors of the relaxation.
inline constexpr std::size_t kCertificateRank = 8;

/// The number of doubles for so many cells and mesh intervals.
constexpr std::size_t certificate_numbers(std::size_t cells, std::size_t intervals) noexcept {
  const std::size_t relaxation =
      3 * cells * cells + 26 * (kCertificateRank + 1) * cells + 4 * kMaxModes * cells;
  const std::size_t mesh = kernel_bounds_numbers(intervals);
  return relaxation > mesh ? relaxation : mesh;
}

/// E(x) <= `bound()` for every signal |x| <= 1 on [0, T].
///
/// By `CertificateGrid`, E(x) <= v' Q v + sum of costs with Q = Phi - Diag(costs) and numbers v
/// within
/// +-1. Multipliers mu >= 0 of inequalities that their products obey, s . X <= 1, turn it into
/// v' Q' v + sum mu + sum of costs, and v' Q' v <= sum y for every y >= 0 with Diag(y) - Q'
/// positive semidefinite, which a Cholesky factorisation shows. How multipliers and y were found
/// does not matter for the proof.
///
///     certificate.start(model, duration_s, cells, switches_s, workspace);
///     while (!certificate.ready()) certificate.prepare();
///     while (there is time) certificate.relax();
///     while (there is time) certificate.polish(progress);
///     certificate.prove();
///
/// Several models may share grid, costs and multipliers: the corners of a box of devices. Costs are
/// then the largest of all, multipliers are found for the first one, and each has a y of its own,
/// by `prove(model)`.
///
/// The multipliers come from an augmented Lagrangian of the relaxation X = V V' with vectors of
/// length 1 or less (Burer and Monteiro), minimised over V by L-BFGS; each round takes in the most
/// violated inequalities. Gradient steps on the multipliers (Adam), between sweeps of the mixing
/// method over V, polish the bound itself. All sums have a fixed order: the same calls give the
/// same bits everywhere. 25 KiB beside the workspace.
class EnergyCertificate {
 public:
  /// @param[in] cells About how many cells to lay out; `coarsest_certificate()` or more.
  /// @param[in] switches_s Those of a good signal, ascending; cells are narrower about them.
  /// Model and workspace must stay until the certificate is no longer needed.
  ///
  /// @returns kOk, or as `KernelBounds::start()` and `lay_out_cells()`; kBufferTooSmall if part of
  /// the workspace is.
  Status start(const ModalModel& model, double duration_s, std::size_t cells,
               Span<const double> switches_s, const CertificateWorkspace& workspace) noexcept;

  /// The same for several models, at least one. @returns As above, for whichever fails.
  Status start(Span<const ModalModel> models, double duration_s, std::size_t cells,
               Span<const double> switches_s, const CertificateWorkspace& workspace) noexcept;

  /// For the largest v' M v of numbers within +-1 instead: no grid, no costs, and ready at once.
  ///
  /// @param[in] matrix M, symmetric, row by row; copied.
  /// @param[in] cells  2 to kMaxCertificateCells.
  Status start(Span<const double> matrix, std::size_t cells,
               const CertificateWorkspace& workspace) noexcept;

  /// Works on the bounds of the kernel, and then on the matrix.
  void prepare() noexcept;
  bool ready() const noexcept { return ready_; }
  double preparation() const noexcept {
    return (static_cast<double>(prepared_) + kernel_.progress()) /
           static_cast<double>(models_.size() + 1);
  }

  /// One round of the augmented Lagrangian: up to 40 times cells^2 times some 20 ns, and a look at
  /// all triangles.
  void relax() noexcept;

  /// @returns After `relax()`, whether all is small: what inequalities are still violated by, and
  /// what the round has changed. More rounds are then of little use.
  bool at_rest() const noexcept { return at_rest_; }

  /// One gradient step on the multipliers, with a sweep. cells^2 times some 10 ns.
  ///
  /// @param[in] progress From 0 to 1: how much of the time for it is over. The steps shorten with
  ///   it, and the bound is only good at the end.
  void polish(double progress) noexcept;

  /// What the relaxation comes to with these multipliers; an estimate, not a bound.
  double estimate() const noexcept { return estimate_; }

  /// Fixes the multipliers, finds y, and so a bound, for the first model.
  ///
  /// @returns False if no factorisation came out, which leaves no bound.
  bool prove() noexcept;

  /// The same for another model; after `prove()`, with the multipliers fixed there. `bound()` and
  /// `duals()` are then those of this model.
  bool prove(std::size_t model) noexcept;

  /// The bound, for a = 1; after `prove()`.
  double bound() const noexcept { return bound_; }

  const CertificateGrid& grid() const noexcept { return grid_; }
  /// What multipliers and y are counted in: a power of two, for a = 1.
  double unit() const noexcept { return unit_; }
  /// Those that are not zero count.
  Span<const TriangleMultiplier> multipliers() const noexcept {
    return Span<const TriangleMultiplier>(memory_.multipliers.data(), multiplier_count_);
  }
  std::size_t used_multipliers() const noexcept;
  /// y of each cell in units.
  Span<const std::int32_t> duals() const noexcept {
    return Span<const std::int32_t>(memory_.duals.data(), grid_.cells);
  }

 private:
  static constexpr std::size_t kHistory = 8;

  // The last steps of L-BFGS and the changes of the gradient along them.
  struct History {
    double* steps[kHistory] = {};
    double* changes[kHistory] = {};
    double curvatures[kHistory] = {};
    std::size_t count = 0;
    std::size_t newest = 0;
  };

  Status take_workspace(const CertificateWorkspace& workspace, std::size_t intervals) noexcept;
  void lay_out_memory() noexcept;
  void begin() noexcept;
  void fill_phi(const ModalModel& model, double scale) noexcept;
  bool find_bound() noexcept;
  bool add_multiplier(std::size_t i, std::size_t j, std::size_t k, std::size_t kind) noexcept;
  void forget_unused_multipliers() noexcept;
  void apply(const TriangleMultiplier& multiplier, double amount) noexcept;
  double slope(const TriangleMultiplier& multiplier) const noexcept;

  // certificate_relaxation.cpp
  std::size_t unknowns() const noexcept { return (kCertificateRank + 1) * grid_.cells; }
  void set_matrix() noexcept;
  double lagrangian(const double* point, double* gradient) noexcept;
  void find_direction(const double* gradient, double* direction) noexcept;
  double minimise(double value) noexcept;
  void disturb_point() noexcept;
  void normalise_point() noexcept;
  void take_vectors(const double* point) noexcept;
  void fill_products() noexcept;
  double update_multipliers() noexcept;
  double add_violated() noexcept;

  // energy_certificate.cpp
  /// A row of the matrix times the vectors.
  void multiply_row(std::size_t i, double (&g)[kCertificateRank]) const noexcept;
  double sweep() noexcept;
  void step_multipliers(double length) noexcept;
  void fix_multipliers() noexcept;
  void settle() noexcept;
  bool set_duals(double raise) noexcept;
  bool is_semidefinite() noexcept;

  Span<const ModalModel> models_;
  std::size_t prepared_ = 0;  // Models whose costs are known.
  CertificateWorkspace memory_ = {};
  KernelBounds kernel_ = {};
  CertificateGrid grid_ = {};
  History history_ = {};
  double* phi_ = nullptr;      // Q, scaled.
  double* matrix_ = nullptr;   // Q', scaled.
  double* scratch_ = nullptr;  // Products of vectors, or a factorisation.
  double* vectors_ = nullptr;  // Row by row.
  double* columns_ = nullptr;
  double* point_ = nullptr;  // Vectors not yet of length 1, and one more component for each.
  double* trial_ = nullptr;
  double* gradient_ = nullptr;
  double* next_gradient_ = nullptr;
  double* direction_ = nullptr;
  double* dual_ = nullptr;
  double* margins_ = nullptr;  // Left on each diagonal element for rounding.
  double* spare_ = nullptr;
  double unit_ = 0.0;
  double scale_ = 0.0;  // Energy of 1 in the scaled matrix.
  double constant_ = 0.0;
  double costs_ = 0.0;  // Scaled.
  double mean_diagonal_ = 0.0;
  double penalty_ = 0.0;
  double estimate_ = 0.0;
  double bound_ = 0.0;
  std::size_t multiplier_count_ = 0;
  std::uint32_t random_ = 1;  // State of the disturbances of vectors.
  double first_power_ = 1.0;
  double second_power_ = 1.0;
  std::uint32_t iteration_ = 0;
  bool at_rest_ = false;
  bool is_polishing_ = false;
  bool ready_ = false;
};

static_assert(std::is_trivially_copyable_v<EnergyCertificate>);

}  // namespace emax
