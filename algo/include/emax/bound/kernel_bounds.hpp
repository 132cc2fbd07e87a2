// Proven upper bounds of how fast the gradient of the energy changes anywhere in [0, T].
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The number of points beyond which no mesh goes.
inline constexpr std::size_t kMaxMesh = std::size_t{1} << 15;

/// @returns The number of intervals of a mesh on [0, T] that resolves the model's fastest mode to
/// 1/16 of its time constant; kMaxMesh + 1 if that takes too many.
std::size_t mesh_intervals(const ModalModel& model, double duration_s) noexcept;

/// The number of doubles that `KernelBounds` needs for such a mesh.
constexpr std::size_t kernel_bounds_numbers(std::size_t intervals) noexcept {
  return (4 * kMaxModes + 3) * (intervals + 1);
}

/// Bounds of how fast the gradient of the energy changes, by the kernel phi(t, s) of paper equation
/// (5):
///
///     m_1(t) = integral from 0 to T of |d phi(t, s) / dt| ds.
///
/// So the derivative of (Phi x)(t) stays within a m_1(t) for every signal |x| <= a. On a mesh in s
/// the integral of |f| is at most that of its linear interpolation plus 1/8 of the squared step
/// times the integral of |f''|, and the same from mesh point to mesh point in t; the third
/// derivatives are bounded by norms of k in closed form. Nothing is estimated but rounding, for
/// which a relative 1e-9 is added.
///
/// Where k does not start at zero (filters of order 1, a delayed reference), the derivative jumps
/// by k(0)^2 at s = t. Between two mesh points in t the jump is somewhere in a strip of one step in
/// s, which adds the step times [k(0)^2/2 + a step times the derivative's own slope].
///
/// For the energy difference phi is that of the sensor less that of the filter.
class KernelBounds {
 public:
  /// Prepares the mesh. Model and memory must stay until all is read.
  ///
  /// @param[in] numbers At least `kernel_bounds_numbers(mesh_intervals(...))`.
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: The duration; or the sensor is ideal, or its poles are those of the
  /// filter.
  /// * kLostDigits: T is so short, or sensor and filter are so alike, that rounding hides k.
  /// * kTooManyCells: The mesh would be too large: shorten T.
  /// * kBufferTooSmall: `numbers` is.
  Status start(const ModalModel& model, double duration_s, Span<double> numbers) noexcept;

  /// Works on the next few mesh points. About 10 ns for each pair of mesh points and mode.
  void step() noexcept;
  bool done() const noexcept { return next_row_ > intervals_; }
  double progress() const noexcept {
    return static_cast<double>(next_row_) / static_cast<double>(intervals_ + 1);
  }

  /// @returns An upper bound of m_1 over [`from_s`, `to_s`], which is cut to [0, T].
  double bound(double from_s, double to_s) const noexcept;

  /// @returns For the energy difference an upper bound of |s Kf| at all frequencies, in
  /// V/(m/s^2)/s;
  ///   else 0. What is integrated from a signal e is passed by the filter as no more than this
  ///   times e.
  double filter_slope() const noexcept;

 private:
  void fill_tables(Span<double> numbers) noexcept;
  struct Norms;
  Norms norms_of(std::size_t first, std::size_t last) const noexcept;
  double remainder_of(const Norms& norms) const noexcept;
  bool fill_remainder() noexcept;
  struct RowSums;
  bool has_digits() const noexcept;
  void fill_row(std::size_t row) noexcept;
  void add_from_row_on(std::size_t row, RowSums& sums) const noexcept;
  void add_up_to_row(std::size_t row, RowSums& sums) const noexcept;

  const ModalModel* model_ = nullptr;
  double duration_s_ = 0.0;
  double step_s_ = 0.0;
  std::size_t intervals_ = 0;
  std::size_t stride_ = 1;  // Mesh points in s for one in t.
  std::size_t next_row_ = 0;
  double remainder_ = 0.0;                       // Of m_1, from one mesh point to the next.
  Span<double> exponential_re_[kMaxModes] = {};  // e^(p d), by the distance d.
  Span<double> exponential_im_[kMaxModes] = {};
  Span<double> held_re_[kMaxModes] = {};  // U_p(T - s), by s.
  Span<double> held_im_[kMaxModes] = {};
  Span<double> impulse_;    // k; for the energy difference that of the sensor.
  Span<double> taken_off_;  // 0; for the energy difference k of the filter.
  Span<double> integrals_;  // Over s at each mesh point in t.
};

static_assert(std::is_trivially_copyable_v<KernelBounds>);

/// U_p(tau) = integral from 0 to tau of e^(p w) k(w) dw for the pole of each mode: with it
/// phi(t, s) = Re sum r_p e^(p (s - t)) U_p(T - s) for t <= s.
void held_responses(const ModalModel& model, double tau_s, Complex* held) noexcept;

/// The energy, or energy difference, up to T of the response to a unit pulse of length `width_s`
/// that starts `left_s` before T; `width_s` <= `left_s`.
double pulse_energy(const ModalModel& model, double left_s, double width_s) noexcept;

}  // namespace emax
