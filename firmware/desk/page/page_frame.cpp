// The frame of every page of the program.
#include "desk/page/page_frame.hpp"

#include "emax/app/base/version.hpp"

namespace emax::desk {

namespace {

// Nothing may be loaded, neither from outside nor by what a label might say.
constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
)";

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light dark; --text: #1a1a1a; --soft: #595959; --line: #c4c4c4; --paper: #ffffff;
  --warn: #8a2b00; --warn-paper: #fff1e6; --note-paper: #f1f4f8; }
@media (prefers-color-scheme: dark) {
  :root { --text: #ececec; --soft: #b4b4b4; --line: #5a5a5a; --paper: #161616; --warn: #ffb080;
    --warn-paper: #3a2413; --note-paper: #242a31; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem; max-width: 62rem; background: var(--paper); color: var(--text);
  font: 1rem/1.45 sans-serif; overflow-wrap: anywhere; }
h1 { margin: 0 0 .2rem; font-size: 1.7rem; line-height: 1.2; }
h2 { margin: 2.2rem 0 .5rem; padding-top: .6rem; border-top: 1px solid var(--line); font-size: 1.25rem; }
p { margin: .6rem 0; }
sup { line-height: 0; }
.about { color: var(--soft); }
#title .about { white-space: pre-line; }
.headline { display: grid; grid-template-columns: repeat(auto-fit, minmax(12rem, 1fr)); gap: .8rem 1.5rem;
  margin: 1rem 0; padding: 1rem; border: 2px solid var(--text); }
.headline div { min-width: 0; }
.headline dt { color: var(--soft); font-size: .9rem; }
.headline dd { margin: 0; font-size: 1.1rem; }
.headline .first { grid-column: 1 / -1; }
.headline .first dd { font-size: 2rem; font-weight: bold; line-height: 1.2; }
.headline .more dd { font-size: 1rem; }
details { margin: .8rem 0; }
summary { cursor: pointer; font-weight: bold; }
.certificate p { max-width: 46rem; }
#in-band .text:has(+ .rows) { font-weight: bold; }
.signature { margin: 3rem 0 0; padding-top: .3rem; border-top: 1px solid var(--text); max-width: 30rem; }
.end { margin: 1.5rem 0; text-align: center; color: var(--soft); }
.watermark { display: none; }
.warning, .note { padding: .6rem .8rem; border-left: .4rem solid var(--line); background: var(--note-paper); }
.warning { border-color: var(--warn); background: var(--warn-paper); color: var(--warn); font-weight: bold; }
/* A number that a warning is about must not look like one to rely on. */
.doubtful { border-color: var(--warn); border-style: dashed; }
.doubtful .first dd { color: var(--warn); font-weight: normal; }
.headline .notes { grid-column: 1 / -1; }
.headline .notes dd { font-size: 1rem; }
.headline .warns { grid-column: 1 / -1; color: var(--warn); }
.headline .warns dt { color: var(--warn); font-weight: bold; }
.headline .warns dd { font-size: 1rem; }
.headline .warns ul { margin: 0; padding-left: 1.2rem; }
.banner { position: sticky; top: 0; z-index: 1; margin: 0 0 1rem; padding: .5rem .8rem; background: var(--warn);
  color: var(--paper); font-weight: bold; text-align: center; }
table { border-collapse: collapse; }
.rows { width: 100%; }
.rows th { width: 14rem; padding: .15rem 1rem .15rem 0; font-weight: normal; color: var(--soft); }
.rows th, .rows td { text-align: left; vertical-align: top; }
.wide { overflow-x: auto; margin: .8rem 0; }
.numbers { font-variant-numeric: tabular-nums; font-size: .88rem; overflow-wrap: normal; }
.numbers th, .numbers td { padding: .12rem .7rem; text-align: right; white-space: nowrap; }
.numbers .name { min-width: 8.5rem; text-align: left; white-space: normal; overflow-wrap: anywhere; }
.numbers tbody th { font-weight: normal; }
.numbers tbody th, .numbers tbody td { vertical-align: top; }
#figures .numbers :is(th, td):first-child, #fit .numbers :is(th, td):first-child { text-align: left; }
.numbers thead tr:last-child th { border-bottom: 1px solid var(--text); }
figure { margin: 1.2rem 0; }
figure svg { display: block; width: 100%; height: auto; background: #ffffff; color: #000000; }
@media screen and (prefers-color-scheme: dark) {
  /* White paper becomes dark, and hues stay what they are. */
  figure svg { filter: invert(.914) hue-rotate(180deg); }
}
figcaption { margin-top: .4rem; color: var(--soft); font-size: .92rem; }
a { color: inherit; }
footer { margin-top: 2.5rem; padding-top: .6rem; border-top: 1px solid var(--line); color: var(--soft);
  font-size: .9rem; }
@media screen and (max-width: 36rem) {
  .rows th, .rows td { display: block; width: auto; }
  .rows td { padding-bottom: .5rem; }
  figure { overflow-x: auto; }
  figure svg { min-width: 36rem; }
  .numbers { font-size: .8rem; }
  .numbers th, .numbers td { padding: .12rem .3rem; }
  #figures .numbers :is(thead th, :is(th, td):first-child) { white-space: normal; }
}
@page { size: A4; margin: 13mm 15mm 16mm; }
@media print {
  :root { --text: #000000; --soft: #404040; --line: #a0a0a0; --paper: #ffffff; --warn: #000000;
    --warn-paper: #ffffff; --note-paper: #ffffff; color-scheme: light; }
  html { font-size: 9.5pt; }
  body { max-width: none; padding: 0; line-height: 1.35; }
  h2 { margin-top: .7rem; padding-top: .3rem; }
  figcaption { margin-top: .1rem; }
  .headline { margin: .6rem 0; padding: .7rem; }
  .headline dd { font-size: .95rem; }
  .rows th, .rows td { padding-top: .08rem; padding-bottom: .08rem; }
  footer { margin-top: .5rem; padding-top: .3rem; }
  /* The header of a table stands on every page. */
  .marked { display: table; width: 100%; }
  .marked .banner { display: table-header-group; break-inside: avoid; position: static; color: #000000; background: none; line-height: 2; }
  .marked main, .marked footer { display: table-row-group; }
  p { margin: .3rem 0; }
  figure { margin: .4rem 0; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  figure svg { max-height: 80mm; }
  #error-system svg { max-height: 71mm; }
  #fit svg { max-height: 105mm; }
  #ranking svg { max-height: 230mm; max-width: 130mm; }
  h1, h2, h2 + p, thead { break-after: avoid; }
  figure, tr, li, .headline, .warning, .note, .sign { break-inside: avoid; }
  summary { break-after: avoid; }
  #in-band .text:has(+ .rows) { break-after: avoid; }
  /* No first or last row alone on a page. */
  .rows tr:first-child { break-after: avoid; }
  .rows tr:last-child { break-before: avoid; }
  /* What is said of a picture stays with it. */
  #error-system, #energy, #trend { break-inside: avoid; }
  /* Nor is a figure parted from its U, or the signature from what is signed. */
  #in-band .rows, #certificate, #budget, #points { break-inside: avoid; }
  /* What is folded on a screen is printed all the same. */
  details::details-content { content-visibility: visible; block-size: auto; }
  summary { list-style: none; }
  .watermark { display: block; position: fixed; top: 42%; left: 0; right: 0; text-align: center; font-size: 64pt; white-space: nowrap;
    font-weight: bold; transform: rotate(-35deg); color: #000000; opacity: .1; }
  .warning { border: 1.5pt solid #000000; }
  .wide { overflow: visible; }
  .numbers { font-size: 8pt; }
  .numbers th, .numbers td { padding: .05rem .35rem; }
  .numbers tbody tr:first-child > * { padding-top: .3rem; }
  .numbers thead tr:last-child th { padding-bottom: .15rem; }
  .numbers .name { min-width: 0; }
}
</style>
</head>
)";

// A string of CSS, in which no character has a meaning; what no line can hold is a blank.
std::string css_string(const std::string& text) {
  constexpr unsigned kFirstPlain = 0x20;
  constexpr unsigned kLastPlain = 0x7F;
  std::string css = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == ' ' || code > kLastPlain;
    if (code < kFirstPlain || code == kLastPlain) {
      css += ' ';
    } else if (is_letter) {
      css += c;
    } else {
      constexpr const char* kDigits = "0123456789abcdef";
      css += {'\\', kDigits[code >> 4U], kDigits[code & 0xFU], ' '};
    }
  }
  return css + "\"";
}

// What Chromium, Firefox and others print in the margin.
std::string margins_of(const std::string& running) {
  constexpr const char* kFont = "font: 8pt sans-serif; color: #404040;";
  return std::string("<style>@page { @bottom-left { content: ") + css_string(running) + "; " +
         kFont + " } @bottom-right { content: \"page \" counter(page) \" of \" counter(pages); " +
         kFont + " } }</style>\n";
}

}  // namespace

std::string page_opening(const std::string& title, const std::string& kind,
                         const std::string& about, const std::string& banner,
                         const std::string& running) {
  const std::string mark =
      banner.empty()
          ? "<body>\n"
          : "<body class=\"marked\">\n<div class=\"banner\" role=\"note\">" + banner +
                "</div>\n<div class=\"watermark\" aria-hidden=\"true\">SIMULATION</div>\n";
  return std::string(kHead) + "<title>" + title + kind + "</title>\n" + margins_of(running) +
         kStyle + mark + "<main>\n<header>\n<h1>" + title + "</h1>\n<p class=\"about\">" + about +
         "</p>\n</header>\n";
}

std::string page_closing(const std::string& files) {
  return std::string("</main>\n<footer>Made by emax ") + app::kVersion + ". " + files +
         "</footer>\n</body>\n</html>\n";
}

void append_figure(std::string& html, const char* kind, const std::string& name,
                   const std::string& value) {
  html += std::string("<div") + kind + "><dt>" + name + "</dt><dd>" + value + "</dd></div>\n";
}

void write_html(app::TextWriter& out, const std::string& html) {
  out.text(Span<const char>(html.data(), html.size()));
}

}  // namespace emax::desk
