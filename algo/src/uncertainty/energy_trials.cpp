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
  const bool has_room = settings.pieces.size() >= kPieces;
  pieces_ = has_room ? settings.pieces.first(kPieces) : Span<EnergyBranches>();
  pieces_ready_ = 0;
  piece_ = 0;
  begun_piece_ = 0;
  return Status::kOk;
}

void EnergyTrials::prepare(EnergySearch& search, GridWorkspace& workspace) noexcept {
  if (ready()) {
    return;
  }
  if (!branches_.is_ready()) {
    branches_.prepare(draws_, search, workspace);
    return;
  }
  const BranchNotes notes = branches_.notes();
  if (branches_.is_predicted() || notes.degree == 0) {
    pieces_ = Span<EnergyBranches>();
    return;
  }
  prepare_piece(workspace);
}

/// Parts of equal size: along f0 first, then along damping.
void EnergyTrials::prepare_piece(GridWorkspace& workspace) noexcept {
  EnergyBranches& piece = pieces_[pieces_ready_];
  if (begun_piece_ == pieces_ready_) {
    ++begun_piece_;
    constexpr double kF0 = 1.0 / static_cast<double>(kCutsOfFrequency);
    constexpr double kDamping = 1.0 / static_cast<double>(kCutsOfDamping);
    const auto of_f0 = static_cast<double>(2 * (pieces_ready_ % kCutsOfFrequency) + 1);
    const auto of_damping = static_cast<double>(2 * (pieces_ready_ / kCutsOfFrequency) + 1);
    piece.start_piece(branches_, {0.0, kF0 * of_f0 - 1.0, kDamping * of_damping - 1.0},
                      {1.0, kF0, kDamping});
    return;
  }
  piece.prepare_piece(branches_, draws_, workspace);
  pieces_ready_ += piece.is_ready() ? 1U : 0U;
}

double EnergyTrials::progress() const noexcept {
  if (is_paper()) {
    return 1.0;
  }
  // Whether there will be pieces is known once the whole is ready.
  constexpr double kWhole = 0.5;
  const double whole = branches_.progress();
  if (pieces_.empty() || ready()) {
    return whole;
  }
  return kWhole * (whole + static_cast<double>(pieces_ready_) / static_cast<double>(kPieces));
}

bool EnergyTrials::predicts() const noexcept {
  if (is_paper()) {
    return false;
  }
  bool all = !pieces_.empty();
  for (const EnergyBranches& piece : pieces_) {
    all = all && piece.is_predicted();
  }
  return all || branches_.is_predicted();
}

double EnergyTrials::tolerance() const noexcept {
  double tolerance = branches_.tolerance();
  for (const EnergyBranches& piece : pieces_) {
    tolerance = piece.tolerance() > tolerance ? piece.tolerance() : tolerance;
  }
  return tolerance;
}

BranchNotes EnergyTrials::notes() const noexcept {
  BranchNotes notes = branches_.notes();
  for (const EnergyBranches& piece : pieces_) {
    const BranchNotes of_piece = piece.notes();
    ++notes.pieces;
    if (of_piece.predicted == of_piece.branches) {
      ++notes.pieces_predicted;
    }
    notes.is_crowded = notes.is_crowded || of_piece.is_crowded;
  }
  return notes;
}

/// The polynomials that hold at a place: those of its piece, if there are pieces.
EnergyBranches& EnergyTrials::branches_at(const DeviceDraws::Place& place) noexcept {
  piece_ = 0;
  if (pieces_.empty() || pieces_ready_ != pieces_.size() || !branches_.is_within_reach(place)) {
    return branches_;
  }
  const CubePoint point = branches_.to_point(place);
  const auto part = [](double x, std::size_t cuts) {
    const double position = 0.5 * (x + 1.0) * static_cast<double>(cuts);
    const std::size_t index = position > 0.0 ? static_cast<std::size_t>(position) : 0;
    return index < cuts ? index : cuts - 1;
  };
  const std::size_t index =
      part(point[1], kCutsOfFrequency) + kCutsOfFrequency * part(point[2], kCutsOfDamping);
  piece_ = index + 1;
  return pieces_[index];
}

/// The branches that the trial asks.
EnergyBranches& EnergyTrials::asked() noexcept {
  return piece_ == 0 ? branches_ : pieces_[piece_ - 1];
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
    branches_at(place).begin(place);
  } else {
    piece_ = 0;
    branches_.begin();
  }
  done_ = asked().done();
  energy_ = asked().energy();
  if (!done_) {
    asked().begin_refinement(draws_, device, workspace);
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
  EnergyBranches& branches = branches_at(draws_.place());
  branches.begin(draws_.place());
  done_ = branches.done();
  energy_ = branches.energy();
  if (!done_) {
    // Seldom, and only then needed.
    branches.begin_refinement(draws_, draws_.device(), workspace);
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
    EnergyBranches& branches = asked();
    branches.step(draws_, workspace);
    energy_ = branches.energy();
    done_ = branches.done();
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
