// The closed form of a switching signal's energy, from what its modes decay by between switches.
#pragma once

#include <cstddef>

#include "emax/base/complex.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// Sums the energy of a signal of unit size mode by mode: paper equations (15), (20), or (13) for
/// the criterion of the energy difference.
///
/// With z_i(t) = integral of e^(p_i (t - v)) x(v) dv and x = c since the last switch, the output is
/// y = Re sum w_i + c D, w_i = r_i (z_i + c/p_i). The integral over an interval of the square of
/// Re sum w_i is F(w) at its end minus F(w) at its start, F(w) = Re sum_i w_i gramian_row(i, w);
/// that of 2 c D Re sum w_i is 2 c D Re sum (r_i/p_i) (z_i at the end - z_i at the start). At a
/// switch w jumps from r (z + c/p) to r (z - c/p), and F of the two differs by 4 c Re sum z_i r_i
/// gramian_row(i, r/p). Summed by parts over all intervals there remain 4 c Re sum z_i J_i at each
/// switch, half of that at T, F(r z) at T, and the settled power times T, with J_i = r_i
/// gramian_row(i, r/p) + D r_i/p_i of the model alone.
///
/// What is carried on is c z. As c turns at each switch, c z at the next one, an interval of d
/// later, is e^(p d) (1/p - c z) - 1/p.
class SignalEnergy {
 public:
  explicit SignalEnergy(const ModalModel& model) noexcept : model_(model) {}

  /// Carries a mode from 0 to T.
  ///
  /// @param[in] intervals Between switches: one more than switches.
  /// @param[in] decay     decay(k) = e^(p_i d) for the length d of interval k, called in order.
  template <typename Decay>
  void add_mode(std::size_t i, std::size_t intervals, Decay decay) noexcept {
    const Complex inverse_pole = model_.inverse_pole(i);
    Complex state;
    Complex at_switches;
    for (std::size_t k = 0; k < intervals; ++k) {
      at_switches = at_switches + state;
      state = decay(k) * (inverse_pole - state) - inverse_pole;
    }
    output_[i] = model_.modes()[i].residue * state;
    weighted_ += real_of_product(at_switches + 0.5 * state, model_.switch_weight(i));
  }

  /// @returns The energy, when all modes have been added.
  double result(double duration_s) const noexcept {
    return model_.static_power() * duration_s + 4.0 * weighted_ + model_.gramian_form(output_);
  }

 private:
  const ModalModel& model_;
  Complex output_[kMaxModes];  // At T.
  double weighted_ = 0.0;
};

}  // namespace emax
