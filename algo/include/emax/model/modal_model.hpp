// The error system, sensor minus filter, as a sum of modes with the Gramian that turns states into
// energies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/model/accelerometer.hpp"
#include "emax/model/butterworth.hpp"
#include "emax/model/mode.hpp"
#include "emax/model/reference_filter.hpp"

namespace emax {

inline constexpr std::size_t kMaxModes = 1 + kMaxFilterModes;

/// Which energy is made as large as possible.
enum class Criterion : std::uint8_t {
  kIntegralSquareError,  ///< Of y = ya - yf, paper equations (8), (14), (15), (20): never negative.
  kEnergyDifference,     ///< E(ya) - E(yf), paper equations (5) and (13): may be negative.
  /// Of what the sensor does wrong within the filter's band: y = h * (ya - G x), h being the filter
  /// with a gain of 1 and G its gain. K(s) = (Ka(s) - G) Kf(s)/G: 0 for an ideal sensor.
  kInBandError,
};

/// Whether the reference is delayed before the sensor is compared with it. Most users of a sensor
/// allow it a constant delay.
enum class DelayMode : std::uint8_t {
  kNone,
  kOfSensor,  ///< By 2 beta/(2 pi f0), the sensor's group delay at low frequencies.
  kGiven,     ///< By a number.
};

struct ReferenceDelay {
  DelayMode mode = {};
  double given_s = 0.0;  ///< kGiven only; 0 to 1/(2 pi band_hz).
};

/// What is called the error, and of which energy.
struct ErrorMeasure {
  Criterion criterion = {};
  ReferenceDelay delay = {};  ///< kInBandError only.
};

/// A value of the impulse response and when it occurs.
struct Peak {
  double value = 0.0;  ///< With its sign.
  double time_s = 0.0;
};

struct SettlingTime {
  double time_s = 0.0;
  bool found =
      false;  ///< False if the response was still above the limit at the end of the search.
};

/// k(t) = ka(t) - kf(t) by partial fractions, paper equation (14), and the two Gramians of its
/// modes; or k of the in-band error, which has the same poles.
///
/// Mode 0 is the sensor, the others are the filter; the filter's residues carry the minus sign.
/// 2.7 KiB. After `set()`, a new sensor costs one row of the Gramians (`set_device()`); for the
/// in-band error also the sums over the filter, as all residues change.
///
/// A delay tau of the reference: y = h * (ya - G x(t - tau)). The delayed filter is taken as h(t -
/// tau) continued to t < tau by its own modes, which keeps the poles simple and the digits:
/// residues r_f (Ka(p_f) - G e^(-p_f tau))/G. Energies are those of the continued filter. What it
/// is off by is `delay_error()`.
///
/// In-band, a sensor with the poles of the filter to 3e-4 has modes of a sensor next to it
/// (`moved_by()`). Signals and peaks are then those of that neighbour; `known_energy()` gives the
/// energy of a signal for the sensor itself.
class ModalModel {
 public:
  /// Takes over sensor, filter and criterion; no delay.
  ///
  /// @returns
  /// * kOk: Ready.
  /// * kOverdamped, kInvalidOrder, kInvalidArgument: As `validate()` of sensor and filter; nothing
  ///   has changed.
  /// * kInvalidArgument: The in-band error, and a filter without gain.
  Status set(const Accelerometer& device, const Butterworth& filter, Criterion criterion) noexcept;

  /// The same for any reference filter, which must be as `ReferenceFilter` says.
  ///
  /// @returns As above, and kDelayTooLong for a delay below 0 or above 1/(2 pi band_hz); nothing
  ///   has changed unless it is kOk.
  Status set(const Accelerometer& device, const ReferenceFilter& filter,
             const ErrorMeasure& measure) noexcept;

  /// An ideal sensor in place of a real one: K = S at every frequency. It keeps a mode of residue 0
  /// in its place, and the error system passes part of its input at once (`feedthrough()`): the
  /// baseline that an energy is compared with.
  ///
  /// @param[in] sensitivity S in V/(m/s^2), finite and above 0.
  /// @param[in] delay_s By which the reference of the in-band error is delayed, as `set()` has
  ///   accepted it for a sensor; 0 for the other criteria. An ideal sensor has no delay of its own.
  /// @returns kOk, or kInvalidArgument (also for the in-band error and a filter without gain) and
  ///   nothing has changed.
  Status set_ideal(double sensitivity, const ReferenceFilter& filter, Criterion criterion,
                   double delay_s = 0.0) noexcept;

  /// Exchanges the sensor and keeps filter, criterion and delay: that of the sensor is the first
  /// sensor's. `set()` comes first.
  ///
  /// @returns As `validate()`; nothing has changed unless it is kOk.
  Status set_device(const Accelerometer& device) noexcept;

  /// Multiplies the filter's gain: for a filter that follows the sensor's sensitivity.
  ///
  /// @param[in] gain In V/(m/s^2), finite and not negative, else kInvalidArgument and nothing has
  ///   changed. A filter that has a gain of 0 keeps it: kInvalidArgument for any other.
  Status set_gain(double gain) noexcept;

  const Accelerometer& device() const noexcept { return device_; }
  const ReferenceFilter& filter() const noexcept { return filter_; }
  Criterion criterion() const noexcept { return criterion_; }
  /// @returns Whether the energy is that of one output, so that it is never negative.
  bool is_square() const noexcept { return criterion_ != Criterion::kEnergyDifference; }
  /// @returns By how much the reference is delayed, in s.
  double delay_s() const noexcept { return delay_s_; }
  /// @returns epsilon, the integral of |h(-s)| from 0 to the delay: with the true delay, y differs
  ///   by at most epsilon G times the limit of x. So the true root mean square over T is within
  ///   epsilon G a of that of the continued filter.
  double delay_error() const noexcept { return delay_error_; }
  /// @returns How far the modes are from the sensor itself: the integral of |k of the modes - k| is
  ///   no more, in V/(m/s^2), nor is |y| off by more for |x| <= 1. 0 but for coincident poles.
  double moved_by() const noexcept { return moved_by_; }
  /// @returns D, where k(t) is D delta(t) + the modes: S for an ideal sensor, else 0.
  double feedthrough() const noexcept { return feedthrough_; }
  /// @returns K(0), what a constant unit input settles at.
  double static_gain() const noexcept { return static_gain_; }
  /// @returns Whether sensor and filter are the same to rounding: k is 0 then.
  bool is_nothing() const noexcept { return is_nothing_; }
  /// @returns Whether k(0) = 0, so that k is continuous.
  bool starts_at_zero() const noexcept {
    return filter_.relative_degree >= 2 && delay_s_ == 0.0 && feedthrough_ == 0.0;
  }
  /// @returns The frequency that a grid has to resolve, in Hz: the larger of the sensor's f0 and
  ///   the end of the filter's band. For the in-band error with a resonance that shows less than a
  ///   tenth of what is in the band, four times the band, but no less than f0/16.
  double grid_hz() const noexcept;
  Span<const Mode> modes() const noexcept { return Span<const Mode>(modes_, count_); }

  /// c/(p_i + p_j) and c/(p_i + conj p_j), c being 1, or for the energy difference +1 for two
  /// sensor modes, -1 for two filter modes and 0 between them.
  Complex gramian(std::size_t i, std::size_t j) const noexcept {
    return i <= j ? gramian_[pair(i, j)] : gramian_[pair(j, i)];
  }
  Complex conjugate_gramian(std::size_t i, std::size_t j) const noexcept {
    return i < j ? conjugate_gramian_[pair(i, j)] : conj(conjugate_gramian_[pair(j, i)]);
  }

  /// 1/2 sum_j [output_j G_ij + conj(output_j) H_ij], G and H being the two Gramians: what the
  /// outputs of the modes at T still hold, seen from mode i.
  Complex gramian_row(std::size_t i, const Complex* output) const noexcept;
  /// Re sum_i output_i gramian_row(i, output). By symmetry each two modes are taken once.
  double gramian_form(const Complex* output) const noexcept;

  /// 1/p_i.
  Complex inverse_pole(std::size_t i) const noexcept { return inverse_pole_[i]; }
  /// The autocorrelation of k at a distance t > 0 is Re sum_i correlation(i) e^(p_i t); at 0 comes
  /// feedthrough()^2 delta(t) on top. Computed in each call, by two products per mode.
  Complex correlation(std::size_t i) const noexcept;
  /// What the state of mode i at a switch is multiplied by in the energy; see `energy()`.
  Complex switch_weight(std::size_t i) const noexcept { return switch_weight_[i]; }
  /// The square of the settled output (or difference of the two squares) for a constant unit input.
  double static_power() const noexcept { return static_power_; }

  /// @returns k(t), ka(t) and kf(t) in V/(m/s), paper equation (14), without what an ideal sensor
  ///   passes at once; 0 for t < 0.
  double impulse_response(double time_s) const noexcept;
  double device_impulse_response(double time_s) const noexcept;
  double filter_impulse_response(double time_s) const noexcept;

  /// @returns The integral of k from 0 to t, in V/(m/s^2).
  double step_response(double time_s) const noexcept;

  /// @returns The value of k farthest from zero, to the last digits, and its time.
  /// Samples k at 64 points per period of its fastest mode, then bisects on its derivative.
  Peak peak() const noexcept;

  /// @returns The last time at which |k| leaves the band of ±`fraction` of its peak. At most 2^20
  ///   samples are looked at; beyond that `found` is false and the time is how far the search came.
  SettlingTime settling_time(double fraction) const noexcept;

 private:
  static constexpr std::size_t kPairs = kMaxModes * (kMaxModes + 1) / 2;
  /// The place of i <= j among the pairs.
  static constexpr std::size_t pair(std::size_t i, std::size_t j) noexcept {
    return j * (j + 1) / 2 + i;
  }
  void take_delay(const ReferenceFilter& filter, double delay_s) noexcept;
  void take(const Accelerometer& device, const ReferenceFilter& filter,
            Criterion criterion) noexcept;
  void fill_modes() noexcept;
  void fill_residues() noexcept;
  void fill_gramians(std::size_t first_row_count) noexcept;
  void fill_sums_over_filter() noexcept;
  void fill_switch_weights() noexcept;

  Mode modes_[kMaxModes] = {};
  // Of pairs i <= j: the first is symmetric, the second Hermitian.
  Complex gramian_[kPairs] = {};
  Complex conjugate_gramian_[kPairs] = {};
  Complex inverse_pole_[kMaxModes] = {};
  Complex settled_[kMaxModes] = {};  // r / p
  Complex switch_weight_[kMaxModes] = {};
  // The part of the sums over modes that a new sensor does not change.
  Complex filter_settled_[kMaxModes] = {};
  double static_power_ = 0.0;
  double static_gain_ = 0.0;
  double feedthrough_ = 0.0;
  double delay_s_ = 0.0;
  double delay_error_ = 0.0;
  double moved_by_ = 0.0;
  double delay_reach_ = 0.0;  // The integral of h(-s) from 0 to the delay, h continued.
  Accelerometer device_ = {};
  ReferenceFilter filter_ = {};
  std::size_t count_ = 0;
  Criterion criterion_ = {};
  bool is_nothing_ = false;
};

static_assert(std::is_trivially_copyable_v<ModalModel>);

}  // namespace emax
