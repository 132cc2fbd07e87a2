// A picture inside a page.
#include "desk/page/page_picture.hpp"

#include <algorithm>

#include "desk/page/html_markup.hpp"

namespace emax::desk {

namespace {

// gnuplot gives the same names to parts of every picture; in one page each needs its own.
std::string with_own_names(const std::string& tag, const std::string& prefix) {
  std::string result = tag;
  for (const std::string start : {"id='", "id=\"", "href='#", "href=\"#", "url(#"}) {
    for (std::size_t at = result.find(start); at != std::string::npos;
         at = result.find(start, at + start.size())) {
      result.insert(at + start.size(), prefix);
    }
  }
  return result;
}

// What is from `start` to `end` is left out, wherever it is.
void remove_parts(std::string& text, const std::string& start, const std::string& end) {
  for (std::size_t first = text.find(start); first != std::string::npos;
       first = text.find(start, first)) {
    const std::size_t last = text.find(end, first);
    if (last == std::string::npos) {
      return;
    }
    text.erase(first, last + end.size() - first);
  }
}

void append_svg(std::string& html, const std::string& picture, const std::string& title,
                std::size_t number) {
  std::string svg = picture.substr(std::min(picture.find("<svg"), picture.size()));
  // A browser would show the titles, which are words of gnuplot's, wherever the mouse is.
  remove_parts(svg, "<title>", "</title>");
  remove_parts(svg, "<desc>", "</desc>");
  const std::string prefix = "p" + std::to_string(number) + "-";
  bool is_first = true;
  for (std::size_t at = 0; at < svg.size();) {
    const std::size_t open = std::min(svg.find('<', at), svg.size());
    const std::size_t close = std::min(svg.find('>', open), svg.size() - 1);
    html.append(svg, at, open - at);
    std::string tag = with_own_names(svg.substr(open, close + 1 - open), prefix);
    if (is_first) {
      tag.insert(4, " role=\"img\" aria-label=\"" + quoted(title.c_str()) + "\"");
      is_first = false;
    }
    html += tag;
    at = close + 1;
  }
}

}  // namespace

void append_picture(std::string& html, const std::string& svg, const PictureWords& words,
                    std::size_t number) {
  html += "<figure>\n";
  append_svg(html, svg, words.title, number);
  html += "<figcaption>" + quoted(words.caption.c_str()) + "</figcaption>\n</figure>\n";
}

}  // namespace emax::desk
