// Why points do not fit a device: known faults of a measuring chain, tried one by one.
#include "emax/identify/fit_diagnosis.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr double kSuspicious = 3.0;  // chi2/dof from which causes are looked for.
constexpr double kGood = 1.5;        // chi2/dof of points that a device explains.
constexpr double kConvincing = 0.1;  // What a cause must bring it down to, as a part.
constexpr double kPeriods = 8.0;     // The longest delay, in periods of the highest frequency.
constexpr int kStepsPerPeriod = 24;  // The minimum over the delay is about half a period wide.
constexpr int kCornersPerDecade = 16;
constexpr int kDecades = 3;
constexpr int kRefinements = 60;  // Of a golden section: 1e-12 of the bracket.

// Below it the phases of radians taken for degrees are all within a turn of radians.
constexpr double kTurnOfRadians_rad = kTwoPi * kRadiansPerDegree;
constexpr double kNoSensorsDamping = 0.002;
constexpr double kNoOnesPhase_rad = 0.025 * kRadiansPerDegree;  // A standard uncertainty.

enum class Fault : std::uint8_t { kDelay, kCoupling, kRadians };

// What a fault of size `value` has added is taken out of one point.
ResponsePoint without(Fault fault, double value, ResponsePoint point) noexcept {
  if (fault == Fault::kDelay) {
    point.phase_rad += kTwoPi * point.frequency_hz * value;
    return point;
  }
  if (fault == Fault::kRadians) {
    point.phase_rad *= kDegreesPerRadian;
    point.u_phase_rad *= kDegreesPerRadian;
    return point;
  }
  const double ratio = value / point.frequency_hz;
  const double gain = sqrt(1.0 + ratio * ratio);
  point.amplitude *= gain;
  point.u_amplitude *= gain;
  point.phase_rad -= atan2(ratio, 1.0);
  return point;
}

class Trials final {
 public:
  Trials(const Wlsp& fit, DiagnosisWorkspace& workspace) noexcept
      : fit_(fit), workspace_(workspace) {}

  /// @returns chi2/dof with the fault taken out; infinity-like where there is no device then.
  double reduced(Fault fault, double value) noexcept {
    constexpr double kNoDevice = 1e300;
    workspace_.response.clear();
    for (const ResponsePoint& point : fit_.response().points()) {
      (void)workspace_.response.add(without(fault, value, point));
    }
    (void)workspace_.response.set_common(fit_.response().common());
    (void)workspace_.response.set_shared(fit_.response().shared());
    const Status status = workspace_.fit.fit(workspace_.response);
    const WlspFit& result = workspace_.fit.result();
    const bool is_device = status == Status::kOk || (status == Status::kNotPhysical &&
                                                     result.mu[0] > 0.0 && result.mu[2] > 0.0);
    return is_device && result.dof > 0 ? result.chi2 / result.dof : kNoDevice;
  }

  /// The damping of the fit made last.
  double damping() const noexcept { return workspace_.fit.result().model.damping; }

  /// The best value in [low, high] by a golden section.
  double refine(Fault fault, double low, double high) noexcept {
    constexpr double kGolden = 0.6180339887498949;
    double left = high - kGolden * (high - low);
    double right = low + kGolden * (high - low);
    double at_left = reduced(fault, left);
    double at_right = reduced(fault, right);
    for (int i = 0; i < kRefinements; ++i) {
      if (at_left < at_right) {
        high = right;
        right = left;
        at_right = at_left;
        left = high - kGolden * (high - low);
        at_left = reduced(fault, left);
      } else {
        low = left;
        left = right;
        at_left = at_right;
        right = low + kGolden * (high - low);
        at_right = reduced(fault, right);
      }
    }
    return at_left < at_right ? left : right;
  }

  double best_delay() noexcept {
    const Span<const ResponsePoint> points = fit_.response().points();
    const double step_s = 1.0 / (points[points.size() - 1].frequency_hz * kStepsPerPeriod);
    const int most = static_cast<int>(kPeriods) * kStepsPerPeriod;
    double best_s = 0.0;
    double least = reduced(Fault::kDelay, 0.0);
    for (int i = -most; i <= most; ++i) {
      const double delay_s = i * step_s;
      const double now = reduced(Fault::kDelay, delay_s);
      if (now < least) {
        least = now;
        best_s = delay_s;
      }
    }
    return refine(Fault::kDelay, best_s - step_s, best_s + step_s);
  }

  double best_corner() noexcept {
    constexpr double kLn10 = 2.302585092994046;
    const double ratio = exp(kLn10 / kCornersPerDecade);
    double corner_hz = 0.01 * fit_.response().points()[0].frequency_hz;
    double best_hz = corner_hz;
    double least = reduced(Fault::kCoupling, corner_hz);
    for (int i = 0; i < kDecades * kCornersPerDecade; ++i) {
      corner_hz *= ratio;
      const double now = reduced(Fault::kCoupling, corner_hz);
      if (now < least) {
        least = now;
        best_hz = corner_hz;
      }
    }
    return refine(Fault::kCoupling, best_hz / ratio, best_hz * ratio);
  }

 private:
  const Wlsp& fit_;
  DiagnosisWorkspace& workspace_;
};

bool has_negative_damping(const WlspFit& fit) noexcept {
  return fit.status == Status::kNotPhysical && fit.mu[0] > 0.0 && fit.mu[2] > 0.0 &&
         fit.model.damping + 2.0 * fit.u_damping < 0.0;
}

bool may_be_radians(const FrequencyResponse& response) noexcept {
  for (const ResponsePoint& point : response.points()) {
    const ResponsePoint turned = without(Fault::kRadians, 1.0, point);
    if (abs(point.phase_rad) > kTurnOfRadians_rad || !is_phase_known(turned)) {
      return false;
    }
  }
  return true;
}

bool has_tiny_phases(const Wlsp& fit) noexcept {
  for (const ResponsePoint& point : fit.response().points()) {
    if (point.u_phase_rad > kNoOnesPhase_rad) {
      return false;
    }
  }
  return fit.result().status == Status::kOk && fit.result().model.damping < kNoSensorsDamping;
}

// What explains the points: the cause that leaves least, if that is little.
void find_cause(const Wlsp& fit, Trials& trials, FitDiagnosis& diagnosis) noexcept {
  constexpr double kNever = 1e300;
  const double delay_s = trials.best_delay();
  const double with_delay = trials.reduced(Fault::kDelay, delay_s);
  const double corner_hz = trials.best_corner();
  const double with_corner = trials.reduced(Fault::kCoupling, corner_hz);
  const bool is_candidate = may_be_radians(fit.response());
  const double with_radians = is_candidate ? trials.reduced(Fault::kRadians, 1.0) : kNever;
  diagnosis.damping = is_candidate ? trials.damping() : 0.0;
  const double of_chain = with_delay < with_corner ? with_delay : with_corner;
  const double best = with_radians < of_chain ? with_radians : of_chain;
  if (!(best < kConvincing * diagnosis.reduced_before || best < kGood)) {
    return;
  }
  diagnosis.reduced_after = best;
  if (with_radians < of_chain) {
    diagnosis.cause = FitCause::kRadians;
  } else if (with_delay < with_corner) {
    diagnosis.cause = FitCause::kDelay;
    diagnosis.delay_s = delay_s;
  } else {
    diagnosis.cause = FitCause::kCoupling;
    diagnosis.corner_hz = corner_hz;
  }
}

}  // namespace

FitDiagnosis diagnose(const Wlsp& fit, DiagnosisWorkspace& workspace) noexcept {
  FitDiagnosis diagnosis;
  const WlspFit& result = fit.result();
  const FrequencyResponse& response = fit.response();
  if (response.size() < 3 || response.known_phases() < response.size() || result.dof == 0) {
    return diagnosis;
  }
  diagnosis.reduced_before = result.chi2 / result.dof;
  const bool is_suspicious = diagnosis.reduced_before > kSuspicious;
  Trials trials(fit, workspace);
  if (is_suspicious) {
    find_cause(fit, trials, diagnosis);
  }
  if (diagnosis.cause == FitCause::kNone && has_negative_damping(result)) {
    diagnosis.cause = FitCause::kPhaseSign;
    diagnosis.reduced_after = diagnosis.reduced_before;
  }
  if (!is_suspicious && has_tiny_phases(fit) && may_be_radians(response)) {
    const double after = trials.reduced(Fault::kRadians, 1.0);
    diagnosis.cause = after < kSuspicious ? FitCause::kMayBeRadians : diagnosis.cause;
    diagnosis.reduced_after = after;
    diagnosis.damping = trials.damping();
  }
  return diagnosis;
}

}  // namespace emax
