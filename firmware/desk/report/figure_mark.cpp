// What the star at the figures of a report means.
#include "desk/report/figure_mark.hpp"

#include <algorithm>
#include <string_view>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/report/report_warnings.hpp"

#include "desk/cli/console.hpp"

namespace emax::desk {

namespace {

using app::Warning;

constexpr Warning kMarking[] = {
    Warning::kUnits,        Warning::kFit,         Warning::kOpenDamping, Warning::kDisagreement,
    Warning::kLowFrequency, Warning::kShortTime,   Warning::kShortInBand, Warning::kGuardInBand,
    Warning::kGuard,        Warning::kCrowded,     Warning::kRedrawn,     Warning::kNoUncertainty,
    Warning::kRough,        Warning::kMeasurement, Warning::kEnded,       Warning::kDataSheet,
    Warning::kChange};

std::string words_on_open_damping(const app::EvaluationResults& results) {
  StringSink sink;
  app::TextWriter out(sink);
  out.text("\n  The points leave beta open: these figures are at ");
  out.general(results.judgement.device.damping, 3).text(".");
  return sink.text();
}

// That E is shown in: of the in-band error it is one of the two figures.
std::uint32_t row_of_energy(const app::Settings& settings) {
  if (settings.criterion != Criterion::kInBandError) {
    return app::kRowEnergy;
  }
  return settings.delay_choice == app::DelayChoice::kNone ? app::kRowBand : app::kRowMatched;
}

bool is_rough(const app::EnergyUncertainty& known) {
  return known.exists() && known.rough_trials > 0 && known.rough_part > app::kMostRough;
}

// What a warning of the energy is about beside E, and one of the band beside both of its figures.
std::uint32_t rows_of(Warning warning, const app::EvaluationResults& results) {
  constexpr std::uint32_t kBoth = app::kRowBand | app::kRowMatched;
  const std::uint32_t energy = row_of_energy(results.settings);
  if (warning == Warning::kShortTime) {
    return energy == app::kRowEnergy ? energy : kBoth;
  }
  if (warning == Warning::kShortInBand) {
    return kBoth;
  }
  if (warning == Warning::kGuardInBand) {
    return (results.band.uncertainty.guard.disagreements > 0 ? app::kRowBand : 0U) |
           (results.matched.uncertainty.guard.disagreements > 0 ? app::kRowMatched : 0U);
  }
  if (warning == Warning::kRough) {
    return (is_rough(results.uncertainty) ? energy : 0U) |
           (is_rough(results.band.uncertainty) ? app::kRowBand : 0U) |
           (is_rough(results.matched.uncertainty) ? app::kRowMatched : 0U);
  }
  const bool is_of_energy = warning == Warning::kGuard || warning == Warning::kCrowded ||
                            warning == Warning::kRedrawn || warning == Warning::kNoUncertainty;
  return is_of_energy ? energy : kBoth | app::kRowEnergy;  // Or on the device.
}

}  // namespace

FigureMark mark_of_figures(const app::EvaluationResults& results,
                           const app::ReportContext& context) {
  FigureMark mark;
  std::string topics;
  std::string_view last;
  for (const Warning warning : kMarking) {
    if (!holds(warning, results, context)) {
      continue;
    }
    mark.rows |= rows_of(warning, results);
    if (about(warning) != last) {
      last = about(warning);
      topics += (topics.empty() ? "" : ", ") + std::string(last);
      std::replace(topics.begin(), topics.end(), '_', ' ');  // As the JSON names them.
    }
  }
  if (!topics.empty()) {
    mark.words = "There is a warning below, on: " + topics + "." +
                 (results.is_damping_open() ? words_on_open_damping(results) : "");
  }
  return mark;
}

}  // namespace emax::desk
