// The commands of settings, made from their rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "emax/app/scpi/command.hpp"
#include "emax/app/settings/setting_row.hpp"
#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"

#include "instrument_commands.hpp"

namespace emax::app {

/// What the handler of a setting's command goes by.
struct SettingCommand {
  const char* unit = nullptr;
  const char* next_unit = nullptr;  ///< As in `CommandText`.
  const char* const* words = nullptr;
  std::uint8_t word_count = 0;
  std::uint8_t field = 0;  ///< Its place among the fields of its structure.
  /// Where the console is narrower than the field: the place of its limits, from 1.
  std::uint8_t narrowed = 0;
};

constexpr bool is_narrowed(const SettingRow& row) noexcept {
  return row.command.header != nullptr &&
         (row.command.min != row.field.min || row.command.max != row.field.max);
}

template <std::size_t kRows>
constexpr std::size_t count_narrowed(const SettingRow (&rows)[kRows]) noexcept {
  std::size_t count = 0;
  for (const SettingRow& row : rows) {
    count += is_narrowed(row) ? 1U : 0U;
  }
  return count;
}

/// The limits of the rows whose console is narrower, in their order.
template <std::size_t kCount, std::size_t kRows>
constexpr std::array<SettingLimits, kCount> narrowed_limits(
    const SettingRow (&rows)[kRows]) noexcept {
  std::array<SettingLimits, kCount> limits;
  std::size_t count = 0;
  for (const SettingRow& row : rows) {
    if (is_narrowed(row)) {
      limits[count].min = row.command.min;
      limits[count].max = row.command.max;
      ++count;
    }
  }
  return limits;
}

template <std::size_t kRows>
constexpr std::size_t count_commands(const SettingRow (&rows)[kRows]) noexcept {
  std::size_t count = 0;
  for (const SettingRow& row : rows) {
    count += row.command.header != nullptr ? 1 : 0;
  }
  return count;
}

/// The handler's part of all rows that are commands, in their order.
template <std::size_t kCommands, std::size_t kRows>
constexpr std::array<SettingCommand, kCommands> setting_commands(
    const SettingRow (&rows)[kRows]) noexcept {
  std::array<SettingCommand, kCommands> commands;
  std::size_t count = 0;
  std::uint8_t narrowed = 0;
  for (std::size_t i = 0; i < kRows; ++i) {
    const CommandText& text = rows[i].command;
    if (text.header != nullptr) {
      SettingCommand& command = commands[count++];
      narrowed = static_cast<std::uint8_t>(narrowed + (is_narrowed(rows[i]) ? 1 : 0));
      command.narrowed = is_narrowed(rows[i]) ? narrowed : std::uint8_t{0};
      command.unit = text.unit;
      command.next_unit = text.next_unit;
      command.words = rows[i].words;
      command.word_count = static_cast<std::uint8_t>(rows[i].word_count);
      command.field = static_cast<std::uint8_t>(i);
    }
  }
  return commands;
}

/// Which settings a table's rows belong to.
enum class SettingsOf : std::uint8_t { kEvaluation, kSweep };

/// One handler for each of the commands.
template <SettingsOf kOf, std::size_t... kIndices>
constexpr auto setting_handlers(std::index_sequence<kIndices...> /*indices*/) noexcept {
  using Handler = void (*)(Instrument&, scpi::Call&);
  using C = InstrumentCommands;
  constexpr bool kIsSweep = kOf == SettingsOf::kSweep;
  return std::array<Handler, sizeof...(kIndices)>{
      (kIsSweep ? Handler{C::sweep_setting<kIndices>} : Handler{C::setting<kIndices>})...};
}

/// Numbers have limits that a query may ask for.
constexpr std::uint8_t flags_of(SettingKind kind) noexcept {
  const bool is_number = kind == SettingKind::kNumber || kind == SettingKind::kWhole ||
                         kind == SettingKind::kNumberOrWord;
  return static_cast<std::uint8_t>((is_number ? scpi::kQueryLimits : scpi::kPlain) | kLearned);
}

/// A command table under construction: parts in the order in which they are listed.
template <std::size_t kRoom>
struct CommandTable {
  scpi::Command<Instrument> rows[kRoom] = {};
  std::size_t count = 0;

  template <std::size_t kPart>
  constexpr void add(const scpi::Command<Instrument> (&part)[kPart]) noexcept {
    for (const scpi::Command<Instrument>& row : part) {
      rows[count++] = row;
    }
  }

  /// Adds the commands of one group of settings.
  template <SettingsOf kOf, std::size_t kRows>
  constexpr void add_settings(const SettingRow (&table)[kRows], SettingGroup group) noexcept {
    constexpr std::size_t kCommands = kOf == SettingsOf::kSweep ? count_commands(kSweepSettingRows)
                                                                : count_commands(kSettingRows);
    constexpr auto kHandlers = setting_handlers<kOf>(std::make_index_sequence<kCommands>());
    std::size_t command = 0;
    for (const SettingRow& row : table) {
      const CommandText& text = row.command;
      if (text.header != nullptr && row.group == group) {
        rows[count++] = {text.header,      scpi::Forms::kSetAndQuery, text.parameters,
                         text.description, flags_of(row.field.kind),  kHandlers[command]};
      }
      command += text.header != nullptr ? 1 : 0;
    }
  }
};

}  // namespace emax::app
