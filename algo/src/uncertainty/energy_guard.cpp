// Full searches for some of the Monte Carlo trials, in case another signal has become the best.
#include "emax/uncertainty/energy_guard.hpp"

#include "emax/base/elementary.hpp"

namespace emax {

void EnergyGuard::start(std::uint32_t trial_count, std::uint32_t trial_of_maximum,
                        std::uint32_t spread) noexcept {
  *this = EnergyGuard();
  trial_count_ = trial_count;
  trial_of_maximum_ = trial_of_maximum;
  wanted_ = spread + 1;
}

double EnergyGuard::progress() const noexcept {
  return wanted_ == 0 ? 1.0 : static_cast<double>(made_) / static_cast<double>(wanted_);
}

/// The middles of equal parts of all trials, then the maximum.
std::uint32_t EnergyGuard::trial_number() const noexcept {
  const std::uint32_t spread = wanted_ - 1;
  if (made_ == spread) {
    return trial_of_maximum_;
  }
  return static_cast<std::uint32_t>(std::uint64_t{trial_count_} * (2 * made_ + 1) / (2 * spread));
}

Status EnergyGuard::end_search(Status status) noexcept {
  phase_ = Phase::kNext;
  ++made_;
  disagreements_ += status != Status::kOk ? 1 : 0;
  return status;
}

Status EnergyGuard::begin_search(EnergyTrials& trials, EnergySearch& search) noexcept {
  const Accelerometer device = trials.device(trial_number());
  trial_energy_ = trials.energy() / trials.scale_of(device);
  trials.set_model(device);
  const Status status = search.start(trials.model(), trials.search_settings());
  if (status != Status::kOk) {
    return end_search(status);
  }
  phase_ = Phase::kSearch;
  return status;
}

Status EnergyGuard::step(EnergyTrials& trials, EnergySearch& search,
                         GridWorkspace& workspace) noexcept {
  if (done()) {
    return Status::kOk;
  }
  if (phase_ != Phase::kSearch) {
    if (phase_ == Phase::kNext) {
      trials.begin(trial_number(), workspace);
      phase_ = Phase::kTrial;
    } else {
      trials.step(workspace);
    }
    return trials.done() ? begin_search(trials, search) : Status::kOk;
  }
  const Status status = search.step(trials.model(), workspace);
  if (status != Status::kOk) {
    return end_search(status);
  }
  if (!search.done()) {
    return status;
  }
  const double excess = (search.result().energy - trial_energy_) / abs(trial_energy_);
  largest_excess_ = excess > largest_excess_ ? excess : largest_excess_;
  const double tolerance = 2.0 * trials.tolerance();
  disagreements_ += excess > (tolerance > kTolerance ? tolerance : kTolerance) ? 1 : 0;
  return end_search(status);
}

}  // namespace emax
