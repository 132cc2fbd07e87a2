// The names of the stages.
#include "emax/app/evaluate/stage.hpp"

namespace emax::app {

const char* name_of(Stage stage) noexcept {
  switch (stage) {
    case Stage::kIdle:
      return "idle";
    case Stage::kModel:
      return "response";
    case Stage::kFitDraws:
      return "fit";
    case Stage::kEnergy:
      return "energy";
    case Stage::kBound:
      return "bound";
    case Stage::kPrediction:
      return "prediction";
    case Stage::kAdaptive:
      return "number of trials";
    case Stage::kMonteCarlo:
      return "Monte Carlo";
    case Stage::kGuard:
      return "guard";
    case Stage::kIdeal:
      return "ideal sensor";
    case Stage::kBand:
      return "in-band error";
    case Stage::kMatched:
      return "in-band error, delay out";
    case Stage::kUncertainty:
      return "uncertainty";
    case Stage::kTrend:
      return "trend";
    case Stage::kDone:
      return "done";
    case Stage::kFailed:
      return "failed";
  }
  return "unknown";
}

}  // namespace emax::app
