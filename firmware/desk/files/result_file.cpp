// What `emax compare` needs of a results.json.
#include "desk/files/result_file.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "emax/app/base/version.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report.hpp"
#include "emax/base/elementary.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/files/json_reader.hpp"
#include "desk/files/text_file.hpp"
#include "desk/report/warning_words.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxResultFileSize = std::size_t{4} << 20;
constexpr const char* kAboutFit = "fit";
constexpr const char* kAboutDamping = "damping";
constexpr const char* kExpectation = "expected a results.json of emax report";

// An object of the file by its name there.
struct Group {
  const JsonValue& value;
  const char* name;
};

// Takes members one by one and remembers the first that is not there.
class Taker final {
 public:
  double number(const Group& group, const char* name) {
    bool exists = false;
    const double value = optional_number(group, name, exists);
    if (!exists) {
      miss(group, name, "number");
    }
    return value;
  }

  // Of what cannot be below 0.
  double size(const Group& group, const char* name) {
    const double value = number(group, name);
    refuse_negative(group, name, value);
    return value;
  }

  // Of what is above 0.
  double positive(const Group& group, const char* name) {
    const double value = size(group, name);
    refuse_if(value == 0.0, group, name, "is 0");
    return value;
  }

  // Of what is between 0 and 1.
  double share(const Group& group, const char* name) {
    const double value = positive(group, name);
    refuse_if(!(value < 1.0), group, name, "is 1 or more");
    return value;
  }

  // Of a bound: rounding apart it is no less than the figure.
  void bound(const Group& group, const char* name, Figure& figure) {
    constexpr double kRounding = 1e-9;
    figure.bound = optional_number(group, name, figure.has_bound);
    const double least = figure.value - kRounding * abs(figure.value);
    if (figure.has_bound && figure.value >= 0.0) {
      refuse_negative(group, name, figure.bound);
    }
    refuse_if(figure.has_bound && figure.bound < least, group, name, "is below the figure");
  }

  double optional_size(const Group& group, const char* name, bool& exists) {
    const double value = optional_number(group, name, exists);
    refuse_negative(group, name, value);
    return value;
  }

  // Null, or no such member, is no number.
  double optional_number(const Group& group, const char* name, bool& exists) {
    const JsonValue& value = group.value[name];
    exists = value.is_number();
    if (!exists && value.kind() != JsonValue::Kind::kNull) {
      miss(group, name, "number");
    }
    // Beyond it squares are no numbers.
    constexpr double kMost = 1e150;
    refuse_if(abs(value.number()) > kMost, group, name, "is beyond 1e150");
    return value.number();
  }

  std::string text(const Group& group, const char* name) {
    const JsonValue& value = group.value[name];
    if (!value.is_string()) {
      miss(group, name, "text");
    }
    return value.text();
  }

  // Only where it matters: of reports from before it was told, nothing is known.
  Delay delay(const Group& group, bool is_due) {
    return is_due ? Delay{text(group, "delay_mode"), size(group, "delay_s")} : Delay{"none", 0.0};
  }

  void optional_interval(const Group& group, const char* name, Figure& figure) {
    const JsonValue& value = group.value[name];
    const std::vector<JsonValue>& ends = value.elements();
    figure.has_interval = ends.size() == 2 && ends[0].is_number() && ends[1].is_number();
    if (figure.has_interval) {
      figure.low = ends[0].number();
      figure.high = ends[1].number();
      refuse_if(figure.low > figure.high, group, name, "ends below its beginning");
    } else if (value.kind() != JsonValue::Kind::kNull) {
      miss(group, name, "interval");
    }
  }

  void interval(const Group& group, const char* name, Figure& figure) {
    optional_interval(group, name, figure);
    if (!figure.has_interval) {
      miss(group, name, "interval");
    }
  }

  // "energy.E is no number", or empty.
  const std::string& missing() const noexcept { return missing_; }

 private:
  void refuse_if(bool is_wrong, const Group& group, const char* name, const char* what) {
    if (is_wrong && missing_.empty()) {
      missing_ = std::string(group.name) + "." + name + " " + what;
    }
  }

  void refuse_negative(const Group& group, const char* name, double value) {
    refuse_if(value < 0.0, group, name, "is below 0");
  }

  void miss(const Group& group, const char* name, const char* kind) {
    if (missing_.empty()) {
      missing_ = std::string(group.name) + "." + name + " is no " + kind;
    }
  }

  std::string missing_;
};

void take_label(const JsonValue& label, std::string& text) {
  if (label.is_string() && !label.text().empty()) {
    text = label.text();
  }
}

Problem check_version(const JsonValue& root, const std::string& file) {
  if (!root["version"].is_string()) {
    return bad_input(file + ": holds no version; " + kExpectation);
  }
  const std::string& version = root["version"].text();
  if (version != app::kVersion) {
    return bad_input(file + ": written by emax " + printable(version) + ", and this is emax " +
                     app::kVersion + "; expected files of one version: run emax report anew");
  }
  return {};
}

void take_conditions(const JsonValue& root, Taker& taker, Result& result) {
  const Group filter = {root["filter"], "filter"};
  const Group energy = {root["energy"], "energy"};
  result.order = taker.positive(filter, "order");
  result.cutoff_hz = taker.positive(filter, "cutoff");
  result.gain_mode = taker.text(filter, "gain_mode");
  result.gain = taker.size(filter, "gain");
  result.limit_mps2 = taker.positive(energy, "a");
  result.duration_s = taker.positive(energy, "T");
  result.criterion = taker.text(energy, "criterion");
  result.energy_delay = taker.delay(energy, result.criterion == "band");
  result.method = taker.text(energy, "method");
  result.sensitivity = taker.positive({root["model"], "model"}, "S");
}

// In the place of the symmetric interval, where the figure is at one end of both.
void take_shortest(const Group& block, const char* name, Taker& taker, Figure& figure) {
  Figure shortest = figure;
  taker.optional_interval(block, name, shortest);
  if (!figure.has_interval) {
    return;
  }
  const CoverageInterval read = shortest.has_interval
                                    ? CoverageInterval{shortest.low, shortest.high}
                                    : CoverageInterval{figure.low, figure.high};
  const CoverageInterval interval = app::widened(read, figure.value);
  figure.is_one_sided = app::is_one_sided(figure.value, figure.expanded, interval);
  if (figure.is_one_sided) {
    figure.low = interval.low;
    figure.high = interval.high;
  }
}

void take_uncertainty(const Group& block, Taker& taker, Figure& energy, double& probability) {
  energy.has_uncertainty = true;
  energy.u = taker.size(block, "u");
  energy.expanded = kCoverageFactor * energy.u;
  probability = taker.share(block, "probability");
  taker.interval(block, "interval", energy);
  if (energy.value > 0.0) {
    take_shortest(block, "shortest", taker, energy);
  }
}

// An interval over the box is not one of E: only u is taken from there.
void take_box(const Group& trials, Taker& taker, Result& result) {
  Figure& energy = result.figure(FigureKind::kEnergy);
  energy.has_uncertainty = true;
  energy.u = sqrt(3.0) * taker.size(trials, "u");
  energy.expanded = kCoverageFactor * energy.u;
  result.energy_u_is_of_box = true;
}

void take_energy(const JsonValue& root, Taker& taker, Result& result) {
  Figure& energy = result.figure(FigureKind::kEnergy);
  const Group block = {root["energy"], "energy"};
  energy.exists = true;
  // Only the difference of two energies can be below 0.
  energy.value =
      result.criterion == "difference" ? taker.number(block, "E") : taker.size(block, "E");
  taker.bound(block, "bound", energy);
  result.ideal_percent =
      taker.optional_number({root["ideal"], "ideal"}, "rms_percent", result.has_ideal);
  const Group uncertainty = {root["uncertainty"], "uncertainty"};
  const Group trials = {root["monte_carlo"], "monte_carlo"};
  if (uncertainty.value.is_object()) {
    take_uncertainty(uncertainty, taker, energy, result.probability);
  } else if (trials.value.is_object() && trials.value["u"].is_number()) {
    if (taker.text(trials, "distribution") == "box") {
      take_box(trials, taker, result);
    } else {
      take_uncertainty(trials, taker, energy, result.probability);
    }
  }
}

// Over the dampings that the points leave open, instead of an uncertainty.
void take_range(const Group& block, const char* name, Taker& taker, Figure& figure) {
  Figure range;
  taker.optional_interval(block, name, range);
  if (range.has_interval) {
    figure.has_range = true;
    figure.low = std::min(range.low, figure.value);
    figure.high = std::max(range.high, figure.value);
  }
}

void take_open_damping(const JsonValue& root, Taker& taker, Result& result) {
  const Group fit = {root["fit"], "fit"};
  result.has_open_damping = fit.value["determined"].text() == "all but beta";
  if (result.has_open_damping) {
    take_range(fit, "E_range", taker, result.figure(FigureKind::kEnergy));
  }
}

void take_figure(const Group& block, bool has_open_damping, Taker& taker, Figure& figure) {
  figure.exists = true;
  figure.value = taker.size(block, "rms_percent");
  taker.bound(block, "bound_percent", figure);
  figure.u = taker.optional_size(block, "u_percent", figure.has_uncertainty);
  if (figure.has_uncertainty) {
    figure.expanded = taker.size(block, "U_percent");
    taker.optional_interval(block, "interval_percent", figure);
    take_shortest(block, "shortest_percent", taker, figure);
  } else if (has_open_damping) {
    take_range(block, "range_percent", taker, figure);
  }
}

void take_band(const JsonValue& root, Taker& taker, Result& result) {
  const Group band = {root["band"], "band"};
  if (!band.value.is_object()) {
    result.band_refused = root["band_refused"].text();
    return;
  }
  take_figure(band, result.has_open_damping, taker, result.figure(FigureKind::kBand));
  const Group matched = {band.value["matched"], "band.matched"};
  if (!matched.value.is_object()) {
    result.matched_refused = band.value["matched_refused"].text();
    return;
  }
  Figure& figure = result.figure(FigureKind::kMatched);
  take_figure(matched, result.has_open_damping, taker, figure);
  figure.epsilon = taker.size(matched, "epsilon_percent");
  result.delay = taker.delay(matched, true);
}

bool has_warning(const JsonValue& warnings, std::string_view about) {
  const std::vector<JsonValue>& all = warnings.elements();
  return std::any_of(all.begin(), all.end(), [about](const JsonValue& warning) {
    return warning["about"].text() == about;
  });
}

// Files from before there were warnings say chi2.
bool chi_square_is_high(const JsonValue& model) {
  const double chi2 = model["chi2"].number();
  const double dof = model["dof"].number();
  constexpr double kMostDof = 1e6;
  return dof >= 1.0 && dof <= kMostDof &&
         chi2 / dof > app::reduced_chi_square_limit(static_cast<std::size_t>(dof));
}

void take_marks(const JsonValue& root, Result& result) {
  const JsonValue& warnings = root["warnings"];
  const bool has_warnings = warnings.kind() == JsonValue::Kind::kArray;
  result.fit_warns =
      has_warnings ? has_warning(warnings, kAboutFit) : chi_square_is_high(root["model"]);
  const bool is_said = root["simulated"].kind() == JsonValue::Kind::kBoolean;
  for (const JsonValue& warning : warnings.elements()) {
    const std::string& about = warning["about"].text();
    if (about != kAboutFit && about != kAboutDamping && warning["text"].is_string()) {
      result.other_warnings.push_back(
          sentence_of(warning["text"].text(), warning["least_time_s"].number()));
    }
  }
  result.is_simulated = is_said ? root["simulated"].is_true() : root["bench"]["truth"].is_object();
}

// Files from before there were warnings have none of what came with them, either.
Problem check_marks(const JsonValue& root, const std::string& file) {
  const bool has_warnings = root["warnings"].kind() == JsonValue::Kind::kArray;
  const bool is_said = root["simulated"].kind() == JsonValue::Kind::kBoolean;
  bool is_new = has_warnings || is_said;
  for (const char* name : {"band", "ideal", "uncertainty"}) {
    is_new = is_new || root[name].is_object();
  }
  if (!is_new || (has_warnings && is_said)) {
    return {};
  }
  return bad_input(file + ": " +
                   (has_warnings ? "simulated is neither true nor false" : "warnings is no list") +
                   "; " + kExpectation);
}

Problem parse_result(const std::string& path, const std::string& file, JsonValue& root) {
  std::string text;
  if (Problem problem = read_text_file(path, kMaxResultFileSize, kExpectation, text)) {
    return problem;
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    return bad_input(file + ": the file is empty; " + kExpectation);
  }
  const JsonError error = parse_json(text, root);
  if (stop_requested()) {
    return stopped();
  }
  if (error.problem != nullptr) {
    return bad_input(file + ":" + std::to_string(error.line) + ":" + std::to_string(error.column) +
                     ": not JSON, " + error.problem + "; " + kExpectation);
  }
  return check_version(root, file);
}

}  // namespace

double Result::rms_v() const noexcept {
  return sqrt(figure(FigureKind::kEnergy).value / duration_s);
}

double Result::rms_percent() const noexcept {
  return rms_percent(figure(FigureKind::kEnergy).value);
}

double Result::rms_percent(double energy) const noexcept {
  return 100.0 * sqrt(energy / duration_s) / (sensitivity * limit_mps2);
}

Problem read_result(const std::string& path, Result& result) {
  result = {};
  result.path = path;
  result.file = name_of_input(path);
  JsonValue root;
  if (Problem problem = parse_result(path, result.file, root)) {
    return problem;
  }
  if (root["fit"]["determined"].text() == "S") {
    return bad_input(result.file + ": holds no maximum energy, its points determine the " +
                     "sensitivity alone; " + kExpectation + " of points nearer to the resonance");
  }
  if (!root["energy"].is_object() || !root["energy"]["E"].is_number()) {
    return bad_input(result.file + ": holds no maximum energy, its measurement has failed; " +
                     kExpectation + " that ended well");
  }
  if (Problem problem = check_marks(root, result.file)) {
    return problem;
  }
  result.device = result.file;
  take_label(root["labels"]["device"], result.device);
  take_label(root["labels"]["serial"], result.serial);
  Taker taker;
  take_conditions(root, taker, result);
  take_energy(root, taker, result);
  take_open_damping(root, taker, result);
  take_band(root, taker, result);
  take_marks(root, result);
  if (!taker.missing().empty()) {
    return bad_input(result.file + ": " + taker.missing() + "; " + kExpectation);
  }
  return {};
}

}  // namespace emax::desk
