// The options of `emax report`, and how the value of each is read.
#include "desk/cli/option_table.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>

#include "emax/base/capacity.hpp"
#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"

#include "desk/import/import_options.hpp"

namespace emax::host {

namespace {

// A list longer than any that is expected.
constexpr std::size_t kMaxList = app::kMaxTrendPoints + 1;

struct Numbers {
  double values[kMaxList] = {};
  std::size_t count = 0;
  bool valid = false;
};

std::string_view without_spaces(std::string_view text) noexcept {
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  while (!text.empty() && text.back() == ' ') {
    text.remove_suffix(1);
  }
  return text;
}

bool take_number(std::string_view text, double& value) noexcept {
  text = without_spaces(text);
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  if (number.status != Status::kOk || number.length != text.size() || !is_finite(number.value)) {
    return false;
  }
  value = number.value;
  return true;
}

template <typename Integer>
bool to_integer(double number, Integer& value) noexcept {
  using Limits = std::numeric_limits<Integer>;
  if (!(number >= static_cast<double>(Limits::min())) ||
      !(number <= static_cast<double>(Limits::max())) || number != emax::floor(number)) {
    return false;
  }
  value = static_cast<Integer>(number);
  return true;
}

template <typename Integer>
bool take_integer(std::string_view text, Integer& value) noexcept {
  double number = 0.0;
  return take_number(text, number) && to_integer(number, value);
}

Numbers take_list(std::string_view text) noexcept {
  Numbers list;
  for (;;) {
    const std::string_view item = text.substr(0, text.find(','));
    if (list.count == kMaxList || !take_number(item, list.values[list.count])) {
      return list;
    }
    ++list.count;
    if (item.size() == text.size()) {
      list.valid = true;
      return list;
    }
    text.remove_prefix(item.size() + 1);
  }
}

template <typename Choice>
bool take_choice(std::string_view text, std::string_view first, Choice first_value,
                 std::string_view second, Choice second_value, Choice& value) noexcept {
  if (text != first && text != second) {
    return false;
  }
  value = text == first ? first_value : second_value;
  return true;
}

bool take_text(std::string_view text, std::string& value) {
  value = text;
  return !text.empty();
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

bool take_gain(std::string_view text, ReportOptions& options) noexcept {
  if (take_choice(text, "auto", app::GainMode::kAuto, "track", app::GainMode::kTrack,
                  options.settings.gain_mode)) {
    return true;
  }
  options.settings.gain_mode = app::GainMode::kFixed;
  return take_number(text, options.settings.gain);
}

bool take_limit(std::string_view text, ReportOptions& options) noexcept {
  options.settings.limit_is_auto = text == "auto";
  return options.settings.limit_is_auto || take_number(text, options.settings.limit_mps2);
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

constexpr double kMaxReferencePercent = 50.0;
constexpr double kMaxFaultTime_s = 1e6;
constexpr double kDefaultFaultTime_s = 3.0;

constexpr const char* kExpectedFault =
    "none, lost-block, late-block, stuck-channel, saturation, unplugged-reference, "
    "unplugged-device, swapped-channels, inverted-polarity or dc-drift, and perhaps @SECONDS";

bool take_bench_seed(std::string_view text, ReportOptions& options) noexcept {
  std::uint32_t seed = 0;
  const bool valid = take_integer(text, seed);
  options.bench.seed = seed;
  return valid;
}

constexpr bool is_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

bool take_bench_truth(std::string_view text, ReportOptions& options) noexcept {
  const Numbers list = take_list(text);
  const double* values = list.values;
  if (!list.valid || list.count != 3 || !is_within(values[0], 1e-3, 1e3) ||
      !is_within(values[1], 1.0, 1e6) || !is_within(values[2], 1e-3, 1.0) || values[2] == 1.0) {
    return false;
  }
  options.bench.device = {values[0], values[1], values[2]};
  options.sweep.expected_sensitivity = values[0];
  return true;
}

bool take_bench_fault(std::string_view text, ReportOptions& options) {
  const std::size_t at = text.find('@');
  double time_s = kDefaultFaultTime_s;
  if (at != std::string_view::npos &&
      (!take_number(text.substr(at + 1), time_s) || !is_within(time_s, 0.0, kMaxFaultTime_s))) {
    return false;
  }
  const sim::ParsedFault parsed = sim::parse_fault(std::string(text.substr(0, at)).c_str());
  const double frame = emax::floor(time_s * sim::kBenchFormat.sample_rate_hz + 0.5);
  options.bench.fault = {parsed.kind, static_cast<std::uint64_t>(frame)};
  return parsed.known;
}

constexpr Option kOptions[] = {
    {"points", "The device", "FILE", nullptr, "the name of a CSV file, or -",
     "measured points, 3 to " EMAX_TEXT_OF(
         EMAX_MAX_POINTS) " lines of a table:\n"
                          "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg;\n"
                          "amplitude in V/(m/s^2), a lag negative, expanded\n"
                          "uncertainties (k = 2); or with a header that names\n"
                          "columns and units; - reads standard input",
     [](std::string_view value, ReportOptions& options) {
       return take_text(value, options.points_path);
     }},
    {"model", nullptr, "S,f0,beta[,uS,uf0,ubeta]", nullptr,
     "three or six numbers, S,f0,beta[,uS,uf0,ubeta]",
     "known parameters: sensitivity in V/(m/s^2), natural\n"
     "frequency in Hz, damping (0.0001 to below 1); then\n"
     "their standard uncertainties, without which there is\n"
     "no Monte Carlo part",
     take_model},
    {"reference-uncertainty", nullptr, "PERCENT", "0", "a number of percent from 0 to 50",
     "of the reference sensor, expanded (k = 2): common to\n"
     "all points; with --points it is taken to be within\n"
     "the uncertainty of each amplitude. 0.5 on the bench",
     [](std::string_view value, ReportOptions& options) {
       double& percent = options.reference_uncertainty_percent;
       return take_number(value, percent) && percent >= 0.0 && percent <= kMaxReferencePercent;
     }},
    {"uncertainty", "Of the table that --points names", "UA,UPHASE", nullptr,
     desk::kExpectedUncertaintyOption,
     "expanded uncertainties (k = 2) of amplitude and phase,\n"
     "such as 1%,1deg, for a table without columns of them",
     [](std::string_view value, ReportOptions& options) {
       return desk::take_uncertainty(value, options.import);
     }},
    {"input-units", nullptr, "UNITS", nullptr, desk::kExpectedInputUnits,
     "of columns whose header names none, such as mV/g or\n"
     "kHz,mV/(m/s2),rad",
     [](std::string_view value, ReportOptions& options) {
       return desk::take_input_units(value, options.import);
     }},
    {"channel-delay", nullptr, "SECONDS", nullptr, desk::kExpectedChannelDelay,
     "known delay of the device's channel behind the\n"
     "reference's; it is taken out of the phases",
     [](std::string_view value, ReportOptions& options) {
       return desk::take_channel_delay(value, options.import);
     }},
    {"invert", nullptr, nullptr, nullptr, nullptr,
     "180 degrees are added to every phase: the polarity of\n"
     "the sensor is turned round",
     [](std::string_view, ReportOptions& options) { return options.import.is_inverted = true; }},
    {"damping", nullptr, "BETA", nullptr, "a number from 0.0001 to below 1",
     "damping, where the table has magnitudes only and does\n"
     "not determine it",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.damping) && is_within(options.damping, 1e-4, 1.0) &&
              options.damping != 1.0;
     }},
    {"bench-seed", "The simulated bench, which measures without --points and --model", "N", "1",
     "a whole number from 0 to 4294967295", "of its noise and of what its certificates leave open",
     take_bench_seed, true},
    {"bench-truth", nullptr, "S,f0,beta", "1.037,4073,0.3182",
     "three numbers: S from 0.001 to 1000 V/(m/s^2), f0 from 1 to 1e6 Hz, beta from 0.001 to below "
     "1",
     "the device that is mounted; S is also what its data\n"
     "sheet says, within a factor of 3",
     take_bench_truth, true},
    {"bench-noise", nullptr, "VOLTS", "0.005", "a number of V from 0 to 1",
     "noise of each channel, rms, in V",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.bench.noise_v) && options.bench.noise_v >= 0.0 &&
              options.bench.noise_v <= 1.0;
     },
     true},
    {"bench-fault", nullptr, "NAME[@SECONDS]", "none", kExpectedFault,
     "what goes wrong, and when (default 3 s after the\n"
     "start; the sweep takes 6): lost-block, late-block,\n"
     "stuck-channel, saturation, unplugged-reference,\n"
     "unplugged-device, swapped-channels,\n"
     "inverted-polarity, dc-drift",
     take_bench_fault, true},
    {"level", nullptr, "MPS2", "1", "a number of m/s^2 above 0",
     "peak acceleration to reach, in m/s^2",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.sweep.level_mps2);
     },
     true},
    {"acceleration-limit", nullptr, "MPS2", "20", "a number of m/s^2 above 0",
     "peak acceleration never to exceed, in m/s^2",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.sweep.limit_mps2);
     },
     true},
    {"drive-limit", nullptr, "VOLTS", "5", "a number of V above 0",
     "peak drive never to exceed, in V, at most 10",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.sweep.drive_limit_v);
     },
     true},
    {"slew", nullptr, "V/S", "100000", "a number of V/s above 0",
     "slope of the drive never to exceed, in V/s",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.sweep.slew_v_per_s);
     },
     true},
    {"settle", nullptr, "SECONDS", "0.01", "a number of seconds from 0 to 10",
     "rest after each ramp, in s; three periods at least",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.sweep.settle_s);
     },
     true},
    {"cycles", nullptr, "N", "3", "a whole number from 1 to 1000",
     "least number of periods in each of five repeats",
     [](std::string_view value, ReportOptions& options) {
       return take_integer(value, options.sweep.cycles);
     },
     true},
    {"order", "The reference filter, a Butterworth low-pass", "L", "10",
     "a whole number from 1 to 15", "order, 1 to 15",
     [](std::string_view value, ReportOptions& options) {
       return take_integer(value, options.settings.filter_order);
     }},
    {"cutoff", nullptr, "HZ", "1000", "a number of Hz above 0", "cutoff frequency (-3 dB) in Hz",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.settings.cutoff_hz);
     }},
    {"gain", nullptr, "auto|NUMBER|track", "auto", "auto, track or a number of V/(m/s^2)",
     "gain in V/(m/s^2): auto is the estimate of S,\n"
     "track the S of each Monte Carlo trial",
     take_gain},
    {"time", "The signal and its energy", "SECONDS", "0.002", "a number of seconds above 0",
     "length T of the signal in s",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.settings.duration_s);
     }},
    {"limit", nullptr, "auto|NUMBER", "auto", "auto or a number of m/s^2 above 0",
     "limit a of the signal in m/s^2, which stays within\n"
     "+-a; auto is the number of S, as in the paper",
     take_limit},
    {"criterion", nullptr, "ise|difference", "ise", "ise or difference",
     "ise: energy of the error, y = ya - yf;\n"
     "difference: energy of ya minus that of yf",
     [](std::string_view value, ReportOptions& options) {
       return take_choice(value, "ise", Criterion::kIntegralSquareError, "difference",
                          Criterion::kEnergyDifference, options.settings.criterion);
     }},
    {"method", nullptr, "best|paper", "best", "best or paper",
     "best: many starts; paper: the fixed point from the\n"
     "first column of Phi, as published",
     [](std::string_view value, ReportOptions& options) {
       return take_choice(value, "best", Method::kBest, "paper", Method::kPaper,
                          options.settings.method);
     }},
    {"step", nullptr, "SECONDS", "2e-6", "a number of seconds above 0",
     "width of a grid cell in s; for --method paper",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.settings.step_s);
     }},
    {"iterations", nullptr, "J", "30", "a whole number from 1 to 1000",
     "iterations at most; for --method paper",
     [](std::string_view value, ReportOptions& options) {
       return take_integer(value, options.settings.iterations);
     }},
    {"trials", "Monte Carlo", "M", "200000", "a whole number from 1000 to 1000000000",
     "number of trials, 1000 to 1e9; a warning below\n"
     "1e4/(1 - p)",
     [](std::string_view value, ReportOptions& options) {
       return take_integer(value, options.settings.trials);
     }},
    {"adaptive", nullptr, nullptr, nullptr, nullptr,
     "the number of trials by JCGM 101 7.9; --trials is\n"
     "then unused",
     [](std::string_view, ReportOptions& options) { return options.settings.adaptive = true; }},
    {"probability", nullptr, "P", "0.95", "a number between 0 and 1",
     "coverage probability p of the intervals",
     [](std::string_view value, ReportOptions& options) {
       return take_number(value, options.settings.probability);
     }},
    {"distribution", nullptr, "box|normal", "box", "box or normal",
     "box: uniform within +-u of each parameter; normal:\n"
     "with the covariance of the fit",
     [](std::string_view value, ReportOptions& options) {
       return take_choice(value, "box", Distribution::kBox, "normal", Distribution::kNormal,
                          options.settings.distribution);
     }},
    {"birge", nullptr, nullptr, nullptr, nullptr,
     "the trials' uncertainties times the fit's Birge\n"
     "ratio, if that is above 1",
     [](std::string_view, ReportOptions& options) { return options.settings.birge = true; }},
    {"seed", nullptr, "A,B,C,D", "123456789,345678901,567890123,789012345",
     "four whole numbers above 0, or three with --generator 1982",
     "start of the random numbers; three numbers will do\n"
     "with --generator 1982",
     take_seed},
    {"generator", nullptr, "2006|1982", "2006", "2006 or 1982",
     "random numbers of Wichmann and Hill",
     [](std::string_view value, ReportOptions& options) {
       return take_choice(value, "2006", Generator::k2006, "1982", Generator::k1982,
                          options.settings.generator);
     }},
    {"trend", "The energy over the length of the signal", "T1,T2,...|none",
     "0.002,0.004,0.006,0.008,0.010", "none or 2 to 16 numbers of seconds",
     "2 to 16 lengths in s, with the straight line through\n"
     "their energies",
     take_trend},
    {"device", "Labels, in UTF-8; no result depends on them", "TEXT", nullptr,
     "the name of the device", "name of the device, for titles too",
     [](std::string_view value, ReportOptions& options) {
       return take_text(value, options.device_name);
     }},
    {"serial", nullptr, "TEXT", nullptr, "a serial number", "its serial number",
     [](std::string_view value, ReportOptions& options) {
       return take_text(value, options.serial);
     }},
    {"operator", nullptr, "TEXT", nullptr, "a name", "who measures",
     [](std::string_view value, ReportOptions& options) {
       return take_text(value, options.operated_by);
     }},
    {"date", nullptr, "TEXT", nullptr, "a date", "when, in any form",
     [](std::string_view value, ReportOptions& options) { return take_text(value, options.date); }},
    {"note", nullptr, "TEXT", nullptr, "a note",
     "anything else; the text report shows the first 240\n"
     "characters of each label, the page and results.json\n"
     "all of it",
     [](std::string_view value, ReportOptions& options) { return take_text(value, options.note); }},
    {"units", "Output", "si|g", "si", "si or g",
     "g: accelerations also in g, sensitivities in V/g, in\n"
     "report and page (standard gravity, 9.80665 m/s^2)",
     [](std::string_view value, ReportOptions& options) {
       return take_choice(value, "si", false, "g", true, options.in_g);
     }},
    {"json", nullptr, nullptr, nullptr, nullptr, "results.json on standard output instead of text",
     [](std::string_view, ReportOptions& options) { return options.json = true; }},
    {"out", nullptr, "DIR", nullptr, "the name of a directory",
     "files as well: report.txt, report.html (one page,\n"
     "also to print), results.json, frequency_response.csv\n"
     "(unless --model; --points can read it, with the\n"
     "report's expanded common part as\n"
     "--reference-uncertainty), impulse_response.csv,\n"
     "signal.csv, trend.csv, histogram.csv; a picture (SVG)\n"
     "of each by gnuplot and its script, pictures.gp; DIR\n"
     "is made if missing, and files of an earlier run are\n"
     "replaced",
     [](std::string_view value, ReportOptions& options) {
       return take_text(value, options.out_directory);
     }},
};

}  // namespace

Span<const Option> option_table() noexcept { return kOptions; }

const Option* find_option(std::string_view name) noexcept {
  const auto* found = std::find_if(std::begin(kOptions), std::end(kOptions),
                                   [name](const Option& option) { return option.name == name; });
  return found == std::end(kOptions) ? nullptr : found;
}

}  // namespace emax::host
