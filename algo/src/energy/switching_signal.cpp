// Exact energy of a switching signal from the states of the modes at its switching times.
#include "emax/energy/switching_signal.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"

#include "signal_energy.hpp"

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

double energy(const ModalModel& model, const SwitchingSignal& signal) noexcept {
  return energy(model, signal.times_s(), signal.duration_s());
}

double energy(const ModalModel& model, Span<const double> times_s, double duration_s) noexcept {
  const std::size_t count = times_s.size();
  SignalEnergy sum(model);
  for (std::size_t i = 0; i < model.modes().size(); ++i) {
    const Complex pole = model.modes()[i].pole;
    double last_s = 0.0;
    sum.add_mode(i, count + 1, [&](std::size_t k) {
      const double time_s = k < count ? times_s[k] : duration_s;
      const double interval_s = time_s - last_s;
      last_s = time_s;
      return exp(interval_s * pole);
    });
  }
  return sum.result(duration_s);
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
