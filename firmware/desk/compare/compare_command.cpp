// `emax compare`.
#include "desk/compare/compare_command.hpp"

#include <cstdio>
#include <utility>
#include <vector>

#include "desk/cli/console.hpp"
#include "desk/cli/option_parser.hpp"
#include "desk/cli/value_text.hpp"
#include "desk/compare/comparison.hpp"
#include "desk/compare/comparison_csv.hpp"
#include "desk/compare/comparison_json.hpp"
#include "desk/compare/comparison_page.hpp"
#include "desk/compare/comparison_picture.hpp"
#include "desk/compare/comparison_report.hpp"
#include "desk/compare/figure_text.hpp"
#include "desk/files/output_files.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxFiles = 1000;

struct CompareOptions {
  std::vector<std::string> paths;
  std::string out_directory;  // Empty for no files.
  FigureKind by = FigureKind::kMatched;
  bool json = false;
  bool csv = false;
};

Problem take_path(std::string_view argument, std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    if (path == argument) {
      return bad_input(printable(argument) + ": given twice; expected each device once");
    }
  }
  paths.emplace_back(argument);
  return paths.size() <= kMaxFiles ? Problem{} : bad_input("compare: more than 1000 files");
}

bool take_by(std::string_view text, FigureKind& by) {
  for (const FigureKind kind : {FigureKind::kMatched, FigureKind::kBand, FigureKind::kEnergy}) {
    if (text == figure_words(kind).option) {
      by = kind;
      return true;
    }
  }
  return false;
}

Syntax syntax_of(CompareOptions& options) {
  Syntax syntax;
  syntax.options = {
      {"by", "Options", "FIGURE", "matched", "matched, band or energy",
       "what ranks: matched, the in-band error in percent of\n"
       "S a with the sensor's constant delay taken out (band\n"
       "for all where one device has no such figure); band,\n"
       "the same with the delay; energy, the E of the paper",
       [&options](std::string_view text) { return take_by(text, options.by); }},
      {"csv", "Options", "", "", "", "prints the table as CSV",
       [&options](std::string_view) { return options.csv = true; }},
      {"json", "Options", "", "", "", "prints everything as JSON",
       [&options](std::string_view) { return options.json = true; }},
      {"out", "Options", "DIR", "", "a directory",
       "writes comparison.html (one page, also to print), the\n"
       "same as .txt, .csv and .json, and the picture (SVG) by\n"
       "gnuplot and its script; DIR is made if missing",
       [&options](std::string_view text) { return take_text(text, options.out_directory); }}};
  syntax.unknown = "no option of emax compare";
  syntax.take_file = [&options](std::string_view path) { return take_path(path, options.paths); };
  return syntax;
}

Problem parse(Span<const std::string_view> arguments, CompareOptions& options) {
  const Syntax syntax = syntax_of(options);
  std::vector<Given> all;
  if (Problem problem = parse_options(arguments, syntax, all)) {
    return problem;
  }
  if (options.json && options.csv) {
    return bad_input("--json: excludes --csv; expected one of the two");
  }
  return options.paths.size() >= 2
             ? Problem{}
             : bad_input("compare: " + std::string(options.paths.empty() ? "no" : "a single") +
                         " file; expected two or more results.json of emax report");
}

// What `remark` says is worth a line, and no reason to end otherwise.
Problem write_files(const Comparison& comparison, OutputFiles& files, Problem& remark) {
  using Write = void (*)(const Comparison&, app::TextWriter&);
  constexpr std::pair<const char*, Write> kFiles[] = {
      {"comparison.txt", write_comparison},
      {"comparison.csv", write_comparison_csv},
      {"comparison.json", write_comparison_json},
      {kComparisonScript, write_comparison_script},
  };
  for (const auto& file : kFiles) {
    const Write write = file.second;
    if (Problem problem =
            files.add(file.first, [&](app::TextWriter& out) { write(comparison, out); })) {
      return problem;
    }
  }
  constexpr const char* kPictures[] = {kComparisonPicture};
  if (Problem problem = files.draw(kComparisonScript, kPictures, remark)) {
    return problem;
  }
  const std::string svg = remark.line.empty() ? files.content_of(kComparisonPicture) : "";
  if (Problem problem = files.add("comparison.html", [&](app::TextWriter& out) {
        write_comparison_page(comparison, svg, out);
      })) {
    return problem;
  }
  return files.commit();
}

Problem print(const Comparison& comparison, const CompareOptions& options) {
  FileSink sink(stdout);
  app::TextWriter out(sink);
  if (options.json) {
    write_comparison_json(comparison, out);
  } else if (options.csv) {
    write_comparison_csv(comparison, out);
  } else {
    write_comparison(comparison, out);
  }
  return check_output(sink);
}

}  // namespace

Problem run_compare(Span<const std::string_view> arguments) {
  CompareOptions options;
  if (Problem problem = parse(arguments, options)) {
    return problem;
  }
  OutputFiles files;
  if (!options.out_directory.empty()) {
    if (Problem problem = files.open(options.out_directory)) {
      return problem;
    }
  }
  std::vector<Result> results;
  for (const std::string& path : options.paths) {
    results.emplace_back();
    if (Problem problem = read_result(path, results.back())) {
      return problem;
    }
  }
  Comparison comparison;
  Problem remark;
  if (Problem problem = compare_all(std::move(results), options.by, comparison)) {
    return problem;
  }
  if (!options.out_directory.empty()) {
    if (Problem problem = write_files(comparison, files, remark)) {
      return problem;
    }
  }
  if (Problem problem = print(comparison, options)) {
    return problem;
  }
  return remark;
}

std::string help_on_compare() {
  CompareOptions options;
  return R"(usage: emax compare A.json B.json ... [options]

Ranks devices by how wrong they can get, from the results.json of emax report.
All reports need the same filter, T, criterion and choice of the delay. S and a
may differ, except with --by energy: give all reports the same --limit then, as
a is the number of S by default. Two devices share their ranks where the
uncertainties do not tell them apart. A device is marked where its fit warns or
its bench was simulated; it is then not told apart from any other.
)" + help_on(syntax_of(options).options);
}

}  // namespace emax::desk
