// Draws a device and climbs from the estimate's best signal.
#include "emax/energy_trials.hpp"

#include "emax/distributions.hpp"
#include "emax/refinement.hpp"

namespace emax {
namespace {

Accelerometer corner(const Accelerometer& estimate, const ParameterBox& box, double side) noexcept {
  return {estimate.sensitivity + side * box.sensitivity,
          estimate.natural_frequency_hz + side * box.natural_frequency_hz,
          estimate.damping + side * box.damping};
}

}  // namespace

Status EnergyTrials::start(const ModalModel& at_estimate, const MaximumEnergy& best,
                           const TrialSettings& settings) noexcept {
  const ParameterBox& box = settings.box;
  if (!(box.sensitivity >= 0.0) || !(box.natural_frequency_hz >= 0.0) || !(box.damping >= 0.0)) {
    return Status::kInvalidArgument;
  }
  const Status low_status = validate(corner(at_estimate.device(), box, -1.0));
  if (low_status != Status::kOk) {
    return low_status;
  }
  const Status high_status = validate(corner(at_estimate.device(), box, 1.0));
  if (high_status != Status::kOk) {
    return high_status;
  }
  PhiOperator phi;
  const Status status = phi.set(at_estimate, settings.search.duration_s, best.cells);
  if (status != Status::kOk) {
    return status;
  }
  model_ = at_estimate;
  phi_ = phi;
  best_signal_ = best.signal;
  settings_ = settings;
  estimate_ = at_estimate.device();
  generator_ = settings.generator;
  next_trial_ = 0;
  cells_ = best.cells;
  return Status::kOk;
}

Accelerometer EnergyTrials::device(std::uint32_t trial) noexcept {
  if (trial != next_trial_) {
    generator_ = settings_.generator;
    generator_.jump(std::uint64_t{3} * trial);
  }
  next_trial_ = trial + 1;
  const ParameterBox& box = settings_.box;
  const auto draw = [this](double estimate, double half_width) {
    return uniform_in(estimate - half_width, estimate + half_width, generator_.next());
  };
  Accelerometer device;
  device.sensitivity = draw(estimate_.sensitivity, box.sensitivity);
  device.natural_frequency_hz = draw(estimate_.natural_frequency_hz, box.natural_frequency_hz);
  device.damping = draw(estimate_.damping, box.damping);
  return device;
}

double EnergyTrials::energy(std::uint32_t trial, GridWorkspace& workspace) noexcept {
  return energy_of(device(trial), workspace);
}

double EnergyTrials::energy_of(const Accelerometer& device, GridWorkspace& workspace) noexcept {
  // Neither call can fail: `start()` has seen that the whole box is valid.
  (void)model_.set_device(device);
  if (settings_.gain_follows) {
    (void)model_.set_gain(device.sensitivity);
  }
  if (settings_.search.method == Method::kBest) {
    SwitchingSignal signal = best_signal_;
    return refine(model_, signal, workspace.refinement()).energy;
  }
  (void)phi_.set(model_, settings_.search.duration_s, cells_);
  const Span<std::int8_t> signs = workspace.signs(cells_);
  const Span<double> product = workspace.product(cells_, false);
  signs_of_column(phi_, 0, signs, product);
  return run_fixed_point(phi_, settings_.search.max_iterations, 0.0, signs,
                         workspace.best_signs(cells_), product, Span<double>())
      .energy;
}

}  // namespace emax
