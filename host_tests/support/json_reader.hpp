// JSON read by its grammar, for tests of what is written.
#pragma once

#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>

namespace emax::test {

/// Reads JSON by the grammar of RFC 8259 into "path" -> text of the value; an array's elements are
/// path[0], path[1], ..., and path[] its size.
class JsonReader {
 public:
  explicit JsonReader(const std::string& text) : text_(text) {
    value("");
    blanks();
    valid_ = valid_ && at_ == text_.size();
  }
  bool valid() const { return valid_; }
  std::string at(const std::string& path) const {
    const auto found = values_.find(path);
    return found == values_.end() ? "nothing at " + path : found->second;
  }
  double number(const std::string& path) const { return std::strtod(at(path).c_str(), nullptr); }

 private:
  void fail() { valid_ = false; }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void blanks() {
    while (peek() == ' ' || peek() == '\n') {
      ++at_;
    }
  }
  bool take(char wanted) {
    blanks();
    if (!valid_ || peek() != wanted) {
      return false;
    }
    ++at_;
    return true;
  }

  void value(const std::string& path) {
    blanks();
    if (peek() == '{') {
      object(path);
    } else if (peek() == '[') {
      array(path);
    } else if (peek() == '"') {
      values_[path] = string();
    } else if (text_.compare(at_, 4, "null") == 0) {
      at_ += 4;
      values_[path] = "null";
    } else if (text_.compare(at_, 4, "true") == 0) {
      at_ += 4;
      values_[path] = "true";
    } else if (text_.compare(at_, 5, "false") == 0) {
      at_ += 5;
      values_[path] = "false";
    } else {
      values_[path] = number_text();
    }
  }

  void object(const std::string& path) {
    (void)take('{');
    if (take('}')) {
      return;
    }
    do {
      blanks();
      const std::string name = string();
      if (!take(':')) {
        fail();
        return;
      }
      const std::string member = path.empty() ? name : path + "." + name;
      if (values_.count(member) != 0) {
        fail();
      }
      value(member);
    } while (take(','));
    if (!take('}')) {
      fail();
    }
  }

  void array(const std::string& path) {
    (void)take('[');
    std::size_t count = 0;
    if (!take(']')) {
      do {
        value(path + "[" + std::to_string(count++) + "]");
      } while (take(','));
      if (!take(']')) {
        fail();
      }
    }
    values_[path + "[]"] = std::to_string(count);
  }

  std::string string() {
    std::string result;
    if (peek() != '"') {
      fail();
      return result;
    }
    for (++at_; valid_ && peek() != '"'; ++at_) {
      const auto byte = static_cast<unsigned char>(peek());
      if (byte < 0x20 || byte >= 0x7F) {
        fail();
      } else if (byte != '\\') {
        result += peek();
      } else if (text_[++at_] == 'u') {
        result += static_cast<char>(std::strtol(text_.substr(at_ + 1, 4).c_str(), nullptr, 16));
        at_ += 4;
      } else if (peek() == '"' || peek() == '\\') {
        result += peek();
      } else {
        fail();
      }
    }
    ++at_;
    return result;
  }

  void digits() {
    if (std::isdigit(static_cast<unsigned char>(peek())) == 0) {
      fail();
    }
    while (std::isdigit(static_cast<unsigned char>(peek())) != 0) {
      ++at_;
    }
  }

  std::string number_text() {
    const std::size_t begin = at_;
    at_ += peek() == '-' ? 1U : 0U;
    if (peek() == '0') {
      ++at_;
    } else {
      digits();
    }
    if (peek() == '.') {
      ++at_;
      digits();
    }
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      at_ += peek() == '+' || peek() == '-' ? 1U : 0U;
      digits();
    }
    return text_.substr(begin, at_ - begin);
  }

  std::string text_;
  std::size_t at_ = 0;
  bool valid_ = true;
  std::map<std::string, std::string> values_;
};

}  // namespace emax::test
