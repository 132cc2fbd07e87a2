// A row of the tables of settings: all that is said of a setting, in one place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "emax/app/settings/setting_field.hpp"

namespace emax::app {

/// What is listed together, on the command line and in the command table.
enum class SettingGroup : std::uint8_t {
  kDrive,
  kRest,
  kRepeats,
  kChain,
  kFilter,
  kSignal,
  kTrials,
  kCoverage,
  kRandom,
  kTrend,
};

/// A setting on the command line.
struct OptionText {
  const char* name = nullptr;         ///< Without dashes; null if it is no option.
  const char* value = nullptr;        ///< "HZ", "auto|NUMBER", "ise|difference"; null for a switch.
  const char* expectation = nullptr;  ///< Of its value; null: that of the field.
  const char* help = nullptr;         ///< Lines of at most 55 characters.
  const char* by_default = nullptr;   ///< Null: made from the default settings.
};

/// A setting on the console.
struct CommandText {
  const char* header = nullptr;  ///< "SOURce:LEVel"; null if it is no command.
  const char* parameters = nullptr;
  const char* description = nullptr;
  const char* unit = nullptr;  ///< "HZ"; null if it has none.
  double min = 0.0;
  double max = 0.0;
  /// Not null where the setting of the next row, a number, is an optional second parameter and the
  /// second field of the answer: its unit.
  const char* next_unit = nullptr;
};

/// One setting: what boards keep of it, and its texts. Rows are constants that other tables are
/// made from when they are compiled: what a program does not use of them takes no memory in it.
struct SettingRow {
  SettingField field;
  SettingGroup group = SettingGroup::kDrive;
  OptionText option;
  CommandText command;
  /// On the console, short forms in capitals: of a choice all in the order of its values, of
  /// kNumberOrWord those that stand for a number, in the order of its byte.
  const char* const* words = nullptr;
  std::size_t word_count = 0;

  /// From `min` to `max`, both of them included. On the console as well, unless it says otherwise.
  constexpr SettingRow within(double min, double max, const char* expectation) const noexcept {
    SettingRow row = *this;
    row.field.min = min;
    row.field.max = max;
    row.field.expectation = expectation;
    row.command.min = min;
    row.command.max = max;
    return row;
  }
  /// One of these words.
  template <std::size_t kCount>
  constexpr SettingRow one_of(const char* const (&list)[kCount]) const noexcept {
    SettingRow row = *this;
    row.words = list;
    row.word_count = kCount;
    row.field.last = static_cast<std::uint16_t>(kCount - 1);
    return row;
  }
  /// A number, or one of these words; `number_mode` is the byte where it is a number.
  template <std::size_t kCount>
  constexpr SettingRow or_one_of(const char* const (&list)[kCount],
                                 std::uint8_t number_mode) const noexcept {
    SettingRow row = one_of(list);
    row.field.last = static_cast<std::uint16_t>(kCount);
    row.field.number_mode = number_mode & 7U;
    return row;
  }
  /// On the command line, under its own name unless another one is given.
  constexpr SettingRow as_option(const OptionText& text) const noexcept {
    SettingRow row = *this;
    row.option = text;
    row.option.name = text.name != nullptr ? text.name : field.name;
    return row;
  }
  constexpr SettingRow as_command(const char* header, const char* parameters,
                                  const char* description,
                                  const char* unit = nullptr) const noexcept {
    SettingRow row = *this;
    row.command.header = header;
    row.command.parameters = parameters;
    row.command.description = description;
    row.command.unit = unit;
    return row;
  }
  /// The next row is this setting's uncertainty: an optional second value of the option and of the
  /// command, which keeps its own where it is left out.
  constexpr SettingRow with_uncertainty(const char* unit) const noexcept {
    SettingRow row = *this;
    row.command.next_unit = unit;
    return row;
  }
  /// The console is narrower than the check.
  constexpr SettingRow on_console_within(double min, double max) const noexcept {
    SettingRow row = *this;
    row.command.min = min;
    row.command.max = max;
    return row;
  }
};

/// How a member of this type is stored.
template <typename T>
struct StorageOf {
  static_assert(std::is_enum_v<T> && sizeof(T) == 1, "no setting can be of this type");
  static constexpr SettingKind kKind = SettingKind::kChoice;
  static constexpr std::size_t kRoom = 0;
};
template <>
struct StorageOf<double> {
  static constexpr SettingKind kKind = SettingKind::kNumber;
  static constexpr std::size_t kRoom = 0;
};
template <>
struct StorageOf<int> {
  static constexpr SettingKind kKind = SettingKind::kWhole;
  static constexpr std::size_t kRoom = 0;
};
template <>
struct StorageOf<std::uint32_t> {
  static constexpr SettingKind kKind = SettingKind::kWhole;
  static constexpr std::size_t kRoom = 0;
};
template <>
struct StorageOf<bool> {
  static_assert(sizeof(bool) == 1);
  static constexpr SettingKind kKind = SettingKind::kSwitch;
  static constexpr std::size_t kRoom = 1;
};
template <std::size_t kSize>
struct StorageOf<std::array<double, kSize>> {
  static constexpr SettingKind kKind = SettingKind::kNumbers;
  static constexpr std::size_t kRoom = kSize;
};
template <std::size_t kSize>
struct StorageOf<std::array<std::uint32_t, kSize>> {
  static constexpr SettingKind kKind = SettingKind::kWholes;
  static constexpr std::size_t kRoom = kSize;
};

/// A member, as EMAX_SETTING names it.
struct SettingMember {
  SettingKind kind;
  std::size_t offset;
  std::size_t room;
  std::size_t beside = 0;
};

template <typename T>
constexpr SettingMember setting_member(std::size_t offset) noexcept {
  return {StorageOf<T>::kKind, offset, StorageOf<T>::kRoom};
}

/// The member of a structure of settings, by its name: nothing else has both its type and its
/// place.
#define EMAX_SETTING(Structure, member) \
  ::emax::app::setting_member<decltype(Structure::member)>(offsetof(Structure, member))

/// A row for a member that stands alone.
constexpr SettingRow setting(const char* name, const SettingMember& member, SettingGroup group,
                             Concern concern) noexcept {
  SettingRow row;
  row.field.name = name;
  row.field.kind = member.kind;
  row.field.offset = static_cast<std::uint16_t>(member.offset);
  row.field.last = static_cast<std::uint16_t>(member.room);
  row.field.concern = concern;
  row.group = group;
  return row;
}

/// A row for two members that are one setting: a number with the byte that says whether it holds,
/// or a list with its count.
constexpr SettingRow setting(const char* name, const SettingMember& member, std::size_t beside,
                             SettingGroup group, Concern concern) noexcept {
  SettingRow row = setting(name, member, group, concern);
  row.field.beside = static_cast<std::uint16_t>(beside);
  if (member.kind == SettingKind::kNumber) {
    row.field.kind = SettingKind::kNumberOrWord;
  }
  return row;
}

/// A row for a list that shares the count of another one, which comes before it.
constexpr SettingRow more_of(const char* name, const SettingMember& member,
                             const SettingRow& list) noexcept {
  SettingRow row = setting(name, member, list.field.beside, list.group, list.field.concern);
  row.field.kind = SettingKind::kMoreNumbers;
  return row;
}

/// @returns The bytes that the settings of these rows take when they are saved, all lists full.
template <std::size_t kRows>
constexpr std::size_t most_saved_bytes(const SettingRow (&rows)[kRows]) noexcept {
  std::size_t bytes = 0;
  for (const SettingRow& row : rows) {
    switch (row.field.kind) {
      case SettingKind::kNumber:
        bytes += 8;
        break;
      case SettingKind::kWhole:
        bytes += 4;
        break;
      case SettingKind::kSwitch:
      case SettingKind::kChoice:
        bytes += 1;
        break;
      case SettingKind::kNumberOrWord:
        bytes += 1 + 8;
        break;
      case SettingKind::kNumbers:
        bytes += 4 + std::size_t{8} * row.field.last;
        break;
      case SettingKind::kMoreNumbers:
        bytes += std::size_t{8} * row.field.last;
        break;
      case SettingKind::kWholes:
        bytes += std::size_t{4} * row.field.last;
        break;
    }
  }
  return bytes;
}

/// @returns How many members these rows speak of.
template <std::size_t kRows>
constexpr std::size_t members_in(const SettingRow (&rows)[kRows]) noexcept {
  std::size_t members = 0;
  for (const SettingRow& row : rows) {
    const bool is_pair =
        row.field.kind == SettingKind::kNumberOrWord || row.field.kind == SettingKind::kNumbers;
    members += is_pair ? 2 : 1;
  }
  return members;
}

/// Stands for a member of any type.
struct AnyMember {
  template <typename T>
  constexpr operator T() const noexcept;  // Never called.
};

template <typename T, typename Indices, typename = void>
struct IsMadeOf : std::false_type {};
template <typename T, std::size_t... kIndices>
struct IsMadeOf<T, std::index_sequence<kIndices...>,
                std::void_t<decltype(T{(static_cast<void>(kIndices), AnyMember{})...})>>
    : std::true_type {};

/// @returns The number of members of a structure.
template <typename T, std::size_t kCount = 0>
constexpr std::size_t member_count() noexcept {
  if constexpr (IsMadeOf<T, std::make_index_sequence<kCount + 1>>::value) {
    return member_count<T, kCount + 1>();
  } else {
    return kCount;
  }
}

constexpr bool is_same_text(const char* a, const char* b) noexcept {
  while (*a != '\0' && *a == *b) {
    ++a;
    ++b;
  }
  return *a == *b;
}

/// @returns The index of the setting of that name; in a constant expression a name that no setting
/// has does not compile.
template <std::size_t kRows>
constexpr std::size_t row_of(const SettingRow (&rows)[kRows], const char* name) noexcept {
  std::size_t index = 0;
  while (!is_same_text(rows[index].field.name, name)) {
    ++index;
  }
  return index;
}

}  // namespace emax::app
