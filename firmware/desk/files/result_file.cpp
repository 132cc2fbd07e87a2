// What `emax compare` needs of a results.json.
#include "desk/files/result_file.hpp"

#include <cstddef>
#include <string_view>
#include <vector>

#include "emax/app/base/version.hpp"
#include "emax/base/elementary.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/files/json_reader.hpp"
#include "desk/files/text_file.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxFileSize = std::size_t{4} << 20;
constexpr const char* kExpectation = "expected a results.json of emax report";

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// Takes members one by one and remembers the first that is not there.
class Taker final {
 public:
  explicit Taker(const JsonValue& root) : root_(root) {}

  double number(const char* group, const char* name) {
    const JsonValue& value = root_[group][name];
    if (!value.is_number()) {
      miss(group, name, "number");
    }
    return value.number();
  }

  std::string text(const char* group, const char* name) {
    const JsonValue& value = root_[group][name];
    if (!value.is_string()) {
      miss(group, name, "text");
    }
    return value.text();
  }

  Interval interval(const char* group, const char* name) {
    const std::vector<JsonValue>& ends = root_[group][name].elements();
    if (ends.size() != 2 || !ends[0].is_number() || !ends[1].is_number()) {
      miss(group, name, "interval");
      return {};
    }
    return {ends[0].number(), ends[1].number()};
  }

  // "energy.E is no number", or empty.
  const std::string& missing() const noexcept { return missing_; }

 private:
  void miss(const char* group, const char* name, const char* kind) {
    if (missing_.empty()) {
      missing_ = std::string(group) + "." + name + " is no " + kind;
    }
  }

  const JsonValue& root_;
  std::string missing_;
};

void take_label(const JsonValue& label, std::string& text) {
  if (label.is_string() && !label.text().empty()) {
    text = label.text();
  }
}

Problem check_version(const JsonValue& root, const std::string& file) {
  if (!root["version"].is_string()) {
    return bad_input(file + ": version is no text; " + kExpectation);
  }
  const std::string& version = root["version"].text();
  if (version != app::kVersion) {
    return bad_input(file + ": written by emax " + printable(version) + ", and this is emax " +
                     app::kVersion + "; expected files of one version: run emax report anew");
  }
  return {};
}

void take_trials(const JsonValue& trials, Taker& taker, Result& result) {
  result.has_uncertainty = trials.kind() == JsonValue::Kind::kObject && trials["u"].is_number();
  if (!result.has_uncertainty) {
    return;
  }
  result.distribution = taker.text("monte_carlo", "distribution");
  const bool is_box = result.distribution == "box";
  result.u_energy_v2s = (is_box ? sqrt(3.0) : 1.0) * taker.number("monte_carlo", "u");
  result.probability = taker.number("monte_carlo", "probability");
  const Interval interval = taker.interval("monte_carlo", "interval");
  result.low_v2s = interval.low;
  result.high_v2s = interval.high;
}

}  // namespace

Problem read_result(const std::string& path, Result& result) {
  result = {};
  result.path = path;
  result.file = name_of_input(path);
  std::string text;
  if (Problem problem = read_text_file(path, kMaxFileSize, kExpectation, text)) {
    return problem;
  }
  JsonValue root;
  const JsonError error = parse_json(text, root);
  if (stop_requested()) {
    return stopped();
  }
  if (error.problem != nullptr) {
    return bad_input(result.file + ":" + std::to_string(error.line) + ":" +
                     std::to_string(error.column) + ": " + error.problem + "; " + kExpectation);
  }
  if (Problem problem = check_version(root, result.file)) {
    return problem;
  }
  if (root["energy"].kind() != JsonValue::Kind::kObject || !root["energy"]["E"].is_number()) {
    return bad_input(result.file + ": holds no maximum energy, its measurement has failed; " +
                     kExpectation + " that ended well");
  }
  result.device = result.file;
  take_label(root["labels"]["device"], result.device);
  take_label(root["labels"]["serial"], result.serial);
  Taker taker(root);
  result.order = taker.number("filter", "order");
  result.cutoff_hz = taker.number("filter", "cutoff");
  result.gain_mode = taker.text("filter", "gain_mode");
  result.gain = taker.number("filter", "gain");
  result.limit_mps2 = taker.number("energy", "a");
  result.duration_s = taker.number("energy", "T");
  result.criterion = taker.text("energy", "criterion");
  result.method = taker.text("energy", "method");
  result.energy_v2s = taker.number("energy", "E");
  result.sensitivity = taker.number("model", "S");
  result.has_bound = root["energy"]["bound"].is_number();
  result.bound_v2s = root["energy"]["bound"].number();
  take_trials(root["monte_carlo"], taker, result);
  if (!taker.missing().empty()) {
    return bad_input(result.file + ": " + taker.missing() + "; " + kExpectation);
  }
  return {};
}

}  // namespace emax::desk
