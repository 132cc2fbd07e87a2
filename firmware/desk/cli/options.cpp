// The command line of `emax report`.
#include "desk/cli/options.hpp"

#include <vector>

#include "emax/base/elementary.hpp"

#include "desk/cli/option_parser.hpp"
#include "desk/cli/option_table.hpp"
#include "desk/cli/setting_options.hpp"
#include "desk/report/model_check.hpp"

namespace emax::desk {

namespace {

Problem excluded(const Given& given, const std::string& source) {
  return bad_input("--" + given.option->name + ": excluded by " + source +
                   "; expected only where the simulated bench measures");
}

Problem check_source(const std::vector<Given>& all, const ReportOptions& options) {
  const bool has_model = !options.model_text.empty();
  if (has_model && !options.points_path.empty()) {
    return bad_input("--model: excludes --points; expected one of the two");
  }
  const std::string source = has_model ? "--model" : "--points";
  if (!options.instrument.empty() && !options.measures()) {
    return bad_input("--instrument: excludes " + source + "; expected one of the two");
  }
  for (const Given& given : all) {
    if (!options.instrument.empty() && given.option->name.compare(0, 6, "bench-") == 0) {
      return bad_input("--" + given.option->name +
                       ": describes the simulated bench; excluded by --instrument");
    }
  }
  for (const Given& given : all) {
    if (given.option->is_for_bench && !options.measures()) {
      return excluded(given, source);
    }
  }
  for (const Given& given : all) {
    if (given.option->heading == kTableHeading && options.points_path.empty()) {
      return bad_input("--" + given.option->name + ": no table; expected --points FILE with it");
    }
  }
  if (has_model && options.reference_uncertainty_percent != 0.0) {
    return bad_input(
        "--reference-uncertainty: excluded by --model; expected with points, since the "
        "uncertainties of a model contain it");
  }
  if (has_model && options.settings.birge) {
    return bad_input(
        "--birge: excluded by --model; expected with points: the ratio belongs to their fit");
  }
  return has_model ? check_model(options.device) : Problem{};
}

// The simulated bench is built as it is described: what the settings of the sweep say of the chain
// is nominal, and what is drawn of it lies within the uncertainties stated.
void tell_sweep_about_bench(const std::vector<Given>& all, ReportOptions& options) {
  if (!is_given(all, "reference-uncertainty") && options.measures()) {
    options.reference_uncertainty_percent =
        app::default_sweep_settings().reference.expanded_percent;
  }
  sim::BenchSettings& bench = options.bench;
  app::SweepSettings& sweep = options.sweep;
  bench.reference_expanded_percent = options.reference_uncertainty_percent;
  sweep.reference.expanded_percent = options.reference_uncertainty_percent;
  bench.reference_sensitivity = app::sensitivity_at(sweep.reference, sweep.check_hz);
  bench.reference_gain = sweep.reference_gain;
  bench.device_gain = sweep.device_gain;
  bench.gain_expanded_percent =
      emax::sqrt(sweep.reference_gain_expanded_percent * sweep.reference_gain_expanded_percent +
                 sweep.device_gain_expanded_percent * sweep.device_gain_expanded_percent);
  bench.ratio_expanded_percent = sweep.ratio_expanded_percent;
  bench.front_end = {sweep.drive_full_scale_v, sweep.reference_full_scale_v,
                     sweep.device_full_scale_v};
  bench.mounting_expanded_percent = sweep.mounting_expanded_percent;
  bench.skew_expanded_s = sweep.skew_expanded_s;
  bench.clock_expanded_ppm = sweep.clock_expanded_ppm;
  bench.crosstalk_expanded_percent = sweep.crosstalk_expanded_percent;
  bench.linearity_expanded_percent = sweep.linearity_expanded_percent;
  if (is_given(all, "bench-truth") && !is_given(all, "device-sensitivity")) {
    sweep.expected_sensitivity = bench.device.sensitivity;
  }
}

app::SettingsError check_settings(const ReportOptions& options) {
  if (options.seed_count < 4 && options.settings.generator != Generator::k1982) {
    return {"seed", "four whole numbers; three do with --generator 1982 only"};
  }
  const app::SettingsError error = app::check(options.settings);
  // What an instrument can do, it says itself.
  return error.setting == nullptr && options.measures() && options.instrument.empty()
             ? app::check(options.sweep, sim::kBenchFormat)
             : error;
}

// The reference on the simulated bench is as sensitive at all frequencies.
bool contradicts_bench(const ReportOptions& options) noexcept {
  constexpr double kPercent = 100.0;
  const app::ReferenceCalibration& reference = options.sweep.reference;
  bool differs = false;
  for (std::size_t i = 0; i < reference.count; ++i) {
    const double off = reference.sensitivity[i] / options.bench.reference_sensitivity - 1.0;
    differs = differs || !(kPercent * emax::abs(off) <= options.reference_uncertainty_percent);
  }
  return differs && options.measures() && options.instrument.empty();
}

Problem check_reference_table(const Given& given, const ReportOptions& options) {
  return contradicts_bench(options)
             ? wrong_value(given,
                           "sensitivities that differ from that at the check frequency by "
                           "--reference-uncertainty at most: the reference of the simulated bench "
                           "has one at all frequencies; a table with a slope is for --instrument")
             : Problem{};
}

Problem check_settings(const std::vector<Given>& all, ReportOptions& options) {
  const app::SettingsError error = check_settings(options);
  if (error.setting == nullptr) {
    for (const Given& given : all) {
      if (given.option->name == "reference-table") {
        return check_reference_table(given, options);
      }
    }
    return {};
  }
  const std::string name(option_of_setting(error.setting));
  const bool is_of_table = is_given(all, "reference-table") &&
                           (name == "reference table" || name == "reference sensitivity");
  for (const Given& given : all) {
    if (is_of_table && given.option->name == "reference-table") {
      const bool is_value = name == "reference sensitivity";
      return wrong_value(given,
                         (is_value ? "sensitivities " : "") + std::string(error.expectation));
    }
    if (given.option->name == name) {
      return wrong_value(given, error.expectation);
    }
  }
  const std::vector<Option> known = report_options(options);
  const Option* option = find_option(known, name);
  const bool has_default = option != nullptr && !option->by_default.empty();
  return bad_input("--" + name + ": " + (has_default ? option->by_default + " by default; " : "") +
                   "expected " + error.expectation);
}

const char* or_null(const std::string& text) noexcept {
  return text.empty() ? nullptr : text.c_str();
}

}  // namespace

std::vector<app::NamedLabel> ReportOptions::more_labels() const {
  std::vector<app::NamedLabel> more;
  for (std::size_t i = 0; i < kLabelRowCount; ++i) {
    if (!certificate[i].empty()) {
      more.push_back({kLabelRows[i].key, kLabelRows[i].name, certificate[i].c_str()});
    }
  }
  for (const OwnLabel& own : own_labels) {
    more.push_back({own.name.c_str(), own.name.c_str(), own.words.c_str()});
  }
  return more;
}

const std::string* ReportOptions::given_value(std::string_view name) const noexcept {
  for (const GivenText& option : given) {
    if (option.name == name) {
      return &option.value;
    }
  }
  return nullptr;
}

app::Labels ReportOptions::labels(const std::vector<app::NamedLabel>& more) const noexcept {
  return {or_null(device_name), or_null(serial), or_null(operated_by),
          or_null(date),        or_null(note),   {more.data(), more.size()}};
}

Problem parse_report_options(Span<const std::string_view> arguments, ReportOptions& options) {
  Syntax syntax;
  syntax.options = report_options(options);
  syntax.other_words = other_words();
  syntax.expected = "options, such as --points FILE";
  std::vector<Given> all;
  const Problem problem = parse_options(arguments, syntax, all);
  return problem ? problem : check_report_options(all, options);
}

Problem check_report_options(const std::vector<Given>& all, ReportOptions& options) {
  if (Problem problem = check_source(all, options)) {
    return problem;
  }
  options.given.clear();
  for (const Given& given : all) {
    options.given.push_back({given.option->name, std::string(given.value)});
  }
  tell_sweep_about_bench(all, options);
  return check_settings(all, options);
}

std::string help_on_report_options() {
  ReportOptions options;
  return help_on(report_options(options));
}

}  // namespace emax::desk
