// The parts of a report as sections, rows and tables of HTML.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/base/span.hpp"

namespace emax::desk {

/// Adds text of others to HTML: markup is escaped, what is not printable replaced, line feeds kept.
void append_quoted(std::string& html, const char* text);

/// @returns The same as HTML of its own.
std::string quoted(const char* text);

/// Adds words of ours: "m/s^2" with a raised 2, "+-" as one sign, 5.1e-03 as 5.1 × 10 with a raised
/// exponent.
void append_words(std::string& html, std::string_view words);

/// The words and numbers of a report, between the marks that `HtmlMarkup` sets.
class HtmlWords final : public app::TextSink {
 public:
  explicit HtmlWords(std::string& html) noexcept : html_(html) {}
  void write(Span<const char> text) noexcept override {
    append_words(html_, std::string_view(text.data(), text.size()));
  }

 private:
  std::string& html_;
};

/// @returns As HTML what `write` writes with a TextWriter.
template <typename Write>
std::string words_of(const Write& write) {
  std::string html;
  HtmlWords sink(html);
  app::TextWriter out(sink);
  write(out);
  return html;
}

/// @returns The title of a section as a link to it.
std::string link_to(app::ReportSection section);

/// What comes at the end of each section: its pictures.
class SectionEnd {
 public:
  SectionEnd(const SectionEnd&) = delete;
  SectionEnd& operator=(const SectionEnd&) = delete;
  virtual void add_to(std::string& html, app::ReportSection section) = 0;

 protected:
  SectionEnd() = default;
  ~SectionEnd() = default;
};

class HtmlMarkup final : public app::ReportMarkup {
 public:
  HtmlMarkup(std::string& html, SectionEnd& section_end) noexcept
      : html_(html), section_end_(section_end) {}

  void begin(app::ReportSection section, const char* heading) noexcept override;
  void begin(app::ReportPart part, const char* name) noexcept override;
  void quote(const char* text) noexcept override { append_quoted(html_, text); }

  /// Ends the last section.
  void finish();

  /// @returns The budget of a measurement, which is long and stands at the end of a page; empty if
  /// there is none.
  const std::string& budget() const noexcept { return budget_; }

 private:
  // What is open: nothing, a table of rows, a paragraph, a table of lines.
  enum class Block { kNone, kRows, kParagraph, kHead, kBody };

  void end_block();
  void begin_row(const char* name);
  void begin_paragraph(const char* kind);
  void begin_line(bool is_head);
  void move_budget();

  std::string& html_;
  SectionEnd& section_end_;
  app::ReportSection section_ = app::ReportSection::kTitle;
  Block block_ = Block::kNone;
  bool has_cell_ = false;
  bool has_section_ = false;
  std::string budget_;
  bool is_budget_ = false;        // The table that is open.
  std::size_t paragraph_at_ = 0;  // Where the last paragraph begins.
};

}  // namespace emax::desk
