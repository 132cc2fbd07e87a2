// Parameters to values, with the standard's error for each way in which one can be wrong.
#include "emax/app/scpi/call.hpp"

#include <limits>

#include "emax/app/scpi/input_buffer.hpp"
#include "emax/app/scpi/pattern.hpp"
#include "emax/app/scpi/program_unit.hpp"

#include "characters.hpp"
#include "number_text.hpp"

namespace emax::app::scpi {
namespace {

// Infinity and NaN of SCPI-99, volume 1, 7.2.1.
constexpr double kInfinityCode = 9.9e37;
constexpr double kNanCode = 9.91e37;

// Whole numbers below are exact.
constexpr double kMaxWhole = 9007199254740992.0;

enum class Kind : std::uint8_t { kNumber, kNondecimal, kWord, kString, kBlock, kExpression };

Kind kind_of(Span<const char> text) noexcept {
  const char first = text[0];
  if (is_letter(first)) {
    return Kind::kWord;
  }
  if (first == '"' || first == '\'') {
    return Kind::kString;
  }
  if (first == '#') {
    return begins_block(text) ? Kind::kBlock : Kind::kNondecimal;
  }
  return first == '(' ? Kind::kExpression : Kind::kNumber;
}

/// What is wrong with data of this kind where it is not wanted.
ErrorCode not_allowed(Kind kind) noexcept {
  switch (kind) {
    case Kind::kNumber:
    case Kind::kNondecimal:
      return ErrorCode::kNumericDataNotAllowed;
    case Kind::kWord:
      return ErrorCode::kCharacterDataNotAllowed;
    case Kind::kString:
      return ErrorCode::kStringDataNotAllowed;
    case Kind::kBlock:
      return ErrorCode::kBlockDataNotAllowed;
    case Kind::kExpression:
      return ErrorCode::kExpressionDataNotAllowed;
  }
  return ErrorCode::kDataTypeError;
}

/// What is wrong with a word as such.
ErrorCode check_word(Span<const char> word) noexcept {
  for (const char c : word) {
    if (!is_letter(c) && !is_digit(c) && c != '_') {
      return is_blank(c) ? ErrorCode::kInvalidSeparator : ErrorCode::kInvalidCharacterData;
    }
  }
  return word.size() > kMaxMnemonic ? ErrorCode::kCharacterDataTooLong : ErrorCode::kNoError;
}

template <std::size_t kSize>
bool is_word(const char (&pattern)[kSize], Span<const char> word) noexcept {
  return matches_word(pattern, kSize - 1, word);
}

std::size_t length_of(const char* words) noexcept {
  std::size_t length = 0;
  while (words[length] != '\0') {
    ++length;
  }
  return length;
}

std::size_t find_word(Words words, Span<const char> word) noexcept {
  std::size_t index = 0;
  while (index < words.size() && !matches_word(words[index], length_of(words[index]), word)) {
    ++index;
  }
  return index;
}

double with_special_values(double value) noexcept {
  if (value == kNanCode) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double infinity = std::numeric_limits<double>::infinity();
  if (value >= kInfinityCode) {
    return infinity;
  }
  return value <= -kInfinityCode ? -infinity : value;
}

/// @param[in] value Within +-kMaxWhole.
std::int64_t rounded(double value) noexcept {
  const auto whole = static_cast<std::int64_t>(value);
  const double rest = value - static_cast<double>(whole);
  if (rest >= 0.5) {
    return whole + 1;
  }
  return rest <= -0.5 ? whole - 1 : whole;
}

NumberRule without_unit(const IntegerRule& rule) noexcept {
  return {static_cast<double>(rule.min), static_cast<double>(rule.max),
          static_cast<double>(rule.by_default), nullptr};
}

}  // namespace

void Call::fail(ErrorCode code, const char* words, const char* subject) noexcept {
  status_.report(code, words, subject);
  note_failure(code);
}

void Call::fail(ErrorCode code, Span<const char> offender) noexcept {
  status_.report(code, offender);
  note_failure(code);
}

void Call::note_failure(ErrorCode code) noexcept {
  failed_ = true;
  stops_message_ = stops_message_ || is_command_error(code);
}

bool Call::refuse(Span<const char> text, ErrorCode error) noexcept {
  fail(error, text);
  return false;
}

bool Call::take(Span<const char>& text) noexcept {
  if (count_ == 0) {
    return refuse({}, ErrorCode::kMissingParameter);
  }
  --count_;
  while (!rest_.empty() && is_blank(rest_[0])) {
    rest_ = rest_.from(1);
  }
  MessageScanner scanner = MessageScanner::at_parameter();
  std::size_t length = 0;
  while (length < rest_.size() &&
         scanner.next(rest_[length]) != MessageScanner::Event::kSeparator) {
    ++length;
  }
  text = rest_.first(length);
  rest_ = rest_.from(length < rest_.size() ? length + 1 : length);
  if (text.empty()) {
    return refuse({}, ErrorCode::kMissingParameter);
  }
  // The bytes of a block may look like blanks.
  const bool is_block = kind_of(text) == Kind::kBlock;
  while (!is_block && is_blank(text[text.size() - 1])) {
    text = text.first(text.size() - 1);
  }
  return true;
}

bool Call::has_word() const noexcept {
  for (const char c : rest_) {
    if (!is_blank(c)) {
      return is_letter(c);
    }
  }
  return false;
}

bool Call::read_word_number(const NumberRule& rule, Span<const char> text, double& value) noexcept {
  const ErrorCode error = check_word(text);
  if (error != ErrorCode::kNoError) {
    return refuse(text, error);
  }
  double number = std::numeric_limits<double>::quiet_NaN();
  if (is_word("MINimum", text)) {
    number = rule.min;
  } else if (is_word("MAXimum", text)) {
    number = rule.max;
  } else if (is_word("DEFault", text)) {
    number = rule.by_default;
    if (number != number) {
      return refuse(text, ErrorCode::kIllegalParameterValue);
    }
  } else if (is_word("INFinity", text)) {
    number = std::numeric_limits<double>::infinity();
  } else if (is_word("NINFinity", text)) {
    number = -std::numeric_limits<double>::infinity();
  } else if (!is_word("NAN", text)) {
    return refuse(text, ErrorCode::kInvalidCharacterData);
  }
  value = number;
  return true;
}

bool Call::read_number(const NumberRule& rule, Span<const char> text, double& value) noexcept {
  const Kind kind = kind_of(text);
  if (kind == Kind::kWord) {
    return read_word_number(rule, text, value);
  }
  if (kind != Kind::kNumber && kind != Kind::kNondecimal) {
    return refuse(text, not_allowed(kind));
  }
  const NumberText number =
      kind == Kind::kNumber ? read_decimal(text, rule.unit) : read_nondecimal(text);
  if (number.error != ErrorCode::kNoError) {
    return refuse(text, number.error);
  }
  value = with_special_values(number.value);
  return true;
}

bool Call::read_in_range(const NumberRule& rule, Span<const char> text, double& value) noexcept {
  double number = 0.0;
  if (!read_number(rule, text, number)) {
    return false;
  }
  if (!(number >= rule.min && number <= rule.max)) {
    return refuse(text, ErrorCode::kDataOutOfRange);
  }
  value = number;
  return true;
}

bool Call::number(const NumberRule& rule, double& value) noexcept {
  Span<const char> text;
  return take(text) && read_in_range(rule, text, value);
}

bool Call::integer(const IntegerRule& rule, std::int64_t& value) noexcept {
  Span<const char> text;
  double number = 0.0;
  if (!take(text) || !read_number(without_unit(rule), text, number)) {
    return false;
  }
  if (!(number >= -kMaxWhole && number <= kMaxWhole)) {
    return refuse(text, ErrorCode::kDataOutOfRange);
  }
  const std::int64_t whole = rounded(number);
  if (whole < rule.min || whole > rule.max) {
    return refuse(text, ErrorCode::kDataOutOfRange);
  }
  value = whole;
  return true;
}

bool Call::boolean(bool& value) noexcept {
  Span<const char> text;
  if (!take(text)) {
    return false;
  }
  if (kind_of(text) == Kind::kWord) {
    constexpr const char* kWords[] = {"OFF", "ON"};
    std::size_t index = 0;
    if (!read_choice(kWords, text, index)) {
      return false;
    }
    value = index == 1;
    return true;
  }
  constexpr NumberRule kAnyNumber{-kMaxWhole, kMaxWhole, 0.0, nullptr};
  double number = 0.0;
  if (!read_in_range(kAnyNumber, text, number)) {
    return false;
  }
  value = rounded(number) != 0;
  return true;
}

bool Call::read_choice(Words words, Span<const char> text, std::size_t& index) noexcept {
  const Kind kind = kind_of(text);
  if (kind != Kind::kWord) {
    return refuse(text, not_allowed(kind));
  }
  const ErrorCode error = check_word(text);
  if (error != ErrorCode::kNoError) {
    return refuse(text, error);
  }
  const std::size_t found = find_word(words, text);
  if (found == words.size()) {
    return refuse(text, ErrorCode::kIllegalParameterValue);
  }
  index = found;
  return true;
}

bool Call::choice(Words words, std::size_t& index) noexcept {
  Span<const char> text;
  return take(text) && read_choice(words, text, index);
}

bool Call::numbers(const NumberRule& rule, Span<double> values, std::size_t& count) noexcept {
  count = 0;
  while (has_more()) {
    Span<const char> text;
    if (!take(text)) {
      return false;
    }
    if (count == values.size()) {
      return refuse(text, ErrorCode::kTooMuchData);
    }
    if (!read_in_range(rule, text, values[count])) {
      return false;
    }
    ++count;
  }
  return true;
}

bool Call::string(Span<const char>& text) noexcept {
  Span<const char> element;
  if (!take(element)) {
    return false;
  }
  const Kind kind = kind_of(element);
  if (kind != Kind::kString) {
    return refuse(element, not_allowed(kind));
  }
  const char quote = element[0];
  const Span<const char> inside = element.from(1);
  std::size_t end = 0;
  while (end < inside.size()) {
    const bool is_quote = inside[end] == quote;
    const bool is_doubled = is_quote && end + 1 < inside.size() && inside[end + 1] == quote;
    if (is_quote && !is_doubled) {
      break;
    }
    end += is_doubled ? 2 : 1;
  }
  if (end + 1 != inside.size()) {
    return refuse(element, ErrorCode::kInvalidStringData);
  }
  text = inside.first(end);
  return true;
}

/// MIN, MAX or DEF of a query.
bool Call::take_limit(const NumberRule& rule, double& value) noexcept {
  constexpr const char* kWords[] = {"MINimum", "MAXimum", "DEFault"};
  std::size_t index = 0;
  if (!choice(kWords, index)) {
    return false;
  }
  value = index == 0 ? rule.min : index == 1 ? rule.max : rule.by_default;
  return true;
}

bool Call::setting(const NumberRule& rule, double current, double& value) noexcept {
  if (!is_query()) {
    return number(rule, value);
  }
  double shown = current;
  if (!has_more() || take_limit(rule, shown)) {
    response_.number(shown);
  }
  return false;
}

bool Call::integer_setting(const IntegerRule& rule, std::int64_t current,
                           std::int64_t& value) noexcept {
  if (!is_query()) {
    return integer(rule, value);
  }
  double shown = 0.0;
  if (!has_more()) {
    response_.integer(current);
  } else if (take_limit(without_unit(rule), shown)) {
    response_.integer(rounded(shown));
  }
  return false;
}

bool Call::boolean_setting(bool current, bool& value) noexcept {
  if (!is_query()) {
    return boolean(value);
  }
  response_.boolean(current);
  return false;
}

bool Call::choice_setting(Words words, std::size_t current, std::size_t& index) noexcept {
  if (!is_query()) {
    return choice(words, index);
  }
  response_.short_form(words[current]);
  return false;
}

bool Call::number_or_word_setting(const NumberRule& rule, Words words, const NumberOrWord& current,
                                  NumberOrWord& value) noexcept {
  Span<const char> text;
  double number = current.number;
  std::size_t word = current.word;
  if (!is_query()) {
    if (!take(text)) {
      return false;
    }
    word = is_word("DEFault", text) ? 0 : find_word(words, text);
    if (word == words.size() && !read_in_range(rule, text, number)) {
      return false;
    }
    value = {number, word};
    return true;
  }
  if (has_more()) {
    if (!take_limit(rule, number)) {
      return false;
    }
    // A rule without a default has a NaN for it.
    word = number == number ? words.size() : 0;
  }
  if (word < words.size()) {
    response_.short_form(words[word]);
  } else {
    response_.number(number);
  }
  return false;
}

void Call::answer_items(std::size_t count) noexcept { items_ = count; }

}  // namespace emax::app::scpi
