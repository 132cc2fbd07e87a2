// Weighted least squares for sensitivity, natural frequency and damping from measured points, with
// covariances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax {

/// Three parameters in the order S in V/(m/s^2), f0 in Hz, beta; everywhere below, rows and columns
/// go in this order.
inline constexpr std::size_t kWlspParameters = 3;

struct WlspFit {
  Status status = Status::kOk;  ///< What `Wlsp::fit()` answered.
  std::uint32_t dof = 0;        ///< Equations (2 a point, 1 without a phase) minus 3.
  Accelerometer model;          ///< The estimates.
  double u_sensitivity =
      0.0;  ///< Standard uncertainties: the roots of the diagonal of `covariance`.
  double u_natural_frequency_hz = 0.0;
  double u_damping = 0.0;
  double covariance[kWlspParameters][kWlspParameters] = {};
  double mu[3] = {};    ///< 1/S, beta/(S w0), 1/(S w0^2), in units of m/s^2, V and s.
  double u_mu[3] = {};  ///< Their standard uncertainties.
  /// Chi-square with the whole covariance that the points state: the least for any parameters and
  /// any sizes of leak, linearity and skew. Without those it is that of `mu`; with them `mu`, which
  /// is fitted without their covariance, has more.
  double chi2 = 0.0;
  double common_effect = 0.0;  ///< The common effect found, in units of its standard uncertainty.
  double birge_ratio = 0.0;    ///< sqrt(chi2/dof): 1 where the model and the uncertainties hold.
  std::uint32_t unknown_phases = 0;  ///< Points of which only the magnitude was fitted.
  /// Magnitudes alone do not determine the damping: it was held, and u(beta) is zero.
  bool is_damping_held = false;
  bool is_damping_given = false;  ///< By `give_damping()`; else it is the nearest one permitted.
  double damping2 = 0.0;          ///< beta^2 by magnitudes alone, where no phase is known; else 0.
  double u_damping2 = 0.0;        ///< Its standard uncertainty.
};

/// Fits 1/K(jw) = mu1 + 2jw mu2 - w^2 mu3 to the points (Link, Taubner, Wabinski, Bruns, Elster,
/// Measurement 40 (2007) 928; the paper's Table 2): S = 1/mu1, w0 = sqrt(mu1/mu3), beta =
/// mu2/sqrt(mu1 mu3).
///
/// Each point's two equations are whitened by the Cholesky factor of its 2x2 covariance; w is
/// scaled by its maximum; the system is reduced by Givens rotations, one row at a time, in fixed
/// memory. The covariance of the estimates is that of the stated uncertainties (it is not
/// multiplied by the Birge ratio), carried from mu by its Jacobian.
///
/// Where the response has a common part, its covariance is C + c c^T over all points together, with
/// c_i = -u_i y_i. The fit takes it as one more unknown z, y = M mu + c z, that has an observation
/// of its own, z = 0 with uncertainty 1: one more column and one more row in the rotations. Solving
/// for mu and z is the same as weighting with (C + c c^T)^-1 by Woodbury's formula, and needs no
/// matrix over the points. z comes first, so what is below it in the triangle belongs to mu alone.
/// y_i is 1/K as modelled by a first fit without the common part, not as measured: a c from
/// scattered values pulls the estimates to one side (Peelle's puzzle). With the same u everywhere c
/// is among the columns of M: estimates and chi-square stay what they were, u(S)^2 grows by (u
/// S)^2, and nothing else changes.
///
/// A point whose phase is unknown (`is_phase_known()`) has one equation, that of its magnitude: its
/// phase is taken from the model, and the fit is repeated until that no longer changes, which is
/// least squares on 1/|K| by Gauss and Newton. `response()` then holds these phases. Where no phase
/// is known, `fit_magnitudes()` says what to begin with and whether the damping is determined; if
/// not, it is held at the value given or at the nearest one that a device may have, by an equation
/// of its own with great weight.
///
/// The object keeps a copy of the points it has fitted and their factors: 4.8 KiB. A fit takes
/// about 300 multiplications per point, twice that and a half with a common part.
class Wlsp {
 public:
  /// Fits with the points' covariances by formula (`inverse_cholesky()`).
  ///
  /// @returns The same as `result().status`:
  /// * kOk
  /// * kTooFewPoints: Fewer than 3 points.
  /// * kNotIdentifiable: The equations are dependent to within rounding (frequencies that hardly
  /// differ), or numbers so
  ///   large or small that the fit overflows.
  /// * kNotPhysical: mu1 and mu3 differ in sign or one is zero, or the damping is zero or less.
  /// * kInvertedPolarity: mu1 and mu3 are both negative and the damping is above zero: -K fits. The
  /// sensitivity in the
  ///   result is negative.
  /// * kOverdamped: The damping is 1 or more.
  ///
  /// The result of an earlier fit is replaced in every case. kInvertedPolarity, kOverdamped and a
  /// kNotPhysical with mu1 and mu3 of the same sign leave all numbers filled in, other kNotPhysical
  /// `mu`, `chi2`, `dof` and `birge_ratio`; the rest leave zeros.
  Status fit(const FrequencyResponse& response) noexcept;

  /// Fits with the given covariances of 1/K, one per point, for instance from
  /// `inverse_covariance_by_draws()`.
  ///
  /// @returns As above, and kInvalidArgument if there are not as many covariances as points or one
  /// is not positive definite.
  Status fit(const FrequencyResponse& response, Span<const ComplexCovariance> covariances) noexcept;

  /// The damping to hold where the points do not determine it: where no phase is known, and where
  /// it is among those that `judge()` says are left open.
  ///
  /// @param[in] damping kMinDamping to below 1; everything else is as if none was given. Stays
  ///                    until the next call. `is_damping_given` tells whether it was held.
  void give_damping(double damping) noexcept { given_damping_ = damping; }

  /// @returns That of the last fit; all zero before the first.
  const WlspFit& result() const noexcept { return fit_; }
  /// @returns The points of the last fit; none if there were too few.
  const FrequencyResponse& response() const noexcept { return response_; }

  /// @param[in] index Of a point, below `response().size()`.
  /// @returns 1/K measured minus 1/K fitted at that point, whitened: L^-1 times the residual, so
  /// that both parts are near 1 in size where the stated uncertainties hold. The common effect
  /// found is taken out first, and so is what leak, linearity and skew explain: those of the sizes
  /// that make chi2 least. The sum of their squares over all points, plus the squares of
  /// `common_effect` and of those sizes, is chi2.
  Complex normalised_residual(std::size_t index) const noexcept;

  /// What of the shared effects the points' own uncertainties leave out: clock, leak and linearity.
  ///
  /// @param[in] index As above, after a fit that has filled in its numbers.
  /// @returns Standard uncertainties by them at that point: of the amplitude, relative (re), and of
  /// the phase in rad (im).
  Complex shared_beside(std::size_t index) const noexcept;

  /// @returns The chi-square of any other model in the same measure: against the same points, with
  /// the same factors and the same common part.
  double chi_square_of(const Accelerometer& model) const noexcept;

 private:
  friend class WlspDraws;

  struct Columns {
    Complex column[3];
  };

  Status load(const FrequencyResponse& response) noexcept;
  Status solve() noexcept;
  Status solve_without_phases() noexcept;
  bool may_hold_given() const noexcept;
  Status hold_given() noexcept;
  Status begin_without_phases(double (&scaled)[3]) noexcept;
  Status iterate_phases(double (&scaled)[3]) noexcept;
  void take_phases_from(const double (&scaled)[3]) noexcept;
  void aim_hold(const double (&scaled)[3]) noexcept;
  void finish_without_phases() noexcept;
  Status factor_points() noexcept;
  Status sensitivity_alone(double a0, double u_a0) noexcept;
  void set_mu_uncertainties() noexcept;
  Status reject(Status status) noexcept;
  bool triangularise(double (&rhs)[3]) noexcept;
  bool triangularise_with_common(double (&rhs)[3]) noexcept;
  Complex whitened_common(std::size_t index) const noexcept;
  Complex without_common(std::size_t index, const Complex& value, double effect) const noexcept;
  /// 1/K of these scaled mu.
  Complex inverse_at(std::size_t index, const double (&scaled)[3]) const noexcept;
  double common_effect_of(const double (&scaled)[3]) const noexcept;
  bool fill_estimates() noexcept;
  enum class Effect : std::uint8_t { kSkew, kDrift, kImages, kLeak, kLeakBack, kLinearity };
  /// One step of the normal equations: A^T z, and c^T z and A^T c for the common vector c.
  struct NormalStep {
    double x[3] = {};
    double columns_common[3] = {};
    double common_z = 0.0;
  };
  void add_to(NormalStep& step, std::size_t index, const Complex& change) const noexcept;
  void solve_step(NormalStep& step) const noexcept;
  double place_of(std::size_t index) const noexcept;
  Complex change_of(Effect effect, std::size_t index) const noexcept;
  NormalStep step_of(Effect effect) const noexcept;
  void add_effect(Effect effect, double (&covariance)[3][3]) const noexcept;
  void add_shared(double (&covariance)[3][3]) const noexcept;
  Complex whiten(std::size_t index, const Complex& value) const noexcept;
  Columns whitened_columns(std::size_t index) const noexcept;
  Complex whitened_residual(std::size_t index, const double (&scaled)[3]) const noexcept;
  /// Of the shared effects, those that the points' own uncertainties leave out, first.
  static constexpr std::size_t kBeside = 3;
  /// Leak, leak back, linearity and skew in units of their uncertainties, and what parameters and
  /// common effect take up of them.
  static constexpr std::size_t kExplained = 4;
  struct Explained {
    double size[kExplained];
    double x[3];
    double common;
  };
  static constexpr Effect explained_by(std::size_t k) noexcept {
    return k < kBeside ? static_cast<Effect>(static_cast<std::size_t>(Effect::kLeak) + k)
                       : Effect::kSkew;
  }
  void explain_by_shared() noexcept;
  Complex left_over(const Explained& explained, std::size_t index) const noexcept;
  Complex explained_residual(std::size_t index, const double (&scaled)[3],
                             double common_effect) const noexcept;
  double chi_square_of_scaled(const double (&scaled)[3], double common_effect) const noexcept;

  FrequencyResponse response_;
  ComplexCholesky factors_[kMaxPoints] = {};
  double max_frequency_hz_ = 0.0;
  double r_[3][3] = {};    // Upper triangular factor of the whitened, scaled equations.
  double scaled_[3] = {};  // mu in units of the scaled frequency: mu1, mu2 w_max, mu3 w_max^2.
  double first_scaled_[3] = {};  // The same of the fit without the common part.
  Explained explained_ = {};
  double largest_amplitude_ = 0.0;
  double common_squares_ = 0.0;  // 1 + sum of the squares of the whitened common vector.
  double given_damping_ = 0.0;
  double damping2_ = 0.0;  // By magnitudes alone, with its uncertainty.
  double u_damping2_ = 0.0;
  double held_damping_ = 0.0;      // 0 while the damping is an unknown of the fit.
  double hold_[3] = {};            // The equation that holds it: hold_ times scaled mu is 0.
  bool is_damping_given_ = false;  // The one that is held.
  bool has_common_ = false;
  bool is_explained_ = false;  // By some leak, linearity or skew.
  WlspFit fit_;
};

static_assert(std::is_trivially_copyable_v<Wlsp>);

struct WlspDrawsResult {
  std::uint32_t draws = 0;      ///< Draws that went into the numbers below.
  std::uint32_t discarded = 0;  ///< Draws with an amplitude, mu1 or mu3 of zero or less: no device.
  double mean[kWlspParameters] = {};
  double covariance[kWlspParameters][kWlspParameters] = {};
};

/// What a draw moves the estimates by.
struct WlspDeviation {
  double parameters[kWlspParameters] = {};
  bool is_device = false;
};

/// The covariance of the estimates by Monte Carlo draws, in slices of any size, so that a console
/// is never blocked.
///
/// Each draw takes amplitude and phase of every point from normal distributions of their standard
/// uncertainties about the measured values and fits again with the weights kept (two uniform
/// numbers per point, in the order of the points; amplitude from the first normal number). Where
/// the response has a common part, two more numbers before those of the points make one normal
/// number that moves all amplitudes together. With the weights kept the fit is linear in 1/K: each
/// draw only costs a new right-hand side. The triangular factor of `Wlsp` is used as it is.
///
/// The estimates stay those of `Wlsp::fit()`. The mean of the draws is shown to be compared with
/// them, never to replace them: it carries the bias of the draws on top of the measurement's.
///
/// Effects that are shared in other ways are not drawn: what the formula of the fit gives for them
/// is added.
///
/// 224 bytes; keeps no reference to the fit. Sums are taken about the fit's estimates, so
/// nothing cancels.
class WlspDraws {
 public:
  /// Starts over.
  ///
  /// @param[in] fit       A fit that answered kOk, or kNotPhysical for a damping of zero or less.
  /// @param[in] draws     2 or more.
  /// @param[in] generator Seeded, and jumped ahead by the caller to where these draws belong.
  /// @returns
  /// * kOk: Ready for `step()`.
  /// * kInvalidArgument: Fewer than 2 draws. Nothing has changed.
  /// * Else the status of the fit, if that is not kOk. Nothing has changed.
  Status start(const Wlsp& fit, std::uint32_t draws, const WichmannHill& generator) noexcept;

  /// Makes the next `count` draws, or as many as are left.
  ///
  /// @param[in] fit The same fit that `start()` was given, unchanged.
  void step(const Wlsp& fit, std::uint32_t count) noexcept;

  /// Looks at draws that are still to be made: for another thread, which shares them.
  ///
  /// @param[in]  fit        As for `step()`.
  /// @param[in]  skipped    So many draws after the next one.
  /// @param[out] deviations Of as many draws as there is room for.
  void look_ahead(const Wlsp& fit, std::uint32_t skipped,
                  Span<WlspDeviation> deviations) const noexcept;
  /// Takes the next draws as `look_ahead()` has seen them; not more than `left()`.
  void take(const Wlsp& fit, Span<const WlspDeviation> deviations) noexcept;

  bool done() const noexcept { return made_ == wanted_; }
  std::uint32_t made() const noexcept { return made_; }
  std::uint32_t left() const noexcept { return wanted_ - made_; }

  /// @returns Mean and covariance of the draws made so far; the covariance divides by draws - 1 and
  /// is zero below 2.
  WlspDrawsResult result() const noexcept;

 private:
  WlspDeviation draw(const Wlsp& fit, WichmannHill& generator) const noexcept;
  void add(const WlspDeviation& deviation) noexcept;
  static std::uint64_t numbers_per_draw(const Wlsp& fit) noexcept;

  WichmannHill generator_;
  std::uint32_t wanted_ = 0;
  std::uint32_t made_ = 0;
  std::uint32_t discarded_ = 0;
  double estimate_[3] = {};
  double sum_[3] = {};
  double products_[3][3] = {};
  double shared_[3][3] = {};  // Covariance of the shared effects, which are not drawn.
};

static_assert(std::is_trivially_copyable_v<WlspDraws>);

}  // namespace emax
