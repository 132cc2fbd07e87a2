// `emax compare`.
#include "desk/compare/compare_command.hpp"

#include <cstdio>
#include <utility>
#include <vector>

#include "desk/cli/console.hpp"
#include "desk/cli/nearest.hpp"
#include "desk/compare/comparison.hpp"
#include "desk/compare/comparison_picture.hpp"
#include "desk/compare/comparison_report.hpp"
#include "desk/files/output_files.hpp"

namespace emax::host {

namespace {

constexpr std::size_t kMaxFiles = 1000;

struct CompareOptions {
  std::vector<std::string> paths;
  std::string out_directory;  // Empty for no files.
  bool json = false;
  bool csv = false;
};

Problem unknown_option(std::string_view argument) {
  constexpr std::string_view kNames[] = {"--json", "--csv", "--out", "--help", "--version"};
  return bad_input(printable(argument) + ": no option of emax compare; did you mean " +
                   std::string(nearest(argument, kNames)) + "?");
}

Problem take_path(std::string_view argument, std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    if (path == argument) {
      return bad_input(printable(argument) + ": given twice; expected each device once");
    }
  }
  paths.emplace_back(argument);
  return paths.size() <= kMaxFiles ? Problem{} : bad_input("compare: more than 1000 files");
}

Problem take_out(std::string_view value, std::string& directory) {
  if (value.empty() || !directory.empty()) {
    return bad_input(value.empty() ? "--out: no value; expected a directory"
                                   : "--out: given twice; expected once");
  }
  directory = value;
  return {};
}

Problem parse_options(Span<const std::string_view> arguments, CompareOptions& options) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view argument = arguments[i];
    Problem problem;
    if (argument == "--json" || argument == "--csv") {
      (argument == "--json" ? options.json : options.csv) = true;
    } else if (argument == "--out") {
      const bool follows = i + 1 < arguments.size() && arguments[i + 1].substr(0, 2) != "--";
      problem = take_out(follows ? arguments[++i] : std::string_view{}, options.out_directory);
    } else if (argument.substr(0, 6) == "--out=") {
      problem = take_out(argument.substr(6), options.out_directory);
    } else if (argument.size() > 1 && argument[0] == '-') {
      problem = unknown_option(argument);
    } else {
      problem = take_path(argument, options.paths);
    }
    if (problem) {
      return problem;
    }
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
  if (Problem problem = parse_options(arguments, options)) {
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
  if (Problem problem = compare_all(std::move(results), comparison)) {
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
  return R"(usage: emax compare A.json B.json ... [options]

Ranks devices by their maximum energy: the results.json of emax report, all with
the same filter, a, T and criterion. Since a is the number of S by default, give
one --limit to all reports. Two devices share ranks where the uncertainties of
their energies do not tell them apart.

Options
  --csv                  prints the table as CSV
  --json                 prints everything as JSON
  --out DIR              writes comparison.txt, .csv and .json, and a picture
)";
}

}  // namespace emax::host
