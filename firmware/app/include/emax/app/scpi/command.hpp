// The rows of a command table, one for each command, for parser and documentation alike.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/scpi/call.hpp"
#include "emax/app/scpi/pattern.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

enum class Forms : std::uint8_t { kSet = 1, kQuery = 2, kSetAndQuery = 3 };

/// Flags of a row; those from kFirstOwnFlag on are the table's owner's.
enum CommandFlag : std::uint8_t {
  kPlain = 0,
  /// Acts at once, even while others wait: must neither wait nor answer more than
  /// `Response::kImmediateRoom` characters.
  kImmediate = 1 << 0,
  /// The query of a row with both forms takes MIN, MAX or DEF.
  kQueryLimits = 1 << 1,
  kFirstOwnFlag = 1 << 4,
};

/// One command. `Context` is what its handler works on: the instrument.
template <typename Context>
struct Command {
  const char* pattern;  ///< "[SENSe:]SWEep:FREQuency", "*ESE"; without '?'.
  Forms forms;
  /// "<S>,<f0>,<beta>[,<uS>,<uf0>,<ubeta>]", "ISE|DIFFerence", "" for none. Those of the query if
  /// there is no other form. The number of parameters is checked against it: see `arity_of()`.
  const char* parameters;
  const char* description;  ///< One line.
  std::uint8_t flags;
  void (*handler)(Context& context, Call& call);

  constexpr bool has_set() const noexcept { return forms != Forms::kQuery; }
  constexpr bool has_query() const noexcept { return forms != Forms::kSet; }
};

/// What the parser needs of a command: no texts for people, and its parameters counted beforehand.
template <typename Context>
struct Row {
  static constexpr std::uint8_t kAny = 0xFF;  ///< Parameters without end.

  const char* pattern;
  void (*handler)(Context& context, Call& call);
  Forms forms;
  std::uint8_t flags;
  std::uint8_t min_parameters;  ///< Those of the query if there is no other form.
  std::uint8_t max_parameters;

  constexpr bool has_set() const noexcept { return forms != Forms::kQuery; }
  constexpr bool has_query() const noexcept { return forms != Forms::kSet; }
  constexpr bool is_immediate() const noexcept { return (flags & kImmediate) != 0; }

  /// How many parameters the form takes.
  constexpr Arity arity(bool is_query) const noexcept {
    Arity arity;
    if (is_query && forms == Forms::kSetAndQuery) {
      arity.max = (flags & kQueryLimits) != 0 ? 1 : 0;
      return arity;
    }
    arity.min = min_parameters;
    arity.max = max_parameters == kAny ? kAnyCount : max_parameters;
    return arity;
  }
};

template <typename Context>
using Table = Span<const Row<Context>>;

template <typename Context, std::size_t kRows>
struct Rows {
  Row<Context> rows[kRows] = {};
};

/// @returns The parser's part of a table, in its order.
template <typename Context, std::size_t kRows>
constexpr Rows<Context, kRows> rows_of(const Command<Context> (&table)[kRows]) noexcept {
  Rows<Context, kRows> all;
  for (std::size_t i = 0; i < kRows; ++i) {
    const Arity arity = arity_of(table[i].parameters);
    const bool is_any = arity.max == kAnyCount;
    all.rows[i] = {table[i].pattern,
                   table[i].handler,
                   table[i].forms,
                   table[i].flags,
                   static_cast<std::uint8_t>(arity.min),
                   is_any ? Row<Context>::kAny : static_cast<std::uint8_t>(arity.max)};
  }
  return all;
}

constexpr bool is_pattern_letter(char c) noexcept {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/// @returns True if the character at `i` may stand between its neighbours.
constexpr bool is_well_placed(const char* pattern, std::size_t i, bool is_open) noexcept {
  const char before = i > 0 ? pattern[i - 1] : '\0';
  const char after = pattern[i + 1];
  switch (pattern[i]) {
    case '*':
      return i == 0 && is_pattern_letter(after);
    case '1':
      return before == '[' && after == ']';
    case '[':
      return !is_open && (after == ':' || after == '1' || is_pattern_letter(after));
    case ']':
      return is_open;
    case ':':
      // Brackets hold one node, with one colon.
      return (is_pattern_letter(before) || before == ']' || before == '[') &&
             (is_open ? is_pattern_letter(after) != is_pattern_letter(before)
                      : is_pattern_letter(after) || after == '[');
    default:
      return is_pattern_letter(pattern[i]);
  }
}

/// @returns True if pattern and parameters of a row follow the notation.
constexpr bool is_well_formed(const char* pattern, const char* parameters) noexcept {
  bool is_open = false;
  for (std::size_t i = 0; pattern[i] != '\0'; ++i) {
    if (!is_well_placed(pattern, i, is_open)) {
      return false;
    }
    is_open = pattern[i] == '[' || (is_open && pattern[i] != ']');
  }
  bool has_required = false;
  PatternNode node = next_node(pattern, 0);
  for (; node.length > 0; node = next_node(pattern, node.next)) {
    if (node.length > kMaxMnemonic || (pattern[node.begin] >= 'a' && pattern[node.begin] <= 'z')) {
      return false;
    }
    has_required = has_required || !node.is_optional;
  }
  return !is_open && has_required && pattern[node.next] == '\0' &&
         arity_of(parameters).is_well_formed;
}

/// @returns The index of the first row that is not well formed or whose pattern a row before it
/// has, too; the size of the table if there is none: for a static_assert.
template <typename Context, std::size_t kRows>
constexpr std::size_t first_bad_row(const Command<Context> (&table)[kRows]) noexcept {
  for (std::size_t row = 0; row < kRows; ++row) {
    if (!is_well_formed(table[row].pattern, table[row].parameters) ||
        table[row].handler == nullptr) {
      return row;
    }
    for (std::size_t other = 0; other < row; ++other) {
      const char* a = table[row].pattern;
      const char* b = table[other].pattern;
      while (*a != '\0' && *a == *b) {
        ++a;
        ++b;
      }
      if (*a == *b) {
        return row;
      }
    }
  }
  return kRows;
}

}  // namespace emax::app::scpi
