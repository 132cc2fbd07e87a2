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

enum class Fault : std::uint8_t { kDelay, kCoupling };

// What a fault of size `value` has added is taken out of one point.
ResponsePoint without(Fault fault, double value, ResponsePoint point) noexcept {
  if (fault == Fault::kDelay) {
    point.phase_rad += kTwoPi * point.frequency_hz * value;
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
    const Status status = workspace_.fit.fit(workspace_.response);
    const WlspFit& result = workspace_.fit.result();
    const bool is_device = status == Status::kOk || (status == Status::kNotPhysical &&
                                                     result.mu[0] > 0.0 && result.mu[2] > 0.0);
    return is_device && result.dof > 0 ? result.chi2 / result.dof : kNoDevice;
  }

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
  if (!is_suspicious && has_negative_damping(result)) {
    diagnosis.cause = FitCause::kPhaseSign;
    diagnosis.reduced_after = diagnosis.reduced_before;
    return diagnosis;
  }
  if (!is_suspicious) {
    return diagnosis;
  }
  Trials trials(fit, workspace);
  const double delay_s = trials.best_delay();
  const double with_delay = trials.reduced(Fault::kDelay, delay_s);
  const double corner_hz = trials.best_corner();
  const double with_corner = trials.reduced(Fault::kCoupling, corner_hz);
  const double best = with_delay < with_corner ? with_delay : with_corner;
  if (!(best < kConvincing * diagnosis.reduced_before || best < kGood)) {
    return diagnosis;
  }
  diagnosis.reduced_after = best;
  if (with_delay < with_corner) {
    diagnosis.cause = FitCause::kDelay;
    diagnosis.delay_s = delay_s;
  } else {
    diagnosis.cause = FitCause::kCoupling;
    diagnosis.corner_hz = corner_hz;
  }
  return diagnosis;
}

}  // namespace emax
