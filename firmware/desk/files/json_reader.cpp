// JSON text as a tree of values, by recursive descent of limited depth.
#include "desk/files/json_reader.hpp"

#include <algorithm>
#include <numeric>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"

#include "desk/cli/stop_request.hpp"
#include "desk/files/utf8_text.hpp"

namespace emax::desk {

namespace {

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// The first member whose name one before it has; their number if there is none.
std::size_t first_repeated(const std::vector<JsonValue::Member>& members) {
  std::vector<std::size_t> order(members.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t one, std::size_t other) {
    const int less = members[one].first.compare(members[other].first);
    return less < 0 || (less == 0 && one < other);
  });
  std::size_t first = members.size();
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (members[order[i]].first == members[order[i - 1]].first) {
      first = std::min(first, order[i]);
    }
  }
  return first;
}

}  // namespace

const JsonValue& JsonValue::operator[](std::string_view name) const noexcept {
  for (const Member& member : members_) {
    if (member.first == name) {
      return member.second;
    }
  }
  static const JsonValue null_value;
  return null_value;
}

/// Each function takes what it is named after, from `at_` on, or says what is wrong there.
class JsonParser final {
 public:
  explicit JsonParser(std::string_view text) noexcept : text_(text) {}

  JsonError parse(JsonValue& value) {
    if (take_value(value, 0)) {
      skip_space();
      if (at_ != text_.size()) {
        (void)fail("something stands behind its end");
      }
    }
    return problem_ == nullptr ? JsonError{} : located();
  }

 private:
  bool fail(const char* problem) noexcept {
    problem_ = problem_ == nullptr ? problem : problem_;
    return false;
  }

  JsonError located() const noexcept {
    JsonError error = {1, 1, problem_};
    for (const char c : text_.substr(0, at_)) {
      error.line += c == '\n' ? 1U : 0U;
      error.column = c == '\n' ? 1 : error.column + 1;
    }
    return error;
  }

  char next() const noexcept { return at_ < text_.size() ? text_[at_] : '\0'; }

  void skip_space() noexcept {
    while (next() == ' ' || next() == '\t' || next() == '\n' || next() == '\r') {
      ++at_;
    }
  }

  bool take(char c) noexcept {
    if (next() != c) {
      return false;
    }
    ++at_;
    return true;
  }

  bool take_word(std::string_view word) noexcept {
    if (text_.substr(at_, word.size()) != word) {
      return fail("a value is missing");
    }
    at_ += word.size();
    return true;
  }

  bool take_value(JsonValue& value, std::size_t depth) {
    if (stop_requested()) {
      return fail("the reading was stopped");
    }
    skip_space();
    switch (next()) {
      case '{':
        return depth < kMaxJsonDepth ? take_object(value, depth) : fail("nested too deep");
      case '[':
        return depth < kMaxJsonDepth ? take_array(value, depth) : fail("nested too deep");
      case '"':
        value.kind_ = JsonValue::Kind::kString;
        return take_string(value.text_);
      case 't':
        value.kind_ = JsonValue::Kind::kBoolean;
        value.number_ = 1.0;
        return take_word("true");
      case 'f':
        value.kind_ = JsonValue::Kind::kBoolean;
        return take_word("false");
      case 'n':
        return take_word("null");
      default:
        return take_number(value);
    }
  }

  bool take_object(JsonValue& value, std::size_t depth) {
    value.kind_ = JsonValue::Kind::kObject;
    std::vector<std::size_t> ends_of_names;
    ++at_;
    skip_space();
    if (take('}')) {
      return true;
    }
    do {
      skip_space();
      JsonValue::Member member;
      if (!take_string(member.first)) {
        return false;
      }
      ends_of_names.push_back(at_);
      skip_space();
      if (!take(':')) {
        return fail("a ':' is missing");
      }
      if (!take_value(member.second, depth + 1)) {
        return false;
      }
      value.members_.push_back(std::move(member));
      skip_space();
    } while (take(','));
    if (!take('}')) {
      return fail("a ',' or '}' is missing");
    }
    const std::size_t again = first_repeated(value.members_);
    if (again < ends_of_names.size()) {
      at_ = ends_of_names[again];
      return fail("a name for the second time");
    }
    return true;
  }

  bool take_array(JsonValue& value, std::size_t depth) {
    value.kind_ = JsonValue::Kind::kArray;
    ++at_;
    skip_space();
    if (take(']')) {
      return true;
    }
    do {
      value.elements_.emplace_back();
      if (!take_value(value.elements_.back(), depth + 1)) {
        return false;
      }
      skip_space();
    } while (take(','));
    return take(']') || fail("a ',' or ']' is missing");
  }

  bool take_string(std::string& text) {
    if (!take('"')) {
      return fail("a name in quotation marks is missing");
    }
    while (at_ < text_.size() && next() != '"') {
      if (static_cast<unsigned char>(next()) < 0x20) {
        return fail("a control character in a string");
      }
      if (!take('\\')) {
        text += text_[at_++];
      } else if (!take_escape(text)) {
        return false;
      }
    }
    return take('"') || fail("a string without an end");
  }

  bool take_escape(std::string& text) {
    constexpr std::string_view kLetters = "\"\\/bfnrt";
    constexpr std::string_view kCharacters = "\"\\/\b\f\n\r\t";
    if (take('u')) {
      return take_code(text);
    }
    const std::size_t which = at_ < text_.size() ? kLetters.find(next()) : std::string_view::npos;
    if (which == std::string_view::npos) {
      return fail("an unknown escape");
    }
    text += kCharacters[which];
    ++at_;
    return true;
  }

  // The four digits behind \u, and for the first half of a pair the second half.
  bool take_code(std::string& text) {
    std::uint32_t code = 0;
    if (!take_hex(code)) {
      return false;
    }
    if (code >= 0xD800 && code < 0xDC00) {
      std::uint32_t low = 0;
      if (!take('\\') || !take('u')) {
        return fail("half of a surrogate pair");
      }
      if (!take_hex(low)) {
        return false;
      }
      if (low < 0xDC00 || low > 0xDFFF) {
        return fail("half of a surrogate pair");
      }
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
    } else if (code >= 0xDC00 && code <= 0xDFFF) {
      return fail("half of a surrogate pair");
    }
    append_utf8(code, text);
    return true;
  }

  bool take_hex(std::uint32_t& code) noexcept {
    constexpr std::string_view kDigits = "0123456789abcdef";
    for (int i = 0; i < 4; ++i) {
      const char c = next();
      const char small = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
      const std::size_t digit = kDigits.find(small);
      if (digit == std::string_view::npos) {
        return fail("four hexadecimal digits are missing");
      }
      code = 16 * code + static_cast<std::uint32_t>(digit);
      ++at_;
    }
    return true;
  }

  // The grammar is checked here; what it permits, parse_decimal() reads.
  bool take_number(JsonValue& value) noexcept {
    const std::size_t start = at_;
    (void)take('-');
    if (!is_digit(next())) {
      at_ = start;
      return fail("a value is missing");
    }
    if (!take('0')) {
      skip_digits();
    }
    if (take('.') && !skip_digits()) {
      return fail("a digit is missing");
    }
    if (take('e') || take('E')) {
      (void)(take('+') || take('-'));
      if (!skip_digits()) {
        return fail("a digit is missing");
      }
    }
    const std::string_view digits = text_.substr(start, at_ - start);
    const ParsedNumber number = parse_decimal(Span<const char>(digits.data(), digits.size()));
    if (number.status != Status::kOk || number.length != digits.size() ||
        !is_finite(number.value)) {
      at_ = start;
      return fail("a number too large");
    }
    value.kind_ = JsonValue::Kind::kNumber;
    value.number_ = number.value;
    return true;
  }

  bool skip_digits() noexcept {
    const std::size_t start = at_;
    while (is_digit(next())) {
      ++at_;
    }
    return at_ > start;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  const char* problem_ = nullptr;
};

JsonError parse_json(std::string_view text, JsonValue& value) {
  value = JsonValue();
  return JsonParser(text).parse(value);
}

}  // namespace emax::desk
