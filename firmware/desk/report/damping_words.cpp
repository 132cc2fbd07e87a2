// What magnitudes alone say of f0 where they leave the damping open.
#include "desk/report/damping_words.hpp"

#include <cmath>
#include <cstdio>
#include <memory>

#include "emax/identify/wlsp.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax::desk {

namespace {

// Standard, of f0: with more it is not known well enough to be worth a number.
constexpr double kMostSpread = 0.1;
constexpr double kStep = 0.01;

bool fits(Wlsp& fit, const FrequencyResponse& points, double damping) {
  fit.give_damping(damping);
  const WlspFit& result = fit.result();
  return fit.fit(points) == Status::kOk && result.is_damping_given &&
         result.u_natural_frequency_hz < kMostSpread * result.model.natural_frequency_hz;
}

}  // namespace

FrequencyByDamping frequency_by_damping(const FrequencyResponse& points) {
  FrequencyByDamping found;
  const auto fit = std::make_unique<Wlsp>();
  if (points.known_phases() > 0 || !fits(*fit, points, kMinDamping)) {
    return found;
  }
  found.f0_hz = fit->result().model.natural_frequency_hz;
  found.u_f0_hz = fit->result().u_natural_frequency_hz;
  found.damping = kMinDamping;
  found.f0_at_damping_hz = found.f0_hz;
  // The iteration may come to no rest at a single value.
  for (int step = 1; step < 100; ++step) {
    if (fits(*fit, points, step * kStep)) {
      found.damping = step * kStep;
      found.f0_at_damping_hz = fit->result().model.natural_frequency_hz;
    }
  }
  return found;
}

std::string words_on_damping(const FrequencyByDamping& found) {
  if (!(found.f0_hz > 0.0)) {
    return "";
  }
  char text[400];
  (void)std::snprintf(
      text, sizeof text,
      "The magnitudes give f0 where the damping is known: from %.0f Hz (U = %.0f Hz, k = 2) for "
      "beta = 0.0001 to %.0f Hz for beta = %.2g, the largest that fits them. --damping B, from "
      "the maker or another test, then gives f0 and the energy.",
      found.f0_hz, 2.0 * found.u_f0_hz, found.f0_at_damping_hz, found.damping);
  return text;
}

}  // namespace emax::desk
