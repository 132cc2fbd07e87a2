// Exponentials of intervals from those of nearby ones.
#include "emax/energy/nearby_energy.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"

#include "signal_energy.hpp"

namespace emax {
namespace {

/// The greatest |p delta|; see the class.
constexpr double kReach = 1.0 / 70.0;

/// The end of interval k: a switch, or T.
double end_of(const SwitchingSignal& signal, std::size_t k) noexcept {
  return k < signal.count() ? signal.times_s()[k] : signal.duration_s();
}

/// e^(p delta) - 1 from p^n/n!, n from 1 to 6. Written out, as it is most of what an energy takes.
Complex excess(const Complex* power, double delta_s) noexcept {
  const auto add = [&](std::size_t n, Complex rest) { return delta_s * (power[n - 1] + rest); };
  return add(1, add(2, add(3, add(4, add(5, delta_s * power[5])))));
}

}  // namespace

void NearbyEnergy::prepare(const ModalModel& model, const SwitchingSignal& signal) noexcept {
  const Span<const Mode> filter = model.modes().from(1);
  const std::size_t intervals = signal.count() + 1;
  intervals_ = 0;
  if (intervals > kMaxIntervals || intervals * filter.size() > kRoom) {
    return;
  }
  intervals_ = intervals;
  double fastest = 0.0;
  for (std::size_t i = 0; i < filter.size(); ++i) {
    const Complex pole = filter[i].pole;
    const double speed = sqrt(norm(pole));
    fastest = speed > fastest ? speed : fastest;
    powers_[i][0] = pole;
    for (std::size_t n = 1; n < kPowers; ++n) {
      powers_[i][n] = (1.0 / static_cast<double>(n + 1)) * (powers_[i][n - 1] * pole);
    }
  }
  reach_s_ = kReach / fastest;
  double last_s = 0.0;
  for (std::size_t k = 0; k < intervals; ++k) {
    const double interval_s = end_of(signal, k) - last_s;
    for (std::size_t i = 0; i < filter.size(); ++i) {
      decays_[i * intervals + k] = exp(interval_s * filter[i].pole);
    }
    last_s = end_of(signal, k);
  }
}

double NearbyEnergy::energy(const ModalModel& model, const SwitchingSignal& signal,
                            const SwitchingSignal& given) const noexcept {
  if (signal.count() + 1 != intervals_) {
    return emax::energy(model, signal);
  }
  double interval_s[kMaxIntervals];
  double delta_s[kMaxIntervals];
  double last_s = 0.0;
  double given_last_s = 0.0;
  for (std::size_t k = 0; k < intervals_; ++k) {
    const double end_s = end_of(signal, k);
    const double given_end_s = end_of(given, k);
    interval_s[k] = end_s - last_s;
    delta_s[k] = interval_s[k] - (given_end_s - given_last_s);
    if (!(abs(delta_s[k]) <= reach_s_)) {
      return emax::energy(model, signal);
    }
    last_s = end_s;
    given_last_s = given_end_s;
  }
  const Span<const Mode> modes = model.modes();
  SignalEnergy sum(model);
  sum.add_mode(0, intervals_, [&](std::size_t k) { return exp(interval_s[k] * modes[0].pole); });
  const Complex* decay = decays_;
  for (std::size_t i = 1; i < modes.size(); ++i) {
    const Complex* power = powers_[i - 1];
    sum.add_mode(i, intervals_, [&](std::size_t k) {
      const Complex given_decay = *decay++;
      return given_decay + given_decay * excess(power, delta_s[k]);
    });
  }
  return sum.result(signal.duration_s());
}

}  // namespace emax
