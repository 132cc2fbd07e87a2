// The grid of the fixed point, its start and its steps.
#include "emax/app/sequencer/fixed_point_run.hpp"

#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/energy/energy_search.hpp"

namespace emax::app {

Status FixedPointRun::start(const ModalModel& model, double limit_mps2,
                            const Settings& settings) noexcept {
  const double duration_s = settings.duration_s;
  const SearchSettings search = {Method::kPaper, duration_s, settings.step_s, settings.iterations};
  if (!(settings.step_s <= duration_s) ||
      phi_.set(model, duration_s, search_cells(model, search)) != Status::kOk) {
    return Status::kTooManyCells;
  }
  a2_ = limit_mps2 * limit_mps2;
  most_ = settings.iterations;
  grid_.share_nothing();
  const std::size_t cells = phi_.cells();
  signs_of_column(phi_, 0, grid_.signs(cells), grid_.product(cells));
  run_.start(most_, 0.0);
  return Status::kOk;
}

void FixedPointRun::step() noexcept {
  const std::size_t cells = phi_.cells();
  run_.step(phi_, grid_.signs(cells), grid_.best_signs(cells), grid_.product(cells),
            Span<double>(trace_));
}

double FixedPointRun::progress() const noexcept {
  return static_cast<double>(iterations()) / static_cast<double>(most_);
}

}  // namespace emax::app
