// The largest energy over the dampings that points leave open.
#include "emax/app/evaluate/cut_range.hpp"

namespace emax::app {

void CutRange::start(const ModalModel& at_estimate, const FitJudgement& judgement,
                     const SearchSettings& settings, bool gain_follows) noexcept {
  *this = CutRange();
  model_ = at_estimate;
  judgement_ = judgement;
  settings_ = settings;
  gain_follows_ = gain_follows;
}

Accelerometer CutRange::device_at(std::size_t corner) const noexcept {
  constexpr double kCoverage = 2.0;
  const Accelerometer& estimate = judgement_.device;
  const bool is_least_damped = corner < 2;
  const double damping = is_least_damped ? judgement_.damping_low : judgement_.damping_high;
  const double moved = damping - estimate.damping;
  const double by_u = is_least_damped ? kCoverage : -kCoverage;
  const double by_u_f0 = corner % 2 == 0 ? kCoverage : -kCoverage;
  return {
      estimate.sensitivity + judgement_.sensitivity_slope * moved + by_u * judgement_.u_sensitivity,
      estimate.natural_frequency_hz + judgement_.frequency_slope_hz * moved +
          by_u_f0 * judgement_.u_natural_frequency_hz,
      damping};
}

void CutRange::give_up(Status status) noexcept {
  status_ = status;
  corner_ = kCorners;
}

void CutRange::step(EnergySearch& search, GridWorkspace& grid) noexcept {
  if (done()) {
    return;
  }
  if (!is_searching_) {
    const Accelerometer device = device_at(corner_);
    Status status = model_.set_device(device);
    if (status == Status::kOk && gain_follows_) {
      status = model_.set_gain(device.sensitivity);
    }
    if (status == Status::kOk) {
      status = search.start(model_, settings_);
    }
    if (status != Status::kOk) {
      give_up(status);
    }
    is_searching_ = true;
    return;
  }
  const Status status = search.step(model_, grid);
  if (status != Status::kOk) {
    give_up(status);
    return;
  }
  if (!search.done()) {
    return;
  }
  const double energy = search.result().energy;
  low_ = corner_ == 0 || energy < low_ ? energy : low_;
  high_ = corner_ == 0 || energy > high_ ? energy : high_;
  is_searching_ = false;
  ++corner_;
}

}  // namespace emax::app
