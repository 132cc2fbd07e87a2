// The fixed point of the paper for its own sake, with the energy of each iterate.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/app/settings/settings.hpp"
#include "emax/base/status.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/model/modal_model.hpp"

namespace emax::app {

/// Iterates paper equation (19) from Phi's first column on the grid of the paper's step, whatever
/// the method of the settings is. One product with Phi a step. 78 KiB.
class FixedPointRun {
 public:
  /// @param[in] model      Not needed after the start.
  /// @param[in] limit_mps2 a.
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kTooManyCells: T over the step is more than kMaxCells, or less than 1.
  Status start(const ModalModel& model, double limit_mps2, const Settings& settings) noexcept;
  void step() noexcept;
  bool done() const noexcept { return run_.done(); }
  /// @returns From 0 to 1, by the iterations permitted.
  double progress() const noexcept;

  /// @returns How many iterates there are beyond the starting one.
  std::size_t iterations() const noexcept { return run_.result().iterations; }
  /// @param[in] iterate 0 to `iterations()`.
  double energy_v2s(std::size_t iterate) const noexcept { return a2_ * trace_[iterate]; }

 private:
  FixedPoint run_;
  double a2_ = 0.0;
  std::size_t most_ = 0;
  PhiOperator phi_;
  double trace_[kMaxIterations + 1] = {};  // For a = 1.
  GridWorkspace grid_;
};

static_assert(std::is_trivially_copyable_v<FixedPointRun>);

}  // namespace emax::app
