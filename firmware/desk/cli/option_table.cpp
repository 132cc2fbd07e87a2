// The options of `emax report`: settings by their rows, here where the device comes from, and what
// is printed.
#include "desk/cli/option_table.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>

#include "emax/base/capacity.hpp"

#include "desk/cli/setting_options.hpp"
#include "desk/cli/value_text.hpp"
#include "desk/import/import_options.hpp"

namespace emax::desk {

namespace {

constexpr double kMaxReferencePercent = 50.0;
constexpr double kMaxFaultTime_s = 1e6;
constexpr double kDefaultFaultTime_s = 3.0;
constexpr double kMaxNoise_v = 1.0;
constexpr double kMaxDriftPercent = 50.0;
constexpr double kMaxSkew_s = 4e-6;  // Of the bench, whose interval is 10 us.

constexpr const char* kExpectedFault =
    "none, lost-block, late-block, stuck-channel, saturation, unplugged-reference, "
    "unplugged-device, swapped-channels, inverted-polarity, dc-drift or gain-step, and perhaps "
    "@SECONDS; one or two of them";

constexpr bool is_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

bool take_model(std::string_view text, ReportOptions& options) {
  const Numbers list = take_list(text);
  if (!list.valid || (list.count != 3 && list.count != 6)) {
    return false;
  }
  options.model_text = text;
  options.device.estimate = {list.values[0], list.values[1], list.values[2]};
  options.device.u = {list.values[3], list.values[4], list.values[5]};
  return true;
}

bool take_reference(std::string_view text, ReportOptions& options) noexcept {
  double& percent = options.reference_uncertainty_percent;
  return take_number(text, percent) && is_within(percent, 0.0, kMaxReferencePercent);
}

bool take_seed(std::string_view text, ReportOptions& options) noexcept {
  const Numbers list = take_list(text);
  if (!list.valid || list.count < 3 || list.count > 4) {
    return false;
  }
  options.seed_count = list.count;
  for (std::size_t i = 0; i < list.count; ++i) {
    if (!to_integer(list.values[i], options.settings.seed[i])) {
      return false;
    }
  }
  return true;
}

bool take_trend(std::string_view text, ReportOptions& options) noexcept {
  if (text == "none") {
    options.settings.trend_count = 0;
    return true;
  }
  const Numbers list = take_list(text);
  if (!list.valid || list.count < 2 || list.count > app::kMaxTrendPoints) {
    return false;
  }
  options.settings.trend_count = list.count;
  std::copy_n(list.values, list.count, options.settings.trend_s.begin());
  return true;
}

bool take_frequencies(std::string_view text, ReportOptions& options) noexcept {
  const Numbers list = take_list(text);
  if (!list.valid || list.count > kMaxPoints) {
    return false;
  }
  options.sweep.frequency_count = list.count;
  std::copy_n(list.values, list.count, options.sweep.frequency_hz.begin());
  return true;
}

bool take_reference_sensitivity(std::string_view text, ReportOptions& options) noexcept {
  double value = 0.0;
  if (!take_number(text, value) || !is_within(value, 1e-9, 1e9)) {
    return false;
  }
  options.sweep.reference.count = 1;
  options.sweep.reference.frequency_hz[0] = 0.0;
  options.sweep.reference.sensitivity[0] = value;
  return true;
}

bool take_reference_table(std::string_view text, ReportOptions& options) noexcept {
  const Numbers list = take_list(text);
  if (!list.valid || list.count % 2 != 0 || list.count < 4 ||
      list.count > 2 * app::kMaxReferencePoints) {
    return false;
  }
  app::ReferenceCalibration& reference = options.sweep.reference;
  reference.count = list.count / 2;
  for (std::size_t i = 0; i < reference.count; ++i) {
    reference.frequency_hz[i] = list.values[2 * i];
    reference.sensitivity[i] = list.values[2 * i + 1];
  }
  return true;
}

bool take_bench_seed(std::string_view text, ReportOptions& options) noexcept {
  std::uint32_t seed = 0;
  const bool valid = take_integer(text, seed);
  options.bench.seed = seed;
  return valid;
}

bool take_bench_truth(std::string_view text, ReportOptions& options) noexcept {
  const Numbers list = take_list(text);
  const double* values = list.values;
  if (!list.valid || list.count != 3 || !is_within(values[0], 1e-5, 1e3) ||
      !is_within(values[1], 1.0, 1e6) || !is_within(values[2], 1e-3, 1.0) || values[2] == 1.0) {
    return false;
  }
  options.bench.device = {values[0], values[1], values[2]};
  return true;
}

bool take_bench_noise(std::string_view text, ReportOptions& options) noexcept {
  return take_number(text, options.bench.noise_v) &&
         is_within(options.bench.noise_v, 0.0, kMaxNoise_v);
}

// "V" or "V,HZ".
bool take_bench_hum(std::string_view text, ReportOptions& options) noexcept {
  const Numbers list = take_list(text);
  if (!list.valid || list.count > 2 || !is_within(list.values[0], 0.0, kMaxNoise_v)) {
    return false;
  }
  options.bench.hum_v = list.values[0];
  options.bench.hum_hz = list.count == 2 ? list.values[1] : options.bench.hum_hz;
  return is_within(options.bench.hum_hz, 0.0, 1000.0);
}

bool take_bench_ratio(std::string_view text, ReportOptions& options) noexcept {
  return take_number(text, options.bench.ratio) && is_within(options.bench.ratio, 0.1, 10.0);
}

bool take_bench_skew(std::string_view text, ReportOptions& options) noexcept {
  return take_number(text, options.bench.skew_s) &&
         is_within(options.bench.skew_s, -kMaxSkew_s, kMaxSkew_s);
}

bool take_bench_drift(std::string_view text, ReportOptions& options) noexcept {
  return take_number(text, options.bench.drift_expanded_percent) &&
         is_within(options.bench.drift_expanded_percent, 0.0, kMaxDriftPercent);
}

bool take_fault(std::string_view text, sim::Fault& fault) {
  const std::size_t at = text.find('@');
  double time_s = kDefaultFaultTime_s;
  if (at != std::string_view::npos &&
      (!take_number(text.substr(at + 1), time_s) || !is_within(time_s, 0.0, kMaxFaultTime_s))) {
    return false;
  }
  const sim::ParsedFault parsed = sim::parse_fault(std::string(text.substr(0, at)).c_str());
  const double frame = emax::floor(time_s * sim::kBenchFormat.sample_rate_hz + 0.5);
  fault = {parsed.kind, static_cast<std::uint64_t>(frame)};
  return parsed.known;
}

bool take_bench_fault(std::string_view text, ReportOptions& options) {
  const std::size_t comma = text.find(',');
  options.bench.second_fault = {};
  return take_fault(text.substr(0, comma), options.bench.fault) &&
         (comma == std::string_view::npos ||
          take_fault(text.substr(comma + 1), options.bench.second_fault));
}

bool take_damping(std::string_view text, ReportOptions& options) noexcept {
  return take_number(text, options.damping) && is_within(options.damping, 1e-4, 1.0) &&
         options.damping != 1.0;
}

bool take_threads(std::string_view text, ReportOptions& options) noexcept {
  if (text == "all") {
    options.threads = static_cast<std::uint32_t>(count_cores());
    return true;
  }
  return take_integer(text, options.threads) && options.threads >= 1 &&
         options.threads <= kMaxThreads;
}

using Take = bool (*)(std::string_view text, ReportOptions& options);

// Options that are written down one below the other, with what they write to.
class Builder {
 public:
  Builder(ReportOptions& target, const char* heading, bool is_for_bench = false)
      : target_(target), heading_(heading), is_for_bench_(is_for_bench) {}

  Builder& add(const char* name, const char* value, const char* by_default, const char* expectation,
               const char* help, Take take) {
    ReportOptions& target = target_;
    options_.push_back({name, heading_, value, by_default, expectation, help,
                        [take, &target](std::string_view text) { return take(text, target); },
                        is_for_bench_});
    return *this;
  }
  Builder& add_text(const char* name, const char* value, const char* expectation, const char* help,
                    std::string& text) {
    options_.push_back({name, heading_, value, "", expectation, help,
                        [&text](std::string_view given) { return take_text(given, text); },
                        is_for_bench_});
    return *this;
  }
  Builder& add_switch(const char* name, const char* help, bool& flag) {
    options_.push_back({name, heading_, "", "", "", help,
                        [&flag](std::string_view) { return flag = true; }, is_for_bench_});
    return *this;
  }
  const std::vector<Option>& options() const noexcept { return options_; }

 private:
  ReportOptions& target_;
  const char* heading_;
  bool is_for_bench_;
  std::vector<Option> options_;
};

std::vector<Option> device_options(ReportOptions& options) {
  Builder builder(options, "The device");
  builder
      .add_text("points", "FILE", "the name of a CSV file, or -",
                "measured points, 3 to " EMAX_TEXT_OF(
                    EMAX_MAX_POINTS) " lines of a table:\n"
                                     "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg;\n"
                                     "amplitude in V/(m/s^2), a lag negative, expanded\n"
                                     "uncertainties (k = 2); or with a header that names\n"
                                     "columns and units; - reads standard input",
                options.points_path)
      .add_text("instrument", "PORT", "HOST:PORT or a serial line",
                "a board with emax that measures: HOST:PORT, or a\n"
                "serial line such as /dev/ttyACM0. Its limits, full\n"
                "scales, gains, reference and corrections stay as they\n"
                "are set there, but for what is given; *RCL 1 before\n"
                "recalls what was saved. This program evaluates. Ctrl-C\n"
                "stops the board's sweep, too",
                options.instrument)
      .add("model", "S,f0,beta[,uS,uf0,ubeta]", "",
           "three or six numbers, S,f0,beta[,uS,uf0,ubeta]",
           "known parameters: sensitivity in V/(m/s^2), natural\n"
           "frequency in Hz, damping (0.0001 to below 1); then\n"
           "their standard uncertainties, without which there is\n"
           "no Monte Carlo part",
           take_model)
      .add("reference-uncertainty", "PERCENT", "0", "a number of percent from 0 to 50",
           "expanded uncertainty (k = 2) that all amplitudes have\n"
           "in common. With --points it is a part of the table's\n"
           "uncertainties: the reference sensor, gains, mounting.\n"
           "On the bench it is that of the reference sensor alone,\n"
           "0.5 unless given",
           take_reference);
  return builder.options();
}

bool take_uncertainty(std::string_view text, ReportOptions& options) {
  return take_uncertainty(text, options.import);
}

bool take_input_units(std::string_view text, ReportOptions& options) {
  return take_input_units(text, options.import);
}

bool take_channel_delay(std::string_view text, ReportOptions& options) {
  return take_channel_delay(text, options.import);
}

std::vector<Option> table_options(ReportOptions& options) {
  Builder builder(options, kTableHeading);
  builder
      .add("uncertainty", "UA,UPHASE", "", kExpectedUncertaintyOption,
           "expanded uncertainties (k = 2) of amplitude and phase,\n"
           "such as 1%,1deg, for a table without columns of them",
           take_uncertainty)
      .add("input-units", "UNITS", "", kExpectedInputUnits,
           "of columns whose header names none, such as mV/g or\n"
           "kHz,mV/(m/s2),rad",
           take_input_units)
      .add("channel-delay", "SECONDS", "", kExpectedChannelDelay,
           "known delay of the device's channel, relative to the\n"
           "reference's; it is taken out of the phases",
           take_channel_delay)
      .add_switch("invert",
                  "adds 180 degrees to every phase: the sensor was\n"
                  "mounted or wired the wrong way round",
                  options.import.is_inverted)
      .add("damping", "BETA", "", "a number from 0.0001 to below 1",
           "damping, where the points of the table do not\n"
           "determine it",
           take_damping);
  return builder.options();
}

std::vector<Option> own_bench_options(ReportOptions& options) {
  Builder builder(options, kBenchHeading, true);
  builder
      .add("bench-seed", "N", "1", "a whole number from 0 to 4294967295",
           "seed of its noise and of its unknown errors", take_bench_seed)
      .add("bench-truth", "S,f0,beta", "1.037,4073,0.3182",
           "three numbers: S from 1e-5 to 1000 V/(m/s^2), f0 from 1 to 1e6 Hz, beta from 0.001 to "
           "below 1",
           "the device that is mounted; S is also what its data\n"
           "sheet says, unless --device-sensitivity does",
           take_bench_truth)
      .add("bench-noise", "VOLTS", "0.005", "a number of V from 0 to 1",
           "noise of each channel, rms, in V", take_bench_noise)
      .add("bench-hum", "VOLTS[,HZ]", "0.0002,49.97", "0 to 1 V, and perhaps 0 to 1000 Hz",
           "hum of the mains in each channel; a third as much at\n"
           "three times the frequency",
           take_bench_hum)
      .add("bench-drift", "PERCENT", "0.02", "a number of percent from 0 to 50",
           "drift of the reference in its first 10 s, expanded", take_bench_drift)
      .add("bench-ratio", "X", "1", "0.1 to 10",
           "true ratio of the channels' gains, as in\n"
           "--correction-ratio",
           take_bench_ratio)
      .add("bench-skew", "SECONDS", "1.25e-6", "seconds within 4e-6 of either sign",
           "true time between the samples of the channels, as in\n"
           "--correction-skew",
           take_bench_skew)
      .add("bench-fault", "NAME[@SECONDS][,NAME[@SECONDS]]", "none", kExpectedFault,
           "what goes wrong, and when (default 3 s after the\n"
           "start; the sweep takes 6): lost-block, late-block,\n"
           "stuck-channel, saturation, unplugged-reference,\n"
           "unplugged-device, swapped-channels,\n"
           "inverted-polarity, dc-drift, gain-step",
           take_bench_fault);
  return builder.options();
}

// Those of the rows, with the list of frequencies, and what the rows of the reference say.
std::vector<Option> bench_setting_options(ReportOptions& options) {
  std::vector<Option> all = sweep_setting_options(options.sweep);
  for (Option& option : all) {
    if (option.name == "frequencies") {
      option.take = [&options](std::string_view text) { return take_frequencies(text, options); };
    }
  }
  Builder builder(options, kBenchHeading, true);
  builder
      .add("reference-sensitivity", "V/(M/S2)", "0.1", "a number above 0",
           "sensitivity of the reference sensor, in V/(m/s^2)", take_reference_sensitivity)
      .add("reference-table", "F1,S1,...", "", "2 to 64 pairs of Hz and V/(m/s^2)",
           "sensitivity of the reference sensor over frequency,\n"
           "with straight lines between the points",
           take_reference_table);
  const std::vector<Option>& more = builder.options();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

constexpr const char* kTrialsHeading = "Monte Carlo";

std::vector<Option> thread_options(ReportOptions& options) {
  Builder builder(options, kTrialsHeading);
  builder.add("threads", "N|all", "all", "a whole number from 1 to 64, or all",
              "number of cores to use; the results do not depend on\n"
              "it",
              take_threads);
  return builder.options();
}

// Those of the rows, with the two that are lists, and with the threads behind the other options of
// the trials.
std::vector<Option> evaluation_options(ReportOptions& options) {
  std::vector<Option> all = setting_options(options.settings);
  for (Option& option : all) {
    if (option.name == "seed") {
      option.take = [&options](std::string_view text) { return take_seed(text, options); };
    } else if (option.name == "trend") {
      option.take = [&options](std::string_view text) { return take_trend(text, options); };
    }
  }
  const auto is_of_trials = [](const Option& option) { return option.heading == kTrialsHeading; };
  const auto last = std::find_if(all.rbegin(), all.rend(), is_of_trials);
  const std::vector<Option> threads = thread_options(options);
  all.insert(last.base(), threads.begin(), threads.end());
  return all;
}

constexpr const char* kLabelHeading = "Labels, in UTF-8; no result depends on them";

bool is_label_name(std::string_view name) noexcept {
  constexpr std::size_t kLongest = 24;
  constexpr std::string_view kPermitted = "abcdefghijklmnopqrstuvwxyz0123456789_";
  constexpr std::string_view kTaken[] = {"device", "serial", "operator", "date", "note"};
  const bool is_key = std::any_of(std::begin(kLabelRows), std::end(kLabelRows),
                                  [name](const LabelRow& row) { return name == row.key; });
  const bool is_taken =
      is_key || std::find(std::begin(kTaken), std::end(kTaken), name) != std::end(kTaken);
  return !name.empty() && name.size() <= kLongest && !is_taken &&
         name.find_first_not_of(kPermitted) == std::string_view::npos;
}

bool take_own_label(std::string_view text, ReportOptions& options) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const std::string_view name = text.substr(0, equals);
  const bool is_known = std::any_of(options.own_labels.begin(), options.own_labels.end(),
                                    [name](const OwnLabel& own) { return own.name == name; });
  if (equals + 1 >= text.size() || is_known || !is_label_name(name)) {
    return false;
  }
  options.own_labels.push_back({std::string(name), std::string(text.substr(equals + 1))});
  return true;
}

std::vector<Option> certificate_options(ReportOptions& options) {
  Builder builder(options, kLabelHeading);
  for (std::size_t i = 0; i < kLabelRowCount; ++i) {
    const LabelRow& row = kLabelRows[i];
    builder.add_text(row.option, "TEXT", row.expectation, row.help, options.certificate[i]);
  }
  builder.add("label", "KEY=VALUE", "",
              "KEY=VALUE, each KEY once, in small letters, digits and _, and not the name of "
              "another label",
              "another label; may be given more than once", take_own_label);
  std::vector<Option> all = builder.options();
  all.back().may_repeat = true;
  return all;
}

std::vector<Option> label_options(ReportOptions& options) {
  Builder builder(options, kLabelHeading);
  builder
      .add_text("device", "TEXT", "the name of the device", "name of the device, for titles too",
                options.device_name)
      .add_text("serial", "TEXT", "a serial number", "its serial number", options.serial)
      .add_text("operator", "TEXT", "a name", "name of the person who measures",
                options.operated_by)
      .add_text("date", "TEXT", "a date", "date of the measurement, in any form", options.date)
      .add_text("note", "TEXT", "a note",
                "anything else; the text report shows the first 240\n"
                "characters of each label, the page and results.json\n"
                "all of it",
                options.note);
  return builder.options();
}

bool take_units(std::string_view text, ReportOptions& options) noexcept {
  options.in_g = text == "g";
  return options.in_g || text == "si";
}

std::vector<Option> output_options(ReportOptions& options) {
  Builder builder(options, "Output");
  builder
      .add("units", "si|g", "si", "si or g",
           "g: accelerations also in g, sensitivities in V/g, in\n"
           "report and page (standard gravity, 9.80665 m/s^2)",
           take_units)
      .add_switch("json", "results.json on standard output instead of text", options.json)
      .add_text("out", "DIR", "the name of a directory",
                "files as well: report.txt, report.html (one page,\n"
                "also to print), results.json, frequency_response.csv\n"
                "(unless --model; --points can read it, with the\n"
                "report's expanded common part as\n"
                "--reference-uncertainty), impulse_response.csv,\n"
                "signal.csv, trend.csv, histogram.csv; a picture (SVG)\n"
                "of each by gnuplot and its script, pictures.gp; DIR\n"
                "is made if missing, and files of an earlier run are\n"
                "replaced",
                options.out_directory)
      .add_text("dcc", "FILE", "the name of a file",
                "also a Digital Calibration Certificate, XML by PTB's\n"
                "schema 3.2.1, not signed; takes the labels --device,\n"
                "--serial, --operator, --date (YYYY-MM-DD),\n"
                "--certificate-number, --laboratory, --country and\n"
                "--customer",
                options.dcc_path);
  return builder.options();
}

void append(std::vector<Option>& all, const std::vector<Option>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

std::vector<Option> report_options(ReportOptions& options) {
  std::vector<Option> all = device_options(options);
  append(all, table_options(options));
  append(all, own_bench_options(options));
  append(all, bench_setting_options(options));
  append(all, evaluation_options(options));
  append(all, label_options(options));
  append(all, certificate_options(options));
  append(all, output_options(options));
  return all;
}

std::vector<Option> bench_options(ReportOptions& options) {
  std::vector<Option> all = {report_option(options, "reference-uncertainty",
                                           "expanded uncertainty (k = 2) of the reference sensor")};
  append(all, own_bench_options(options));
  append(all, bench_setting_options(options));
  all[0].heading = kBenchHeading;
  all[0].by_default = "0.5";
  return all;
}

std::vector<std::pair<std::string_view, std::string_view>> other_words() {
  return {{"--common-uncertainty", "--reference-uncertainty"}};
}

Option report_option(ReportOptions& options, const char* name, const char* help) {
  const std::vector<Option> all = report_options(options);
  Option option = *find_option(all, name);
  option.help = help != nullptr ? help : option.help;
  return option;
}

}  // namespace emax::desk
