// How far a sweep is, and its points as a table for the fit.
#include "emax/app/measure/sweep_results.hpp"

namespace emax::app {

double SweepResults::progress() const noexcept {
  if (stage == SweepStage::kDone) {
    return 1.0;
  }
  const double all = static_cast<double>(settings.frequency_count) + 2.0;
  const double checks = check_before.re == 0.0 && check_before.im == 0.0 ? 0.0 : 1.0;
  return (static_cast<double>(point_count) + checks) / all;
}

bool SweepResults::has_measured(Span<const ResponsePoint> any) const noexcept {
  for (const ResponsePoint& one : any) {
    for (const SweepPoint& own : points()) {
      if (one.amplitude == own.point.amplitude && one.frequency_hz == own.point.frequency_hz) {
        return true;
      }
    }
  }
  return false;
}

Status SweepResults::copy_to(FrequencyResponse& response) const noexcept {
  response.clear();
  if (stage != SweepStage::kDone && stage != SweepStage::kFailed) {
    return Status::kNotRunning;
  }
  for (const SweepPoint& point : points()) {
    const Status added = response.add(point.point);
    if (added != Status::kOk) {
      response.clear();
      return added;
    }
  }
  const Status set = response.set_shared(shared);
  return set == Status::kOk ? response.set_common(common.total) : set;
}

}  // namespace emax::app
