// A comparison to read.
#include "desk/compare/comparison_report.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "emax/app/base/version.hpp"

#include "desk/cli/console.hpp"
#include "desk/compare/comparison_words.hpp"
#include "desk/compare/name_lines.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

constexpr std::size_t kMostColumns = 130;
constexpr std::size_t kGap = 2;
constexpr std::size_t kLeastName = 12;
constexpr std::size_t kMostName = 36;
constexpr std::size_t kReportNameLines = kNameShown / kLeastName;
constexpr double kWordsColumns = 86.0;
constexpr std::size_t kAnyLines = 100;

void write_words(const std::string& words, const char* first_start, const char* start,
                 TextWriter& out) {
  const char* before = first_start;
  for (const std::string& line : wrapped(words, kWordsColumns, kAnyLines)) {
    out.text(before).text(line.c_str()).line();
    before = start;
  }
}

std::vector<std::size_t> widths_of(const ComparisonTable& table) {
  std::vector<std::size_t> widths;
  std::size_t others = 0;
  for (std::size_t column = 0; column < table.headings.size(); ++column) {
    std::size_t width = table.headings[column].size();
    for (const std::vector<std::string>& row : table.rows) {
      width = std::max(width, characters_in(row[column]));
    }
    widths.push_back(width);
    others += kGap + (column == table.names ? 0 : width);
  }
  // Names have what the numbers leave, and go on below.
  const std::size_t room = kMostColumns - std::min(kMostColumns, others);
  widths[table.names] = std::min(widths[table.names], std::clamp(room, kLeastName, kMostName));
  return widths;
}

bool is_of_words(const ComparisonTable& table, std::size_t column) {
  return column <= table.names || table.headings[column] == "mark";
}

void write_row(const ComparisonTable& table, const std::vector<std::string>& row,
               const std::vector<std::size_t>& widths, TextWriter& out) {
  std::string line;
  for (std::size_t column = 0; column < row.size(); ++column) {
    const std::string padding(widths[column] - std::min(widths[column], characters_in(row[column])),
                              ' ');
    line += std::string(kGap, ' ');
    line += is_of_words(table, column) ? row[column] + padding : padding + row[column];
  }
  line.erase(line.find_last_not_of(' ') + 1);
  out.text(line.c_str()).line();
}

void write_device(const ComparisonTable& table, const Result& result, std::vector<std::string> row,
                  const std::vector<std::size_t>& widths, TextWriter& out) {
  const std::vector<std::string> lines =
      name_lines(result, static_cast<double>(widths[table.names]), kReportNameLines);
  const std::string below(kGap + widths[0] + kGap, ' ');
  row[table.names] = lines.front();
  write_row(table, row, widths, out);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    out.text(below.c_str()).text(lines[i].c_str()).line();
  }
}

void write_table(const Comparison& comparison, TextWriter& out) {
  const ComparisonTable table = table_of(comparison);
  const std::vector<std::size_t> widths = widths_of(table);
  write_row(table, table.headings, widths, out);
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    write_device(table, comparison.results[i], table.rows[i], widths, out);
  }
}

void write_neighbours(const Comparison& comparison, TextWriter& out) {
  out.text("\nNEIGHBOURS\n");
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const Fact verdict = verdict_of(comparison, i);
    const std::string names =
        short_name_of(comparison.results[i]) + " and " + short_name_of(comparison.results[i + 1]);
    write_words(names + ": " + verdict.name + ": " + verdict.words, "  ", "    ", out);
  }
}

}  // namespace

void write_comparison(const Comparison& comparison, TextWriter& out) {
  constexpr std::size_t kLabel = 26;
  out.text("COMPARISON OF ").integer(comparison.results.size());
  out.text(" DEVICES (emax ").text(app::kVersion).text(")\n");
  const std::string banner = banner_of(comparison);
  if (!banner.empty()) {
    out.text("  ").text(banner.c_str()).line();
  }
  for (const Fact& condition : conditions_of(comparison)) {
    out.text("  ").left(kLabel).text(condition.name.c_str()).text(condition.words.c_str()).line();
  }
  for (const Note& note : notes_of(comparison)) {
    out.line();
    write_words((note.is_warning ? "WARNING: " : "Note: ") + note.words, "  ", "  ", out);
  }
  out.line();
  write_table(comparison, out);
  out.line();
  for (const Fact& fact : legend_of(comparison)) {
    write_words(fact.name + ": " + fact.words, "  ", "    ", out);
  }
  write_neighbours(comparison, out);
}

}  // namespace emax::desk
