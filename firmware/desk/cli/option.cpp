// One option of a command: how it is found, and how the help shows it.
#include "desk/cli/option.hpp"

#include <algorithm>
#include <cstddef>

namespace emax::desk {

namespace {

// Where descriptions start, and where lines end.
constexpr std::size_t kColumn = 25;
constexpr std::size_t kWidth = 80;

void add_lines(std::string& text, const std::string& lines) {
  for (const char c : lines) {
    if (text.back() == '\n') {
      text.append(kColumn, ' ');
    }
    text.push_back(c);
  }
}

void add_help(std::string& text, const Option& option) {
  std::string left = "  --" + option.name;
  if (!option.value.empty()) {
    left += " " + option.value;
  }
  text += left;
  text += left.size() + 2 <= kColumn ? std::string(kColumn - left.size(), ' ') : "\n";
  add_lines(text, option.help);
  if (!option.by_default.empty()) {
    const std::string by_default = "(default " + option.by_default + ")";
    const std::size_t used = text.size() - text.rfind('\n') - 1;
    add_lines(text, used + 1 + by_default.size() <= kWidth ? " " : "\n");
    add_lines(text, by_default);
  }
  text += "\n";
}

}  // namespace

const Option* find_option(const std::vector<Option>& options, std::string_view name) noexcept {
  const auto found = std::find_if(options.begin(), options.end(),
                                  [name](const Option& option) { return option.name == name; });
  return found == options.end() ? nullptr : &*found;
}

bool is_given(const std::vector<Given>& all, std::string_view name) noexcept {
  return std::any_of(all.begin(), all.end(),
                     [name](const Given& given) { return given.option->name == name; });
}

std::string help_on(const std::vector<Option>& options) {
  std::string text;
  std::string heading;
  for (const Option& option : options) {
    if (option.heading != heading) {
      heading = option.heading;
      text += "\n" + heading + "\n";
    }
    add_help(text, option);
  }
  return text;
}

}  // namespace emax::desk
