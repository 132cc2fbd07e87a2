// The sizes of what an energy sums, and another form where they are too large.
#include "emax/energy/known_energy.hpp"

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

constexpr double kHalfUnit = 0x1p-53;
/// Of each term. Residues are products of up to 15 factors, but roundings have no common sign: of
/// 600 devices none was off by more than half of what comes out, and those of orders above 9 by no
/// more than a twentieth.
constexpr double kRoundings = 2.0;
/// Where nothing cancels: of the sum itself.
constexpr double kOfSum = 16.0;
/// What a delay may leave open, as part of the root mean square.
constexpr double kDelayPart = 0.01;

double size(Complex z) noexcept { return sqrt(norm(z)); }

}  // namespace

double energy_rounding(const ModalModel& model, double duration_s, std::size_t switches,
                       double energy) noexcept {
  const Span<const Mode> modes = model.modes();
  double settled[kMaxModes] = {};
  double state[kMaxModes] = {};
  for (std::size_t i = 0; i < modes.size(); ++i) {
    settled[i] = size(modes[i].residue) * size(model.inverse_pole(i));
    // A state is at most the integral of its decay, and the difference of two numbers like 1/p.
    const double life_s = -1.0 / modes[i].pole.re;
    state[i] = 2.0 * size(model.inverse_pole(i)) + (life_s < duration_s ? life_s : duration_s);
  }
  double form = 0.0;
  double weighted = 0.0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const double residue = size(modes[i].residue);
    double weight = abs(model.static_gain()) * settled[i];
    for (std::size_t j = 0; j < modes.size(); ++j) {
      const double gramian = size(model.gramian(i, j)) + size(model.conjugate_gramian(i, j));
      weight += 0.5 * residue * gramian * settled[j];
      form += 0.5 * residue * gramian * size(modes[j].residue) * state[i] * state[j];
    }
    weighted += weight * state[i];
  }
  // Roundings at many switches have no common sign either.
  const double ends = 0.5 + 1.5 * sqrt(static_cast<double>(switches));
  const double terms = abs(model.static_power()) * duration_s + 4.0 * ends * weighted + form;
  return kHalfUnit * (kRoundings * terms + kOfSum * abs(energy));
}

EnergyAnswer known_energy(const ModalModel& model, const SwitchingSignal& signal) noexcept {
  EnergyAnswer answer;
  answer.known.energy = energy(model, signal);
  answer.known.rounding =
      energy_rounding(model, signal.duration_s(), signal.count(), answer.known.energy);
  if (model.moved_by() > 0.0) {
    answer.known.rounding = abs(answer.known.energy);  // Of another sensor.
  }
  if (answer.known.rounding <= kPermittedRounding * abs(answer.known.energy)) {
    return answer;
  }
  CascadeResponse response;
  if (response.start(model, signal.duration_s())) {
    double last_s = 0.0;
    double sign = 1.0;
    for (const double time_s : signal.times_s()) {
      response.advance(time_s - last_s, sign);
      last_s = time_s;
      sign = -sign;
    }
    response.advance(signal.duration_s() - last_s, sign);
    const KnownEnergy found = response.energy();
    if (found.rounding < answer.known.rounding) {
      answer.known = found;
    }
  }
  const bool is_known = answer.known.rounding <= kPermittedRounding * abs(answer.known.energy);
  answer.status = is_known ? Status::kOk : Status::kLostDigits;
  return answer;
}

double delay_tolerance(const ModalModel& model) noexcept {
  return model.delay_error() * model.filter().gain;
}

double true_bound(const ModalModel& model, double bound, double duration_s) noexcept {
  const double tolerance = delay_tolerance(model) + model.moved_by();
  if (tolerance == 0.0) {
    return bound;
  }
  const double root = sqrt(bound) + tolerance * sqrt(duration_s);
  return root * root;
}

Status check_delay(const ModalModel& model, double energy, double duration_s) noexcept {
  const double tolerance = delay_tolerance(model);
  const bool is_resolved = tolerance * tolerance * duration_s <= kDelayPart * kDelayPart * energy;
  return tolerance == 0.0 || is_resolved ? Status::kOk : Status::kDelayNotResolved;
}

double fast_switching_limit(const ModalModel& model, double duration_s) noexcept {
  return model.feedthrough() * model.feedthrough() * duration_s;
}

}  // namespace emax
