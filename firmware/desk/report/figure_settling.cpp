// How long the error of the leading figure takes to develop.
#include "desk/report/figure_settling.hpp"

#include <cmath>
#include <memory>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/model/response_scan.hpp"

namespace emax::desk {

const app::FigureResults* leading_figure(const app::EvaluationResults& results) noexcept {
  const bool is_plain = results.settings.delay_choice == app::DelayChoice::kNone;
  if (results.matched.exists() && !is_plain) {
    return &results.matched;
  }
  return results.band.exists() ? &results.band : nullptr;
}

double settling_time_of_leading_s(const app::EvaluationResults& results) {
  const app::FigureResults* const figure = leading_figure(results);
  if (figure == nullptr) {
    return 0.0;
  }
  if (figure == &results.band) {
    return results.band_settling.found ? results.band_settling.time_s : 0.0;
  }
  const bool is_given = results.settings.delay_choice == app::DelayChoice::kGiven;
  const ReferenceDelay delay = is_given
                                   ? ReferenceDelay{DelayMode::kGiven, results.settings.delay_s}
                                   : ReferenceDelay{DelayMode::kOfSensor, 0.0};
  const auto model = std::make_unique<ModalModel>();
  if (model->set(results.device.estimate, results.model.filter(),
                 {Criterion::kInBandError, delay}) != Status::kOk) {
    return 0.0;
  }
  PeakSearch peak;
  for (peak.start(*model); !peak.done();) {
    peak.step(*model);
  }
  SettlingSearch settling;
  for (settling.start(*model, app::Evaluation::kSettled * std::abs(peak.result().value));
       !settling.done();) {
    settling.step(*model);
  }
  return settling.result().found ? settling.result().time_s : 0.0;
}

}  // namespace emax::desk
