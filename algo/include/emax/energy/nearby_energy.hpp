// The energy of signals that are near a given one, at a fraction of the price.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// `energy()` for many sensors with one filter and signals whose intervals between switches are
/// nearly those of one signal.
///
/// Most of the price of an energy are the exponentials e^(p d), one per mode and interval. Those
/// of the filter's modes for the intervals d of the given signal are kept here; an interval
/// that is longer by `delta` only takes a polynomial: e^(p (d + delta)) = e^(p d) sum (p delta)^n /
/// n!. Its terms end at n = 6. Up to |p delta| = 1/70 what is left out is below (1/70)^7/7! =
/// 2.5e-17, a ninth of the last place of 1; rounding adds at most 2e-16 of |e^(p d)|. The sensor's
/// mode is computed as in `energy()`; so is all of a signal with an interval that is farther away,
/// or with more intervals than there is room for.
///
/// 1.8 KiB.
class NearbyEnergy {
 public:
  /// A signal with more intervals, one more than switches, is computed as in `energy()`,
  static constexpr std::size_t kMaxIntervals = 32;
  /// and so is one with more intervals times modes of the filter: 11 switches at order 10.
  static constexpr std::size_t kRoom = 64;

  /// Takes the filter of a model and a signal. Without it, or where there is no room, `energy()`
  /// is right too, at the full price.
  void prepare(const ModalModel& model, const SwitchingSignal& signal) noexcept;

  /// @param[in] model  Of any sensor, with the filter of `prepare()`; the filter's gain may differ.
  /// @param[in] signal With as many switches as the one of `prepare()`, else it is `energy()`.
  /// @param[in] given  The signal of `prepare()`.
  /// @returns As `energy()` of model and signal, to rounding.
  double energy(const ModalModel& model, const SwitchingSignal& signal,
                const SwitchingSignal& given) const noexcept;

 private:
  static constexpr std::size_t kPowers = 6;

  Complex decays_[kRoom] = {};                     // e^(p d), mode by mode.
  Complex powers_[kMaxFilterModes][kPowers] = {};  // p^n/n!, from n = 1 on.
  double reach_s_ = 0.0;                           // The greatest delta.
  std::size_t intervals_ = 0;                      // 0 if there was no room.
};

static_assert(std::is_trivially_copyable_v<NearbyEnergy>);

}  // namespace emax
