// Parts of a report as HTML.
#include "desk/page/html_markup.hpp"

#include <algorithm>

#include "emax/app/base/utf8.hpp"

namespace emax::desk {

namespace {

using app::ReportPart;
using app::ReportSection;

struct SectionName {
  ReportSection section;
  const char* id;
  const char* title;
};

constexpr SectionName kSections[] = {
    {ReportSection::kTitle, "title", ""},
    {ReportSection::kLabels, "labels", "Item and laboratory"},
    {ReportSection::kFigures, "figures", "The figures"},
    {ReportSection::kInput, "input", "What was put in"},
    {ReportSection::kFault, "fault", "Fault"},
    {ReportSection::kMeasurement, "measurement", "Measurement"},
    {ReportSection::kFit, "fit", "Fit"},
    {ReportSection::kErrorSystem, "error-system", "Error system"},
    {ReportSection::kEnergy, "energy", "Maximum energy"},
    {ReportSection::kInBand, "in-band", "In-band error"},
    {ReportSection::kUncertainty, "uncertainty", "Uncertainty of E"},
    {ReportSection::kMonteCarlo, "monte-carlo", "Monte Carlo"},
    {ReportSection::kTrend, "trend", "Trend"},
};

const SectionName& name_of(ReportSection section) noexcept {
  for (const SectionName& name : kSections) {
    if (name.section == section) {
      return name;
    }
  }
  return kSections[0];
}

void append_escaped(std::string& html, char c) {
  switch (c) {
    case '&':
      html += "&amp;";
      break;
    case '<':
      html += "&lt;";
      break;
    case '>':
      html += "&gt;";
      break;
    case '"':
      html += "&quot;";
      break;
    default:
      html += c;
  }
}

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

// Of the "e-03" behind a number's digits; 0 if there is none.
std::size_t length_of_power(std::string_view words) noexcept {
  constexpr std::size_t kSign = 2;
  if (words.size() <= kSign || words[0] != 'e' || (words[1] != '-' && words[1] != '+')) {
    return 0;
  }
  std::size_t end = kSign;
  while (end < words.size() && is_digit(words[end])) {
    ++end;
  }
  return end > kSign ? end : 0;
}

constexpr const char* kUnknownCharacter = "\xEF\xBF\xBD";  // U+FFFD.

}  // namespace

void append_quoted(std::string& html, const char* text) {
  while (*text != '\0') {
    const app::Character next = app::first_character(text);
    if (next.code == '\n') {
      html += "<br>";
    } else if (next.code == '\t' || next.code == '\r') {
      html += ' ';
    } else if (next.code == app::kReplacement || !app::is_printable(next.code)) {
      html += kUnknownCharacter;
    } else if (next.length == 1) {
      append_escaped(html, *text);
    } else {
      html.append(text, next.length);
    }
    text += next.length;
  }
}

std::string quoted(const char* text) {
  std::string html;
  append_quoted(html, text);
  return html;
}

void append_words(std::string& html, std::string_view words) {
  char before = ' ';
  for (; !words.empty(); words.remove_prefix(1)) {
    const std::size_t power = is_digit(before) ? length_of_power(words) : 0;
    if (power > 0) {
      html += words[1] == '-' ? " × 10<sup>−" : " × 10<sup>";
      std::string_view digits = words.substr(2, power - 2);
      digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size() - 1));
      html.append(digits).append("</sup>");
      words.remove_prefix(power - 1);
      before = '0';
      continue;
    }
    before = words.front();
    const std::string_view two = words.substr(0, 2);
    if (two == "^2") {
      html += "²";
      words.remove_prefix(1);
    } else if (two == "+-") {
      html += "±";
      words.remove_prefix(1);
    } else {
      append_escaped(html, words.front());
    }
  }
}

std::string link_to(ReportSection section) {
  const SectionName& name = name_of(section);
  return "<a href=\"#" + std::string(name.id) + "\">" + name.title + "</a>";
}

void HtmlMarkup::begin(ReportSection section, const char* heading) noexcept {
  finish();
  section_ = section;
  has_section_ = true;
  const SectionName& name = name_of(section);
  html_ += "<section id=\"" + std::string(name.id) + "\">\n";
  if (heading == nullptr) {
    begin_paragraph("about");
    return;
  }
  html_ += "<h2>" + std::string(name.title) + "</h2>\n";
  // "FIT" is the title again; in brackets behind it is what the title stands for.
  const std::string_view words = heading;
  const std::size_t bracket = words.find('(');
  if (bracket != std::string_view::npos) {
    html_ += "<p class=\"about\">";
    append_words(html_, words.substr(bracket + 1, words.rfind(')') - bracket - 1));
    html_ += "</p>\n";
  }
}

void HtmlMarkup::begin(ReportPart part, const char* name) noexcept {
  switch (part) {
    case ReportPart::kRow:
      begin_row(name);
      break;
    case ReportPart::kMore:
      html_ += "<br>";
      break;
    case ReportPart::kText:
      begin_paragraph("text");
      break;
    case ReportPart::kNote:
      begin_paragraph("note");
      break;
    case ReportPart::kWarning:
      begin_paragraph("warning");
      break;
    case ReportPart::kTable:
      end_block();
      is_budget_ = section_ == ReportSection::kMeasurement;
      break;
    case ReportPart::kHead:
    case ReportPart::kLine:
      begin_line(part == ReportPart::kHead);
      break;
    case ReportPart::kCell:
      html_ += has_cell_ ? (block_ == Block::kHead ? "</th>" : "</td>") : "";
      html_ += block_ == Block::kHead ? "<th scope=\"col\">" : "<td>";
      has_cell_ = true;
      break;
  }
}

void HtmlMarkup::finish() {
  if (!has_section_) {
    return;
  }
  end_block();
  section_end_.add_to(html_, section_);
  html_ += "</section>\n";
  has_section_ = false;
}

void HtmlMarkup::end_block() {
  switch (block_) {
    case Block::kNone:
      break;
    case Block::kRows:
      html_ += "</td></tr>\n</table>\n";
      break;
    case Block::kParagraph:
      html_ += "</p>\n";
      break;
    case Block::kHead:
      html_ += "</th></tr>\n</thead></table></div>\n";
      break;
    case Block::kBody:
      html_ += "</td></tr>\n</tbody></table></div>\n";
      move_budget();
      break;
  }
  block_ = Block::kNone;
  has_cell_ = false;
}

void HtmlMarkup::move_budget() {
  if (!is_budget_) {
    return;
  }
  budget_ = html_.substr(paragraph_at_);
  html_.erase(paragraph_at_);
  html_ += "<p><a href=\"#budget\">Uncertainty budget of each point</a>, at the end.</p>\n";
  is_budget_ = false;
}

void HtmlMarkup::begin_row(const char* name) {
  if (block_ == Block::kRows) {
    html_ += "</td></tr>\n";
  } else {
    end_block();
    html_ += "<table class=\"rows\">\n";
    block_ = Block::kRows;
  }
  html_ += "<tr><th scope=\"row\">";
  append_words(html_, name);
  html_ += "</th><td>";
}

void HtmlMarkup::begin_paragraph(const char* kind) {
  end_block();
  paragraph_at_ = html_.size();
  html_ += "<p class=\"" + std::string(kind) + "\">";
  block_ = Block::kParagraph;
}

void HtmlMarkup::begin_line(bool is_head) {
  if (block_ == Block::kHead) {
    html_ += is_head ? "</th></tr>\n" : "</th></tr>\n</thead>\n<tbody>\n";
  } else if (block_ == Block::kBody) {
    html_ += "</td></tr>\n";
  } else {
    end_block();
    html_ += "<div class=\"wide\" tabindex=\"0\"><table class=\"numbers\">\n";
    html_ += is_head ? "<thead>\n" : "<tbody>\n";
  }
  html_ += "<tr>";
  block_ = is_head ? Block::kHead : Block::kBody;
  has_cell_ = false;
}

}  // namespace emax::desk
