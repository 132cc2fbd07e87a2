// The largest energy over the dampings that points leave open.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/status.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/identify/fit_judgement.hpp"
#include "emax/model/modal_model.hpp"

namespace emax::app {

/// Searches at the ends of the range that `judge()` has cut to what a device may be: the least
/// damping with S + 2u and f0 +- 2u, the largest with S - 2u and f0 +- 2u, S and f0 as they follow
/// from the damping. The energy falls as the damping grows, so these ends and the estimate enclose
/// it.
///
///     range.start(at_estimate, judgement, search_settings, gain_follows);
///     while (!range.done()) {
///       range.step(search, grid);
///     }
class CutRange {
 public:
  /// @param[in] at_estimate The model of the judgement's device, with filter and criterion.
  void start(const ModalModel& at_estimate, const FitJudgement& judgement,
             const SearchSettings& settings, bool gain_follows) noexcept;

  /// A step of a search. Where a search cannot be made (too many switches or cells, or no device at
  /// this end), there is no range.
  void step(EnergySearch& search, GridWorkspace& grid) noexcept;

  bool done() const noexcept { return corner_ == kCorners; }
  /// With `done()`: all searches have come to an end.
  bool is_found() const noexcept { return status_ == Status::kOk; }
  double low() const noexcept { return low_; }    ///< For a = 1.
  double high() const noexcept { return high_; }  ///< For a = 1.
  double progress() const noexcept { return static_cast<double>(corner_) / kCorners; }

 private:
  static constexpr std::size_t kCorners = 4;

  Accelerometer device_at(std::size_t corner) const noexcept;
  void give_up(Status status) noexcept;

  ModalModel model_ = {};
  FitJudgement judgement_ = {};
  SearchSettings settings_ = {};
  double low_ = 0.0;
  double high_ = 0.0;
  std::size_t corner_ = 0;
  Status status_ = Status::kOk;
  bool gain_follows_ = false;
  bool is_searching_ = false;
};

static_assert(std::is_trivially_copyable_v<CutRange>);

}  // namespace emax::app
