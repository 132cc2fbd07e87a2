// Samples of the impulse response, and bisection between them.
#include "emax/model/response_scan.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr std::uint32_t kMaxSamples = 1u << 20;
constexpr double kSamplesPerPeriod = 64.0;

/// dk/dt.
double slope_of(Span<const Mode> modes, double time_s) noexcept {
  double sum = 0.0;
  for (const Mode& mode : modes) {
    sum += real_of_product(mode.residue * mode.pole, exp(time_s * mode.pole));
  }
  return sum;
}

/// An upper bound of |k| from this time on.
double envelope(Span<const Mode> modes, double time_s) noexcept {
  double sum = 0.0;
  for (const Mode& mode : modes) {
    sum += sqrt(norm(mode.residue)) * exp(time_s * mode.pole.re);
  }
  return sum;
}

double sample_step_s(Span<const Mode> modes) noexcept {
  double fastest = 0.0;
  for (const Mode& mode : modes) {
    const double rate = norm(mode.pole);
    fastest = rate > fastest ? rate : fastest;
  }
  return kTwoPi / (kSamplesPerPeriod * sqrt(fastest));
}

/// Where a function of time with opposite signs at both ends is zero: bisection down to
/// neighbouring doubles.
template <typename Function>
double bisect(double low_s, double high_s, const Function& function) noexcept {
  const bool positive_at_low = function(low_s) > 0.0;
  for (int i = 0; i < 80; ++i) {
    const double middle_s = low_s + 0.5 * (high_s - low_s);
    if (!(middle_s > low_s && middle_s < high_s)) {
      break;
    }
    if ((function(middle_s) > 0.0) == positive_at_low) {
      low_s = middle_s;
    } else {
      high_s = middle_s;
    }
  }
  return low_s + 0.5 * (high_s - low_s);
}

ResponseScan begin(const ModalModel& model) noexcept {
  ResponseScan scan;
  scan.step_s = sample_step_s(model.modes());
  scan.slope = slope_of(model.modes(), 0.0);
  scan.running = !model.is_nothing();
  scan.complete = model.is_nothing();
  return scan;
}

/// Hands over the next intervals between samples, and whether k turns in each; ends where the
/// envelope says that nothing as large as `floor_of()` can follow, or after kMaxSamples.
template <typename Floor, typename Visit>
void go_on(ResponseScan& scan, const ModalModel& model, const Floor& floor_of,
           const Visit& visit) noexcept {
  constexpr std::uint32_t kEnvelopeStride = 16;
  for (std::uint32_t k = 0; scan.running && k < ResponseScan::kSamplesPerStep; ++k) {
    const double start_s = scan.taken * scan.step_s;
    ++scan.taken;
    const double end_s = scan.taken * scan.step_s;
    const double next_slope = slope_of(model.modes(), end_s);
    visit(start_s, end_s, (scan.slope > 0.0) != (next_slope > 0.0));
    scan.slope = next_slope;
    scan.complete =
        scan.taken % kEnvelopeStride == 0 && envelope(model.modes(), end_s) < floor_of();
    scan.running = !scan.complete && scan.taken < kMaxSamples;
  }
}

double extremum_between(const ModalModel& model, double start_s, double end_s) noexcept {
  return bisect(start_s, end_s, [&](double t) { return slope_of(model.modes(), t); });
}

}  // namespace

void PeakSearch::start(const ModalModel& model) noexcept {
  scan_ = begin(model);
  best_ = {model.impulse_response(0.0), 0.0};
}

void PeakSearch::step(const ModalModel& model) noexcept {
  go_on(
      scan_, model, [&] { return abs(best_.value); },
      [&](double start_s, double end_s, bool turns) {
        const double time_s = turns ? extremum_between(model, start_s, end_s) : end_s;
        const double value = model.impulse_response(time_s);
        if (abs(value) > abs(best_.value)) {
          best_ = {value, time_s};
        }
      });
}

void SettlingSearch::start(const ModalModel& model, double limit) noexcept {
  scan_ = begin(model);
  limit_ = limit;
  time_s_ = 0.0;
}

void SettlingSearch::step(const ModalModel& model) noexcept {
  const auto above = [&](double t) { return abs(model.impulse_response(t)) - limit_; };
  const auto look = [&](double from_s, double to_s) {
    if (above(to_s) > 0.0) {
      time_s_ = to_s;
    } else if (above(from_s) > 0.0) {
      time_s_ = bisect(from_s, to_s, above);
    }
  };
  go_on(
      scan_, model, [&] { return limit_; },
      [&](double start_s, double end_s, bool turns) {
        if (!turns) {
          look(start_s, end_s);
          return;
        }
        const double extremum_s = extremum_between(model, start_s, end_s);
        look(start_s, extremum_s);
        look(extremum_s, end_s);
      });
}

}  // namespace emax
