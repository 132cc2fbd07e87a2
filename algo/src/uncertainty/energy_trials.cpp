// Draws a device, and asks what its largest energy is.
#include "emax/uncertainty/energy_trials.hpp"

#include <algorithm>
#include <limits>

#include "emax/base/elementary.hpp"
#include "emax/energy/phi_operator.hpp"

namespace emax {
namespace {

/// What trials cost, in cells of a product.
constexpr std::size_t kWorkOfDraws = 2;
constexpr std::size_t kWorkOfPolynomial = 2;
constexpr std::size_t kWorkOfRefinement = 32;
/// The share of the draws in a piece. To cut it costs some 500 refinements, as much as a part of
/// 2e5 trials in it would.
constexpr double kWorthCutting = 1.0 / 256.0;
/// The most refinements times switches that the first pieces, and all of them, are worth at least,
/// whatever they save: half a second on a PC.
constexpr double kMostWorkOfFirst = 1e5;
constexpr double kMostWorkOfPieces = 2.5e5;
/// The parts of what they save that they are worth.
constexpr double kWorthOfFirst = 0.1;
constexpr double kWorthOfPieces = 0.25;
/// So many trials show how many are refined.
constexpr std::uint32_t kTried = 256;
/// From this part of the standard deviation on a polynomial of the whole ranges is worth a cut.
constexpr double kRough = 1e-4;

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
  pieces_ = settings.pieces.size() >= kFirstPieces ? settings.pieces : Span<TrialPiece>();
  if (!pieces_.empty()) {
    branches_.expect_pieces();
  }
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
  if (!branches_.is_ready()) {
    branches_.prepare(draws_, search, workspace);
    return;
  }
  if (pieces_used_ == 0) {
    if (branches_.is_accurate() || branches_.notes().degree == 0 || !is_worth_pieces()) {
      pieces_ = Span<TrialPiece>();
      return;
    }
    begin_pieces();
  }
  prepare_piece(workspace);
}

/// Also says what pieces save.
bool EnergyTrials::is_worth_pieces() noexcept {
  const bool is_predicted = branches_.is_predicted();
  const bool is_rough = branches_.rough_part() > kRough;
  if (is_predicted && !is_rough) {
    return false;
  }
  work_saved_ = is_predicted ? 0.0
                             : refined_part() * static_cast<double>(expected_trials_) *
                                   static_cast<double>(branches_.most_switches() + 1);
  const std::size_t work = kFirstPieces * branches_.work_of_fit(EnergyBranches::kFirstDegree) /
                           branches_.notes().branches;
  return static_cast<double>(work) <= std::max(kMostWorkOfFirst, kWorthOfFirst * work_saved_);
}

/// The part of the trials that is refined without pieces.
double EnergyTrials::refined_part() noexcept {
  DeviceDraws draws = draws_;
  std::uint32_t refined = 0;
  for (std::uint32_t trial = 0; trial < kTried; ++trial) {
    if (draws.draw(trial)) {
      branches_.begin(draws.place());
      refined += branches_.done() ? 0U : 1U;
    }
  }
  return static_cast<double>(refined) / static_cast<double>(kTried);
}

/// Parts of equal size along f0 or damping.
void EnergyTrials::begin_pieces() noexcept {
  constexpr double kHalf = 1.0 / static_cast<double>(kFirstPieces);
  first_axis_ = branches_.roughest_axis();
  for (std::size_t i = 0; i < kFirstPieces; ++i) {
    TrialPiece& piece = pieces_[i];
    piece.child = 0;
    piece.middle = {0.0, 0.0, 0.0};
    piece.middle[first_axis_] = kHalf * static_cast<double>(2 * i + 1) - 1.0;
    piece.half = {1.0, 1.0, 1.0};
    piece.half[first_axis_] = kHalf;
    piece.parent = 0;
    piece.branches.start_piece(branches_, piece.middle, piece.half);
  }
  pieces_used_ = kFirstPieces;
  pieces_begun_ = kFirstPieces;
}

void EnergyTrials::prepare_piece(GridWorkspace& workspace) noexcept {
  TrialPiece& piece = pieces_[pieces_ready_];
  if (!piece.branches.is_ready()) {
    const EnergyBranches& seeds =
        piece.parent == 0 ? branches_ : pieces_[piece.parent - 1].branches;
    piece.branches.prepare_piece(seeds, draws_, workspace);
    return;
  }
  work_of_pieces_ += piece.branches.work_of_fit(EnergyBranches::kFirstDegree);
  if (is_worth_cutting(piece)) {
    cut(piece);
  }
  ++pieces_ready_;
}

bool EnergyTrials::is_worth_cutting(const TrialPiece& piece) const noexcept {
  if (piece.branches.is_accurate() || pieces_used_ + 2 > pieces_.size() ||
      static_cast<double>(work_of_pieces_) >
          std::max(kMostWorkOfPieces, kWorthOfPieces * work_saved_)) {
    return false;
  }
  double share = 1.0;
  for (std::size_t a = 1; a < 3; ++a) {
    share *=
        branches_.axes()[a] ? branches_.share_of_draws(a, piece.middle[a], piece.half[a]) : 1.0;
  }
  return share > kWorthCutting;
}

/// Across the axis along which the energy changes least smoothly.
void EnergyTrials::cut(TrialPiece& piece) noexcept {
  piece.axis = piece.branches.roughest_axis();
  piece.child = pieces_used_;
  for (const double side : {-0.5, 0.5}) {
    TrialPiece& child = pieces_[pieces_used_++];
    CubePoint middle = {};
    CubePoint half = {1.0, 1.0, 1.0};
    middle[piece.axis] = side;
    half[piece.axis] = 0.5;
    child.child = 0;
    child.parent = pieces_ready_ + 1;
    child.middle = piece.middle;
    child.middle[piece.axis] += side * piece.half[piece.axis];
    child.half = piece.half;
    child.half[piece.axis] *= 0.5;
    child.branches.start_piece(piece.branches, middle, half);
  }
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
