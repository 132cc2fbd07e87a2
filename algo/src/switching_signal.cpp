// Exact energy of a switching signal from the states of the modes at its switching times.
#include "emax/switching_signal.hpp"

#include "emax/complex_exp.hpp"
#include "emax/elementary.hpp"

namespace emax {
namespace {

// Notation. With z_i(t) = integral of e^(p_i (t - v)) x(v) dv and x = c since the last switch, the
// output is y = Re sum w_i + c D, w_i = r_i (z_i + c / p_i). The integral of the square of Re sum
// w_i over an interval is F(w) at its end minus F(w) at its start, F being the Gramian form below.
// At a switch w jumps from r (z + c/p) to r (z - c/p); F of these two differs by 4 c Re sum z_i r_i
// H_i with H independent of the signal. So only the end and the start need F itself, and each
// switch costs one product per mode.

/// Half of the Gramian times a vector: row i of F's matrix.
Complex gramian_row(const ModalModel& model, std::size_t i, const Complex* vector) noexcept {
  Complex sum;
  for (std::size_t j = 0; j < model.modes().size(); ++j) {
    sum = sum + model.gramian(i, j) * vector[j] + model.conjugate_gramian(i, j) * conj(vector[j]);
  }
  return 0.5 * sum;
}

double gramian_form(const ModalModel& model, const Complex* vector) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < model.modes().size(); ++i) {
    sum += real_of_product(vector[i], gramian_row(model, i, vector));
  }
  return sum;
}

}  // namespace

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

Status SwitchingSignal::set_signs(Span<const std::int8_t> signs, double duration_s) noexcept {
  std::size_t changes = 0;
  for (std::size_t i = 1; i < signs.size(); ++i) {
    changes += signs[i] != signs[i - 1] ? 1u : 0u;
  }
  if (changes > kMaxSwitches) {
    return Status::kTooManySwitches;
  }
  count_ = 0;
  duration_s_ = duration_s;
  const double cells = static_cast<double>(signs.size());
  for (std::size_t i = 1; i < signs.size(); ++i) {
    if (signs[i] != signs[i - 1]) {
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

double energy(const ModalModel& model, const SwitchingSignal& signal) noexcept {
  const Span<const Mode> modes = model.modes();
  const std::size_t count = modes.size();
  Complex inverse_pole[kMaxModes];
  Complex settled[kMaxModes];    // r / p
  Complex at_switch[kMaxModes];  // what a switch multiplies z by: r H + D r / p
  Complex state[kMaxModes];      // z
  for (std::size_t i = 0; i < count; ++i) {
    inverse_pole[i] = Complex{1.0, 0.0} / modes[i].pole;
    settled[i] = modes[i].residue * inverse_pole[i];
  }
  // The linear part, 2 c D Re sum (w_end - w_start)_i / p_i, is 2 c D Re sum (r/p) (z_end -
  // z_start): summed by parts it is 4 c D Re sum (r/p) z at each switch and 2 c D Re sum (r/p) z at
  // the end.
  for (std::size_t i = 0; i < count; ++i) {
    at_switch[i] =
        modes[i].residue * gramian_row(model, i, settled) + model.static_gain(i) * settled[i];
  }

  double sum = -gramian_form(model, settled) + model.static_power() * signal.duration_s();
  double sign = 1.0;
  double last_s = 0.0;
  for (std::size_t k = 0; k <= signal.count(); ++k) {
    const bool at_end = k == signal.count();
    const double time_s = at_end ? signal.duration_s() : signal.times_s()[k];
    const double elapsed_s = time_s - last_s;
    double change = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Complex shift = sign * inverse_pole[i];
      state[i] = exp(elapsed_s * modes[i].pole) * (state[i] + shift) - shift;
      change += real_of_product(state[i], at_switch[i]);
    }
    if (!at_end) {
      sum += 4.0 * sign * change;
      sign = -sign;
    }
    last_s = time_s;
  }
  Complex end[kMaxModes];
  double linear = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    end[i] = modes[i].residue * state[i] + sign * settled[i];
    linear += model.static_gain(i) * real_of_product(settled[i], state[i]);
  }
  return sum + gramian_form(model, end) + 2.0 * sign * linear;
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
