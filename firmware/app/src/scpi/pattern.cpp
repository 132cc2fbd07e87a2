// Headers against patterns, node by node.
#include "emax/app/scpi/pattern.hpp"

#include "characters.hpp"

namespace emax::app::scpi {
namespace {

/// Cuts the text up to the next colon off the header.
Span<const char> take_mnemonic(Span<const char>& header) noexcept {
  std::size_t length = 0;
  while (length < header.size() && header[length] != ':') {
    ++length;
  }
  const Span<const char> mnemonic = header.first(length);
  header = header.from(length < header.size() ? length + 1 : length);
  return mnemonic;
}

bool is_same(const char* pattern, const PatternNode& node, const char* other,
             const PatternNode& other_node) noexcept {
  if (node.length != other_node.length) {
    return false;
  }
  for (std::size_t i = 0; i < node.length; ++i) {
    if (pattern[node.begin + i] != other[other_node.begin + i]) {
      return false;
    }
  }
  return true;
}

// Without a number, 1 is meant (SCPI-99, volume 1, 6.2.5.2), so a 1 says the same everywhere, but
// in common commands.
HeaderMatch match_mnemonic(const char* pattern, const PatternNode& node,
                           Span<const char> mnemonic) noexcept {
  const char* name = pattern + node.begin;
  if (matches_word(name, node.length, mnemonic)) {
    return HeaderMatch::kYes;
  }
  std::size_t length = mnemonic.size();
  while (length > 0 && is_digit(mnemonic[length - 1])) {
    --length;
  }
  if (length == mnemonic.size() || name[0] == '*' ||
      !matches_word(name, node.length, mnemonic.first(length))) {
    return HeaderMatch::kNo;
  }
  const bool is_one = mnemonic.size() - length == 1 && mnemonic[length] == '1';
  return is_one ? HeaderMatch::kYes : HeaderMatch::kSuffixOutOfRange;
}

}  // namespace

HeaderMatchResult match_header(const char* pattern, Span<const char> header, const char* from_path,
                               std::uint16_t path_nodes) noexcept {
  HeaderMatchResult result;
  PatternNode node;
  PatternNode path_node;
  for (std::uint16_t i = 0; i < path_nodes; ++i) {
    node = next_node(pattern, node.next);
    path_node = next_node(from_path, path_node.next);
    if (!is_same(pattern, node, from_path, path_node)) {
      return {};
    }
  }
  std::uint16_t nodes = path_nodes;
  HeaderMatch match = HeaderMatch::kYes;
  while (!header.empty()) {
    const Span<const char> mnemonic = take_mnemonic(header);
    HeaderMatch node_match = HeaderMatch::kNo;
    for (;;) {
      node = next_node(pattern, node.next);
      if (node.length == 0) {
        return {};
      }
      node_match = match_mnemonic(pattern, node, mnemonic);
      if (node_match != HeaderMatch::kNo) {
        break;
      }
      if (!node.is_optional) {
        return {};
      }
      ++nodes;
    }
    match = node_match == HeaderMatch::kYes ? match : node_match;
    result.nodes = nodes;
    ++nodes;
  }
  for (node = next_node(pattern, node.next); node.length > 0;
       node = next_node(pattern, node.next)) {
    if (!node.is_optional) {
      return {};
    }
  }
  result.match = match;
  return result;
}

}  // namespace emax::app::scpi
