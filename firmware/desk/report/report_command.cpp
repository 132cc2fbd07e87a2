// `emax report`.
#include "desk/report/report_command.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/app/sequencer/sequencer.hpp"
#include "emax/identify/frequency_response.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/console_progress.hpp"
#include "desk/cli/options.hpp"
#include "desk/dcc/certificate_xml.hpp"
#include "desk/files/output_files.hpp"
#include "desk/files/points_file.hpp"
#include "desk/files/report_files.hpp"
#include "desk/files/single_file.hpp"
#include "desk/files/text_file.hpp"
#include "desk/page/certificate_part.hpp"
#include "desk/report/bench_job.hpp"
#include "desk/report/damping_words.hpp"
#include "desk/report/failure_words.hpp"
#include "desk/report/figure_mark.hpp"
#include "desk/report/figure_settling.hpp"
#include "desk/report/fit_causes.hpp"
#include "desk/trials/thread_helper.hpp"

namespace emax::desk {

namespace {

constexpr std::uint32_t kMaxStoredTrials = 10'000'000;

// What a report is written from.
struct Results {
  const app::EvaluationResults& evaluation;
  const app::ReportContext& context;
};

// For who waits: what the points say, which takes no time.
std::string words_of_fit(const app::EvaluationResults& evaluation) {
  if (!evaluation.has_fit()) {
    return "";
  }
  const Accelerometer& device = evaluation.device.estimate;
  const WlspFit& fit = evaluation.fit.result();
  StringSink sink;
  app::TextWriter out(sink);
  out.text("fit: S = ").general(device.sensitivity, 5).text(" V/(m/s^2), f0 = ");
  out.general(device.natural_frequency_hz, 5).text(" Hz, beta = ").general(device.damping, 4);
  if (evaluation.is_damping_open()) {
    out.text(", which the points leave open up to ").general(evaluation.judgement.damping_high, 3);
  }
  if (fit.dof > 0) {
    out.text("; chi2/dof = ").general(fit.chi2 / fit.dof, 4);
    const bool warns = fit.chi2 / fit.dof > app::reduced_chi_square_limit(fit.dof);
    out.text(warns ? ", which is too large" : "");
  }
  out.text(". The figures follow");
  return sink.text();
}

// Begins with what there is to begin with: a bench, a device or points.
Problem start(const ReportOptions& options, BenchJob& job, ImportedPoints& imported,
              ConsoleProgress& progress) {
  if (!options.instrument.empty()) {
    const Problem problem = job.measure_with_instrument(options, progress);
    const bool is_refused = !problem && job.sequencer().evaluation().status() != Status::kOk;
    return is_refused ? describe_failure(job.sequencer().evaluation(), options, true, "") : problem;
  }
  if (options.measures()) {
    return job.start(options);
  }
  app::Sequencer& sequencer = job.sequencer();
  if (!options.model_text.empty()) {
    sequencer.take(options.device);
  } else {
    if (Problem problem = read_points(options.points_path, options.import,
                                      options.reference_uncertainty_percent, imported)) {
      return problem;
    }
    sequencer.take(imported.points);
    sequencer.give_damping(options.damping);
  }
  const bool is_refused =
      static_cast<bool>(sequencer.evaluate(options.settings, app::Goal::kReport));
  const Problem problem = check_given_damping(sequencer.evaluation(), options, imported.points);
  return problem || !is_refused ? problem
                                : describe_failure(sequencer.evaluation(), options,
                                                   imported.names_phase_unit, imported.doubt);
}

// Of a criterion whose error rounding hides, as the sensor is nearly the filter: the in-band error
// is another one, and has figures. Their report is then the answer, and the remark says why.
//
// @param[in] problem The failure in words, which is returned where there is another cause.
Problem work_in_band(const ReportOptions& options, BenchJob& job, ConsoleProgress& progress,
                     Problem problem, Problem& remark) {
  app::Sequencer& sequencer = job.sequencer();
  const app::Failure& failure = sequencer.evaluation().failure;
  const bool is_hidden = failure.status == Status::kLostDigits &&
                         failure.stage == app::Stage::kEnergy &&
                         options.settings.criterion != Criterion::kInBandError;
  if (!is_hidden) {
    return problem;
  }
  app::Settings settings = options.settings;
  settings.criterion = Criterion::kInBandError;
  settings.delay_choice = app::DelayChoice::kNone;
  if (sequencer.evaluate(settings, app::Goal::kReport)) {
    return problem;
  }
  if (Problem in_band = job.run(progress)) {
    return in_band;
  }
  // With so short a T the words on that are the answer.
  if (sequencer.failure() || holds(app::Warning::kShortTime, sequencer.evaluation(), {})) {
    return problem;
  }
  remark = {ExitStatus::kDone,
            problem.line + "; so E, trials and trend are those of --criterion band"};
  return {};
}

// Everything from the measurement to the results, with room for the trials' values, so that each is
// computed once.
//
// @param[out] remark What the results are of, where that is not what was asked for.
Problem work(const ReportOptions& options, BenchJob& job, ImportedPoints& imported,
             Problem& remark) {
  const std::uint32_t trials =
      options.settings.adaptive ? kMaxStoredTrials : options.settings.trials;
  const std::size_t room = std::min(trials, kMaxStoredTrials);
  const std::unique_ptr<double[]> store(new (std::nothrow) double[room]);
  app::Sequencer& sequencer = job.sequencer();
  if (store != nullptr) {
    sequencer.lend_trial_store(Span<double>(store.get(), room));
  }
  const std::unique_ptr<TrialPiece[]> pieces(new (std::nothrow)
                                                 TrialPiece[EnergyTrials::kManyPieces]);
  const std::unique_ptr<ResonanceSurface> surface(new (std::nothrow) ResonanceSurface);
  if (pieces != nullptr) {
    sequencer.lend_trial_pieces(
        TrialPieces({pieces.get(), EnergyTrials::kManyPieces}, surface.get()));
  }
  ThreadHelper helper(options.threads);
  sequencer.lend_helper(&helper);
  ConsoleProgress progress;
  Problem problem = start(options, job, imported, progress);
  if (!problem) {
    progress.announce(words_of_fit(sequencer.evaluation()));
    problem = job.run(progress);
  }
  if (!problem && sequencer.failure()) {
    problem = describe_failure(sequencer.evaluation(), options,
                               imported.names_phase_unit || options.measures(), imported.doubt);
    problem = work_in_band(options, job, progress, std::move(problem), remark);
  }
  return problem;
}

void write_text(const Results& results, app::TextWriter& out) {
  write_report(results.evaluation, results.context, out);
}

void write_results(const Results& results, app::TextWriter& out) {
  write_json(results.evaluation, results.context, out);
}

const char* or_null(const std::string& text) noexcept {
  return text.empty() ? nullptr : text.c_str();
}

template <typename Write>
Problem print(Write write) {
  FileSink sink(stdout);
  app::TextWriter out(sink);
  write(out);
  return check_output(sink);
}

// Of a measurement whose files cannot be written: its points, in a file of their own if there is
// room for that.
//
// @returns What became of them, as the end of a line.
std::string keep_points(const app::EvaluationResults* results, const app::ReportContext& context,
                        OutputFiles& files) {
  const std::string name = write_points_alone(results, context, files);
  return "; the points are on standard output" + (name.empty() ? "" : " and in " + name);
}

// The files and the text of a measurement that has led to no result: what there is.
Problem keep(const app::ReportContext& context, const app::EvaluationResults* refused, bool json,
             OutputFiles* files) {
  Problem problem = files != nullptr ? write_fault_files(context, refused, *files) : Problem{};
  const bool are_points_lost = problem.status == ExitStatus::kFault;
  if (are_points_lost) {
    problem.line += keep_points(nullptr, context, *files);
  }
  const Problem printed =
      json ? print([&](app::TextWriter& out) { write_measurement_json(context, refused, out); })
           : print([&](app::TextWriter& out) {
               write_measurement(context, refused, out);
               if (are_points_lost) {
                 write_points(nullptr, context, out.line());
               }
             });
  return problem ? problem : printed;
}

// The fault, and in the same line what became of what there is.
Problem keep_and_report(const Problem& fault, const Results& results, bool json,
                        OutputFiles* files) {
  const bool was_swept = results.context.measurement->sweep.status == Status::kOk;
  const app::EvaluationResults* refused = was_swept ? &results.evaluation : nullptr;
  Problem problem = fault;
  if (const Problem kept = keep(results.context, refused, json, files)) {
    problem.line += kept.line.empty() ? "" : "; " + kept.line;
  } else if (files != nullptr && !files->prefix().empty()) {
    problem.line += "; its files begin with " + files->prefix() + ", complete ones are kept";
  }
  return problem;
}

// A stop behind the sweep: its points are kept, or it is said where they are.
Problem keep_stopped(const std::string& stop, const Results& results, const BenchJob& bench,
                     const ReportOptions& options, OutputFiles* files) {
  const bool is_remote = !options.instrument.empty();
  const auto ended = [&](const std::string& words) {
    return Problem{ExitStatus::kStopped, stop + "; " + words};
  };
  if (bench.has_left_sweep()) {
    return ended("the points of its sweep are still in the instrument: FETC:TRAC? answers them");
  }
  if (files == nullptr) {
    return ended(is_remote ? "the points of the sweep are still in the instrument: FETC:TRAC? "
                             "answers them; --out DIR keeps them at a stop"
                           : "the sweep that was measured is lost: --out DIR keeps its points at a "
                             "stop");
  }
  const app::EvaluationResults* evaluation =
      results.evaluation.has_fit() ? &results.evaluation : nullptr;
  const std::string name = write_stopped_points(evaluation, results.context, *files);
  if (!name.empty()) {
    return ended("the points of the sweep are kept in " + printable(options.out_directory) + "/" +
                 name + ", which --points takes");
  }
  const Problem printed =
      print([&](app::TextWriter& out) { write_points(evaluation, results.context, out); });
  return ended("--out cannot be written to; the points of the sweep are on standard output" +
               (printed ? "; " + printed.line : std::string()));
}

void write_early_points(const std::vector<EarlyPoint>& points, app::TextWriter& out) {
  out.text("f_hz,amplitude,phase_deg\n");
  for (const EarlyPoint& point : points) {
    out.exact(point.frequency_hz).text(",").exact(point.amplitude).text(",");
    out.exact(point.phase_deg).text("\n");
  }
}

// An instrument that was lost in its sweep: the points that it has told until then.
Problem keep_early_points(const Problem& fault, const std::vector<EarlyPoint>& points,
                          OutputFiles* files) {
  constexpr const char* kName = "interrupted_points.csv";
  const auto table = [&](app::TextWriter& out) { write_early_points(points, out); };
  Problem problem = files != nullptr ? files->add(kName, table) : Problem{};
  problem = files != nullptr && !problem ? files->commit() : problem;
  const Problem printed = print(table);
  problem = problem ? problem : printed;
  Problem kept = fault;
  kept.line += "; " + std::to_string(points.size()) + " points, without uncertainties, are kept" +
               (files != nullptr && !problem ? std::string(" in ") + kName : "") +
               (problem ? "; " + problem.line : "");
  return kept;
}

// Two remarks in one line; the second may be of a fault.
Problem both(const Problem& first, const Problem& second) {
  const bool is_single = first.line.empty() || second.line.empty();
  const ExitStatus status = second.line.empty() ? first.status : second.status;
  return {status, first.line + (is_single ? "" : "; ") + second.line};
}

// The results are then those of the in-band error.
constexpr const char* kOtherCriterion =
    "E, trials and trend are those of --criterion band: rounding hides the error asked for";

bool is_sensitivity_alone(const app::EvaluationResults& evaluation, const ReportOptions& options) {
  return !options.points_path.empty() && !(options.damping > 0.0) &&
         evaluation.stage == app::Stage::kFailed &&
         evaluation.judgement.determined == Determined::kSensitivity;
}

// Points that determine S alone: its value is a result.
Problem give_sensitivity(const Results& results, bool json, OutputFiles* files) {
  const auto text = [&](app::TextWriter& out) {
    write_sensitivity_text(results.evaluation, results.context, out);
  };
  const auto object = [&](app::TextWriter& out) {
    write_sensitivity_json(results.evaluation, results.context, out);
  };
  if (Problem problem = files != nullptr
                            ? write_sensitivity_files(results.evaluation, results.context, *files)
                            : Problem{}) {
    return problem;
  }
  return json ? print(object) : print(text);
}

// Where the eyes are, too.
Problem remark_on_table(const ReportOptions& options, const ImportedPoints& imported) {
  const std::string& doubt = imported.doubt;
  return {ExitStatus::kDone,
          doubt.empty() ? "" : name_of_input(options.points_path) + ": " + in_line(doubt)};
}

Problem remark_on_reference(const ReportOptions& options) {
  app::SweepResults asked;
  asked.settings = options.sweep;
  const bool is_short = options.measures() && contradicts(app::Warning::kBeyondTable, asked);
  return {ExitStatus::kDone, is_short ? std::string("--reference-table: ") +
                                            app::words_of_contradiction(app::Warning::kBeyondTable)
                                      : ""};
}

// A certificate may name less than ISO/IEC 17025 asks for, but not unnoticed.
Problem remark_on_labels(const app::ReportContext& context) {
  const std::string missing = labels_not_stated(context);
  return {ExitStatus::kDone,
          missing.empty() ? "" : "--certificate-number: ISO/IEC 17025 also asks for " + missing};
}

// Before the long work: the labels of a digital certificate, and whether there is room for it.
Problem open_digital(const ReportOptions& options, const std::vector<app::NamedLabel>& more,
                     SingleFile& file) {
  if (options.dcc_path.empty()) {
    return {};
  }
  const Problem problem = check_certificate_labels(options.labels(more));
  return problem ? problem : file.open();
}

Problem write_digital(const Results& results, SingleFile& file) {
  return file.write([&results](app::TextWriter& out) {
    const std::string xml = certificate_xml(results.evaluation, results.context);
    out.text(Span<const char>(xml.data(), xml.size()));
  });
}

}  // namespace

Problem run_report(Span<const std::string_view> arguments) {
  ReportOptions options;
  if (Problem problem = parse_report_options(arguments, options)) {
    return problem;
  }
  const std::vector<app::NamedLabel> more_labels = options.more_labels();
  SingleFile digital(options.dcc_path);
  if (Problem problem = open_digital(options, more_labels, digital)) {
    return problem;
  }
  OutputFiles out_files;
  OutputFiles* files = options.out_directory.empty() ? nullptr : &out_files;
  if (Problem problem = files != nullptr ? files->open(options.out_directory) : Problem{}) {
    return problem;
  }
  static BenchJob bench;
  static ImportedPoints imported;
  Problem criterion_changed;
  Problem problem_of_work = work(options, bench, imported, criterion_changed);
  const app::EvaluationResults& evaluation = bench.sequencer().evaluation();
  const std::string points_name = name_of_input(options.points_path);
  const bool has_table = !options.points_path.empty() && !problem_of_work;
  const bool is_measured = options.measures() && evaluation.has_fit();
  const std::string cause = has_table     ? cause_of(evaluation.fit, imported.names_phase_unit)
                            : is_measured ? cause_of_measured(evaluation.fit)
                            : is_sensitivity_alone(evaluation, options)
                                ? words_on_damping(frequency_by_damping(imported.points))
                                : "";
  const app::Measurement measurement = bench.measurement();
  app::ReportContext context = {options.points_path.empty() ? nullptr : points_name.c_str(),
                                options.measures() ? &measurement : nullptr,
                                options.labels(more_labels),
                                options.in_g,
                                or_null(cause),
                                or_null(imported.understanding)};
  context.doubt = or_null(imported.doubt);
  const FigureMark mark = problem_of_work ? FigureMark{} : mark_of_figures(evaluation, context);
  context.mark = or_null(mark.words);
  context.marked = mark.rows;
  context.leading_settling_s =
      evaluation.stage == app::Stage::kDone ? settling_time_of_leading_s(evaluation) : 0.0;
  context.other_criterion = criterion_changed.line.empty() ? nullptr : kOtherCriterion;
  const Results results = {evaluation, context};
  if (problem_of_work && is_sensitivity_alone(evaluation, options)) {
    return give_sensitivity(results, options.json, files);
  }
  if (problem_of_work.status == ExitStatus::kFault && !bench.early_points().empty()) {
    return keep_early_points(problem_of_work, bench.early_points(), files);
  }
  const bool has_points = options.measures() && (bench.has_swept() || bench.has_left_sweep());
  if (problem_of_work.status == ExitStatus::kStopped && has_points) {
    return keep_stopped(problem_of_work.line, results, bench, options, files);
  }
  const bool is_of_rest = problem_of_work && bench.has_result_of_rest();
  if (problem_of_work && !is_of_rest) {
    const bool keeps = problem_of_work.status == ExitStatus::kFault && bench.has_measured();
    return keeps ? keep_and_report(problem_of_work, results, options.json, files) : problem_of_work;
  }
  Problem remark;
  Problem unwritten =
      files != nullptr ? write_files(evaluation, context, *files, remark) : Problem{};
  if (unwritten.status == ExitStatus::kStopped && has_points) {
    const std::string fault_before = is_of_rest ? problem_of_work.line + "; " : "";
    return keep_stopped(fault_before + unwritten.line, results, bench, options, files);
  }
  // A measurement that no file holds is at least printed, with its points.
  const bool are_points_lost =
      unwritten.status == ExitStatus::kFault && options.measures() && !options.json;
  if (unwritten.status == ExitStatus::kFault && options.measures()) {
    unwritten.line += keep_points(&evaluation, context, *files);
  }
  if (!unwritten && !is_of_rest) {
    unwritten = write_digital(results, digital);
  }
  if (unwritten && !(unwritten.status == ExitStatus::kFault && options.measures())) {
    return unwritten;
  }
  Problem problem = options.json ? print([&](app::TextWriter& out) { write_results(results, out); })
                                 : print([&](app::TextWriter& out) {
                                     write_text(results, out);
                                     if (are_points_lost) {
                                       write_points(&evaluation, context, out.line());
                                     }
                                   });
  problem = unwritten ? unwritten : problem;
  if (is_of_rest && !problem) {
    return problem_of_work;
  }
  if (!problem && remark.line.empty()) {
    remark = bench.unstruck();
  }
  const Problem of_table = remark_on_table(options, imported);
  return problem ? problem
                 : both(both(of_table, remark_on_reference(options)),
                        both(both(criterion_changed, remark), remark_on_labels(context)));
}

std::string help_on_report() {
  return R"(usage: emax report [options]
       emax report --instrument PORT [options]
       emax report --points FILE [options]
       emax report --model S,f0,beta[,uS,uf0,ubeta] [options]

Measures an accelerometer, on the simulated bench or on a board, or takes a
table of measured points or known parameters. Then it fits a model, finds the
signal with the largest error energy and prints a report. Numbers are in SI
units. Write --option VALUE or --option=VALUE.
)" + help_on_report_options();
}

}  // namespace emax::desk
