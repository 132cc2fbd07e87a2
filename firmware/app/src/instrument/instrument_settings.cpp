// The commands that set something and answer what is set.
#include <limits>

#include "emax/app/settings/setting_field.hpp"

#include "instrument_commands.hpp"
#include "setting_commands.hpp"

namespace emax::app {
namespace {

using scpi::IntegerRule;
using scpi::NumberRule;

constexpr double kNoDefault = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMaxSeed = 4294967295;
constexpr NumberRule kFrequency = {0.1, 1e9, kNoDefault, scpi::kHertz};
constexpr auto kCommands = setting_commands<count_commands(kSettingRows)>(kSettingRows);
constexpr auto kSweepCommands =
    setting_commands<count_commands(kSweepSettingRows)>(kSweepSettingRows);

// A setting whose command is executed, in a copy of its structure.
class SettingCall {
 public:
  SettingCall(scpi::Call& call, const SettingCommand& command, const SettingField& field,
              double by_default, void* next) noexcept
      : call_(call), command_(command), field_(field), by_default_(by_default), next_(next) {}

  /// @returns True if the copy holds what was given.
  bool take() noexcept {
    switch (field_.kind) {
      case SettingKind::kNumber:
        return take_number();
      case SettingKind::kWhole:
        return take_whole();
      case SettingKind::kSwitch: {
        bool& value = member_at<bool>(next_, field_.offset);
        return call_.boolean_setting(value, value);
      }
      case SettingKind::kChoice:
        return take_choice();
      case SettingKind::kNumberOrWord:
        return take_number_or_word();
      case SettingKind::kNumbers:
      case SettingKind::kMoreNumbers:
      case SettingKind::kWholes:
        break;  // Lists have handlers of their own.
    }
    return false;
  }

 private:
  NumberRule rule(double by_default) const noexcept {
    return {command_.min, command_.max, by_default, command_.unit};
  }
  scpi::Words words() const noexcept { return {command_.words, command_.word_count}; }

  bool take_number() noexcept {
    double& value = member_at<double>(next_, field_.offset);
    return call_.setting(rule(by_default_), value, value);
  }

  bool take_whole() noexcept {
    std::uint32_t& value = member_at<std::uint32_t>(next_, field_.offset);
    const IntegerRule rule = {static_cast<std::int64_t>(command_.min),
                              static_cast<std::int64_t>(command_.max),
                              static_cast<std::int64_t>(by_default_)};
    std::int64_t number = 0;
    if (!call_.integer_setting(rule, value, number)) {
      return false;
    }
    value = static_cast<std::uint32_t>(number);
    return true;
  }

  bool take_choice() noexcept {
    std::uint8_t& value = member_at<std::uint8_t>(next_, field_.offset);
    std::size_t index = 0;
    if (!call_.choice_setting(words(), value, index)) {
      return false;
    }
    value = static_cast<std::uint8_t>(index);
    return true;
  }

  // The byte counts words, and the number as if it were one of them.
  bool take_number_or_word() noexcept {
    double& number = member_at<double>(next_, field_.offset);
    std::uint8_t& mode = member_at<std::uint8_t>(next_, field_.beside);
    const std::uint8_t number_mode = field_.number_mode;
    std::size_t word = command_.word_count;
    if (mode != number_mode) {
      word = mode < number_mode ? mode : mode - std::size_t{1};
    }
    scpi::NumberOrWord value{number, word};
    if (!call_.number_or_word_setting(rule(kNoDefault), words(), value, value)) {
      return false;
    }
    number = value.number;
    mode = number_mode;
    if (value.word < command_.word_count) {
      mode = static_cast<std::uint8_t>(value.word < number_mode ? value.word : value.word + 1);
    }
    return true;
  }

  scpi::Call& call_;
  const SettingCommand& command_;
  const SettingField& field_;
  double by_default_;
  void* next_;
};

}  // namespace

Instrument::Refusal Instrument::take(const Settings& next) noexcept {
  if (const Refusal refusal = conflict_with(Change::kEnergy)) {
    return refusal;
  }
  const SettingsError error = check(next);
  if (error.setting != nullptr) {
    return {scpi::ErrorCode::kSettingsConflict, error.expectation, error.setting};
  }
  const bool has_other_numbers = !is_same_random(next, settings_);
  if (!is_same_energy(next, settings_)) {
    invalidate(Change::kEnergy);
  }
  if (!is_same_trials(next, settings_)) {
    invalidate(Change::kTrials);
  }
  if (!is_same_trend(next, settings_)) {
    invalidate(Change::kTrend);
  }
  settings_ = next;
  if (has_other_numbers) {
    seed_generator();
  }
  return {};
}

Instrument::Refusal Instrument::take(const SweepSettings& next) noexcept {
  if (const Refusal refusal = conflict_with(Change::kSweep)) {
    return refusal;
  }
  const SettingsError error = check(next, ports_.analog.format());
  if (error.setting != nullptr) {
    return {scpi::ErrorCode::kSettingsConflict, error.expectation, error.setting};
  }
  sweep_settings_ = next;
  return {};
}

void InstrumentCommands::take(Instrument& i, Call& call, const Settings& next) noexcept {
  if (const Refusal refusal = i.take(next)) {
    call.fail(refusal.code, refusal.words, refusal.subject);
  }
}

void InstrumentCommands::take(Instrument& i, Call& call, const SweepSettings& next) noexcept {
  if (const Refusal refusal = i.take(next)) {
    call.fail(refusal.code, refusal.words, refusal.subject);
  }
}

void InstrumentCommands::setting(Instrument& i, Call& call, std::size_t index) noexcept {
  const SettingCommand& command = kCommands[index];
  const SettingField& field = fields_of(i.settings())[command.field];
  if (field.kind == SettingKind::kWholes) {
    seed(i, call);
    return;
  }
  Settings next = i.settings();
  const double by_default = number_in(field, &kDefaultSettings);
  if (!SettingCall(call, command, field, by_default, &next).take()) {
    return;
  }
  // What is set already may be set again while it is in use, if it is a plain value.
  if (field.kind == SettingKind::kNumberOrWord || !is_same(field, &next, &i.settings())) {
    take(i, call, next);
  }
}

void InstrumentCommands::sweep_setting(Instrument& i, Call& call, std::size_t index) noexcept {
  const SettingCommand& command = kSweepCommands[index];
  SweepSettings next = i.default_sweep();
  const SettingField& field = fields_of(next)[command.field];
  const double by_default = number_in(field, &next);
  next = i.sweep_settings();
  if (SettingCall(call, command, field, by_default, &next).take()) {
    take(i, call, next);
  }
}

void InstrumentCommands::seed(Instrument& i, Call& call) noexcept {
  if (call.is_query()) {
    for (const std::uint32_t part : i.settings().seed) {
      call.answer().integer(part);
    }
    return;
  }
  Settings next = i.settings();
  for (std::uint32_t& part : next.seed) {
    std::int64_t value = 0;
    if (!call.integer({1, kMaxSeed, 1}, value)) {
      return;
    }
    part = static_cast<std::uint32_t>(value);
  }
  take(i, call, next);
  if (!call.failed()) {
    i.seed_generator();
  }
}

void InstrumentCommands::reference(Instrument& i, Call& call) noexcept {
  const ReferenceCalibration& current = i.sweep_settings().reference;
  if (call.is_query()) {
    call.answer().number(current.sensitivity[0]).number(current.expanded_percent);
    return;
  }
  SweepSettings next = i.default_sweep();
  const NumberRule sensitivity = {kSmallest, kLargest, next.reference.sensitivity[0], nullptr};
  const NumberRule percent = {0.0, kMaxPercent, next.reference.expanded_percent, scpi::kPercent};
  next = i.sweep_settings();
  if (!call.number(sensitivity, next.reference.sensitivity[0]) ||
      (call.has_more() && !call.number(percent, next.reference.expanded_percent))) {
    return;
  }
  next.reference.count = 1;
  take(i, call, next);
}

void InstrumentCommands::sweep_frequencies(Instrument& i, Call& call) noexcept {
  const SweepSettings& current = i.sweep_settings();
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(current.frequency_hz[call.item()]);
    return;
  }
  if (call.is_query()) {
    call.answer_items(current.frequency_count);
    return;
  }
  SweepSettings next = current;
  if (call.numbers(kFrequency, Span<double>(next.frequency_hz), next.frequency_count)) {
    take(i, call, next);
  }
}

void InstrumentCommands::default_frequencies(Instrument& i, Call& call) noexcept {
  const SweepSettings by_default = i.default_sweep();
  SweepSettings next = i.sweep_settings();
  next.frequency_hz = by_default.frequency_hz;
  next.frequency_count = by_default.frequency_count;
  take(i, call, next);
}

bool InstrumentCommands::take_slot(Instrument& i, Call& call, std::uint32_t& slot) noexcept {
  std::int64_t number = 0;
  if (!call.integer({0, kSavedSlots - 1, 0}, number)) {
    return false;
  }
  if (i.ports_.store == nullptr) {
    call.fail(ErrorCode::kMemoryError, "this board has no store");
    return false;
  }
  slot = static_cast<std::uint32_t>(number);
  return true;
}

void InstrumentCommands::save(Instrument& i, Call& call) noexcept {
  std::uint32_t slot = 0;
  if (!take_slot(i, call, slot)) {
    return;
  }
  if (i.is_working()) {
    call.wait();  // For the memory.
    return;
  }
  if (i.save_settings(slot) != Status::kOk) {
    call.fail(ErrorCode::kMemoryError, "the store refuses: another slot");
  }
}

void InstrumentCommands::recall(Instrument& i, Call& call) noexcept {
  std::uint32_t slot = 0;
  if (!take_slot(i, call, slot)) {
    return;
  }
  if (i.is_working()) {
    call.fail(ErrorCode::kSettingsConflict, "running: ABOR or *WAI first");
    return;
  }
  const Status status = i.recall_settings(slot);
  if (status == Status::kNothingStored) {
    call.fail(ErrorCode::kDataCorruptOrStale, "empty or damaged slot: *SAV first");
  } else if (status != Status::kOk) {
    call.fail(ErrorCode::kSaveRecallMemoryLost, "set everything anew, *SAV again");
  }
}

}  // namespace emax::app
