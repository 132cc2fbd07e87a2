// Cuts the ranges of trials where the polynomials of the whole do not hold, or lays a surface.
#include <algorithm>

#include "emax/uncertainty/energy_trials.hpp"

namespace emax {
namespace {

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
/// The refinements times switches that all trials together are worth: 0.3 s on a PC.
constexpr double kMostWorkOfTrials = 3e4;
constexpr double kLeastWork = 1e-3;
/// So many trials show how many are refined.
constexpr std::uint32_t kTried = 256;
/// From this part of the standard deviation on a polynomial of the whole ranges is worth a cut.
constexpr double kRough = 1e-4;

}  // namespace

TrialPieces::TrialPieces(Span<TrialPiece> memory, ResonanceSurface* surface) noexcept {
  surface_ = surface;
  prepare_ = &EnergyTrials::prepare_pieces;
  if (memory.size() >= EnergyTrials::kFirstPieces) {
    memory_ = memory;
  }
}

/// A step of the surface; where it fails, branches begin.
void EnergyTrials::prepare_surface(EnergySearch& search, GridWorkspace& workspace) noexcept {
  if (!has_begun_surface_) {
    surface_->start(draws_, search_.duration_s, estimate_energy_);
    has_begun_surface_ = true;
  }
  surface_->step(draws_, branches_, search, workspace);
  if (surface_->has_failed()) {
    surface_ = nullptr;
  } else if (surface_->is_done()) {
    branches_.stand_for_surface(surface_->tolerance(), surface_->rough_part());
    pieces_ = Span<TrialPiece>();
    ask_ = &EnergyTrials::ask_surface;
  }
}

/// @param[in] device Null: the one drawn last.
double EnergyTrials::ask_surface(EnergyTrials& trials, const Accelerometer* device,
                                 GridWorkspace& workspace) noexcept {
  const ResonanceSurface& surface = *trials.surface_;
  trials.rough_ += device == nullptr && trials.draws_.is_first_time() ? 1U : 0U;
  const Accelerometer asked = device == nullptr ? trials.draws_.device() : *device;
  if (surface.reaches(asked)) {
    return surface.energy(asked);
  }
  trials.set_model(asked);
  return resonant_energy(trials.model(), trials.search_.duration_s, workspace);
}

/// A step: of the surface, of the first cut, if one is worth it, or of a piece.
void EnergyTrials::prepare_pieces(EnergyTrials& trials, EnergySearch& search,
                                  GridWorkspace& workspace) noexcept {
  if (trials.surface_ != nullptr) {
    trials.prepare_surface(search, workspace);
    return;
  }
  if (trials.pieces_used_ == 0) {
    const EnergyBranches& whole = trials.branches_;
    if (whole.is_accurate() || whole.notes().degree == 0 || !trials.is_worth_pieces()) {
      trials.pieces_ = Span<TrialPiece>();
      trials.limit_trials();
      return;
    }
    trials.begin_pieces();
  }
  trials.prepare_piece(workspace);
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

/// The part of the trials that is refined with what is ready.
double EnergyTrials::refined_part() noexcept {
  DeviceDraws draws = draws_;
  std::uint32_t refined = 0;
  for (std::uint32_t trial = 0; trial < kTried; ++trial) {
    if (draws.draw(trial)) {
      EnergyBranches& branches = branches_at(draws.place());
      branches.begin(draws.place());
      refined += branches.done() ? 0U : 1U;
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
  if (++pieces_ready_ == pieces_used_) {
    limit_trials();
  }
}

/// Few enough that those of them that are refined take a fraction of a second on a PC.
void EnergyTrials::limit_trials() noexcept {
  if (predicts()) {
    return;
  }
  const double work = refined_part() * static_cast<double>(branches_.most_switches() + 1);
  const double most = kMostWorkOfTrials / std::max(work, kLeastWork);
  most_trials_ = std::max(static_cast<std::uint32_t>(most), kFewestTrials);
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

}  // namespace emax
