// The files of a report.
#include "desk/files/report_files.hpp"

#include <vector>

#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"

#include "desk/cli/stop_request.hpp"
#include "desk/compare/name_lines.hpp"
#include "desk/page/html_page.hpp"
#include "desk/pictures/pictures.hpp"

namespace emax::desk {

namespace {

constexpr char kPointsTable[] = "frequency_response.csv";

// The other tables; they need nothing but the results.
struct Table {
  const char* name;
  void (*write)(const app::EvaluationResults& results, app::TextWriter& out) noexcept;
};

constexpr Table kTables[] = {
    {"impulse_response.csv", app::write_impulse_response_csv},
    {"signal.csv", app::write_signal_csv},
    {"trend.csv", app::write_trend_csv},
    {"histogram.csv", app::write_histogram_csv},
};

Problem add_points_table(const app::EvaluationResults& results, const app::ReportContext& context,
                         OutputFiles& files) {
  if (results.source != app::Source::kPoints) {
    files.set_aside(kPointsTable);  // It may be the only record of a measurement.
    return {};
  }
  const app::SweepResults* sweep =
      context.measurement != nullptr ? &context.measurement->sweep : nullptr;
  return files.add(kPointsTable, [&](app::TextWriter& out) {
    write_frequency_response_csv(results, sweep, out);
  });
}

Problem add_tables(const app::EvaluationResults& results, OutputFiles& files) {
  for (const Table& table : kTables) {
    Problem problem =
        files.add(table.name, [&](app::TextWriter& out) { table.write(results, out); });
    if (problem) {
      return problem;
    }
  }
  return {};
}

// Those of an earlier run go, unless there are new ones.
void drop_pictures(OutputFiles& files) {
  for (const char* name : kPictureFiles) {
    files.drop(name);
  }
  files.drop(kPictureScript);
  files.drop(kStartTable);
}

// The script of the pictures, and the pictures where gnuplot can draw them.
//
// @param[out] remark What stands in the way of the pictures.
Problem add_pictures(const app::EvaluationResults& results, const app::ReportContext& context,
                     OutputFiles& files, std::vector<PagePicture>& shown, Problem& remark) {
  drop_pictures(files);
  const std::vector<Picture> pictures = pictures_of(results, context);
  Problem problem = files.add(
      kPictureScript, [&](app::TextWriter& out) { write_picture_script(pictures, results, out); });
  if (problem) {
    return problem;
  }
  if (has_start_table(results)) {
    problem =
        files.add(kStartTable, [&](app::TextWriter& out) { write_start_table(results, out); });
    if (problem) {
      return problem;
    }
  }
  std::vector<const char*> names;
  names.reserve(pictures.size());
  for (const Picture& picture : pictures) {
    names.push_back(picture.file);
  }
  problem = files.draw(kPictureScript, Span<const char* const>(names.data(), names.size()), remark);
  if (problem) {
    return problem;
  }
  if (remark.line.empty()) {
    for (const Picture& picture : pictures) {
      shown.push_back({picture, files.content_of(picture.file)});
    }
  }
  return {};
}

// @returns The name of the file; empty if there is none.
std::string put_points(const app::EvaluationResults* results, const app::ReportContext& context,
                       OutputFiles& files) {
  const Problem problem =
      files.add(kPointsTable, [&](app::TextWriter& out) { write_points(results, context, out); });
  return problem || files.commit() ? "" : files.prefix() + kPointsTable;
}

}  // namespace

Problem write_files(const app::EvaluationResults& results, const app::ReportContext& context,
                    OutputFiles& files, Problem& remark) {
  Problem problem =
      files.add("report.txt", [&](app::TextWriter& out) { write_report(results, context, out); });
  if (problem) {
    return problem;
  }
  problem =
      files.add("results.json", [&](app::TextWriter& out) { write_json(results, context, out); });
  if (problem) {
    return problem;
  }
  problem = add_points_table(results, context, files);
  problem = problem ? problem : add_tables(results, files);
  if (problem) {
    return problem;
  }
  std::vector<PagePicture> pictures;
  problem = add_pictures(results, context, files, pictures, remark);
  if (problem) {
    return problem;
  }
  problem = files.add("report.html",
                      [&](app::TextWriter& out) { write_page(results, context, pictures, out); });
  if (problem) {
    return problem;
  }
  return stop_requested() ? stopped() : files.commit();
}

void write_points(const app::EvaluationResults* results, const app::ReportContext& context,
                  app::TextWriter& out) {
  if (results == nullptr) {
    write_measured_points_csv(*context.measurement, out);
    return;
  }
  write_frequency_response_csv(*results, &context.measurement->sweep, out);
}

std::string write_points_alone(const app::EvaluationResults* results,
                               const app::ReportContext& context, OutputFiles& files) {
  files.abandon();
  files.set_prefix(files.has(kPointsTable) ? "failed_" : "");
  return put_points(results, context, files);
}

std::string write_stopped_points(const app::EvaluationResults* results,
                                 const app::ReportContext& context, OutputFiles& files) {
  files.abandon();
  if (files.has(kPointsTable)) {
    files.set_prefix("stopped_");
    files.set_aside(kPointsTable);  // That of the last stop.
  }
  return put_points(results, context, files);
}

Problem write_fault_files(const app::ReportContext& context, const app::EvaluationResults* refused,
                          OutputFiles& files) {
  const auto text = [&](app::TextWriter& out) { write_measurement(context, refused, out); };
  const auto json = [&](app::TextWriter& out) { write_measurement_json(context, refused, out); };
  const auto page = [&](app::TextWriter& out) { write_fault_page(context, refused, out); };
  const auto points = [&](app::TextWriter& out) { write_points(nullptr, context, out); };
  // A complete report, which alone has a signal, is worth more than what a fault leaves.
  if (files.has("signal.csv")) {
    files.set_prefix("failed_");
  }
  Problem problem = files.add("report.txt", text);
  problem = problem ? problem : files.add("results.json", json);
  problem = problem ? problem : files.add("report.html", page);
  problem = problem ? problem : files.add(kPointsTable, points);
  return problem ? problem : files.commit();
}

void write_sensitivity_text(const app::EvaluationResults& results,
                            const app::ReportContext& context, app::TextWriter& out) {
  constexpr double kWidth = 94.0;
  constexpr std::size_t kMostLines = 8;
  write_sensitivity_report(results, context, out);
  // Magnitudes alone have no chi-square there, beside which the cause is written.
  if (context.cause == nullptr || results.fit.result().chi2 > 0.0) {
    return;
  }
  out.line();
  for (const std::string& line :
       wrapped(std::string("Note: ") + context.cause, kWidth, kMostLines)) {
    out.text("  ").text(line.c_str()).line();
  }
}

Problem write_sensitivity_files(const app::EvaluationResults& results,
                                const app::ReportContext& context, OutputFiles& files) {
  Problem problem = files.add(
      "report.txt", [&](app::TextWriter& out) { write_sensitivity_text(results, context, out); });
  problem = problem ? problem : files.add("results.json", [&](app::TextWriter& out) {
    write_sensitivity_json(results, context, out);
  });
  files.set_aside(kPointsTable);  // It may be the only record of a measurement.
  for (const Table& table : kTables) {
    files.drop(table.name);
  }
  files.drop("report.html");
  drop_pictures(files);
  return problem ? problem : files.commit();
}

}  // namespace emax::desk
