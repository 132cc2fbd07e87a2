// The memory that an evaluation works in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/cut_range.hpp"
#include "emax/app/evaluate/evaluation_helper.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/figure_range.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/span.hpp"
#include "emax/bound/energy_bound.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/model/absolute_error.hpp"
#include "emax/model/response_scan.hpp"
#include "emax/uncertainty/energy_guard.hpp"
#include "emax/uncertainty/energy_trials.hpp"
#include "emax/uncertainty/monte_carlo.hpp"

namespace emax::app {

/// The memory that an evaluation works in. Between `done()` and the next `start_...()` or
/// `pursue()` it may hold anything else. 85 KiB, all zero before use.
class EvaluationWorkspace {
 public:
  /// @returns Progress of the stage that runs, from 0 to 1; of Stage::kAdaptive an estimate, which
  /// may go back. Only while an evaluation runs.
  double progress() const noexcept { return progress_; }

 private:
  friend class Evaluation;

  // Made in place, one at a time; <new> is no header of a freestanding program.
  struct InPlace {
    static void* operator new(std::size_t /*size*/, void* place) noexcept { return place; }
  };
  struct ModelPart : InPlace {
    PeakSearch peak;
    SettlingSearch settling;
    AbsoluteError absolute_error;
  };
  struct BoundPart : InPlace {
    EnergyBound bound;
  };
  struct CutPart : InPlace {
    CutRange range;
  };
  struct FigureRangePart : InPlace {
    FigureRange range;
  };
  struct FigurePart : InPlace {
    ModalModel model;
    EnergyBound bound;
    PeakSearch peak;
    SettlingSearch settling;
  };
  // Lies in the grid's memory while trials start from it.
  struct FigureModel : InPlace {
    ModalModel model;
  };
  // Mean and squares of a quantity about its first value.
  struct Scatter {
    double origin = 0.0;
    double mean = 0.0;
    double squares = 0.0;
    std::uint32_t count = 0;
  };
  struct TrialPart : InPlace {
    EnergyTrials trials;
    MonteCarlo monte_carlo;
    AdaptiveTrials adaptive;
    Scatter root;              // Of sqrt(E), from the first pass.
    bool is_relative = false;  // The second run, of E (S/S_t)^2.
  };
  union Part {
    constexpr Part() noexcept : trial() {}
    ModelPart model;
    BoundPart bound;
    CutPart cut;
    FigureRangePart figure_range;
    FigurePart figure;
    TrialPart trial;
  };

  enum class FigurePhase : std::uint8_t {
    kSettling,
    kSearch,
    kBound,
    kPrediction,
    kTrials,
    kGuard,
    kRange,
    kEnd
  };
  static_assert(!kHasDefaultCapacities ||
                sizeof(FigureModel) <= sizeof(double) * kWorkspaceNumbers);

  Span<double> store_;
  TrialPieces pieces_;
  EvaluationHelper* helper_ = nullptr;
  double progress_ = 0.0;
  std::uint32_t stored_ = 0;  // Trials 0 to stored_ - 1 are in the store.
  std::uint32_t trials_ = 0;
  Goal goal_ = Goal::kModel;
  FigurePhase figure_phase_ = FigurePhase::kSearch;  // Of the stages from kIdeal to kUncertainty.
  bool trial_runs_ = false;
  bool trend_search_runs_ = false;
  EnergyGuard guard_;
  WlspDraws draws_;
  EnergySearch search_;
  Part part_;
  GridWorkspace grid_;
};

static_assert(std::is_trivially_copyable_v<EvaluationWorkspace>);
static_assert(!kHasDefaultCapacities ||
              sizeof(EvaluationResults) + sizeof(EvaluationWorkspace) <= 98 * 1024);

}  // namespace emax::app
