// Full searches for some of the Monte Carlo trials, in case another signal has become the best.
#include "emax/energy_guard.hpp"

#include "emax/elementary.hpp"

namespace emax {

void EnergyGuard::start(std::uint32_t trial_count, std::uint32_t trial_of_maximum) noexcept {
  *this = EnergyGuard();
  trial_count_ = trial_count;
  trial_of_maximum_ = trial_of_maximum;
  wanted_ = kSearches;
}

double EnergyGuard::progress() const noexcept {
  return wanted_ == 0 ? 1.0 : static_cast<double>(made_) / static_cast<double>(wanted_);
}

/// The middles of kSpread equal parts of all trials, then the maximum.
std::uint32_t EnergyGuard::trial_number() const noexcept {
  if (made_ == kSpread) {
    return trial_of_maximum_;
  }
  return static_cast<std::uint32_t>(std::uint64_t{trial_count_} * (2 * made_ + 1) / (2 * kSpread));
}

Status EnergyGuard::end_search(Status status) noexcept {
  searching_ = false;
  ++made_;
  disagreements_ += status != Status::kOk ? 1 : 0;
  return status;
}

Status EnergyGuard::step(EnergyTrials& trials, EnergySearch& search,
                         GridWorkspace& workspace) noexcept {
  if (done()) {
    return Status::kOk;
  }
  if (!searching_) {
    const Accelerometer device = trials.device(trial_number());
    trial_energy_ = trials.energy_of(device, workspace) / trials.scale_of(device);
    const Status status = search.start(trials.model(), trials.search_settings(), workspace);
    searching_ = status == Status::kOk;
    return searching_ ? status : end_search(status);
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
  disagreements_ += excess > kTolerance ? 1 : 0;
  return end_search(status);
}

}  // namespace emax
