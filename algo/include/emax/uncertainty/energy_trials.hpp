// One trial of the Monte Carlo procedure: the largest energy for a device drawn from its ranges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/status.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/uncertainty/device_draws.hpp"
#include "emax/uncertainty/energy_branches.hpp"
#include "emax/uncertainty/resonance_surface.hpp"

namespace emax {

/// A part of the ranges with branches of its own, or cut in two. 10.5 KiB.
struct TrialPiece {
  EnergyBranches branches = {};
  CubePoint middle = {};  ///< In the cube of the whole ranges.
  CubePoint half = {};
  std::size_t parent = 0;  ///< The piece that it is half of, counted from 1; 0 for none.
  std::size_t axis = 0;    ///< That it is cut across,
  std::size_t child = 0;   ///< into this piece and the next one; 0 if it is not.
};

class EnergyTrials;

/// Memory for polynomials of parts of the ranges and for a surface where signals ride on the
/// resonance, and the code that makes them: an image where nobody makes one of these of memory has
/// neither.
class TrialPieces {
 public:
  /// None.
  constexpr TrialPieces() noexcept = default;
  /// @param memory `EnergyTrials::kFirstPieces` and more; 96 are enough for most. Fewer are none.
  explicit TrialPieces(Span<TrialPiece> memory, ResonanceSurface* surface = nullptr) noexcept;

 private:
  friend class EnergyTrials;

  Span<TrialPiece> memory_;
  void (*prepare_)(EnergyTrials&, EnergySearch&, GridWorkspace&) = nullptr;
  ResonanceSurface* surface_ = nullptr;
};

struct TrialSettings : DrawSettings {
  bool gain_follows =
      false;  ///< The filter's gain is each trial's sensitivity, not the estimate's.
  /// S stays at its estimate, and only f0 and beta are drawn: whatever box or covariance say of S
  /// is left out. For figures in units of S, whose gain is S. Trials take as many numbers as else.
  bool holds_sensitivity = false;
  SearchSettings search;
  /// Where the polynomials of the whole do not hold: nobody else's while there are trials.
  TrialPieces pieces;
  /// How many trials there will be, if that is known: the more there are, the more pieces are cut
  /// where each trial is refined without them.
  std::uint32_t expected_trials = 0;
};

/// The trials of Fig. 5, in any order: `DeviceDraws` draws the device of a trial.
///
/// With `Method::kBest` a trial takes the largest of the energies that the signals which may be the
/// worst within the ranges have for its device (`EnergyBranches`): polynomials, or refinements
/// where these do not hold. With `Method::kPaper` each trial is a whole run of the fixed point from
/// Phi's first column.
///
/// Where a polynomial does not hold all over the ranges, as signals end and others begin, and there
/// is memory for `TrialSettings::pieces`, the ranges are cut along f0 (and damping), and each part
/// has branches and polynomials of its own; where these fail too, it is cut in two, as long as
/// more than 1/256 of the draws are in it and the pieces made so far have cost no more than a
/// quarter of the refinements that they save, as the first trials show (or half a second on a PC,
/// if that is more). What is left is refined.
///
/// Where the estimate's best signal has EnergySearch::kManySwitches and there is memory for a
/// `ResonanceSurface`, a trial takes its value; branches come where the surface fails.
///
/// With a gain that follows, the whole error system scales with S: the trial is done at the
/// estimate's S and multiplied by the square of their ratio.
///
///     trials.start(at_estimate, best, settings);
///     while (!trials.ready()) {
///       trials.prepare(search, workspace);
///     }
///     const double energy = trials.energy(0, workspace);
///
/// 11 KiB beside the workspace.
class EnergyTrials {
 public:
  /// The ranges are cut into as many parts along f0, and those in two where polynomials fail.
  static constexpr std::size_t kFirstPieces = 8;
  /// So many trials say where 95 % of the energies are to within 1 % of all trials (k = 2).
  static constexpr std::uint32_t kFewestTrials = 2000;
  /// Enough for most: 1.1 MB.
  static constexpr std::size_t kManyPieces = 96;

  /// @param[in] at_estimate The model of the estimate, with filter and criterion.
  /// @param[in] best        The search's result at the estimate, with the same search settings.
  /// @returns
  /// * kOk: `prepare()` until `ready()`.
  /// * kOverdamped, kInvalidArgument: As `DeviceDraws::start()`; or no search's result or duration.
  /// * kTooManyCells: kPaper, and more cells than there is room for beside a store:
  ///   GridWorkspace::kMaxTrialCells.
  /// Nothing has changed unless it is kOk.
  Status start(const ModalModel& at_estimate, const MaximumEnergy& best,
               const TrialSettings& settings) noexcept;

  /// A step of the searches and refinements that the polynomials are made of. Trials made before it
  /// is `ready()` refine the estimate's signal.
  ///
  /// @param search    Nobody else's until `ready()`.
  /// @param workspace As for a search, without a store; once `ready()` there may be one in it.
  void prepare(EnergySearch& search, GridWorkspace& workspace) noexcept;
  bool ready() const noexcept {
    return is_paper() || (branches_.is_ready() && (pieces_.empty() || is_cut()));
  }
  /// @returns From 0 to 1, of the preparation.
  double progress() const noexcept;

  /// @returns The device of one trial; the estimate if there is none, see `is_exhausted()`.
  Accelerometer device(std::uint32_t trial) noexcept;
  /// @returns S of the trial last begun, or last asked for its device.
  double sensitivity() const noexcept { return draws_.sensitivity(); }
  /// @returns How often trials were drawn again because a draw was no device.
  std::uint32_t redraws() const noexcept { return draws_.redraws(); }
  /// @returns Whether a trial has been drawn again DeviceDraws::kMaxRedraws times in vain; its
  ///   energy is not a number.
  bool is_exhausted() const noexcept { return is_exhausted_; }

  /// Begins a trial; one that the polynomials answer is then done already.
  void begin(std::uint32_t trial, GridWorkspace& workspace) noexcept;
  /// A step of a refinement, or one product with Phi of the paper's method.
  void step(GridWorkspace& workspace) noexcept;
  bool done() const noexcept { return done_; }
  /// @returns With `done()`, the largest energy of the device, for a = 1.
  double energy() const noexcept { return scale_ * energy_; }
  /// @returns What `begin()` or a `step()` costs at most, in cells of a product.
  std::size_t work() const noexcept;

  /// @returns The largest energy of one trial, for a = 1, all its steps at once.
  double energy(std::uint32_t trial, GridWorkspace& workspace) noexcept;

  /// @returns A copy that makes the trials from `first` on, beside this one: in another thread.
  ///
  /// @param[out] pieces Memory of its own, of at least `pieces_in_use()`, as long as it is asked.
  EnergyTrials share(std::uint32_t first, Span<TrialPiece> pieces) const noexcept;
  std::size_t pieces_in_use() const noexcept { return pieces_used_; }
  /// Takes over what a share has counted: `redraws()` and `is_exhausted()`. The shares in the order
  /// of their trials, without gaps, from the first trial on that has not been made here.
  void join(const EnergyTrials& share) noexcept;

  /// @returns The largest energy of a given device, found as in a trial: of a corner of the box,
  ///   for one.
  double energy_of(const Accelerometer& device, GridWorkspace& workspace) noexcept;

  /// Sets `model()` to a device that exists: for a search of its own.
  void set_model(const Accelerometer& device) noexcept { branches_.set_device(device); }
  /// The model of the device last set; at the estimate's sensitivity if the gain follows.
  const ModalModel& model() const noexcept { return branches_.model(); }
  /// What an energy of `model()` is multiplied by to be that of the device: 1 unless the gain
  /// follows.
  double scale_of(const Accelerometer& device) const noexcept;

  const SearchSettings& search_settings() const noexcept { return search_; }
  /// The cells of the grid of the paper's method.
  std::size_t cells() const noexcept { return cells_; }
  /// @returns With `ready()`, whether polynomials answer all trials within their reach.
  bool predicts() const noexcept;
  /// @returns With `ready()`, how many trials are worth their time: fewer than wanted where many of
  ///   them take a refinement and there was memory for pieces, but at least kFewestTrials.
  std::uint32_t most_trials() const noexcept { return most_trials_; }
  /// @returns Whether trials are values of a surface.
  bool has_surface() const noexcept { return ask_ != nullptr; }
  /// @returns What a trial may be off by, as part of the energy.
  double tolerance() const noexcept;
  BranchNotes notes() const noexcept;

 private:
  friend class TrialPieces;

  bool is_paper() const noexcept { return search_.method == Method::kPaper; }
  bool is_cut() const noexcept { return pieces_begun_ != 0 && pieces_ready_ == pieces_used_; }
  static void prepare_pieces(EnergyTrials& trials, EnergySearch& search,
                             GridWorkspace& workspace) noexcept;
  static double ask_surface(EnergyTrials& trials, const Accelerometer* device,
                            GridWorkspace& workspace) noexcept;
  void prepare_surface(EnergySearch& search, GridWorkspace& workspace) noexcept;
  void begin_pieces() noexcept;
  void prepare_piece(GridWorkspace& workspace) noexcept;
  void cut(TrialPiece& piece) noexcept;
  bool is_worth_pieces() noexcept;
  double refined_part() noexcept;
  void limit_trials() noexcept;
  bool is_worth_cutting(const TrialPiece& piece) const noexcept;
  EnergyBranches& asked() noexcept;
  EnergyBranches& branches_at(const DeviceDraws::Place& place) noexcept;
  void begin_fixed_point(const Accelerometer& device, GridWorkspace& workspace) noexcept;
  double run(GridWorkspace& workspace) noexcept;

  EnergyBranches branches_ = {};
  Span<TrialPiece> pieces_;
  void (*prepare_pieces_)(EnergyTrials&, EnergySearch&, GridWorkspace&) = nullptr;
  ResonanceSurface* surface_ = nullptr;  // That is to be laid.
  // With a surface that is laid: the energy of a device, or of the one drawn last.
  double (*ask_)(EnergyTrials&, const Accelerometer*, GridWorkspace&) = nullptr;
  double estimate_energy_ = 0.0;
  std::size_t pieces_used_ = 0;
  std::size_t work_of_pieces_ = 0;
  double work_saved_ = 0.0;  // By pieces, in refinements times switches, as the work of them.
  std::uint32_t expected_trials_ = 0;
  std::size_t pieces_begun_ = 0;
  std::size_t pieces_ready_ = 0;
  std::size_t first_axis_ = 1;  // That the first pieces are parts of.
  std::size_t piece_ = 0;       // Of the trial that is made, counted from 1; 0 for the whole.
  DeviceDraws draws_ = {};
  SearchSettings search_ = {};
  FixedPoint fixed_point_ = {};
  double energy_ = 0.0;  // Of the trial that is done.
  double scale_ = 0.0;
  double inverse_sensitivity_ = 0.0;
  std::size_t cells_ = 0;
  std::uint32_t rough_ = 0;
  std::uint32_t most_trials_ = 0;
  bool gain_follows_ = false;
  bool is_exhausted_ = false;
  bool has_begun_surface_ = false;
  bool done_ = false;
};

static_assert(std::is_trivially_copyable_v<EnergyTrials>);

}  // namespace emax
