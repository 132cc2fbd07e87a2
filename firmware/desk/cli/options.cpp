// The command line of `emax report`.
#include "desk/cli/options.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

#include "desk/cli/console.hpp"
#include "desk/cli/nearest.hpp"
#include "desk/cli/option_table.hpp"
#include "desk/report/model_check.hpp"

namespace emax::host {

namespace {

// An option of the table with the value that it was given.
struct Given {
  const Option* option = nullptr;
  std::string_view value;
};

bool is_for_table(const Option& option) noexcept {
  constexpr std::string_view kNames[] = {"uncertainty", "input-units", "channel-delay", "invert",
                                         "damping"};
  return std::find(std::begin(kNames), std::end(kNames), option.name) != std::end(kNames);
}

std::string dashed(std::string_view name) { return "--" + std::string(name); }

Problem unknown_option(std::string_view name) {
  std::vector<std::string_view> names = {"help", "version"};
  for (const Option& option : option_table()) {
    names.push_back(option.name);
  }
  const std::string_view meant =
      nearest(name, Span<const std::string_view>(names.data(), names.size()));
  return bad_input(printable(dashed(name)) + ": unknown option; did you mean " + dashed(meant) +
                   "?");
}

Problem no_value(const Option& option) {
  return bad_input(dashed(option.name) + ": no value; expected " + option.expectation);
}

Problem wrong_value(const Given& given, const char* expectation) {
  return bad_input(dashed(given.option->name) + ": \"" + printable(given.value) +
                   "\" given; expected " + expectation);
}

// One argument, or two, as an option of the table; advances beyond them.
Problem next_option(Span<const std::string_view> arguments, std::size_t& index, Given& given) {
  const std::string_view argument = arguments[index++];
  if (argument.size() < 3 || argument.substr(0, 2) != "--") {
    return bad_input(printable(argument) +
                     ": unexpected argument; expected options, such as --points FILE");
  }
  const std::size_t equals = argument.find('=');
  const bool has_value = equals != std::string_view::npos;
  const std::string_view name = argument.substr(2, has_value ? equals - 2 : equals);
  given.option = find_option(name);
  if (given.option == nullptr) {
    return unknown_option(name);
  }
  if (given.option->value == nullptr) {
    return has_value ? bad_input(dashed(name) + ": takes no value; expected just " + dashed(name))
                     : Problem{};
  }
  if (has_value) {
    given.value = argument.substr(equals + 1);
    return given.value.empty() ? no_value(*given.option) : Problem{};
  }
  if (index == arguments.size() || arguments[index].substr(0, 2) == "--") {
    return no_value(*given.option);
  }
  given.value = arguments[index++];
  return given.value.empty() ? no_value(*given.option) : Problem{};
}

Problem take_option(const Given& given, std::vector<Given>& all, ReportOptions& options) {
  for (const Given& earlier : all) {
    if (earlier.option == given.option) {
      return bad_input(dashed(given.option->name) + ": given twice; expected once");
    }
  }
  all.push_back(given);
  if (!given.option->take(given.value, options)) {
    return wrong_value(given, given.option->expectation);
  }
  return {};
}

Problem check_source(const std::vector<Given>& all, const ReportOptions& options) {
  const bool has_model = !options.model_text.empty();
  if (has_model && !options.points_path.empty()) {
    return bad_input("--model: excludes --points; expected one of the two");
  }
  const std::string source = has_model ? "--model" : "--points";
  for (const Given& given : all) {
    if (given.option->is_for_bench && !options.measures()) {
      return bad_input(dashed(given.option->name) + ": excluded by " + source +
                       "; expected only where the simulated bench measures");
    }
  }
  for (const Given& given : all) {
    if (is_for_table(*given.option) && options.points_path.empty()) {
      return bad_input(dashed(given.option->name) + ": no table; expected --points FILE with it");
    }
  }
  if (has_model && options.reference_uncertainty_percent != 0.0) {
    return bad_input(
        "--reference-uncertainty: excluded by --model; expected with points, since the "
        "uncertainties of a model contain it");
  }
  return has_model ? check_model(options.device) : Problem{};
}

// What is one number on the bench and in the settings of the sweep.
void tell_sweep_about_bench(const std::vector<Given>& all, ReportOptions& options) {
  const app::SweepSettings by_default;
  const bool is_given = std::any_of(all.begin(), all.end(), [](const Given& given) {
    return given.option->name == "reference-uncertainty";
  });
  if (!is_given && options.measures()) {
    options.reference_uncertainty_percent = by_default.reference.expanded_percent;
  }
  sim::BenchSettings& bench = options.bench;
  app::SweepSettings& sweep = options.sweep;
  bench.reference_expanded_percent = options.reference_uncertainty_percent;
  sweep.reference.expanded_percent = options.reference_uncertainty_percent;
  sweep.reference.sensitivity[0] = bench.reference_sensitivity;
  sweep.reference_gain = bench.reference_gain;
  sweep.device_gain = bench.device_gain;
  sweep.gain_expanded_percent = bench.gain_expanded_percent;
  sweep.mounting_expanded_percent = bench.mounting_expanded_percent;
  sweep.skew_s = bench.skew_s;
}

// The sweep has names of its own for some settings.
app::SettingsError check_sweep(const ReportOptions& options) {
  app::SettingsError error = app::check(options.sweep, sim::kBenchFormat);
  constexpr struct {
    std::string_view setting;
    const char* option;
  } kNames[] = {{"acceleration limit", "acceleration-limit"},
                {"drive limit", "drive-limit"},
                {"settling time", "settle"}};
  for (const auto& name : kNames) {
    if (error.setting != nullptr && error.setting == name.setting) {
      error.setting = name.option;
    }
  }
  return error;
}

app::SettingsError check_settings(const ReportOptions& options) {
  if (options.seed_count < 4 && options.settings.generator != Generator::k1982) {
    return {"seed", "four whole numbers; three do with --generator 1982 only"};
  }
  const app::SettingsError error = app::check(options.settings);
  return error.setting == nullptr && options.measures() ? check_sweep(options) : error;
}

Problem check_settings(const std::vector<Given>& all, const ReportOptions& options) {
  const app::SettingsError error = check_settings(options);
  if (error.setting == nullptr) {
    return {};
  }
  for (const Given& given : all) {
    if (given.option->name == error.setting) {
      return wrong_value(given, error.expectation);
    }
  }
  const Option* option = find_option(error.setting);
  const bool has_default = option != nullptr && option->by_default != nullptr;
  return bad_input(dashed(error.setting) + ": " +
                   (has_default ? std::string(option->by_default) + " by default; " : "") +
                   "expected " + error.expectation);
}

// Of the help: where descriptions start, and where lines end.
constexpr std::size_t kColumn = 25;
constexpr std::size_t kWidth = 80;

void add_lines(std::string& text, const char* lines) {
  for (; *lines != '\0'; ++lines) {
    if (text.back() == '\n') {
      text.append(kColumn, ' ');
    }
    text.push_back(*lines);
  }
}

void add_help(std::string& text, const Option& option) {
  if (option.heading != nullptr) {
    text += std::string("\n") + option.heading + "\n";
  }
  std::string left = "  " + dashed(option.name);
  if (option.value != nullptr) {
    left += std::string(" ") + option.value;
  }
  text += left;
  text += left.size() + 2 <= kColumn ? std::string(kColumn - left.size(), ' ') : "\n";
  add_lines(text, option.help);
  if (option.by_default != nullptr) {
    const std::string by_default = std::string("(default ") + option.by_default + ")";
    const std::size_t used = text.size() - text.rfind('\n') - 1;
    add_lines(text, used + 1 + by_default.size() <= kWidth ? " " : "\n");
    add_lines(text, by_default.c_str());
  }
  text += "\n";
}

const char* or_null(const std::string& text) noexcept {
  return text.empty() ? nullptr : text.c_str();
}

}  // namespace

app::Labels ReportOptions::labels() const noexcept {
  return {or_null(device_name), or_null(serial), or_null(operated_by), or_null(date),
          or_null(note)};
}

Problem parse_report_options(Span<const std::string_view> arguments, ReportOptions& options) {
  std::vector<Given> all;
  for (std::size_t index = 0; index < arguments.size();) {
    Given given;
    if (Problem problem = next_option(arguments, index, given)) {
      return problem;
    }
    if (Problem problem = take_option(given, all, options)) {
      return problem;
    }
  }
  if (Problem problem = check_source(all, options)) {
    return problem;
  }
  tell_sweep_about_bench(all, options);
  return check_settings(all, options);
}

std::string help_on_report_options() {
  std::string text;
  for (const Option& option : option_table()) {
    add_help(text, option);
  }
  return text;
}

std::string help_on_bench_options() {
  std::string text;
  for (const Option& option : option_table()) {
    if (is_for_console(option)) {
      add_help(text, option);
    }
  }
  return text;
}

}  // namespace emax::host
