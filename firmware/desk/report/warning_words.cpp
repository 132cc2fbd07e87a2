// What a warning says.
#include "desk/report/warning_words.hpp"

#include <algorithm>

#include "emax/app/base/text_writer.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"

namespace emax::desk {

namespace {

constexpr double kMilli = 1e3;

// Of a fit whose chi-square says that something does not hold.
std::string consequence_of_fit(const app::EvaluationResults& results) {
  StringSink sink;
  app::TextWriter out(sink);
  out.text(results.trial_scale() > 1.0
               ? ". U of parameters and errors is widened by the Birge ratio, "
               : ". U of parameters and errors is too small by about the Birge ratio, ");
  out.general(results.fit.result().birge_ratio, 3);
  out.text(", and the estimates themselves are not sure: other weights would move them by as much");
  return sink.text();
}

}  // namespace

std::string sentence_of(const std::string& words, double least_time_s) {
  if (!(least_time_s > 0.0)) {
    return words;
  }
  constexpr int kDigits = 3;
  StringSink sink;
  app::TextWriter out(sink);
  out.text(words.c_str()).text(", ");
  out.general(rounded_up(kMilli * least_time_s, kDigits - 1), kDigits).text(" ms");
  return sink.text();
}

std::string sentence_of(app::Warning warning, const app::EvaluationResults& results,
                        double leading_settling_s) {
  const std::string words = words_of(warning, results);
  if (warning == app::Warning::kFit) {
    return words + consequence_of_fit(results);
  }
  const double least_s = least_time_s(warning, results);
  const bool is_in_band = warning == app::Warning::kShortInBand && least_s > 0.0;
  const bool is_reached = is_in_band && is_reachable(leading_settling_s, results);
  return sentence_of(words, is_reached ? std::max(least_s, leading_settling_s) : least_s);
}

std::string note_on_time(const app::EvaluationResults& results, double leading_settling_s) {
  if (!(results.settings.duration_s < leading_settling_s)) {
    return "";
  }
  StringSink sink;
  app::TextWriter out(sink);
  out.text("T = ").general(kMilli * results.settings.duration_s, 10);
  out.text(" ms is shorter than the settling time of the first figure's error, ");
  out.general(kMilli * leading_settling_s, 4);
  out.text(" ms, so it has not developed: a longer signal may make more of it");
  return sink.text();
}

}  // namespace emax::desk
