// Total minus common, point by point.
#include "emax/app/points/reference_uncertainty.hpp"

#include "emax/base/elementary.hpp"

namespace emax::app {

CommonRemoval remove_common(FrequencyResponse& response, double expanded_percent) noexcept {
  if (!(expanded_percent >= 0.0) || !(expanded_percent < 100.0)) {
    return {Status::kInvalidArgument, 0};
  }
  const double relative_u = expanded_percent / 200.0;
  if (relative_u == 0.0) {
    return {Status::kOk, 0};
  }
  FrequencyResponse result;
  for (std::size_t i = 0; i < response.size(); ++i) {
    ResponsePoint point = response.points()[i];
    const double common = relative_u * point.amplitude;
    const double square = (point.u_amplitude - common) * (point.u_amplitude + common);
    point.u_amplitude = square > 0.0 ? sqrt(square) : 0.0;
    if (result.add(point) != Status::kOk) {
      return {Status::kUncertaintyNotPositive, i};
    }
  }
  const Status status = result.set_common(relative_u);
  if (status == Status::kOk) {
    response = result;
  }
  return {status, 0};
}

}  // namespace emax::app
