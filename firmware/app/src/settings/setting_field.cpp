// The tables of settings as boards keep them, and what can be done with any of their fields.
#include "emax/app/settings/setting_field.hpp"

#include <array>

#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"

namespace emax::app {
namespace {

template <std::size_t kRows>
constexpr std::array<SettingField, kRows> fields_in(const SettingRow (&rows)[kRows]) noexcept {
  std::array<SettingField, kRows> fields;
  for (std::size_t i = 0; i < kRows; ++i) {
    fields[i] = rows[i].field;
  }
  return fields;
}

constexpr auto kFields = fields_in(kSettingRows);
constexpr auto kSweepFields = fields_in(kSweepSettingRows);

bool is_same_list(const SettingField& field, const void* a, const void* b) noexcept {
  const auto count = member_at<std::size_t>(a, field.beside);
  if (count != member_at<std::size_t>(b, field.beside) || count > field.last) {
    return false;
  }
  const double* ones = &member_at<double>(a, field.offset);
  const double* others = &member_at<double>(b, field.offset);
  for (std::size_t i = 0; i < count; ++i) {
    if (ones[i] != others[i]) {
      return false;
    }
  }
  return true;
}

bool is_same_wholes(const SettingField& field, const void* a, const void* b) noexcept {
  const std::uint32_t* ones = &member_at<std::uint32_t>(a, field.offset);
  const std::uint32_t* others = &member_at<std::uint32_t>(b, field.offset);
  for (std::size_t i = 0; i < field.last; ++i) {
    if (ones[i] != others[i]) {
      return false;
    }
  }
  return true;
}

template <typename T>
bool is_same_member(const void* a, const void* b, std::size_t offset) noexcept {
  return member_at<T>(a, offset) == member_at<T>(b, offset);
}

}  // namespace

Span<const SettingField> fields_of(const Settings& /*settings*/) noexcept { return kFields; }
Span<const SettingField> fields_of(const SweepSettings& /*settings*/) noexcept {
  return kSweepFields;
}

double number_in(const SettingField& field, const void* settings) noexcept {
  if (field.kind == SettingKind::kWhole) {
    return member_at<std::uint32_t>(settings, field.offset);  // Below 0 it is far too large.
  }
  const bool is_number =
      field.kind == SettingKind::kNumber || field.kind == SettingKind::kNumberOrWord;
  return is_number ? member_at<double>(settings, field.offset) : 0.0;
}

bool is_in_range(const SettingField& field, const void* settings) noexcept {
  const bool is_word = field.kind == SettingKind::kNumberOrWord &&
                       member_at<std::uint8_t>(settings, field.beside) != field.number_mode;
  // A setting without a range has one from 0 to 0.
  const double value = number_in(field, settings);
  return is_word || (value >= field.min && value <= field.max);
}

bool is_same(const SettingField& field, const void* a, const void* b) noexcept {
  switch (field.kind) {
    case SettingKind::kNumber:
      return is_same_member<double>(a, b, field.offset);
    case SettingKind::kWhole:
      return is_same_member<std::uint32_t>(a, b, field.offset);
    case SettingKind::kSwitch:
    case SettingKind::kChoice:
      return is_same_member<std::uint8_t>(a, b, field.offset);
    case SettingKind::kNumberOrWord:
      return is_same_member<std::uint8_t>(a, b, field.beside) &&
             (member_at<std::uint8_t>(a, field.beside) != field.number_mode ||
              is_same_member<double>(a, b, field.offset));
    case SettingKind::kNumbers:
    case SettingKind::kMoreNumbers:
      return is_same_list(field, a, b);
    case SettingKind::kWholes:
      return is_same_wholes(field, a, b);
  }
  return false;
}

}  // namespace emax::app
