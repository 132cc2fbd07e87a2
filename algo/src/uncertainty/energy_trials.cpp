// Draws a device, and asks what its largest energy is.
#include "emax/uncertainty/energy_trials.hpp"

#include <limits>

#include "emax/base/elementary.hpp"
#include "emax/energy/phi_operator.hpp"

namespace emax {
namespace {

/// What trials cost, in cells of a product.
constexpr std::size_t kWorkOfDraws = 2;
constexpr std::size_t kWorkOfPolynomial = 2;
constexpr std::size_t kWorkOfRefinement = 32;

/// Whether two values are the same but for rounding of a place and back.
bool is_same(double a, double b) noexcept {
  constexpr double kRounding = 1e-12;
  return abs(a - b) <= kRounding * abs(b);
}

bool is_same(const Accelerometer& a, const Accelerometer& b, bool without_sensitivity) noexcept {
  return (without_sensitivity || is_same(a.sensitivity, b.sensitivity)) &&
         is_same(a.natural_frequency_hz, b.natural_frequency_hz) && is_same(a.damping, b.damping);
}

/// Leaves S no uncertainty.
void hold_sensitivity(DrawSettings& settings) noexcept {
  settings.box.sensitivity = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    settings.covariance[0][i] = 0.0;
    settings.covariance[i][0] = 0.0;
  }
}

}  // namespace

Status EnergyTrials::start(const ModalModel& at_estimate, const MaximumEnergy& best,
                           const TrialSettings& settings) noexcept {
  if (!(settings.search.duration_s > 0.0) || best.cells == 0) {
    return Status::kInvalidArgument;
  }
  if (settings.search.method == Method::kPaper && best.cells > GridWorkspace::kMaxTrialCells) {
    return Status::kTooManyCells;
  }
  DrawSettings drawn = settings;
  if (settings.holds_sensitivity) {
    hold_sensitivity(drawn);
  }
  const Status status = draws_.start(at_estimate.device(), drawn);
  if (status != Status::kOk) {
    return status;
  }
  search_ = settings.search;
  gain_follows_ = settings.gain_follows;
  inverse_sensitivity_ = 1.0 / at_estimate.device().sensitivity;
  cells_ = best.cells;
  is_exhausted_ = false;
  branches_.start(at_estimate, best, draws_, search_, gain_follows_);
  return Status::kOk;
}

void EnergyTrials::prepare(EnergySearch& search, GridWorkspace& workspace) noexcept {
  if (!ready()) {
    branches_.prepare(draws_, search, workspace);
  }
}

Accelerometer EnergyTrials::device(std::uint32_t trial) noexcept {
  is_exhausted_ = !draws_.draw(trial) || is_exhausted_;
  return draws_.device();
}

double EnergyTrials::scale_of(const Accelerometer& device) const noexcept {
  const double ratio = device.sensitivity * inverse_sensitivity_;
  return gain_follows_ ? ratio * ratio : 1.0;
}

std::size_t EnergyTrials::work() const noexcept {
  if (is_paper()) {
    return cells_;
  }
  return predicts() ? kWorkOfDraws + kWorkOfPolynomial * branches_.notes().branches
                    : kWorkOfRefinement * (branches_.most_switches() + 1);
}

double EnergyTrials::energy(std::uint32_t trial, GridWorkspace& workspace) noexcept {
  begin(trial, workspace);
  return run(workspace);
}

double EnergyTrials::energy_of(const Accelerometer& device, GridWorkspace& workspace) noexcept {
  scale_ = scale_of(device);
  if (is_paper()) {
    begin_fixed_point(device, workspace);
    return run(workspace);
  }
  const DeviceDraws::Place place = draws_.place_of(device);
  if (is_same(draws_.device_at(place), device, gain_follows_)) {
    branches_.begin(place);
  } else {
    branches_.begin();
  }
  done_ = branches_.done();
  energy_ = branches_.energy();
  if (!done_) {
    branches_.begin_refinement(draws_, device, workspace);
  }
  return run(workspace);
}

double EnergyTrials::run(GridWorkspace& workspace) noexcept {
  while (!done()) {
    step(workspace);
  }
  return energy();
}

void EnergyTrials::begin(std::uint32_t trial, GridWorkspace& workspace) noexcept {
  scale_ = 1.0;
  if (!draws_.draw(trial)) {
    is_exhausted_ = true;
    energy_ = std::numeric_limits<double>::quiet_NaN();
    done_ = true;
    return;
  }
  if (gain_follows_) {
    const double ratio = draws_.sensitivity() * inverse_sensitivity_;
    scale_ = ratio * ratio;
  }
  if (is_paper()) {
    begin_fixed_point(draws_.device(), workspace);
    return;
  }
  branches_.begin(draws_.place());
  done_ = branches_.done();
  energy_ = branches_.energy();
  if (!done_) {
    branches_.begin_refinement(draws_, draws_.device(),
                               workspace);  // Seldom, and only then needed.
  }
}

void EnergyTrials::begin_fixed_point(const Accelerometer& device,
                                     GridWorkspace& workspace) noexcept {
  done_ = false;
  branches_.set_device(device);
  PhiOperator phi;
  (void)phi.set(model(), search_.duration_s, cells_);
  signs_of_column(phi, 0, workspace.signs(cells_), workspace.product(cells_));
  fixed_point_.start(search_.max_iterations, 0.0);
}

void EnergyTrials::step(GridWorkspace& workspace) noexcept {
  if (!is_paper()) {
    branches_.step(draws_, workspace);
    energy_ = branches_.energy();
    done_ = branches_.done();
    return;
  }
  PhiOperator phi;
  (void)phi.set(model(), search_.duration_s, cells_);
  fixed_point_.step(phi, workspace.signs(cells_), workspace.best_signs(cells_),
                    workspace.product(cells_), Span<double>());
  energy_ = fixed_point_.result().energy;
  done_ = fixed_point_.done();
}

}  // namespace emax
