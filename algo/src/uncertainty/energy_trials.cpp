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
  pieces_ = settings.pieces.memory_;
  prepare_pieces_ = settings.pieces.prepare_;
  if (!pieces_.empty()) {
    branches_.expect_pieces();
  }
  surface_ = best.signal.count() < EnergySearch::kManySwitches ? nullptr : settings.pieces.surface_;
  most_trials_ = std::numeric_limits<std::uint32_t>::max();
  ask_ = nullptr;
  has_begun_surface_ = false;
  estimate_energy_ = best.energy;
  pieces_used_ = 0;
  work_of_pieces_ = 0;
  expected_trials_ = settings.expected_trials;
  work_saved_ = 0.0;
  rough_ = 0;
  pieces_begun_ = 0;
  pieces_ready_ = 0;
  piece_ = 0;
  return Status::kOk;
}

void EnergyTrials::prepare(EnergySearch& search, GridWorkspace& workspace) noexcept {
  if (ready()) {
    return;
  }
  if (surface_ == nullptr && !branches_.is_ready()) {
    branches_.prepare(draws_, search, workspace);
    return;
  }
  prepare_pieces_(*this, search, workspace);
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
  // How many are cut is not known either: there is room for no more.
  return kWhole *
         (whole + static_cast<double>(pieces_ready_) / static_cast<double>(pieces_.size()));
}

bool EnergyTrials::predicts() const noexcept {
  if (is_paper()) {
    return false;
  }
  bool all = pieces_used_ != 0;
  for (const TrialPiece& piece : pieces_.first(pieces_used_)) {
    all = all && (piece.child != 0 || piece.branches.is_predicted());
  }
  return all || branches_.is_predicted();
}

double EnergyTrials::tolerance() const noexcept {
  double tolerance = pieces_used_ == 0 ? branches_.tolerance() : 0.0;
  for (const TrialPiece& piece : pieces_.first(pieces_used_)) {
    if (piece.child == 0 && piece.branches.tolerance() > tolerance) {
      tolerance = piece.branches.tolerance();
    }
  }
  return tolerance;
}

BranchNotes EnergyTrials::notes() const noexcept {
  const auto rough_part = [](const BranchNotes& so_far, const EnergyBranches& branches) {
    const auto part = static_cast<float>(branches.rough_part());
    return part > so_far.rough_part ? part : so_far.rough_part;
  };
  BranchNotes notes = branches_.notes();
  notes.rough_trials = rough_;
  notes.rough_part = pieces_used_ == 0 ? rough_part(notes, branches_) : 0.0F;
  for (const TrialPiece& piece : pieces_.first(pieces_used_)) {
    if (piece.child != 0) {
      continue;
    }
    ++notes.pieces;
    if (piece.branches.is_predicted()) {
      ++notes.pieces_predicted;
    }
    notes.is_crowded = notes.is_crowded || piece.branches.notes().is_crowded;
    notes.rough_part = rough_part(notes, piece.branches);
  }
  return notes;
}

/// The polynomials that hold at a place: those of its piece, if there are pieces.
EnergyBranches& EnergyTrials::branches_at(const DeviceDraws::Place& place) noexcept {
  piece_ = 0;
  if (!is_cut() || !branches_.is_within_reach(place)) {
    return branches_;
  }
  const CubePoint point = branches_.to_point(place);
  const double position = 0.5 * (point[first_axis_] + 1.0) * static_cast<double>(kFirstPieces);
  std::size_t index = position > 0.0 ? static_cast<std::size_t>(position) : 0;
  index = index < kFirstPieces ? index : kFirstPieces - 1;
  for (std::size_t child = pieces_[index].child; child != 0; child = pieces_[index].child) {
    const std::size_t axis = pieces_[index].axis;
    index = child + (point[axis] < pieces_[index].middle[axis] ? 0 : 1);
  }
  piece_ = index + 1;
  return pieces_[index].branches;
}

/// The branches that the trial asks.
EnergyBranches& EnergyTrials::asked() noexcept {
  return piece_ == 0 ? branches_ : pieces_[piece_ - 1].branches;
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

EnergyTrials EnergyTrials::share(std::uint32_t first, Span<TrialPiece> pieces) const noexcept {
  EnergyTrials share = *this;
  share.draws_.start_share(first);
  share.rough_ = 0;
  for (std::size_t i = 0; i < pieces_used_; ++i) {
    pieces[i] = pieces_[i];
  }
  share.pieces_ = pieces_.empty() ? Span<TrialPiece>() : pieces;
  return share;
}

void EnergyTrials::join(const EnergyTrials& share) noexcept {
  draws_.join(share.draws_);
  rough_ += share.rough_;
  is_exhausted_ = is_exhausted_ || share.is_exhausted_;
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
  if (has_surface()) {
    energy_ = ask_(*this, &device, workspace);
    return energy();
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
  if (has_surface()) {
    energy_ = ask_(*this, nullptr, workspace);
    done_ = true;
    return;
  }
  EnergyBranches& branches = branches_at(draws_.place());
  branches.begin(draws_.place());
  done_ = branches.done();
  energy_ = branches.energy();
  rough_ += done_ && draws_.is_first_time() && branches.rough_part() > 0.0 ? 1U : 0U;
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
