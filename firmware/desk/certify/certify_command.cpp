// `emax certify`.
#include "desk/certify/certify_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/decimal.hpp"
#include "emax/bound/energy_certificate.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/model/cascade_response.hpp"

#include "desk/certify/certificate_file.hpp"
#include "desk/cli/console.hpp"
#include "desk/cli/console_progress.hpp"
#include "desk/cli/option_parser.hpp"
#include "desk/cli/option_table.hpp"
#include "desk/cli/options.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/cli/value_text.hpp"
#include "desk/compare/name_lines.hpp"
#include "desk/files/points_file.hpp"
#include "desk/files/rounding.hpp"
#include "desk/files/single_file.hpp"
#include "desk/files/text_file.hpp"
#include "desk/report/fit_causes.hpp"

namespace emax::desk {

namespace {

using Clock = std::chrono::steady_clock;

// Of the effort: what the multipliers get; the cases get the rest.
constexpr double kMultipliersShare = 0.8;
// How much longer they get after Ctrl-C, to come to rest.
constexpr double kRest_s = 1.5;
// Iterations that are worth a finer grid, and what one of them takes for each pair of cells.
constexpr double kEnoughIterations = 12000.0;
constexpr double kPair_s = 7e-9;
// No finer than this many times the coarsest grid: roundings then cost less than the rest.
constexpr double kFinest = 6.0;
constexpr std::size_t kMultipliers = 200'000;
constexpr std::size_t kHash = std::size_t{1} << 19;
constexpr std::size_t kLeafNumbers = 6'000'000;
constexpr double kMaxEffort_s = 1e7;

struct CertifyOptions {
  ReportOptions report;
  double effort_s = 60.0;
  std::string out_path;  // Empty for no file.
};

bool take_effort(std::string_view text, double& effort_s) {
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  effort_s = number.value;
  return number.status == Status::kOk && number.length == text.size() && number.value > 0.0 &&
         number.value <= kMaxEffort_s;
}

constexpr char kCriterionHelp[] =
    "ise, the integral-square error, or band, the error within the\n"
    "filter's band against the reference without a delay";

// The first ones mean here what they mean for a report.
Syntax syntax_of(CertifyOptions& options) {
  ReportOptions& report = options.report;
  Syntax syntax;
  for (const char* name :
       {"points", "model", "reference-uncertainty", "uncertainty", "input-units", "channel-delay",
        "invert", "damping", "order", "cutoff", "gain", "time", "limit", "criterion"}) {
    const std::string_view wanted = name;
    const char* const words = wanted == "order"       ? "order, 2 to 15"
                              : wanted == "criterion" ? kCriterionHelp
                                                      : nullptr;
    syntax.options.push_back(report_option(report, name, words));
  }
  syntax.options.push_back(report_option(report, "json",
                                         "{E,bound,gap,cells,multipliers,nodes,seconds,\n"
                                         "E_range,warnings} on standard output instead of text"));
  const std::string heading = syntax.options.back().heading;
  syntax.options.push_back({"effort", heading, "SECONDS", "60", "a number of seconds above 0",
                            "how long to work on the bound", [&options](std::string_view text) {
                              return take_effort(text, options.effort_s);
                            }});
  syntax.options.push_back(
      {"out", heading, "FILE", "", "the name of a file",
       "the certificate, JSON, which\n"
       "host_tests/reference/check_certificate.py verifies",
       [&options](std::string_view text) { return take_text(text, options.out_path); }});
  syntax.unknown = "no option of emax certify";
  syntax.expected = "options, such as --points FILE";
  return syntax;
}

Problem parse(Span<const std::string_view> arguments, CertifyOptions& options) {
  const Syntax syntax = syntax_of(options);
  std::vector<Given> all;
  if (Problem problem = parse_options(arguments, syntax, all)) {
    return problem;
  }
  if (options.report.measures()) {
    return bad_input("certify: no device; expected --model S,f0,beta or --points FILE");
  }
  app::Settings& settings = options.report.settings;
  if (settings.criterion == Criterion::kEnergyDifference) {
    return bad_input(
        "--criterion: the proof needs an energy that is a square; expected ise or band");
  }
  settings.delay_choice = app::DelayChoice::kNone;
  return check_report_options(all, options.report);
}

// The draws of the fit, and the range of E where the points leave the damping open: what a report
// may have to warn of. Where it cannot have them, the proof does not need them.
Problem judge_fit(const ReportOptions& options, app::Evaluation& evaluation,
                  const app::EvaluationResults& results) {
  if (evaluation.pursue(options.settings, app::Goal::kReport) != Status::kOk) {
    return {};
  }
  ConsoleProgress progress;
  const auto is_judged = [&results] {
    return results.has_fit_draws && (!results.is_damping_open() || results.is_cut_done);
  };
  while (!is_judged() && !evaluation.done()) {
    if (stop_requested()) {
      return stopped();
    }
    progress.show(name_of(results.stage), evaluation.progress());
    evaluation.step();
  }
  return {};
}

// Finds the device and the signal with the largest energy known.
Problem find_energy(const ReportOptions& options, app::EvaluationResults& results) {
  static app::EvaluationWorkspace workspace;
  app::Evaluation evaluation(results, workspace);
  Status status = Status::kOk;
  if (options.points_path.empty()) {
    status = evaluation.start_from_model(options.device, options.settings, app::Goal::kEnergy);
  } else {
    static ImportedPoints imported;
    if (Problem problem = read_points(options.points_path, options.import,
                                      options.reference_uncertainty_percent, imported)) {
      return problem;
    }
    evaluation.give_damping(options.damping);
    status = evaluation.start_from_points(imported.points, options.settings, app::Goal::kEnergy);
  }
  const bool has_points = !options.points_path.empty();
  ConsoleProgress progress;
  while (status == Status::kOk && !evaluation.done() && !results.has_energy) {
    if (stop_requested()) {
      return stopped();
    }
    progress.show(name_of(results.stage), evaluation.progress());
    evaluation.step();
    status = results.status();
  }
  if (status == Status::kOk) {
    return has_points ? judge_fit(options, evaluation, results) : Problem{};
  }
  StringSink sentence;
  app::TextWriter writer(sentence);
  write_failure(results, writer);
  const bool is_search = status == Status::kTooManyCells || status == Status::kTooManySwitches;
  const std::string source =
      options.points_path.empty() ? "--model" : name_of_input(options.points_path);
  return bad_input((is_search ? "--time" : source) + ": " + sentence.text());
}

// Memory of a certificate, and the certificate.
class Work final {
 public:
  Problem start(const ModalModel& model, double duration_s, double effort_s) {
    const std::size_t coarsest = coarsest_certificate(model, duration_s);
    const double affordable = std::sqrt(kMultipliersShare * effort_s / kEnoughIterations / kPair_s);
    const double most = 0.92 * static_cast<double>(kMaxCertificateCells);
    const double finest = std::min(kFinest * static_cast<double>(coarsest), most);
    const auto cells = static_cast<std::size_t>(
        std::max(static_cast<double>(coarsest), std::min(affordable, finest)));
    // What the narrow cells at the ends add is less than a tenth and 32.
    const std::size_t room = std::min(kMaxCertificateCells, cells + cells / 10 + 32);
    const std::size_t leaves =
        std::min(EnergyCertificate::kMaxLeaves, kLeafNumbers / (kCertificateRank * room));
    const std::size_t intervals = std::min(mesh_intervals(model, duration_s), kMaxMesh);
    numbers_.resize(certificate_numbers(room, intervals, leaves));
    multipliers_.resize(kMultipliers);
    hash_.resize(kHash);
    nodes_.resize(2 * leaves);
    signs_.resize(leaves * room);
    duals_.resize(leaves * room);
    CertificateWorkspace workspace;
    workspace.numbers = {numbers_.data(), numbers_.size()};
    workspace.multipliers = {multipliers_.data(), multipliers_.size()};
    workspace.hash = {hash_.data(), hash_.size()};
    workspace.nodes = {nodes_.data(), nodes_.size()};
    workspace.signs = {signs_.data(), signs_.size()};
    workspace.duals = {duals_.data(), duals_.size()};
    const Status status = certificate_->start(model, duration_s, cells, workspace);
    if (status == Status::kInvalidOrder) {
      return bad_input(
          "--order: the proof needs an error response that starts at zero; expected "
          "an order of 2 or more");
    }
    if (status == Status::kTooManyCells) {
      return bad_input(
          "--time: the proof needs more cells than there is room for; expected a "
          "shorter time");
    }
    return status == Status::kOk ? Problem{}
                                 : bad_input(std::string("--model: ") + explain(status));
  }

  EnergyCertificate& certificate() { return *certificate_; }

 private:
  std::vector<double> numbers_;
  std::vector<TriangleMultiplier> multipliers_;
  std::vector<std::uint32_t> hash_;
  std::vector<CertificateNode> nodes_;
  std::vector<std::int8_t> signs_;
  std::vector<std::int32_t> duals_;
  std::unique_ptr<EnergyCertificate> certificate_ = std::make_unique<EnergyCertificate>();
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A progress line with the gap: that of a proof only once there is one.
void show(ConsoleProgress& progress, const char* words, double bound, double energy,
          double fraction) {
  char stage[64];
  std::snprintf(stage, sizeof stage, "%s, gap %.3f %%,", words, 100.0 * (bound / energy - 1.0));
  progress.show(stage, fraction);
}

void improve_multipliers(EnergyCertificate& certificate, double energy, double from_progress,
                         double time_s, bool may_stop) {
  ConsoleProgress progress;
  const Clock::time_point start = Clock::now();
  for (double part = 0.0; part < 1.0 && !(may_stop && stop_requested());
       part = seconds_since(start) / time_s) {
    const double now = from_progress + (1.0 - from_progress) * part;
    certificate.improve(now);
    show(progress, "multipliers", certificate.estimate(), energy, now);
  }
}

Problem prove(EnergyCertificate& certificate, double energy, double effort_s,
              Clock::time_point start) {
  ConsoleProgress progress;
  while (!certificate.ready()) {
    if (stop_requested()) {
      return stopped();
    }
    progress.show("bounds of the kernel", certificate.preparation());
    certificate.prepare();
  }
  progress.erase();
  const Clock::time_point ready = Clock::now();
  const double time_s = kMultipliersShare * std::max(effort_s - seconds_since(start), 0.0);
  improve_multipliers(certificate, energy, 0.0, std::max(time_s, 0.1), true);
  if (stop_requested()) {
    const double part = std::min(seconds_since(ready) / std::max(time_s, 0.1), 0.9);
    improve_multipliers(certificate, energy, part, kRest_s, false);
  }
  if (!certificate.prove()) {
    return fault(
        "certify: no factorisation came out, so nothing is proven; expected more seconds "
        "of --effort to help");
  }
  const double begin_s = seconds_since(start);
  double now_s = begin_s;
  while (now_s < effort_s && !stop_requested() && certificate.branch()) {
    now_s = seconds_since(start);
    show(progress, "cases", certificate.bound(), energy, (now_s - begin_s) / (effort_s - begin_s));
  }
  return {};
}

struct CertifyResult {
  const app::EvaluationResults* evaluation = nullptr;
  ProvenEnergy proven;
  double seconds = 0.0;
  std::string certificate_path;
};

// As in results.json.
void write_fit_json(const app::EvaluationResults& evaluation, app::TextWriter& out) {
  out.text(", \"E_range\": ");
  if (evaluation.has_cut_range) {
    out.text("[").exact(evaluation.cut_low_v2s).text(", ").exact(evaluation.cut_high_v2s);
    out.text("]");
  } else {
    out.text("null");
  }
  out.text(", \"warnings\": [");
  const char* separator = "";
  for (const app::Warning warning : app::kWarnings) {
    if (holds(warning, evaluation, {})) {
      out.text(separator).text("{\"about\": \"").text(about(warning));
      out.text("\", \"text\": \"").text(words_of(warning)).text("\"}");
      separator = ", ";
    }
  }
  out.text("]}\n");
}

void write_json(const CertifyResult& result, app::TextWriter& out) {
  const EnergyCertificate& certificate = *result.proven.certificate;
  out.text("{\"E\": ").exact(result.proven.energy_v2s);
  out.text(", \"bound\": ").exact(result.proven.bound_v2s());
  out.text(", \"gap\": ").exact(result.proven.gap());
  out.text(", \"cells\": ").integer(certificate.grid().cells);
  out.text(", \"multipliers\": ").integer(certificate.used_multipliers());
  out.text(", \"nodes\": ").integer(certificate.nodes().size());
  out.text(", \"seconds\": ").fixed(result.seconds, 1);
  write_fit_json(*result.evaluation, out);
}

void write_warning(const std::string& words, app::TextWriter& out) {
  constexpr double kWidth = 96.0;
  constexpr std::size_t kMostLines = 8;
  for (const std::string& line : wrapped("WARNING: " + words, kWidth, kMostLines)) {
    out.text(line.c_str()).line();
  }
}

// What a report on these points warns of: the device that the proof is about may be another one.
void write_warnings(const app::EvaluationResults& evaluation, app::TextWriter& out) {
  for (const app::Warning warning : app::kWarnings) {
    if (holds(warning, evaluation, {})) {
      write_warning(words_of(warning), out);
    }
  }
  const std::string cause =
      evaluation.source == app::Source::kPoints ? cause_of(evaluation.fit) : "";
  if (!cause.empty()) {
    write_warning(cause, out);
  }
  if (evaluation.has_cut_range) {
    out.text("Range of E  ").scientific(evaluation.cut_low_v2s, 3).text(" to ");
    out.scientific(evaluation.cut_high_v2s, 3);
    out.text(" V^2 s over the dampings left open, not proven\n");
  }
}

void write_text(const CertifyResult& result, app::TextWriter& out) {
  const ProvenEnergy& proven = result.proven;
  const EnergyCertificate& certificate = *proven.certificate;
  const Accelerometer& device = proven.model->device();
  const ReferenceFilter& filter = proven.model->filter();
  const std::size_t switches = proven.signal->count();
  const double duration_s = proven.signal->duration_s();
  out.text("Device      S = ").general(device.sensitivity, 7).text(" V/(m/s^2), f0 = ");
  out.general(device.natural_frequency_hz, 7).text(" Hz, beta = ").general(device.damping, 7);
  out.line();
  write_warnings(*result.evaluation, out);
  out.text("Filter      Butterworth, order ")
      .integer(static_cast<std::uint64_t>(filter.relative_degree));
  out.text(", cutoff ").general(filter.band_hz, 7).text(" Hz, gain ").general(filter.gain, 7);
  out.text(" V/(m/s^2)\nSignals     of any shape within +-").general(proven.limit_mps2, 7);
  out.text(" m/s^2 for ").general(duration_s, 7).text(" s\n");
  const bool is_in_band = proven.model->criterion() == Criterion::kInBandError;
  out.text(is_in_band ? "Error       in band, the reference without a delay\n\n" : "\n");
  out.text("Reached     E  = ").general(proven.energy_v2s, 7).text(" V^2 s, by a signal with ");
  out.integer(switches).text(switches == 1 ? " switch\n" : " switches\n");
  out.text("Proven      E <= ").general(rounded_up(proven.bound_v2s(), 6), 7);
  out.text(" V^2 s for every such signal\nGap         ").fixed(100.0 * proven.gap(), 3);
  out.text(" % of the energy reached\nRMS error   ");
  out.general(std::sqrt(proven.energy_v2s / duration_s), 5).text(" V reached, at most ");
  out.general(rounded_up(std::sqrt(proven.bound_v2s() / duration_s), 4), 5).text(" V\n\n");
  out.text("The proof has ").integer(certificate.grid().cells).text(" cells, ");
  out.integer(certificate.used_multipliers()).text(" multipliers and ");
  out.integer(certificate.nodes().size());
  out.text(certificate.nodes().size() == 1 ? " node" : " nodes").text(", found in ");
  out.fixed(result.seconds, 1).text(" s.\n");
  if (!result.certificate_path.empty()) {
    out.text("Certificate in ").text(printable(result.certificate_path).c_str());
    out.text(";\ncheck it with host_tests/reference/check_certificate.py.\n");
  }
}

}  // namespace

Problem run_certify(Span<const std::string_view> arguments) {
  const Clock::time_point start = Clock::now();
  CertifyOptions options;
  if (Problem problem = parse(arguments, options)) {
    return problem;
  }
  // Only the estimate's energy is wanted.
  options.report.settings.trend_count = 0;
  static app::EvaluationResults evaluation;
  SingleFile file(options.out_path);
  Problem problem = file.open();
  problem = problem ? problem : find_energy(options.report, evaluation);
  if (problem) {
    return problem;
  }
  const ModalModel model = evaluation.model;
  if (model.is_nothing()) {
    return bad_input(
        "--model: the sensor is the filter, so the error is 0 and nothing is left to prove; "
        "expected another sensor or filter");
  }
  if (one_sided_response(model, evaluation.maximum.signal.duration_s()).holds) {
    return bad_input(
        "--time: the impulse response has one sign within T, so the constant signal is the worst "
        "one and nothing is left to prove; expected a longer time, or emax report");
  }
  Work work;
  problem = work.start(model, evaluation.maximum.signal.duration_s(), options.effort_s);
  if (problem ||
      (problem = prove(work.certificate(), evaluation.maximum.energy, options.effort_s, start))) {
    return problem;
  }
  CertifyResult result;
  result.evaluation = &evaluation;
  result.proven.model = &model;
  result.proven.certificate = &work.certificate();
  result.proven.signal = &evaluation.maximum.signal;
  result.proven.limit_mps2 = evaluation.limit_mps2;
  result.proven.energy_v2s = evaluation.energy_v2s();
  result.seconds = seconds_since(start);
  result.certificate_path = options.out_path;
  // What has been proven is printed, whatever becomes of the file.
  const Problem unwritten =
      file.write([&result](app::TextWriter& out) { write_certificate(result.proven, out); });
  if (unwritten) {
    result.certificate_path.clear();
  }
  FileSink sink(stdout);
  app::TextWriter out(sink);
  options.report.json ? write_json(result, out) : write_text(result, out);
  problem = check_output(sink);
  return unwritten ? unwritten : problem;
}

std::string help_on_certify() {
  CertifyOptions options;
  return R"(usage: emax certify --model S,f0,beta [options]
       emax certify --points FILE [options]

Proves how far the maximum energy of emax report can be from the truth: a bound
of the integral-square error (or the in-band error) that no signal within +-a on [0, T] exceeds,
whatever its shape. The longer it runs the tighter the bound; Ctrl-C ends it
early with what is proven by then.
)" + help_on(syntax_of(options).options);
}

}  // namespace emax::desk
