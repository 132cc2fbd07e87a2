// `emax certify`.
#include "desk/certify/certify_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/decimal.hpp"
#include "emax/bound/energy_bound.hpp"
#include "emax/bound/energy_certificate.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/model/cascade_response.hpp"

#include "desk/certify/box_proof.hpp"
#include "desk/certify/certificate_file.hpp"
#include "desk/cli/console.hpp"
#include "desk/cli/console_progress.hpp"
#include "desk/cli/option.hpp"
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
#include "desk/report/failure_words.hpp"
#include "desk/report/fit_causes.hpp"
#include "desk/report/warning_words.hpp"

namespace emax::desk {

namespace {

// Of the effort: what the augmented Lagrangian gets at most; gradient steps get the rest, and the
// last factorisations a little.
constexpr double kRelaxShare = 0.65;
constexpr double kPolishShare = 0.9;
// Gradient steps for each round, if rounds are given.
constexpr double kPolishPerRound = 40.0;
// After Ctrl-C, to come to rest.
constexpr double kRestSteps = 300.0;
// What rounds and steps that come to rest take for the square of the cells.
constexpr double kPair_s = 1.7e-4;
// No finer than this many times the coarsest grid: cells then cost less than the rest.
constexpr double kFinest = 4.0;
// Of the room for cells, with none about switches.
constexpr double kMostOfRoom = 0.8;
constexpr double kMostCorners = 500.0;
constexpr std::size_t kMultipliers = 1'000'000;
constexpr std::size_t kHash = std::size_t{1} << 21;
// Inequalities that may come in at once, for each cell.
constexpr std::size_t kViolatedPerCell = 40;
constexpr double kMaxEffort_s = 1e7;
constexpr std::uint64_t kMaxRounds = 100'000;

struct CertifyOptions {
  ReportOptions report;
  double effort_s = 10.0;
  std::uint64_t rounds = 0;  // 0: as the effort allows.
  std::string out_path;      // Empty for no file.
  BoxOption box;
  bool is_time_given = false;
};

bool take_effort(std::string_view text, double& effort_s) {
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  effort_s = number.value;
  return number.status == Status::kOk && number.length == text.size() && number.value > 0.0 &&
         number.value <= kMaxEffort_s;
}

bool take_rounds(std::string_view text, std::uint64_t& rounds) {
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  const bool is_number = number.status == Status::kOk && number.length == text.size() &&
                         number.value >= 1.0 && number.value <= static_cast<double>(kMaxRounds) &&
                         number.value == std::floor(number.value);
  rounds = is_number ? static_cast<std::uint64_t>(number.value) : rounds;
  return is_number;
}

// The first ones mean here what they mean for a report.
Syntax syntax_of(CertifyOptions& options) {
  ReportOptions& report = options.report;
  Syntax syntax;
  constexpr std::pair<const char*, const char*> kOfReport[] = {
      {"points", nullptr},
      {"model",
       "known parameters: sensitivity in V/(m/s^2), natural\n"
       "frequency in Hz, damping (0.0001 to below 1); then\n"
       "their standard uncertainties, for --box auto"},
      {"reference-uncertainty",
       "expanded uncertainty (k = 2) that all amplitudes of\n"
       "the table have in common: reference sensor, gains,\n"
       "mounting"},
      {"uncertainty", nullptr},
      {"input-units", nullptr},
      {"channel-delay", nullptr},
      {"invert", nullptr},
      {"damping", nullptr},
      {"order", nullptr},
      {"cutoff", nullptr},
      {"gain", nullptr},
      {"time", nullptr},
      {"limit", nullptr},
      {"criterion", nullptr},
      {"reference-delay", nullptr},
  };
  for (const auto& [name, help] : kOfReport) {
    syntax.options.push_back(report_option(report, name, help));
  }
  syntax.options.push_back(report_option(report, "json",
                                         "{T,E,bound,gap,cells,multipliers,nodes,\n"
                                         "corners,seconds,E_range,warnings} on\n"
                                         "standard output instead of text"));
  const std::string heading = syntax.options.back().heading;
  syntax.options.push_back(
      {"box", heading, "auto|uS,uf0,ubeta", "", "auto or three numbers, uS,uf0,ubeta",
       "a bound for all devices within +-uS, +-uf0, +-ubeta;\n"
       "auto: the uncertainties of --model or of the fit",
       [&options](std::string_view text) { return take_box(text, options.box); }});
  syntax.options.push_back(
      {"effort", heading, "SECONDS", "10", "a number of seconds above 0",
       "processor time to spend on the bound; it also decides\n"
       "how fine the grid is",
       [&options](std::string_view text) { return take_effort(text, options.effort_s); }});
  syntax.options.push_back(
      {"rounds", heading, "N", "", "a whole number from 1 to 100000",
       "number of rounds, however long they take: it gives\n"
       "the same certificate, byte for byte, every time",
       [&options](std::string_view text) { return take_rounds(text, options.rounds); }});
  syntax.options.push_back(
      {"out", heading, "FILE", "", "the name of a file",
       "writes the proof as JSON, which\n"
       "host_tests/reference/check_certificate.py verifies",
       [&options](std::string_view text) { return take_text(text, options.out_path); }});
  syntax.other_words = other_words();
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
  options.is_time_given = is_given(all, "time");
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

bool has_room(const ModalModel& model, double duration_s) {
  return coarsest_certificate(model, duration_s) <= kMaxCertificateCells &&
         mesh_intervals(model, duration_s) <= kMaxMesh;
}

// In three digits.
double longest_proof_s(const ModalModel& model, double duration_s) {
  constexpr int kHalvings = 50;
  double longest_s = 0.0;
  double step_s = duration_s;
  for (int i = 0; i < kHalvings; ++i) {
    step_s *= 0.5;
    longest_s += has_room(model, longest_s + step_s) ? step_s : 0.0;
  }
  constexpr int kDigits = 3;
  char text[24];
  const std::size_t length = format_general(-rounded_up(-longest_s, kDigits - 1), kDigits, text);
  return parse_decimal(Span<const char>(text, length)).value;
}

Problem too_long(const ModalModel& model, double duration_s) {
  StringSink sink;
  app::TextWriter out(sink);
  out.text("--time: the proof needs more cells than there is room for; expected at most ");
  out.general(longest_proof_s(model, duration_s), 3).text(" s");
  return bad_input(sink.text());
}

Status start(const ReportOptions& options, const ImportedPoints& imported,
             app::Evaluation& evaluation) {
  if (options.points_path.empty()) {
    return evaluation.start_from_model(options.device, options.settings, app::Goal::kEnergy);
  }
  evaluation.give_damping(options.damping);
  return evaluation.start_from_points(imported.points, options.settings, app::Goal::kEnergy);
}

// Finds the device and the signal with the largest energy known.
Problem find_energy(const ReportOptions& options, const ImportedPoints& imported,
                    app::EvaluationResults& results) {
  static app::EvaluationWorkspace workspace;
  app::Evaluation evaluation(results, workspace);
  Status status = start(options, imported, evaluation);
  const bool has_points = !options.points_path.empty();
  if (Problem problem =
          has_points ? check_given_damping(results, options, imported.points) : Problem{}) {
    return problem;
  }
  ConsoleProgress progress;
  while (status == Status::kOk && !evaluation.done() && !results.has_energy) {
    if (stop_requested()) {
      return stopped();
    }
    progress.show(name_of(results.stage), evaluation.progress());
    evaluation.step();
    status = results.status();
    const double duration_s = options.settings.duration_s;
    if (status == Status::kOk && results.has_model && !has_room(results.model, duration_s)) {
      return too_long(results.model, duration_s);
    }
  }
  if (status == Status::kOk) {
    return has_points ? judge_fit(options, evaluation, results) : Problem{};
  }
  return describe_failure(results, options, imported.names_phase_unit, imported.doubt);
}

// The same, where nobody has asked for a time with the longest one that the proof has room for.
//
// @param[out] default_s The time that this is shorter than; 0 if it is not.
Problem find_energy_in_room(CertifyOptions& options, const ImportedPoints& imported,
                            app::EvaluationResults& results, double& default_s) {
  Problem problem = find_energy(options.report, imported, results);
  double& duration_s = options.report.settings.duration_s;
  if (!problem || options.is_time_given || !results.has_model ||
      has_room(results.model, duration_s)) {
    return problem;
  }
  default_s = duration_s;
  duration_s = longest_proof_s(results.model, duration_s);
  return find_energy(options.report, imported, results);
}

// The bound of `emax report`, for a = 1; infinity if there is none.
double quick_bound(const ModalModel& model, double duration_s) {
  static GridWorkspace workspace;
  static EnergyBound bound;
  Status status = bound.start(model, duration_s, workspace);
  while (status == Status::kOk && !bound.done()) {
    status = bound.step(model, workspace);
  }
  return status == Status::kOk ? bound.bound() : std::numeric_limits<double>::infinity();
}

// The same for all devices of a box.
double quick_bound(const BoxProof& box, double duration_s) {
  double largest = 0.0;
  for (const ModalModel& model : box.models()) {
    largest = std::max(largest, quick_bound(model, duration_s));
  }
  return box.bound(largest);
}

// Corners take what is left of the effort.
std::size_t most_corners(const CertifyOptions& options) {
  return static_cast<std::size_t>(std::min(8.0 + 2.0 * options.effort_s, kMostCorners));
}

// Memory of a certificate, and the certificate.
class Work final {
 public:
  Problem start(Span<const ModalModel> models, const SwitchingSignal& signal, double effort_s) {
    const ModalModel& model = models[0];
    const double duration_s = signal.duration_s();
    const auto coarsest = static_cast<double>(coarsest_certificate(model, duration_s));
    const double affordable = std::sqrt(effort_s / kPair_s);
    const double finest =
        std::min(kFinest * coarsest, kMostOfRoom * static_cast<double>(kMaxCertificateCells));
    const auto cells = static_cast<std::size_t>(std::max(coarsest, std::min(affordable, finest)));
    std::size_t intervals = 0;
    for (const ModalModel& own : models) {
      intervals = std::max(intervals, std::min(mesh_intervals(own, duration_s), kMaxMesh));
    }
    numbers_.resize(certificate_numbers(kMaxCertificateCells, intervals));
    multipliers_.resize(kMultipliers);
    hash_.resize(kHash);
    violated_.resize(kViolatedPerCell * std::min(cells, kMaxCertificateCells));
    duals_.resize(kMaxCertificateCells);
    CertificateWorkspace workspace;
    workspace.numbers = {numbers_.data(), numbers_.size()};
    workspace.multipliers = {multipliers_.data(), multipliers_.size()};
    workspace.hash = {hash_.data(), hash_.size()};
    workspace.violated = {violated_.data(), violated_.size()};
    workspace.duals = {duals_.data(), duals_.size()};
    Status status = certificate_->start(models, duration_s, cells, signal.times_s(), workspace);
    if (status == Status::kTooManyCells) {  // Not finer about the switches, for there are many.
      status = certificate_->start(models, duration_s, cells, {}, workspace);
    }
    if (status == Status::kTooManyCells) {
      return too_long(model, duration_s);
    }
    return status == Status::kOk ? Problem{}
                                 : bad_input(std::string("--model: ") + explain(status));
  }

  EnergyCertificate& certificate() { return *certificate_; }

 private:
  std::vector<double> numbers_;
  std::vector<TriangleMultiplier> multipliers_;
  std::vector<std::uint32_t> hash_;
  std::vector<ViolatedTriangle> violated_;
  std::vector<std::int32_t> duals_;
  std::unique_ptr<EnergyCertificate> certificate_ = std::make_unique<EnergyCertificate>();
};

// Time of the processor that this program has had.
double spent_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A progress line with the gap that the work comes to; it is proven only at the end.
void show(ConsoleProgress& progress, const char* words, double bound, double energy,
          double fraction) {
  char stage[64];
  std::snprintf(stage, sizeof stage, "%s, gap %.3f %%,", words, 100.0 * (bound / energy - 1.0));
  progress.show(stage, fraction);
}

void relax(EnergyCertificate& certificate, double energy, const CertifyOptions& options) {
  ConsoleProgress progress;
  std::uint64_t rounds = 0;
  const auto part = [&]() {
    return options.rounds > 0 ? static_cast<double>(rounds) / static_cast<double>(options.rounds)
                              : spent_s() / (kRelaxShare * options.effort_s);
  };
  while (part() < 1.0 && !certificate.at_rest() && !stop_requested()) {
    certificate.relax();
    ++rounds;
    show(progress, "relaxation", certificate.estimate(), energy, std::min(part(), 1.0));
  }
}

void polish(EnergyCertificate& certificate, double energy, const CertifyOptions& options) {
  ConsoleProgress progress;
  double steps = 0.0;
  const double begin_s = spent_s();
  const double time_s = std::max(kPolishShare * options.effort_s - begin_s, 0.05);
  const double most = kPolishPerRound * static_cast<double>(options.rounds);
  const auto part = [&]() {
    return options.rounds > 0 ? steps / most : (spent_s() - begin_s) / time_s;
  };
  double now = 0.0;
  for (; now < 1.0 && !stop_requested(); now = part()) {
    certificate.polish(now);
    steps += 1.0;
    show(progress, "multipliers", certificate.estimate(), energy, now);
  }
  const double left = now < 1.0 ? 1.0 - now : 0.0;
  for (double step = 0.0; left > 0.0 && step < kRestSteps; step += 1.0) {
    certificate.polish(now + left * step / kRestSteps);
  }
}

Problem prove(EnergyCertificate& certificate, double energy, const CertifyOptions& options) {
  ConsoleProgress progress;
  while (!certificate.ready()) {
    if (stop_requested()) {
      return stopped();
    }
    progress.show("bounds of the kernel", certificate.preparation());
    certificate.prepare();
  }
  progress.erase();
  relax(certificate, energy, options);
  polish(certificate, energy, options);
  return certificate.prove()
             ? Problem{}
             : fault(
                   "certify: no factorisation came out, so nothing is proven; expected more "
                   "seconds of --effort to help");
}

// The corners but the first, which is proven.
Problem prove_corners(EnergyCertificate& certificate, BoxProof& box) {
  ConsoleProgress progress;
  const std::size_t count = box.models().size();
  box.take(0, certificate);
  for (std::size_t model = 1; model < count; ++model) {
    progress.show("corners", static_cast<double>(model) / static_cast<double>(count));
    if (!certificate.prove(model)) {
      return fault(
          "certify: no factorisation came out at a corner, so nothing is proven; expected "
          "more seconds of --effort, or a smaller --box, to help");
    }
    box.take(model, certificate);
  }
  return {};
}

struct CertifyResult {
  const app::EvaluationResults* evaluation = nullptr;
  std::string cause;  ///< Why its points do not fit, if anybody knows.
  std::string doubt;  ///< Of the units of its table, if any.
  ProvenEnergy proven;
  double quick_bound_v2s = 0.0;  // That of emax report.
  double seconds = 0.0;
  double default_time_s = 0.0;  // That of emax report, if T is shorter for the sake of the proof.
  std::string certificate_path;

  double bound_v2s() const { return std::min(proven.bound_v2s(), quick_bound_v2s); }
  double gap() const { return bound_v2s() / proven.energy_v2s - 1.0; }

  // What warnings depend on beside the evaluation.
  app::ReportContext context() const {
    app::ReportContext context;
    context.doubt = doubt.empty() ? nullptr : doubt.c_str();
    return context;
  }
  const char* words_on(app::Warning warning) const {
    return warning == app::Warning::kUnits ? doubt.c_str() : words_of(warning, *evaluation);
  }
};

std::string words_on_time(const CertifyResult& result) {
  StringSink sink;
  app::TextWriter out(sink);
  out.text("T is ").general(result.proven.signal->duration_s(), 3).text(" s, not the ");
  out.general(result.default_time_s, 3);
  out.text(" s of emax report: the proof has no room for a longer one, and E is that of this T");
  return sink.text();
}

// As in results.json.
void write_fit_json(const CertifyResult& result, app::TextWriter& out) {
  const app::EvaluationResults& evaluation = *result.evaluation;
  out.text(", \"E_range\": ");
  if (evaluation.has_cut_range) {
    out.text("[").exact(evaluation.cut_low_v2s).text(", ").exact(evaluation.cut_high_v2s);
    out.text("]");
  } else {
    out.text("null");
  }
  out.text(", \"warnings\": [");
  const char* separator = "";
  if (result.default_time_s > 0.0) {
    out.text("{\"about\": \"energy\", \"text\": \"").text(words_on_time(result).c_str());
    out.text("\"}");
    separator = ", ";
  }
  for (const app::Warning warning : app::kWarnings) {
    if (holds(warning, evaluation, result.context())) {
      out.text(separator).text("{\"about\": \"").text(about(warning));
      out.text("\", \"text\": \"").text(result.words_on(warning)).text("\"");
      const double least_s = least_time_s(warning, evaluation);
      if (least_s > 0.0) {
        out.text(", \"least_time_s\": ").exact(least_s);
      }
      out.text("}");
      separator = ", ";
    }
  }
  out.text("]}\n");
}

void write_json(const CertifyResult& result, app::TextWriter& out) {
  const EnergyCertificate& certificate = *result.proven.certificate;
  out.text("{\"T\": ").exact(result.proven.signal->duration_s());
  out.text(", \"E\": ").exact(result.proven.energy_v2s);
  out.text(", \"bound\": ").exact(result.bound_v2s());
  out.text(", \"gap\": ").exact(result.gap());
  out.text(", \"cells\": ").integer(certificate.grid().cells);
  out.text(", \"multipliers\": ").integer(certificate.used_multipliers());
  out.text(", \"nodes\": 0, \"corners\": ");
  out.integer(result.proven.box != nullptr ? result.proven.box->models().size() : 1);
  out.text(", \"seconds\": ").fixed(result.seconds, 1);
  write_fit_json(result, out);
}

void write_warning(const std::string& words, app::TextWriter& out) {
  constexpr double kWidth = 96.0;
  constexpr std::size_t kMostLines = 8;
  for (const std::string& line : wrapped("WARNING: " + words, kWidth, kMostLines)) {
    out.text(line.c_str()).line();
  }
}

// What a report on these points warns of: the device that the proof is about may be another one.
void write_warnings(const CertifyResult& result, app::TextWriter& out) {
  const app::EvaluationResults& evaluation = *result.evaluation;
  for (const app::Warning warning : app::kWarnings) {
    if (holds(warning, evaluation, result.context())) {
      write_warning(sentence_of(result.words_on(warning), least_time_s(warning, evaluation)), out);
    }
  }
  if (!result.cause.empty()) {
    write_warning(result.cause, out);
  }
  if (result.default_time_s > 0.0) {
    write_warning(words_on_time(result) + ".", out);
  }
  if (evaluation.has_cut_range) {
    out.text("Range of E  ").scientific(evaluation.cut_low_v2s, 3).text(" to ");
    out.scientific(evaluation.cut_high_v2s, 3);
    out.text(" V^2 s over the dampings left open, not proven\n");
  }
}

void write_error_measure(const ModalModel& model, app::TextWriter& out) {
  if (model.criterion() == Criterion::kEnergyDifference) {
    out.text("Error       the energy of the sensor less that of the filter\n");
    return;
  }
  if (model.criterion() != Criterion::kInBandError) {
    return;
  }
  out.text("Error       in band, the reference ");
  if (model.delay_s() > 0.0) {
    out.text("delayed by ").general(1e6 * model.delay_s(), 5).text(" us\n");
  } else {
    out.text("without a delay\n");
  }
}

void write_box(const BoxProof& box, app::TextWriter& out) {
  const ParameterBox& half_width = box.half_width();
  out.text("Box         S +- ").general(half_width.sensitivity, 7).text(" V/(m/s^2), f0 +- ");
  out.general(half_width.natural_frequency_hz, 7).text(" Hz, beta +- ");
  out.general(half_width.damping, 7);
  out.text(box.gain_follows() ? ", the gain follows S\n" : ", the gain is fixed\n");
}

void write_best_corner(const BoxProof& box, app::TextWriter& out) {
  const Accelerometer& device = box.device();
  out.text("            at S = ").general(device.sensitivity, 7).text(" V/(m/s^2), f0 = ");
  out.general(device.natural_frequency_hz, 7).text(" Hz, beta = ").exact(device.damping);
  out.line();
}

// With the digits that the bound above is printed with.
void write_gap(double percent, app::TextWriter& out) {
  constexpr double kLeast = 0.001;
  if (percent < kLeast) {
    out.text("< 0.001");
  } else {
    out.fixed(percent, 3);
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
  out.general(device.natural_frequency_hz, 7).text(" Hz, beta = ").exact(device.damping);
  out.line();
  write_warnings(result, out);
  if (proven.box != nullptr) {
    write_box(*proven.box, out);
  }
  out.text("Filter      Butterworth, order ")
      .integer(static_cast<std::uint64_t>(filter.relative_degree));
  out.text(", cutoff ").general(filter.band_hz, 7).text(" Hz, gain ").general(filter.gain, 7);
  out.text(" V/(m/s^2)\nSignals     of any shape within +-").general(proven.limit_mps2, 7);
  out.text(" m/s^2 for ").general(duration_s, 7).text(" s\n");
  write_error_measure(*proven.model, out);
  out.line();
  out.text("Reached     E  = ").general(proven.energy_v2s, 7).text(" V^2 s, by a signal with ");
  out.integer(switches).text(switches == 1 ? " switch\n" : " switches\n");
  if (proven.box != nullptr) {
    write_best_corner(*proven.box, out);
  }
  out.text("Proven      E <= ").general(rounded_up(result.bound_v2s(), 6), 7);
  out.text(" V^2 s for every such signal");
  out.text(proven.box != nullptr ? ", and every device in the box" : "");
  out.text("\nGap         ");
  write_gap(100.0 * result.gap(), out);
  const bool is_error = proven.model->criterion() != Criterion::kEnergyDifference;
  out.text(" % of the energy reached\n").text(is_error ? "RMS error   " : "sqrt(E/T)   ");
  out.general(std::sqrt(proven.energy_v2s / duration_s), 5).text(" V reached, at most ");
  out.general(rounded_up(std::sqrt(result.bound_v2s() / duration_s), 4), 5).text(" V\n");
  if (proven.model->delay_s() > 0.0) {
    // Where the gain follows S, that of the corners is the largest one.
    const ModalModel& model = proven.box != nullptr ? proven.box->models()[0] : *proven.model;
    const double a2 = proven.limit_mps2 * proven.limit_mps2;
    const double whole = a2 * true_bound(model, result.bound_v2s() / a2, duration_s);
    out.text("True delay  E <= ").general(rounded_up(whole, 6), 7);
    out.text(" V^2 s; all else is for the delayed filter continued by its modes\n");
  }
  out.line();
  out.text("The proof has ").integer(certificate.grid().cells).text(" cells and ");
  out.integer(certificate.used_multipliers()).text(" multipliers, found in ");
  out.fixed(result.seconds, 1).text(" s of the processor.\n");
  if (proven.box != nullptr) {
    const double corners = proven.box->corner_bound();
    out.text("It holds at ").integer(proven.box->models().size()).text(" corners, by ");
    out.fixed(100.0 * (corners / proven.box->maximum().energy - 1.0), 3);
    out.text(" %; what may lie between them is ");
    out.fixed(100.0 * (proven.box->bound() / corners - 1.0), 4).text(" % more.\n");
  }
  if (result.bound_v2s() < proven.bound_v2s()) {
    out.text("The bound is that of emax report; the certificate proves E <= ");
    out.general(rounded_up(proven.bound_v2s(), 6), 7).text(" V^2 s. More --effort\nhelps.\n");
  }
  if (!result.certificate_path.empty()) {
    out.text("Certificate in ").text(printable(result.certificate_path).c_str());
    out.text(";\ncheck it with host_tests/reference/check_certificate.py.\n");
  }
}

}  // namespace

Problem run_certify(Span<const std::string_view> arguments) {
  CertifyOptions options;
  if (Problem problem = parse(arguments, options)) {
    return problem;
  }
  // Only the estimate's energy is wanted.
  options.report.settings.trend_count = 0;
  static app::EvaluationResults evaluation;
  static ImportedPoints imported;
  SingleFile file(options.out_path);
  Problem problem = file.open();
  if (!problem && !options.report.points_path.empty()) {
    problem = read_points(options.report.points_path, options.report.import,
                          options.report.reference_uncertainty_percent, imported);
  }
  double default_s = 0.0;
  problem = problem ? problem : find_energy_in_room(options, imported, evaluation, default_s);
  if (problem) {
    return problem;
  }
  const ModalModel model = evaluation.model;
  if (!(evaluation.maximum.energy > 0.0) && !model.is_nothing()) {
    return bad_input(
        "--criterion: no signal is known for which the sensor's energy is above the filter's, so "
        "there is nothing to compare a bound with; expected another filter, or ise");
  }
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
  const double duration_s = evaluation.maximum.signal.duration_s();
  std::unique_ptr<BoxProof> box;
  if (options.box.is_wanted) {
    box = std::make_unique<BoxProof>();
    if ((problem = box->start(evaluation, options.box, most_corners(options)))) {
      return problem;
    }
  }
  const MaximumEnergy& maximum = box ? box->maximum() : evaluation.maximum;
  const Span<const ModalModel> models = box ? box->models() : Span<const ModalModel>(&model, 1);
  Work work;
  problem = work.start(models, maximum.signal, options.effort_s);
  problem = problem ? problem : prove(work.certificate(), maximum.energy, options);
  problem = problem || !box ? problem : prove_corners(work.certificate(), *box);
  if (problem) {
    return problem;
  }
  CertifyResult result;
  result.evaluation = &evaluation;
  result.default_time_s = default_s;
  if (evaluation.source == app::Source::kPoints) {
    result.cause = cause_of(evaluation.fit, imported.names_phase_unit);
    result.doubt = imported.doubt;
  }
  result.proven.box = box.get();
  result.proven.model = &model;
  result.proven.certificate = &work.certificate();
  result.proven.signal = &maximum.signal;
  result.proven.limit_mps2 = evaluation.limit_mps2;
  result.proven.energy_v2s = evaluation.a2() * maximum.energy;
  result.quick_bound_v2s = result.proven.limit_mps2 * result.proven.limit_mps2 *
                           (box ? quick_bound(*box, duration_s) : quick_bound(model, duration_s));
  result.seconds = spent_s();
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

Proves how far the maximum energy of emax report can be from the truth. It finds
a bound that no signal within +-a on [0, T] exceeds, whatever its shape; with
--box the bound holds for every device within its uncertainties. The longer it
runs, the tighter is the bound. Ctrl-C ends it early, with what is proven by
then.
)" + help_on(syntax_of(options).options);
}

}  // namespace emax::desk
