// JSON text as a tree of values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace emax::desk {

/// One value of a JSON text (RFC 8259).
class JsonValue final {
 public:
  enum class Kind : std::uint8_t { kNull, kBoolean, kNumber, kString, kArray, kObject };
  using Member = std::pair<std::string, JsonValue>;

  Kind kind() const noexcept { return kind_; }
  bool is_number() const noexcept { return kind_ == Kind::kNumber; }
  bool is_string() const noexcept { return kind_ == Kind::kString; }
  /// 0 unless it is a number.
  double number() const noexcept { return number_; }
  bool is_object() const noexcept { return kind_ == Kind::kObject; }
  /// @returns Whether it is the value true.
  bool is_true() const noexcept { return kind_ == Kind::kBoolean && number_ != 0.0; }
  /// Empty unless it is a string. UTF-8, with escapes resolved.
  const std::string& text() const noexcept { return text_; }
  /// The elements of an array; none otherwise.
  const std::vector<JsonValue>& elements() const noexcept { return elements_; }

  /// @returns The member of that name, or, as where this is no object, a null value.
  const JsonValue& operator[](std::string_view name) const noexcept;

 private:
  friend class JsonParser;

  Kind kind_ = Kind::kNull;
  double number_ = 0.0;  // For a boolean 0 or 1.
  std::string text_;
  std::vector<JsonValue> elements_;
  std::vector<Member> members_;
};

/// Where a text stops being JSON.
struct JsonError {
  std::size_t line = 0;           ///< From 1; 0 if all is well.
  std::size_t column = 0;         ///< In bytes, from 1.
  const char* problem = nullptr;  ///< "a value is missing", for instance; null if all is well.
};

/// Reads a whole text, which is nested at most kMaxJsonDepth deep. Of two members with the same
/// name the second is an error. The work is proportional to the text, but for a logarithm of the
/// members per object. A stop request ends it with an error.
///
/// @param[out] value Of no use after an error.
JsonError parse_json(std::string_view text, JsonValue& value);

inline constexpr std::size_t kMaxJsonDepth = 32;

}  // namespace emax::desk
