// The in-band error over the dampings that points leave open.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/status.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/identify/fit_judgement.hpp"
#include "emax/model/accelerometer.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/model/reference_filter.hpp"

namespace emax::app {

/// Whether an image has them: where flash is scarce a report has no ranges of the in-band errors.
inline constexpr bool kHasFigureRanges = !kHasDefaultCapacities;

/// Searches over the range of the damping that `judge()` has cut to what a device may be, with f0
/// as it follows from the damping, +- 2u: the least and the greatest of the energies that devices
/// of these dampings have. A delay that is the sensor's is that of each of these devices.
///
/// Over the damping an in-band error falls, or rises, or falls and then rises: its resonance gets
/// less, and its delay more. So the greatest is at an end of the range. The least is, too, unless
/// the error falls from that end inwards: it is then found by golden sections.
///
///     range.start(judgement, error, search_settings, holds_sensitivity);
///     while (!range.done()) {
///       range.step(search, grid);
///     }
class FigureRange {
 public:
  /// What the energy is of.
  struct Error {
    ReferenceFilter filter;
    ErrorMeasure measure;  ///< In band.
    double at_estimate;    ///< Its largest energy at the judgement's device, for a = 1.
  };

  /// @param[in] holds_sensitivity The filter's gain follows S, so that S is that of the estimate
  ///   for all of them. Else it is within +- 2u, and an energy counts for the square of its S.
  void start(const FitJudgement& judgement, const Error& error, const SearchSettings& settings,
             bool holds_sensitivity) noexcept;

  /// A step of a search. Where a search cannot be made (too many switches or cells, a delay that
  /// cannot be taken out, or no device), there is no range.
  void step(EnergySearch& search, GridWorkspace& grid) noexcept;

  bool done() const noexcept { return phase_ == Phase::kDone; }
  /// With `done()`: all searches have come to an end.
  bool is_found() const noexcept { return status_ == Status::kOk; }
  double low() const noexcept { return low_; }    ///< For a = 1 and the S of the estimate.
  double high() const noexcept { return high_; }  ///< The same.
  double progress() const noexcept;

 private:
  enum class Phase : std::uint8_t { kEnds, kInwards, kSections, kDone };

  static constexpr std::size_t kSides = 2;          // Of f0: less and more by 2u.
  static constexpr std::size_t kSensitivities = 3;  // The same, and the nearest to the gain.

  std::size_t corners() const noexcept;
  Accelerometer device_at(double damping, std::size_t corner) const noexcept;
  void begin_search(EnergySearch& search) noexcept;
  void take(double energy) noexcept;
  void take_end(double energy) noexcept;
  void begin_sections() noexcept;
  void take_section(double energy) noexcept;
  void give_up(Status status) noexcept;

  ModalModel model_ = {};
  FitJudgement judgement_ = {};
  Error error_ = {};
  SearchSettings settings_ = {};
  double low_ = 0.0;
  double high_ = 0.0;
  double damping_ = 0.0;    // Of the search that runs, or comes next.
  double least_end_ = 0.0;  // The least energy at an end of the range.
  double least_at_ = 0.0;   // The damping of that end.
  double from_ = 0.0;       // What the sections have left of the range,
  double to_ = 0.0;         // and the two dampings that part it.
  double inner_[2] = {};
  double inner_energy_[2] = {};
  std::size_t made_ = 0;          // Searches of this phase.
  std::size_t corner_ = 0;        // Of f0 and S.
  std::size_t least_corner_ = 0;  // Of the least energy at an end.
  Phase phase_ = Phase::kDone;
  Status status_ = Status::kOk;
  bool holds_sensitivity_ = false;
  bool is_searching_ = false;
};

static_assert(std::is_trivially_copyable_v<FigureRange>);

}  // namespace emax::app
