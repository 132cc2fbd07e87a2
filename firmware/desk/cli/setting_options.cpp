// The options of settings, made from their rows.
#include "desk/cli/setting_options.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"

#include "desk/cli/value_text.hpp"

namespace emax::desk {

namespace {

using app::member_at;
using app::SettingField;
using app::SettingGroup;
using app::SettingKind;
using app::SettingRow;

// What stands for a number among words: "auto|NUMBER".
constexpr std::string_view kNumber = "NUMBER";

const char* heading_of(SettingGroup group) {
  switch (group) {
    case SettingGroup::kDrive:
    case SettingGroup::kRest:
    case SettingGroup::kRepeats:
    case SettingGroup::kChain:
      return kBenchHeading;
    case SettingGroup::kFilter:
      return "The reference filter, a Butterworth low-pass";
    case SettingGroup::kSignal:
      return "The signal and its energy";
    case SettingGroup::kTrials:
    case SettingGroup::kCoverage:
    case SettingGroup::kRandom:
      return "Monte Carlo";
    case SettingGroup::kTrend:
      return "The energy over the length of the signal";
  }
  return "";
}

// The words that may be given, without what stands for a number: in the order of the console's.
std::vector<std::string_view> words_of(const SettingRow& row) {
  std::vector<std::string_view> words = alternatives(row.option.value);
  words.erase(std::remove(words.begin(), words.end(), kNumber), words.end());
  return words;
}

// The byte for a word: those of kNumberOrWord leave one out for the number.
std::uint8_t byte_of(const SettingField& field, std::size_t word) {
  const bool is_behind = field.kind == SettingKind::kNumberOrWord && word >= field.number_mode;
  return static_cast<std::uint8_t>(word + (is_behind ? 1 : 0));
}

// False for what is none of the words.
bool take_word(const SettingRow& row, std::string_view text, std::uint8_t& byte) {
  const std::vector<std::string_view> words = words_of(row);
  const auto found = std::find(words.begin(), words.end(), text);
  if (found == words.end()) {
    return false;
  }
  byte = byte_of(row.field, static_cast<std::size_t>(found - words.begin()));
  return true;
}

// A number, and perhaps behind a comma that of the next field.
bool take_pair(const SettingField& field, const SettingField& next, std::string_view text,
               void* settings) {
  const Numbers list = take_list(text);
  if (!list.valid || list.count < 1 || list.count > 2) {
    return false;
  }
  member_at<double>(settings, field.offset) = list.values[0];
  if (list.count == 2) {
    member_at<double>(settings, next.offset) = list.values[1];
  }
  return true;
}

bool take_setting(const SettingRow& row, std::string_view text, void* settings) {
  const SettingField& field = row.field;
  if (row.command.next_unit != nullptr) {
    return take_pair(field, (&row)[1].field, text, settings);
  }
  switch (field.kind) {
    case SettingKind::kNumber:
      return take_number(text, member_at<double>(settings, field.offset));
    case SettingKind::kWhole:
      return take_integer(text, member_at<std::uint32_t>(settings, field.offset));
    case SettingKind::kSwitch:
      return member_at<bool>(settings, field.offset) = true;
    case SettingKind::kChoice:
      return take_word(row, text, member_at<std::uint8_t>(settings, field.offset));
    case SettingKind::kNumberOrWord:
      if (take_word(row, text, member_at<std::uint8_t>(settings, field.beside))) {
        return true;
      }
      member_at<std::uint8_t>(settings, field.beside) = field.number_mode;
      return take_number(text, member_at<double>(settings, field.offset));
    case SettingKind::kNumbers:
    case SettingKind::kMoreNumbers:
    case SettingKind::kWholes:
      break;
  }
  return false;
}

std::string word_of(const SettingRow& row, std::uint8_t byte) {
  const std::vector<std::string_view> words = words_of(row);
  for (std::size_t word = 0; word < words.size(); ++word) {
    if (byte_of(row.field, word) == byte) {
      return std::string(words[word]);
    }
  }
  return "";
}

std::string default_text(const SettingRow& row, const void* defaults) {
  const SettingField& field = row.field;
  if (row.option.by_default != nullptr) {
    return row.option.by_default;
  }
  switch (field.kind) {
    case SettingKind::kNumber:
    case SettingKind::kWhole:
      return shortest_text(number_in(field, defaults));
    case SettingKind::kChoice:
      return word_of(row, member_at<std::uint8_t>(defaults, field.offset));
    case SettingKind::kNumberOrWord: {
      const std::string word = word_of(row, member_at<std::uint8_t>(defaults, field.beside));
      return word.empty() ? shortest_text(number_in(field, defaults)) : word;
    }
    case SettingKind::kSwitch:
    case SettingKind::kNumbers:
    case SettingKind::kMoreNumbers:
    case SettingKind::kWholes:
      break;
  }
  return "";
}

std::string or_empty(const char* text) { return text != nullptr ? text : ""; }

template <std::size_t kRows>
std::vector<Option> options_of(const SettingRow (&rows)[kRows], const void* defaults,
                               void* settings, bool is_for_bench) {
  std::vector<Option> options;
  for (const SettingRow& row : rows) {
    if (row.option.name == nullptr) {
      continue;
    }
    Option option;
    option.name = row.option.name;
    option.heading = heading_of(row.group);
    option.value = or_empty(row.option.value);
    option.by_default = default_text(row, defaults);
    option.expectation = or_empty(row.option.expectation != nullptr ? row.option.expectation
                                                                    : row.field.expectation);
    option.help = row.option.help;
    option.take = [&row, settings](std::string_view text) {
      return take_setting(row, text, settings);
    };
    option.is_for_bench = is_for_bench;
    options.push_back(option);
  }
  return options;
}

// An uncertainty is given behind its value, by the option of the row before it.
template <std::size_t kRows>
const char* option_in(const SettingRow (&rows)[kRows], std::string_view setting) noexcept {
  const char* before = nullptr;
  for (const SettingRow& row : rows) {
    const char* option = row.option.name != nullptr ? row.option.name : before;
    if (setting == row.field.name && option != nullptr) {
      return option;
    }
    before = row.command.next_unit != nullptr ? row.option.name : nullptr;
  }
  return nullptr;
}

}  // namespace

std::vector<Option> setting_options(app::Settings& settings) {
  return options_of(app::kSettingRows, &app::kDefaultSettings, &settings, false);
}

std::vector<Option> sweep_setting_options(app::SweepSettings& settings) {
  const app::SweepSettings defaults = app::default_sweep_settings();
  return options_of(app::kSweepSettingRows, &defaults, &settings, true);
}

std::string_view option_of_setting(std::string_view setting) noexcept {
  const char* option = option_in(app::kSettingRows, setting);
  option = option != nullptr ? option : option_in(app::kSweepSettingRows, setting);
  return option != nullptr ? option : setting;
}

}  // namespace emax::desk
