// Headers and words in the notation of the standard, "[SENSe:]SWEep:FREQuency", and their matching.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// The longest mnemonic of IEEE 488.2, 7.6.1.
inline constexpr std::size_t kMaxMnemonic = 12;

/// One mnemonic of a pattern.
struct PatternNode {
  std::size_t begin = 0;
  std::size_t length = 0;  ///< 0 past the last one.
  std::size_t next = 0;    ///< Where the next node is looked for.
  bool is_optional = false;
};

/// @param[in] pattern  Ends with a zero.
/// @param[in] position 0, or `next` of the node before.
constexpr PatternNode next_node(const char* pattern, std::size_t position) noexcept {
  PatternNode node;
  std::size_t i = position;
  for (; pattern[i] == ':' || pattern[i] == '[' || pattern[i] == ']'; ++i) {
    node.is_optional = pattern[i] == '[' || (node.is_optional && pattern[i] != ']');
  }
  node.begin = i;
  while (pattern[i] != '\0' && pattern[i] != ':' && pattern[i] != '[' && pattern[i] != ']') {
    ++i;
  }
  node.length = i - node.begin;
  if (pattern[i] == '[' && pattern[i + 1] == '1' && pattern[i + 2] == ']') {
    i += 3;
  }
  node.next = i;
  return node;
}

constexpr char upper(char character) noexcept {
  return character >= 'a' && character <= 'z' ? static_cast<char>(character - 'a' + 'A')
                                              : character;
}

/// @returns How much of the pattern's `length` characters is the short form: all before the first
/// small letter.
constexpr std::size_t short_form_length(const char* pattern, std::size_t length) noexcept {
  std::size_t short_length = 0;
  while (short_length < length && !(pattern[short_length] >= 'a' && pattern[short_length] <= 'z')) {
    ++short_length;
  }
  return short_length;
}

/// @returns True if the word is the short or the long form of `length` characters of the pattern,
/// in any case.
constexpr bool matches_word(const char* pattern, std::size_t length,
                            Span<const char> word) noexcept {
  if (word.size() != length && word.size() != short_form_length(pattern, length)) {
    return false;
  }
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (upper(word[i]) != upper(pattern[i])) {
      return false;
    }
  }
  return true;
}

/// How far the units of one message have gone down the tree: the first `nodes` nodes of a row.
struct HeaderPath {
  std::uint16_t row = 0;
  std::uint16_t nodes = 0;  ///< 0 at the root.
};

enum class HeaderMatch : std::uint8_t {
  kNo,
  kYes,
  kSuffixOutOfRange,  ///< All mnemonics are right, but a number after one of them is not.
};

struct HeaderMatchResult {
  HeaderMatch match = HeaderMatch::kNo;
  std::uint16_t nodes = 0;  ///< Nodes of the pattern before the last mnemonic that was given.
};

/// Compares a header, without leading colon and question mark, with a pattern.
///
/// @param[in] from_path    The pattern of the path's row; not looked at if path_nodes is 0.
/// @param[in] path_nodes   Nodes that the pattern must share with it; the header goes on after
///                         them.
HeaderMatchResult match_header(const char* pattern, Span<const char> header, const char* from_path,
                               std::uint16_t path_nodes) noexcept;

/// How many parameters a row takes.
struct Arity {
  std::uint16_t min = 0;
  std::uint16_t max = 0;
  bool is_well_formed = true;
};

inline constexpr std::uint16_t kAnyCount = 0xFFFF;

/// Counts the parameters in their documentation: "<f>" is one, "<S>,<f0>[,<u>]" two or three,
/// "<f1>,<f2>,..." one or more (what the dots repeat is needed once), "[<t1>,...]" any number,
/// "<g>|AUTO|TRACk" one.
constexpr Arity arity_of(const char* parameters) noexcept {
  Arity arity;
  bool is_optional = false;
  bool in_name = false;
  bool has_element = false;
  bool repeats = false;
  for (std::size_t i = 0;; ++i) {
    const char c = parameters[i];
    const bool ends_element = !in_name && (c == ',' || c == ']' || c == '[' || c == '\0');
    if (ends_element) {
      if (has_element) {
        ++arity.max;
        arity.min = static_cast<std::uint16_t>(arity.min + (is_optional ? 0 : 1));
      }
      has_element = false;
      if (c == '[' || c == ']') {
        arity.is_well_formed = arity.is_well_formed && is_optional == (c == ']');
        is_optional = c == '[';
      }
      if (c == '\0') {
        break;
      }
      continue;
    }
    if (c == '<' || c == '>') {
      arity.is_well_formed = arity.is_well_formed && in_name == (c == '>');
      in_name = c == '<';
    }
    if (c == '\0') {
      arity.is_well_formed = false;
      break;
    }
    if (c == '.' && parameters[i + 1] == '.' && parameters[i + 2] == '.') {
      repeats = true;
      i += 2;
      continue;
    }
    has_element = true;
  }
  if (repeats) {
    arity.min = arity.min > 0 ? std::uint16_t{1} : std::uint16_t{0};
    arity.max = kAnyCount;
  }
  arity.is_well_formed = arity.is_well_formed && !is_optional;
  return arity;
}

}  // namespace emax::app::scpi
