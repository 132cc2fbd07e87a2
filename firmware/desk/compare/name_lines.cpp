// Names of devices in lines of a limited width.
#include "desk/compare/name_lines.hpp"

#include <algorithm>
#include <cstdint>

#include "emax/app/base/utf8.hpp"

#include "desk/cli/console.hpp"

namespace emax::desk {

namespace {

constexpr const char* kDots = "...";
constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);

// Of letters of a sans-serif typeface, roughly, and on the safe side.
double width_of(std::uint32_t code, Typeface typeface) noexcept {
  constexpr std::uint32_t kFirstWide = 0x1100;  // From here on scripts of square characters.
  if (typeface == Typeface::kMonospaced) {
    return 1.0;
  }
  if (code >= kFirstWide) {
    return 2.0;
  }
  const bool is_broad = code > 0x7F || (code >= 'A' && code <= 'Z') || code == 'm' || code == 'w' ||
                        code == '@' || code == '%';
  return is_broad ? 1.5 : 1.0;
}

// How many bytes of `text` from `at` on fit into a line; at least one character.
std::size_t bytes_that_fit(const std::string& text, std::size_t at, double width,
                           Typeface typeface) {
  double used = 0.0;
  std::size_t end = at;
  while (end < text.size()) {
    const app::Character next = app::first_character(&text[end]);
    used += width_of(next.code, typeface);
    if (used > width && end > at) {
      break;
    }
    end += std::max<std::size_t>(next.length, 1);
  }
  return end - at;
}

// The same, to the last blank if the text goes on and the blank leaves no line nearly empty.
std::size_t bytes_of_line(const std::string& text, std::size_t at, double width,
                          Typeface typeface) {
  const std::size_t count = bytes_that_fit(text, at, width, typeface);
  if (at + count == text.size() || text[at + count] == ' ') {
    return count;
  }
  const std::size_t blank = text.rfind(' ', at + count);
  return blank != std::string::npos && blank > at + count / 3 ? blank - at : count;
}

std::string cut(const std::string& text, double width, Typeface typeface) {
  if (width_of(text, typeface) <= width) {
    return text;
  }
  return text.substr(0, bytes_that_fit(text, 0, width - 3.0, typeface)) + kDots;
}

// What tells a device from those of its name, and is not cut off: its number or its file.
std::string last_of(const Result& result) {
  return result.has_namesake ? "(" + result.file + ")" : printable(result.serial);
}

}  // namespace

std::string name_of(const Result& result) {
  const std::string device = printable(result.device);
  const std::string name = result.serial.empty() ? device : device + " " + printable(result.serial);
  return result.has_namesake ? name + " (" + result.file + ")" : name;
}

double width_of(const std::string& text, Typeface typeface) {
  double width = 0.0;
  for (std::size_t at = 0; at < text.size();) {
    const app::Character next = app::first_character(&text[at]);
    width += width_of(next.code, typeface);
    at += std::max<std::size_t>(next.length, 1);
  }
  return width;
}

std::vector<std::string> wrapped(const std::string& text, double width, std::size_t most,
                                 Typeface typeface) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size() || lines.empty();) {
    if (lines.size() + 1 == most) {
      lines.push_back(cut(text.substr(at), width, typeface));
      return lines;
    }
    const std::size_t count = bytes_of_line(text, at, width, typeface);
    lines.push_back(text.substr(at, count));
    at += count;
    at = std::min(text.find_first_not_of(' ', at), text.size());
  }
  return lines;
}

std::vector<std::string> name_lines(const Result& result, double width, std::size_t most,
                                    Typeface typeface) {
  const std::string last = last_of(result);
  const std::vector<std::string> whole = wrapped(name_of(result), width, kNoLimit, typeface);
  if (whole.size() <= most || last.empty() || most < 2) {
    return wrapped(name_of(result), width, most, typeface);
  }
  std::vector<std::string> lines = wrapped(printable(result.device), width, most - 1, typeface);
  lines.push_back(cut(last, width, typeface));
  return lines;
}

std::string short_name_of(const Result& result, std::size_t most) {
  const std::string name = name_of(result);
  const std::string last = last_of(result);
  if (characters_in(name) <= most || last.empty()) {
    return cut(name, static_cast<double>(most), Typeface::kMonospaced);
  }
  const std::size_t half = most / 2;
  const std::string serial = cut(last, static_cast<double>(half), Typeface::kMonospaced);
  const std::size_t rest = most - characters_in(serial) - 1;
  return cut(printable(result.device), static_cast<double>(rest), Typeface::kMonospaced) + " " +
         serial;
}

std::string list_of(const std::vector<const Result*>& results, const char* last) {
  constexpr std::size_t kMostNamed = 5;
  const std::size_t count = results.size();
  // One more name is as short as "and 1 other".
  const std::size_t named = count <= kMostNamed + 1 ? count : kMostNamed;
  std::string text;
  for (std::size_t i = 0; i < named; ++i) {
    text += i == 0 ? "" : i + 1 == count ? " " + std::string(last) + " " : ", ";
    text += short_name_of(*results[i]);
  }
  return named == count ? text
                        : text + " " + last + " " + std::to_string(count - named) + " others";
}

}  // namespace emax::desk
