// Exact energy of a switching signal from the states of the modes at its switching times.
#include "emax/switching_signal.hpp"

#include "emax/complex_exp.hpp"
#include "emax/elementary.hpp"

namespace emax {
Status SwitchingSignal::set(Span<const double> times_s, double duration_s) noexcept {
  if (!(duration_s > 0.0) || !is_finite(duration_s)) {
    return Status::kInvalidArgument;
  }
  if (times_s.size() > kMaxSwitches) {
    return Status::kTooManySwitches;
  }
  double last_s = 0.0;
  for (const double time_s : times_s) {
    if (!(time_s > 0.0) || !(time_s < duration_s)) {
      return Status::kInvalidArgument;
    }
    if (!(time_s > last_s)) {
      return Status::kNotAscending;
    }
    last_s = time_s;
  }
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    times_s_[i] = times_s[i];
  }
  count_ = static_cast<std::uint16_t>(times_s.size());
  duration_s_ = duration_s;
  return Status::kOk;
}

Status SwitchingSignal::set_signs(Signs signs, double duration_s) noexcept {
  std::size_t changes = 0;
  for (std::size_t i = 1; i < signs.size(); ++i) {
    changes += signs.is_positive(i) != signs.is_positive(i - 1) ? 1u : 0u;
  }
  if (changes > kMaxSwitches) {
    return Status::kTooManySwitches;
  }
  count_ = 0;
  duration_s_ = duration_s;
  const double cells = static_cast<double>(signs.size());
  for (std::size_t i = 1; i < signs.size(); ++i) {
    if (signs.is_positive(i) != signs.is_positive(i - 1)) {
      times_s_[count_++] = duration_s * static_cast<double>(i) / cells;
    }
  }
  return Status::kOk;
}

double SwitchingSignal::value(double time_s) const noexcept {
  if (!(time_s >= 0.0) || time_s > duration_s_) {
    return 0.0;
  }
  double sign = 1.0;
  for (std::size_t i = 0; i < count_ && times_s_[i] <= time_s; ++i) {
    sign = -sign;
  }
  return sign;
}

// With z_i(t) = integral of e^(p_i (t - v)) x(v) dv and x = c since the last switch, the output is
// y = Re sum w_i + c D, w_i = r_i (z_i + c/p_i). The integral over an interval of the square of
// Re sum w_i is F(w) at its end minus F(w) at its start, F(w) = Re sum_i w_i gramian_row(i, w);
// that of 2 c D Re sum w_i is 2 c D Re sum (r_i/p_i) (z_i at the end - z_i at the start). At a
// switch w jumps from r (z + c/p) to r (z - c/p), and F of the two differs by 4 c Re sum z_i r_i
// gramian_row(i, r/p). Summed by parts over all intervals there remain 4 c Re sum z_i J_i at each
// switch, half of that at T, F(r z) at T, and the settled power times T, with J_i = r_i
// gramian_row(i, r/p) + D r_i/p_i of the model alone.
double energy(const ModalModel& model, const SwitchingSignal& signal) noexcept {
  return energy(model, signal.times_s(), signal.duration_s());
}

double energy(const ModalModel& model, Span<const double> times_s, double duration_s) noexcept {
  const std::size_t count = model.modes().size();
  Complex state[kMaxModes];  // z
  double sum = model.static_power() * duration_s;
  double sign = 1.0;
  double last_s = 0.0;
  for (std::size_t k = 0; k <= times_s.size(); ++k) {
    const bool at_end = k == times_s.size();
    const double time_s = at_end ? duration_s : times_s[k];
    double weighted = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Complex shift = sign * model.inverse_pole(i);
      state[i] = exp((time_s - last_s) * model.modes()[i].pole) * (state[i] + shift) - shift;
      weighted += real_of_product(state[i], model.switch_weight(i));
    }
    sum += (at_end ? 2.0 : 4.0) * sign * weighted;
    sign = -sign;
    last_s = time_s;
  }
  for (std::size_t i = 0; i < count; ++i) {
    state[i] = model.modes()[i].residue * state[i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    sum += real_of_product(state[i], model.gramian_row(i, state));
  }
  return sum;
}

double error_output(const ModalModel& model, const SwitchingSignal& signal,
                    double time_s) noexcept {
  double sum = model.step_response(time_s);
  double sign = -1.0;
  for (const double switch_s : signal.times_s()) {
    if (!(switch_s < time_s)) {
      break;
    }
    sum += 2.0 * sign * model.step_response(time_s - switch_s);
    sign = -sign;
  }
  return sum;
}

}  // namespace emax
