// Where a unit and its header end, and what a header may look like.
#include "emax/app/scpi/program_unit.hpp"

#include "emax/app/scpi/input_buffer.hpp"
#include "emax/app/scpi/pattern.hpp"

#include "characters.hpp"

namespace emax::app::scpi {
namespace {

using Event = MessageScanner::Event;

Span<const char> without_leading_blanks(Span<const char> text) noexcept {
  while (!text.empty() && is_blank(text[0])) {
    text = text.from(1);
  }
  return text;
}

/// @returns The characters of the text in front of the first blank.
std::size_t length_of_header(Span<const char> text) noexcept {
  std::size_t length = 0;
  while (length < text.size() && !is_blank(text[length])) {
    ++length;
  }
  return length;
}

constexpr bool is_mnemonic_character(char c) noexcept {
  return is_letter(c) || is_digit(c) || c == '_';
}

/// @returns The length of the mnemonic at the front; 0 if there is none.
std::size_t length_of_mnemonic(Span<const char> text) noexcept {
  std::size_t length = 0;
  if (!text.empty() && is_letter(text[0])) {
    while (length < text.size() && is_mnemonic_character(text[length])) {
      ++length;
    }
  }
  return length;
}

/// What a character means that cannot stand where it is.
ErrorCode misplaced(Span<const char> rest, bool follows_mnemonic) noexcept {
  const char c = rest.empty() ? '\0' : rest[0];
  if (follows_mnemonic && (c == ',' || c == '"' || c == '\'' || c == '#' || c == '(' || c == '?' ||
                           is_mnemonic_character(c))) {
    return ErrorCode::kHeaderSeparatorError;
  }
  const bool is_known = c == '\0' || c == ':' || c == '?' || c == '*' || is_digit(c);
  return is_known ? ErrorCode::kCommandHeaderError : ErrorCode::kInvalidCharacter;
}

void parse_header(ProgramUnit& unit) noexcept {
  Span<const char> rest = unit.header;
  unit.is_common = rest[0] == '*';
  unit.is_absolute = rest[0] == ':';
  if (unit.is_absolute) {
    rest = rest.from(1);
  }
  const char* name = rest.data();
  std::size_t name_length = unit.is_common ? 1 : 0;
  rest = rest.from(name_length);
  for (;;) {
    const std::size_t length = length_of_mnemonic(rest);
    if (length == 0) {
      unit.error = misplaced(rest, false);
      return;
    }
    if (length > kMaxMnemonic) {
      unit.error = ErrorCode::kProgramMnemonicTooLong;
      return;
    }
    name_length += length;
    rest = rest.from(length);
    if (unit.is_common || rest.empty() || rest[0] != ':') {
      break;
    }
    ++name_length;
    rest = rest.from(1);
  }
  unit.name = Span<const char>(name, name_length);
  unit.is_query = !rest.empty() && rest[0] == '?';
  rest = rest.from(unit.is_query ? 1 : 0);
  if (!rest.empty()) {
    unit.error = misplaced(rest, true);
  }
}

}  // namespace

bool begins_block(Span<const char> parameter) noexcept {
  return parameter.size() > 1 && parameter[0] == '#' && is_digit(parameter[1]);
}

ProgramUnit cut_unit(Span<const char> message, std::size_t& position) noexcept {
  ProgramUnit unit;
  MessageScanner scanner;
  std::size_t separators = 0;
  std::size_t end = position;
  Event event = Event::kMore;
  for (; end < message.size(); ++end) {
    event = scanner.next(message[end]);
    if (event == Event::kUnitEnd) {
      break;
    }
    separators += event == Event::kSeparator ? 1U : 0U;
  }
  const Span<const char> text =
      without_leading_blanks(Span<const char>(message.data() + position, end - position));
  position = end < message.size() ? end + 1 : end;
  if (text.empty()) {
    unit.is_empty = true;
    return unit;
  }
  const std::size_t length = length_of_header(text);
  unit.header = text.first(length);
  unit.parameters = without_leading_blanks(text.from(length));
  unit.count = unit.parameters.empty() ? 0 : separators + 1;
  parse_header(unit);
  return unit;
}

}  // namespace emax::app::scpi
