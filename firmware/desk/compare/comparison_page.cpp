// A comparison as one page.
#include "desk/compare/comparison_page.hpp"

#include <cstddef>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "desk/compare/comparison_picture.hpp"
#include "desk/compare/comparison_words.hpp"
#include "desk/compare/figure_text.hpp"
#include "desk/compare/name_lines.hpp"
#include "desk/page/html_markup.hpp"
#include "desk/page/page_frame.hpp"
#include "desk/page/page_picture.hpp"

namespace emax::desk {

namespace {

// Words of ours; those with names of others among them are quoted.
std::string html_of(const std::string& words) {
  std::string html;
  append_words(html, words);
  return html;
}

// "5.1e-03" with its power of ten as in print.
std::string html_of_numbers(const std::string& text) {
  std::string html = html_of(text);
  constexpr std::string_view kDigits = "0123456789";
  for (std::size_t at = html.find('e'); at != std::string::npos; at = html.find('e', at + 1)) {
    const std::size_t end = html.find_first_not_of(kDigits, at + 2);
    const bool is_exponent = at > 0 && kDigits.find(html[at - 1]) != std::string_view::npos &&
                             at + 2 < html.size() && (html[at + 1] == '-' || html[at + 1] == '+');
    if (is_exponent) {
      const int exponent = std::atoi(html.c_str() + at + 1);
      const std::string power = " × 10<sup>" + std::string(exponent < 0 ? "−" : "") +
                                std::to_string(std::abs(exponent)) + "</sup>";
      html.replace(at, (end == std::string::npos ? html.size() : end) - at, power);
      at += power.size() - 1;
    }
  }
  return html;
}

void append_paragraph(std::string& html, const char* kind, const std::string& words) {
  html += "<p class=\"" + std::string(kind) + "\">" + quoted(words.c_str()) + "</p>\n";
}

void begin_section(std::string& html, const char* id, const char* title) {
  html += "<section id=\"" + std::string(id) + "\">\n<h2>" + title + "</h2>\n";
}

// Headline

std::string figure_with_uncertainty(const Comparison& comparison, const Result& result) {
  const Figure& figure = comparison.figure(result);
  const FigureKind by = comparison.by;
  std::string text = value_text(figure, by);
  if (figure.is_one_sided) {
    text += " (" + interval_text(figure, by) + ")";
  } else if (figure.has_uncertainty) {
    text += " +- " + expanded_text(figure, by);
  }
  // The unit stays in one piece.
  std::string unit = html_of(figure_words(by).unit);
  const std::size_t product = unit.find("S a");
  if (product != std::string::npos) {
    unit.replace(product, 3, "S&nbsp;a");
  }
  return html_of_numbers(text) + unit;
}

// What stands beside the figure.
std::string words_of_range(const Comparison& comparison, const Result& result) {
  const Figure& figure = comparison.figure(result);
  if (figure.is_one_sided) {
    return " (interval)";
  }
  return figure.has_uncertainty ? " (k = 2)" : "";
}

// Those that may be the best.
std::vector<const Result*> leaders_of(const Comparison& comparison) {
  std::vector<const Result*> leaders;
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    if (comparison.ranks[i].best == 1) {
      leaders.push_back(&comparison.results[i]);
    }
  }
  return leaders;
}

void append_headline(std::string& html, const Comparison& comparison) {
  const std::vector<const Result*> leaders = leaders_of(comparison);
  const bool is_alone = leaders.size() == 1;
  html += "<dl class=\"headline\">\n";
  const bool is_difference =
      comparison.by == FigureKind::kEnergy && comparison.results.front().criterion == "difference";
  const std::string what = is_difference ? "energy difference" : "error";
  append_figure(html, " class=\"first\"",
                "Smallest " + what + (is_alone ? "" : ": the results do not say which one's"),
                quoted(list_of(leaders, "or").c_str()));
  const Result& least = comparison.results.front();
  const Result& largest = comparison.results.back();
  append_figure(
      html, "",
      (is_alone ? "Its " : "Least ") + what + " found" + words_of_range(comparison, least),
      figure_with_uncertainty(comparison, least));
  append_figure(html, "", "Largest " + what + " found" + words_of_range(comparison, largest),
                figure_with_uncertainty(comparison, largest));
  html += "</dl>\n";
}

void append_conditions(std::string& html, const Comparison& comparison) {
  html += "<table class=\"rows\">\n";
  for (const Fact& condition : conditions_of(comparison)) {
    html += "<tr><th scope=\"row\">" + html_of(condition.name) + "</th><td>" +
            html_of(condition.words) + "</td></tr>\n";
  }
  html += "</table>\n";
}

// Sections

void append_cell(std::string& html, const std::string& text, bool is_name) {
  html += is_name ? "<th scope=\"row\" class=\"name\">" + quoted(text.c_str()) + "</th>"
                  : "<td>" + html_of_numbers(text) + "</td>";
}

void append_table(std::string& html, const Comparison& comparison) {
  const ComparisonTable table = table_of(comparison);
  html += "<div class=\"wide\" tabindex=\"0\"><table class=\"numbers\">\n<thead>\n<tr>";
  for (std::size_t column = 0; column < table.headings.size(); ++column) {
    html += column == table.names ? "<th scope=\"col\" class=\"name\">" : "<th scope=\"col\">";
    html += html_of(table.headings[column]) + "</th>";
  }
  html += "</tr>\n</thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    std::vector<std::string> row = table.rows[i];
    row[table.names] = short_name_of(comparison.results[i]);
    html += "<tr>";
    for (std::size_t column = 0; column < row.size(); ++column) {
      append_cell(html, row[column], column == table.names);
    }
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n";
}

void append_ranking(std::string& html, const Comparison& comparison, const std::string& svg) {
  begin_section(html, "ranking", "Ranking");
  append_table(html, comparison);
  if (svg.empty()) {
    append_paragraph(html, "note",
                     std::string("No picture: gnuplot was missing when this page was made, or has "
                                 "failed. Running gnuplot ") +
                         kComparisonScript + " beside this page draws it.");
  } else {
    append_picture(html, svg,
                   {"Devices by rank with their errors",
                    "Each device's largest error with its expanded uncertainty, or its interval "
                    "where U says too little; a bar that ends at the left edge goes on to "
                    "0. Bars that overlap much belong to devices that share their ranks, and so do "
                    "devices with a mark, whatever their bars; at the estimates the triangle is "
                    "above every signal of any shape."},
                   1);
  }
  html += "</section>\n";
}

void append_neighbours(std::string& html, const Comparison& comparison) {
  begin_section(html, "neighbours", "Neighbours");
  html += "<table class=\"rows pairs\">\n";
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const Fact verdict = verdict_of(comparison, i);
    const Pair& pair = comparison.pairs[i];
    const std::string names =
        short_name_of(comparison.results[i]) + " and " + short_name_of(comparison.results[i + 1]);
    html += "<tr><th scope=\"row\">" + quoted(names.c_str()) + "</th><td>";
    html += pair.told_apart ? verdict.name : "<strong>" + verdict.name + "</strong>";
    html += ": " +
            (pair.is_compared ? html_of_numbers(verdict.words) : quoted(verdict.words.c_str())) +
            ".</td></tr>\n";
  }
  html += "</table>\n</section>\n";
}

void append_legend(std::string& html, const Comparison& comparison) {
  begin_section(html, "meaning", "What the figures mean");
  html += "<table class=\"rows\">\n";
  for (const Fact& fact : legend_of(comparison)) {
    html += "<tr><th scope=\"row\">" + html_of(fact.name) + "</th><td>" + html_of(fact.words) +
            "</td></tr>\n";
  }
  html += "</table>\n</section>\n";
}

}  // namespace

void write_comparison_page(const Comparison& comparison, const std::string& svg,
                           app::TextWriter& out) {
  const std::string banner = banner_of(comparison);
  const std::string title =
      "Comparison of " + std::to_string(comparison.results.size()) + " accelerometers";
  std::string html =
      page_opening(title, std::string(banner.empty() ? "" : " (simulation)") + " - emax",
                   "The largest errors that they can make, side by side",
                   banner.empty() ? "" : html_of(banner) + ".");
  append_headline(html, comparison);
  append_conditions(html, comparison);
  for (const Note& note : notes_of(comparison)) {
    append_paragraph(html, note.is_warning ? "warning" : "note", note.words);
  }
  append_ranking(html, comparison, svg);
  append_neighbours(html, comparison);
  append_legend(html, comparison);
  write_html(out, html + page_closing("The same as text is in comparison.txt, the numbers for "
                                      "programs are in comparison.csv and comparison.json."));
}

}  // namespace emax::desk
