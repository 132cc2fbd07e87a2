// Why an evaluation has led to nothing, in the line that the program ends with.
#include "desk/report/failure_words.hpp"

#include <cctype>
#include <cstddef>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/units.hpp"
#include "emax/identify/fit_judgement.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/text_file.hpp"
#include "desk/report/damping_words.hpp"
#include "desk/report/fit_causes.hpp"

namespace emax::desk {

std::string in_line(const std::string& text) {
  std::string line;
  bool starts = true;
  bool starts_next = false;  // Behind the end of a sentence.
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool ends = i + 1 == text.size() || text[i + 1] == ' ' || text[i + 1] == ')';
    if (c == '.' && ends) {
      const bool goes_on = i + 2 < text.size() && text[i + 1] == ' ';
      line += goes_on ? ";" : "";
      starts_next = goes_on;
      continue;
    }
    if (starts_next && c != ' ') {
      const bool is_word =
          i + 1 < text.size() && (text[i + 1] == ' ' ? c == 'A' : text[i + 1] >= 'a');
      starts = is_word;  // A symbol keeps its capital.
      starts_next = false;
    }
    line += starts ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
    starts = text.compare(i, 5, "(The ") == 0;
  }
  return line;
}

namespace {

// What has to be changed: an option, or the device.
std::string culprit(const app::EvaluationResults& evaluation, const ReportOptions& options) {
  const app::Failure& failure = evaluation.failure;
  const bool is_lost_in_time =
      failure.status == Status::kLostDigits && holds(app::Warning::kShortTime, evaluation, {});
  const bool is_search =
      failure.status == Status::kTooManyCells || failure.status == Status::kTooManySwitches;
  if (is_search && failure.stage == app::Stage::kTrend) {
    return "--trend";
  }
  if (is_search || is_lost_in_time) {
    return "--time";
  }
  if (options.measures()) {
    return "measurement";
  }
  return options.points_path.empty() ? "--model" : name_of_input(options.points_path);
}

}  // namespace

Problem describe_failure(const app::EvaluationResults& evaluation, const ReportOptions& options,
                         bool is_phase_unit_named, const std::string& doubt) {
  const app::Failure& failure = evaluation.failure;
  const bool is_inverted = failure.status == Status::kInvertedPolarity;
  StringSink sentence;
  app::TextWriter writer(sentence);
  write_failure(evaluation, writer);
  if (failure.status == Status::kDelayTooLong) {
    const double longest_s = 1.0 / (kTwoPi * evaluation.settings.cutoff_hz);
    writer.text(" (at most ").general(1e6 * longest_s, 4).text(" us)");
  }
  const std::string who = culprit(evaluation, options);
  std::string line =
      who + ": " + (is_inverted ? "inverted polarity: " : "") + in_line(sentence.text());
  if (is_inverted && !options.points_path.empty()) {
    line += "; --invert adds 180 degrees to every phase";
  }
  if (failure.stage == app::Stage::kFitDraws) {
    const std::string cause = cause_of(evaluation.fit, is_phase_unit_named);
    line += cause.empty() ? "" : "; " + in_line(cause);
  }
  line += doubt.empty() ? "" : "; " + in_line(doubt);
  // What the bench gave is no input of the user's.
  return who == "measurement" ? fault(line) : bad_input(line);
}

Problem check_given_damping(const app::EvaluationResults& evaluation, const ReportOptions& options,
                            const FrequencyResponse& points) {
  const WlspFit& fit = evaluation.fit.result();
  if (!(options.damping > 0.0) || fit.is_damping_given) {
    return {};
  }
  if (evaluation.judgement.determined == Determined::kSensitivity) {
    return bad_input(
        "--damping: the points determine the sensitivity alone, and without f0 a damping is of no "
        "use; expected points nearer to the resonance, or no --damping");
  }
  if (evaluation.judgement.determined == Determined::kNothing) {
    const FrequencyByDamping found = frequency_by_damping(points);
    if (!(found.f0_hz > 0.0)) {
      return {};
    }
    const std::string largest = std::to_string(found.damping).substr(0, 4);
    return bad_input(options.damping > found.damping
                         ? "--damping: no resonance fits these magnitudes with so large a damping; "
                           "expected at most " +
                               largest
                         : "--damping: the fit of these magnitudes comes to no rest with this "
                           "damping; expected another one nearby");
  }
  StringSink sink;
  app::TextWriter out(sink);
  out.text("--damping: the points say beta = ").general(fit.model.damping, 4).text(" with U = ");
  out.general(2.0 * fit.u_damping, 3);
  const FitJudgement& judgement = evaluation.judgement;
  if (judgement.determined == Determined::kAllButDamping) {
    out.text(" (k = 2); expected ").general(judgement.damping_low, 3).text(" to ");
    out.general(judgement.damping_high, 3).text(", which they leave open, or no --damping");
  } else {
    out.text(" (k = 2); they determine it: expected no --damping");
  }
  return bad_input(sink.text());
}

}  // namespace emax::desk
