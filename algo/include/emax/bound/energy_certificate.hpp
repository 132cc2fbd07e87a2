// A proven upper bound of the energy of every signal within the limit, and the numbers that prove
// it.
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
/// X_ij = v_i v_j of three signs obey.
inline constexpr std::int8_t kTriangleSigns[4][3] = {
    {-1, -1, -1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};

/// A multiplier of s . X <= 1 for cells i < j < k; of any sign if it is of kind 3 and no run fits
/// between (`CertificateGrid::no_run_between()`), else not negative.
struct TriangleMultiplier {
  std::uint16_t i = 0;
  std::uint16_t j = 0;
  std::uint16_t k = 0;
  std::uint8_t kind = 0;
  bool is_free = false;    ///< Of any sign.
  std::int32_t units = 0;  ///< What counts, in units of `EnergyCertificate::unit()`.
  float value = 0.0F;      ///< What the search has come to.
  float mean = 0.0F;       ///< Of its gradient, and below of the squares.
  float square = 0.0F;
};

/// A node of the tree of cases: fixing one cell splits a case into two.
struct CertificateNode {
  enum class Kind : std::uint8_t {
    kLeaf,   ///< Has a y.
    kSplit,  ///< By the sign of `cell`.
    kEmpty,  ///< No pattern without too short runs.
  };
  Kind kind = Kind::kLeaf;
  std::uint16_t cell = 0;
  std::uint32_t children[2] = {};  ///< Nodes for +1 and -1.
  std::uint32_t leaf = 0;
};

/// What a certificate works in; the caller's.
struct CertificateWorkspace {
  Span<double> numbers;  ///< At least `certificate_numbers()`.
  Span<TriangleMultiplier> multipliers;
  Span<std::uint32_t> hash;  ///< A power of two, at least twice as many as multipliers.
  Span<CertificateNode> nodes;
  Span<std::int8_t> signs;   ///< Leaves times cells.
  Span<std::int32_t> duals;  ///< Leaves times cells.
};

inline constexpr std::size_t kCertificateRank = 8;

/// The number of doubles for so many cells, mesh intervals and leaves.
constexpr std::size_t certificate_numbers(std::size_t cells, std::size_t intervals,
                                          std::size_t leaves) noexcept {
  const std::size_t matrices = 4 * cells * cells + (2 * kCertificateRank + 1) * cells +
                               4 * kMaxModes * cells + leaves * (kCertificateRank * cells + 1);
  const std::size_t mesh = kernel_bounds_numbers(intervals);
  return matrices > mesh ? matrices : mesh;
}

/// E(x) <= `bound()` for every signal |x| <= 1 on [0, T].
///
/// By `CertificateGrid`, E(x) <= F(v), a quadratic form of a sign pattern v. Multipliers mu of
/// inequalities that all sign patterns obey, s . X <= 1, turn it into
/// F(v) <= v' Q' v + sum mu + constant, and v' Q' v <= sum y for every y with Diag(y) - Q' positive
/// semidefinite, which a Cholesky factorisation shows. Cases by the signs of some cells sharpen
/// that: in each, the fixed cells are merged into one and have a y of their own. How multipliers
/// and y were found does not matter for the proof.
///
///     certificate.start(model, duration_s, cells, workspace);
///     while (!certificate.ready()) certificate.prepare();
///     while (there is time) certificate.improve(progress);
///     certificate.prove();
///     while (there is time) certificate.branch();
///
/// Multipliers are found by the mixing method, unit vectors v_i <- normalised sum_j Q'_ij v_j,
/// alternating with gradient steps (Adam) on mu; the most violated inequalities come in every 40
/// iterations. The bits are not the same on every target: compilers may vectorise here, and the
/// proof does not depend on them. 46 KiB beside the workspace.
class EnergyCertificate {
 public:
  /// @param[in] cells About how many cells to lay out; `coarsest_certificate()` or more.
  /// Model and workspace must stay until the certificate is no longer needed.
  ///
  /// @returns kOk, or as `KernelBounds::start()` and `lay_out_cells()`; kBufferTooSmall if part of
  /// the workspace is.
  Status start(const ModalModel& model, double duration_s, std::size_t cells,
               const CertificateWorkspace& workspace) noexcept;

  /// For the largest v' M v of a sign pattern v instead: no grid, no rounding, and ready at once.
  ///
  /// @param[in] matrix M, symmetric, row by row; copied.
  /// @param[in] cells  2 to kMaxCertificateCells.
  Status start(Span<const double> matrix, std::size_t cells,
               const CertificateWorkspace& workspace) noexcept;

  /// Works on the bounds of the kernel, and then on the matrix.
  void prepare() noexcept;
  bool ready() const noexcept { return ready_; }
  double preparation() const noexcept { return kernel_.progress(); }

  /// One iteration on the multipliers. cells^2 times a few ns, and 40 times that every 40th time.
  ///
  /// @param[in] progress From 0 to 1: how much of the time for it is over. The steps shorten with
  ///   it, and the bound is only good at the end.
  void improve(double progress) noexcept;

  /// What the relaxation comes to with these multipliers; an estimate, not a bound.
  double estimate() const noexcept { return estimate_; }

  /// Fixes the multipliers, finds y for all patterns together, and so a bound.
  ///
  /// @returns False if no factorisation came out, which leaves no bound.
  bool prove() noexcept;
  bool proven() const noexcept { return proven_; }

  /// Splits the case with the largest bound in two.
  ///
  /// @returns False if that is not possible: the memory is full, or the case is a single pattern.
  bool branch() noexcept;

  /// The bound, for a = 1; after `prove()`.
  double bound() const noexcept;

  const CertificateGrid& grid() const noexcept { return grid_; }
  /// What multipliers and y are counted in: a power of two, for a = 1.
  double unit() const noexcept { return unit_; }
  /// Those that are not zero count.
  Span<const TriangleMultiplier> multipliers() const noexcept {
    return Span<const TriangleMultiplier>(memory_.multipliers.data(), multiplier_count_);
  }
  std::size_t used_multipliers() const noexcept;
  /// The tree; its root is the first.
  Span<const CertificateNode> nodes() const noexcept {
    return Span<const CertificateNode>(memory_.nodes.data(), node_count_);
  }
  /// y of a leaf in units: of all fixed cells as one first, if there are any, then of each other
  /// cell.
  Span<const std::int32_t> duals(std::size_t leaf) const noexcept {
    return Span<const std::int32_t>(memory_.duals.data() + leaf * grid_.cells, leaves_[leaf].size);
  }

  static constexpr std::size_t kMaxLeaves = 2048;

 private:
  struct Leaf {
    std::uint16_t size = 0;
    double bound = 0.0;  // Of v' Q' v, scaled.
  };

  Status take_workspace(const CertificateWorkspace& workspace, std::size_t intervals) noexcept;
  void lay_out_memory() noexcept;
  void begin() noexcept;
  void add_run_multipliers() noexcept;
  bool add_multiplier(std::size_t i, std::size_t j, std::size_t k, std::size_t kind,
                      bool is_free) noexcept;
  void forget_unused_multipliers() noexcept;
  void apply(const TriangleMultiplier& multiplier, double amount) noexcept;
  void step_multipliers(double length) noexcept;
  void add_violated() noexcept;
  void fix_multipliers() noexcept;
  double sweep(const double* matrix, std::size_t size, double* vectors) noexcept;
  bool find_duals(const double* matrix, std::size_t size, double* vectors, std::size_t sweeps,
                  Span<std::int32_t> duals, double& bound) noexcept;
  bool is_semidefinite(const double* matrix, std::size_t size,
                       Span<const std::int32_t> duals) noexcept;
  bool propagate(std::int8_t* signs) const noexcept;
  std::size_t merge(const std::int8_t* signs) noexcept;
  bool solve_leaf(std::size_t leaf, const std::int8_t* parent_signs,
                  const double* parent_vectors) noexcept;
  void keep_children(std::size_t parent, std::size_t cell, CertificateNode* children) noexcept;
  void take_over_duals(std::size_t parent, std::size_t leaf) noexcept;
  void move_leaf(std::size_t from, std::size_t to) noexcept;
  std::size_t undecided_cell(std::size_t leaf) const noexcept;
  double* vectors_of(std::size_t leaf) noexcept;
  const double* vectors_of(std::size_t leaf) const noexcept;
  std::int8_t* signs_of(std::size_t leaf) const noexcept {
    return memory_.signs.data() + leaf * grid_.cells;
  }

  const ModalModel* model_ = nullptr;
  CertificateWorkspace memory_ = {};
  KernelBounds kernel_ = {};
  CertificateGrid grid_ = {};
  Leaf leaves_[kMaxLeaves] = {};
  double* phi_ = nullptr;      // The matrix of F, scaled.
  double* matrix_ = nullptr;   // Q', scaled.
  double* scratch_ = nullptr;  // Products of vectors, or a factorisation.
  double* merged_ = nullptr;   // Q' of a case.
  double* vectors_ = nullptr;
  double* dual_ = nullptr;
  double* columns_ = nullptr;
  double* leaf_vectors_ = nullptr;
  double unit_ = 0.0;
  double scale_ = 0.0;     // Energy of 1 in the scaled matrix.
  double constant_ = 0.0;  // Scaled, with the sum of multipliers.
  double rounding_constant_ = 0.0;
  double mean_diagonal_ = 0.0;
  double estimate_ = 0.0;
  std::size_t max_leaves_ = 0;
  std::size_t multiplier_count_ = 0;
  std::size_t node_count_ = 0;
  std::size_t leaf_count_ = 0;
  std::uint32_t iteration_ = 0;
  std::uint32_t random_ = 1;  // State of the disturbances of vectors.
  double first_power_ = 1.0;
  double second_power_ = 1.0;
  bool ready_ = false;
  bool proven_ = false;
};

static_assert(std::is_trivially_copyable_v<EnergyCertificate>);

}  // namespace emax
