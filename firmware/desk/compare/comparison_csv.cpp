// A comparison as CSV.
#include "desk/compare/comparison_csv.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "emax/app/base/utf8.hpp"

#include "desk/compare/comparison_words.hpp"
#include "desk/compare/figure_text.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

constexpr const char* kUnknownCharacter = "\xEF\xBF\xBD";  // U+FFFD.

// U+200B has no width, U+3000 is as wide as an ideogram.
bool is_blank(std::uint32_t code) noexcept {
  return code == ' ' || code == 0xA0 || (code >= 0x2000 && code <= 0x200B) || code == 0x202F ||
         code == 0x205F || code == 0x3000 || code == 0xFEFF;
}

// Spreadsheets take a field that begins with one of these for a formula and run it, behind blanks
// too; those of full width are the same to some.
bool begins_formula(const std::string& field) noexcept {
  constexpr std::uint32_t kFullWidth = 0xFEE0;
  for (std::size_t at = 0; at < field.size();) {
    const app::Character next = app::first_character(&field[at]);
    if (!is_blank(next.code)) {
      const std::uint32_t sign = next.code > kFullWidth ? next.code - kFullWidth : next.code;
      return sign == '=' || sign == '+' || sign == '-' || sign == '@';
    }
    at += next.length;
  }
  return false;
}

// An apostrophe before a formula makes it text. Control characters become blanks.
std::string harmless(const std::string& text) {
  std::string field;
  for (std::size_t at = 0; at < text.size();) {
    const app::Character next = app::first_character(&text[at]);
    const std::size_t length = std::max<std::size_t>(next.length, 1);
    if (next.code == app::kReplacement) {
      field += kUnknownCharacter;
    } else {
      field += app::is_printable(next.code) ? text.substr(at, length) : " ";
    }
    at += length;
  }
  return begins_formula(field) ? "'" + field : field;
}

// RFC 4180: quotes around all that might be more than a word.
void write_field(const std::string& words, TextWriter& out) {
  const std::string text = harmless(words);
  if (text.find_first_of("\",\r\n") == std::string::npos) {
    out.text(text.c_str());
    return;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  out.text((quoted + "\"").c_str());
}

void write_number(bool exists, double value, TextWriter& out) {
  out.text(",");
  if (exists) {
    out.exact(value);
  }
}

void write_ranked(const Figure& figure, TextWriter& out) {
  write_number(true, figure.value, out);
  write_number(figure.has_uncertainty, figure.u, out);
  write_number(figure.has_uncertainty, figure.expanded, out);
  const bool has_ends = figure.has_interval || figure.has_range;
  write_number(has_ends, figure.low, out);
  write_number(has_ends, figure.high, out);
  write_number(figure.has_bound, figure.bound, out);
}

void write_device(const Comparison& comparison, std::size_t index, TextWriter& out) {
  const Result& result = comparison.results[index];
  const Rank& rank = comparison.ranks[index];
  out.integer(rank.best).text(",").integer(rank.worst).text(",");
  write_field(result.device, out);
  out.text(",");
  write_field(result.serial, out);
  out.text(",").text(figure_words(comparison.by).option);
  write_ranked(comparison.figure(result), out);
  const Figure& matched = result.figure(FigureKind::kMatched);
  const Figure& band = result.figure(FigureKind::kBand);
  const double energy_v2s = result.figure(FigureKind::kEnergy).value;
  write_number(matched.exists, matched.value, out);
  write_number(band.exists, band.value, out);
  write_number(energy_v2s >= 0.0, result.rms_percent(), out);
  write_number(true, energy_v2s, out);
  write_number(energy_v2s >= 0.0, result.rms_v(), out);
  out.text(",");
  write_field(matched.exists ? result.delay.mode : "", out);
  write_number(matched.exists, result.delay.time_s, out);
  write_number(true, result.sensitivity, out);
  write_number(true, result.limit_mps2, out);
  out.text(",").text(mark_of(result).c_str()).text(",");
  write_field(result.path, out);
  out.line();
}

}  // namespace

void write_comparison_csv(const Comparison& comparison, TextWriter& out) {
  out.text("rank_best,rank_worst,device,serial,ranked_by,value,u,U,low,high,bound,");
  out.text("matched_percent,band_percent,rms_percent,E,rms,delay_mode,delay_s,S,a,mark,file\n");
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    write_device(comparison, i, out);
  }
}

}  // namespace emax::desk
