// The name that somebody who mistyped it may have meant.
#include "desk/cli/nearest.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace emax::desk {

namespace {

// No name is nearly as long, and the work goes with the length.
constexpr std::size_t kMaxLength = 40;

// Levenshtein's distance; a name and its start are close to one another.
std::size_t distance(std::string_view text, std::string_view name) {
  const std::size_t common = std::min(text.size(), name.size());
  if (common > 0 && name.substr(0, common) == text.substr(0, common)) {
    return 1;
  }
  std::vector<std::size_t> row(name.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < name.size(); ++j) {
      const std::size_t replaced = diagonal + (text[i] == name[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string_view without_dashes(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of('-'), text.size()));
  return text;
}

}  // namespace

std::string_view nearest(std::string_view text, Span<const std::string_view> names) {
  text = without_dashes(text).substr(0, kMaxLength);
  // With more changes than half its characters nearly every text becomes some name.
  std::size_t least = std::max(text.size() / 2, std::size_t{1}) + 1;
  std::string_view best;
  for (const std::string_view name : names) {
    const std::size_t changes = distance(text, without_dashes(name));
    if (changes < least) {
      least = changes;
      best = name;
    }
  }
  return best;
}

}  // namespace emax::desk
