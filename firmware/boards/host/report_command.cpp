// `emax report`.
#include "report_command.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <new>
#include <string>

#include "emax/app/evaluation.hpp"
#include "emax/app/measurement.hpp"
#include "emax/app/report.hpp"
#include "emax/frequency_response.hpp"

#include "bench_job.hpp"
#include "console.hpp"
#include "console_progress.hpp"
#include "options.hpp"
#include "output_files.hpp"
#include "points_file.hpp"
#include "stop_request.hpp"
#include "text_file.hpp"

namespace emax::host {

namespace {

constexpr std::uint32_t kMaxStoredTrials = 10'000'000;

// Sentences of the library, with what they add in brackets, as the middle of a line: small letters
// at the start, no full stops.
std::string in_line(const std::string& text) {
  std::string line;
  bool starts = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool ends = i + 1 == text.size() || text[i + 1] == ' ' || text[i + 1] == ')';
    if (c == '.' && ends) {
      continue;
    }
    line += starts ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
    starts = text.compare(i, 5, "(The ") == 0;
  }
  return line;
}

// What has to be changed: an option, or the device.
std::string culprit(const app::Failure& failure, const ReportOptions& options) {
  const bool is_search =
      failure.status == Status::kTooManyCells || failure.status == Status::kTooManySwitches;
  if (is_search && failure.stage == app::Stage::kTrend) {
    return "--trend";
  }
  if (is_search) {
    return "--time";
  }
  if (options.measures()) {
    return "measurement";
  }
  return options.points_path.empty() ? "--model" : name_of_input(options.points_path);
}

Problem describe(const app::Evaluation& evaluation, const ReportOptions& options) {
  const app::Failure& failure = evaluation.failure();
  const bool is_inverted = failure.status == Status::kInvertedPolarity;
  StringSink sentence;
  app::TextWriter writer(sentence);
  write_failure(evaluation, writer);
  const std::string who = culprit(failure, options);
  const std::string line =
      who + ": " + (is_inverted ? "inverted polarity: " : "") + in_line(sentence.text());
  // What the bench gave is no input of the user's.
  return who == "measurement" ? fault(line) : bad_input(line);
}

// What a report is written from.
struct Results {
  const app::Evaluation& evaluation;
  const char* points_name;              // Null if there is no table of points.
  const app::Measurement* measurement;  // Null without one.
};

Problem start(const ReportOptions& options, const app::Sweep& sweep, app::Evaluation& evaluation) {
  if (!options.model_text.empty()) {
    const Status status = evaluation.start_from_model(options.device, options.settings);
    return status == Status::kOk ? Problem{} : describe(evaluation, options);
  }
  static FrequencyResponse points;
  if (options.measures()) {
    (void)sweep.copy_to(points);  // A sweep that is done has points that a table takes.
  } else if (Problem problem =
                 read_points(options.points_path, options.reference_uncertainty_percent, points)) {
    return problem;
  }
  const Status status = evaluation.start_from_points(points, options.settings);
  return status == Status::kOk ? Problem{} : describe(evaluation, options);
}

// Runs an evaluation that has been started, with room for the trials' values, so that each is
// computed once.
Problem run(const ReportOptions& options, ConsoleProgress& progress, app::Evaluation& evaluation) {
  const std::uint32_t trials =
      options.settings.adaptive ? kMaxStoredTrials : options.settings.trials;
  const std::size_t room = std::min(trials, kMaxStoredTrials);
  const std::unique_ptr<double[]> store(new (std::nothrow) double[room]);
  if (store != nullptr) {
    evaluation.lend_trial_store(Span<double>(store.get(), room));
  }
  while (!evaluation.done()) {
    if (stop_requested()) {
      return stopped();
    }
    progress.show(name_of(evaluation.stage()), evaluation.progress());
    evaluation.step();
  }
  evaluation.lend_trial_store({});
  return evaluation.status() == Status::kOk ? Problem{} : describe(evaluation, options);
}

// Everything from the measurement to the results.
Problem work(const ReportOptions& options, BenchJob& bench, app::Evaluation& evaluation) {
  ConsoleProgress progress;
  Problem problem = options.measures() ? bench.run(options, progress) : Problem{};
  if (!problem) {
    problem = start(options, bench.sweep(), evaluation);
  }
  return problem ? problem : run(options, progress, evaluation);
}

// The tables; they need nothing but the evaluation.
struct Table {
  const char* name;
  void (*write)(const app::Evaluation& evaluation, app::TextWriter& out) noexcept;
  bool needs_points;
};

constexpr Table kTables[] = {
    {"frequency_response.csv", app::write_frequency_response_csv, true},
    {"impulse_response.csv", app::write_impulse_response_csv, false},
    {"signal.csv", app::write_signal_csv, false},
    {"trend.csv", app::write_trend_csv, false},
    {"histogram.csv", app::write_histogram_csv, false},
};

Problem add_tables(const app::Evaluation& evaluation, OutputFiles& files) {
  for (const Table& table : kTables) {
    if (table.needs_points && evaluation.source() != app::Source::kPoints) {
      files.drop(table.name);
      continue;
    }
    Problem problem =
        files.add(table.name, [&](app::TextWriter& out) { table.write(evaluation, out); });
    if (problem) {
      return problem;
    }
  }
  return {};
}

void write_text(const Results& results, app::TextWriter& out) {
  if (results.measurement != nullptr) {
    write_report(results.evaluation, *results.measurement, out);
  } else {
    write_report(results.evaluation, results.points_name, out);
  }
}

void write_results(const Results& results, app::TextWriter& out) {
  if (results.measurement != nullptr) {
    write_json(results.evaluation, *results.measurement, out);
  } else {
    write_json(results.evaluation, results.points_name, out);
  }
}

Problem write_files(const Results& results, OutputFiles& files) {
  Problem problem =
      files.add("report.txt", [&](app::TextWriter& out) { write_text(results, out); });
  if (problem) {
    return problem;
  }
  problem = files.add("results.json", [&](app::TextWriter& out) { write_results(results, out); });
  if (problem) {
    return problem;
  }
  problem = add_tables(results.evaluation, files);
  if (problem) {
    return problem;
  }
  return stop_requested() ? stopped() : files.commit();
}

template <typename Write>
Problem print(Write write) {
  FileSink sink(stdout);
  app::TextWriter out(sink);
  write(out);
  return check_output(sink);
}

// The files and the text of a measurement that has led to no result: what there is.
Problem keep(const app::Measurement& measurement, const app::Evaluation* refused, bool json,
             OutputFiles* files) {
  const auto text = [&](app::TextWriter& out) { write_measurement(measurement, refused, out); };
  const auto results = [&](app::TextWriter& out) {
    write_measurement_json(measurement, refused, out);
  };
  const auto points = [&](app::TextWriter& out) { write_measured_points_csv(measurement, out); };
  if (files != nullptr) {
    Problem problem = files->add("report.txt", text);
    problem = problem ? problem : files->add("results.json", results);
    problem = problem ? problem : files->add("frequency_response.csv", points);
    for (const Table& table : kTables) {
      if (!table.needs_points) {
        files->drop(table.name);
      }
    }
    problem = problem ? problem : files->commit();
    if (problem) {
      return problem;
    }
  }
  return json ? print(results) : print(text);
}

// The fault, and in the same line what became of what there is.
Problem keep_and_report(const Problem& fault, const BenchJob& bench,
                        const app::Evaluation& evaluation, bool json, OutputFiles* files) {
  const app::Evaluation* refused = bench.sweep().status() == Status::kOk ? &evaluation : nullptr;
  Problem problem = fault;
  if (const Problem kept = keep(bench.measurement(), refused, json, files)) {
    problem.line += kept.line.empty() ? "" : "; " + kept.line;
  }
  return problem;
}

}  // namespace

Problem run_report(Span<const std::string_view> arguments) {
  ReportOptions options;
  if (Problem problem = parse_report_options(arguments, options)) {
    return problem;
  }
  OutputFiles out_files;
  OutputFiles* files = options.out_directory.empty() ? nullptr : &out_files;
  if (Problem problem = files != nullptr ? files->open(options.out_directory) : Problem{}) {
    return problem;
  }
  static BenchJob bench;
  static app::Evaluation evaluation;
  if (Problem problem = work(options, bench, evaluation)) {
    const bool keeps = problem.status == ExitStatus::kFault && bench.has_measured();
    return keeps ? keep_and_report(problem, bench, evaluation, options.json, files) : problem;
  }
  const std::string points_name = name_of_input(options.points_path);
  const app::Measurement measurement = bench.measurement();
  const Results results = {evaluation, options.points_path.empty() ? nullptr : points_name.c_str(),
                           options.measures() ? &measurement : nullptr};
  if (Problem problem = files != nullptr ? write_files(results, *files) : Problem{}) {
    return problem;
  }
  return options.json ? print([&](app::TextWriter& out) { write_results(results, out); })
                      : print([&](app::TextWriter& out) { write_text(results, out); });
}

}  // namespace emax::host
