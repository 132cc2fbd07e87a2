// The commands that set something and answer what is set.
#include <array>
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
constexpr auto kNarrowed = narrowed_limits<count_narrowed(kSettingRows)>(kSettingRows);
constexpr auto kSweepNarrowed =
    narrowed_limits<count_narrowed(kSweepSettingRows)>(kSweepSettingRows);

/// A new value: a number, a byte, or both.
struct SettingValue {
  double number = 0.0;
  std::uint8_t byte = 0;
};

// A setting whose command is executed. It reads the value alone: a copy of all settings would be on
// the stack while text becomes a number, which takes most of it.
class SettingCall {
 public:
  /// @param[in] narrowed The limits of the commands that are narrower than their fields.
  /// @param[in] current  The structure with the value that is set.
  SettingCall(scpi::Call& call, const SettingCommand& command, const SettingField& field,
              const SettingLimits* narrowed, const void* current) noexcept
      : call_(call),
        command_(command),
        field_(field),
        limits_(command.narrowed > 0 ? narrowed[command.narrowed - 1]
                                     : SettingLimits{field.min, field.max}),
        current_(current) {}

  /// To what MINimum and MAXimum are, of a setting of the sweep. A number beyond is a conflict of
  /// settings, which has words.
  void narrow(const Instrument& i) noexcept {
    if (call_.has_word()) {
      i.narrow(command_.field, limits_);
    }
  }

  /// @returns True if there is a new value. A query is answered.
  bool take(double by_default, SettingValue& value) noexcept {
    value.number = number_in(field_, current_);
    switch (field_.kind) {
      case SettingKind::kNumber:
        return call_.setting(rule(by_default), value.number, value.number);
      case SettingKind::kWhole:
        return take_whole(by_default, value.number);
      case SettingKind::kSwitch:
        return take_switch(value.byte);
      case SettingKind::kChoice:
        return take_choice(value.byte);
      case SettingKind::kNumberOrWord:
        return take_number_or_word(value);
      case SettingKind::kNumbers:
      case SettingKind::kMoreNumbers:
      case SettingKind::kWholes:
        break;  // Lists have handlers of their own.
    }
    return false;
  }

 private:
  NumberRule rule(double by_default) const noexcept {
    return {limits_.min, limits_.max, by_default, command_.unit};
  }
  scpi::Words words() const noexcept { return {command_.words, command_.word_count}; }

  bool take_whole(double by_default, double& value) noexcept {
    const IntegerRule rule = {static_cast<std::int64_t>(limits_.min),
                              static_cast<std::int64_t>(limits_.max),
                              static_cast<std::int64_t>(by_default)};
    std::int64_t number = 0;
    if (!call_.integer_setting(rule, static_cast<std::int64_t>(value), number)) {
      return false;
    }
    value = static_cast<double>(number);
    return true;
  }

  bool take_switch(std::uint8_t& byte) noexcept {
    bool is_on = false;
    const bool is_new = call_.boolean_setting(member_at<bool>(current_, field_.offset), is_on);
    byte = is_on ? 1 : 0;
    return is_new;
  }

  bool take_choice(std::uint8_t& byte) noexcept {
    std::size_t index = 0;
    const std::size_t current = member_at<std::uint8_t>(current_, field_.offset);
    const bool is_new = call_.choice_setting(words(), current, index);
    byte = static_cast<std::uint8_t>(index);
    return is_new;
  }

  // The byte counts words, and the number as if it were one of them.
  bool take_number_or_word(SettingValue& value) noexcept {
    const std::size_t number_mode = field_.number_mode;
    const std::size_t mode = member_at<std::uint8_t>(current_, field_.beside);
    scpi::NumberOrWord given{value.number, command_.word_count};
    if (mode != number_mode) {
      given.word = mode < number_mode ? mode : mode - 1;
    }
    if (!call_.number_or_word_setting(rule(kNoDefault), words(), given, given)) {
      return false;
    }
    std::size_t byte = number_mode;
    if (given.word < command_.word_count) {
      byte = given.word < number_mode ? given.word : given.word + 1;
    }
    value = {given.number, static_cast<std::uint8_t>(byte)};
    return true;
  }

  scpi::Call& call_;
  const SettingCommand& command_;
  const SettingField& field_;
  SettingLimits limits_;
  const void* current_;
};

void store(const SettingField& field, const SettingValue& value, void* settings) noexcept {
  switch (field.kind) {
    case SettingKind::kNumberOrWord:
      member_at<std::uint8_t>(settings, field.beside) = value.byte;
      [[fallthrough]];
    case SettingKind::kNumber:
      member_at<double>(settings, field.offset) = value.number;
      return;
    case SettingKind::kWhole:
      member_at<std::uint32_t>(settings, field.offset) = static_cast<std::uint32_t>(value.number);
      return;
    case SettingKind::kSwitch:
    case SettingKind::kChoice:
      member_at<std::uint8_t>(settings, field.offset) = value.byte;
      return;
    case SettingKind::kNumbers:
    case SettingKind::kMoreNumbers:
    case SettingKind::kWholes:
      return;
  }
}

// These are out of line for the sake of the stack: each holds the settings of a sweep.
[[gnu::noinline]] double default_number(const Instrument& i, const SettingField& field) noexcept {
  const SweepSettings by_default = i.default_sweep();
  return number_in(field, &by_default);
}

struct ReferenceValue {
  double sensitivity = 0.0;
  double expanded_percent = 0.0;
};

[[gnu::noinline]] ReferenceValue default_reference(const Instrument& i) noexcept {
  const ReferenceCalibration reference = i.default_sweep().reference;
  return {reference.sensitivity[0], reference.expanded_percent};
}

[[gnu::noinline]] void take_reference(Instrument& i, scpi::Call& call,
                                      const ReferenceValue& value) noexcept {
  SweepSettings next = i.sweep_settings();
  next.reference.frequency_hz[0] = 0.0;
  next.reference.sensitivity[0] = value.sensitivity;
  next.reference.expanded_percent = value.expanded_percent;
  next.reference.count = 1;
  InstrumentCommands::take(i, call, next);
}

[[gnu::noinline]] void take_frequencies(Instrument& i, scpi::Call& call,
                                        const std::array<double, kMaxPoints>& frequency_hz,
                                        std::size_t count) noexcept {
  SweepSettings next = i.sweep_settings();
  next.frequency_hz = frequency_hz;
  next.frequency_count = count;
  InstrumentCommands::take(i, call, next);
}

[[gnu::noinline]] void take_table(Instrument& i, scpi::Call& call,
                                  const std::array<double, 2 * kMaxReferencePoints>& pairs,
                                  std::size_t count) noexcept {
  SweepSettings next = i.sweep_settings();
  for (std::size_t k = 0; k < count; ++k) {
    next.reference.frequency_hz[k] = pairs[2 * k];
    next.reference.sensitivity[k] = pairs[2 * k + 1];
  }
  next.reference.count = count;
  InstrumentCommands::take(i, call, next);
}

[[gnu::noinline]] void take_corrections(Instrument& i, scpi::Call& call,
                                        const LoopbackResults& found) noexcept {
  SweepSettings next = i.sweep_settings();
  next.ratio_correction = found.ratio;
  next.ratio_expanded_percent = found.ratio_percent;
  next.skew_s = found.skew_s;
  next.skew_expanded_s = found.skew_expanded_s;
  InstrumentCommands::take(i, call, next);
}

/// @param[in] uncertainty The new value of the next field; null if it keeps its own.
[[gnu::noinline]] void take_value(Instrument& i, scpi::Call& call, const SettingField* field,
                                  const SettingValue& value, const double* uncertainty) noexcept {
  SweepSettings next = i.sweep_settings();
  store(*field, value, &next);
  if (uncertainty != nullptr) {
    store(field[1], {*uncertainty, 0}, &next);
  }
  InstrumentCommands::take(i, call, next);
}

}  // namespace

void InstrumentCommands::take(Instrument& i, Call& call, const Settings& next) noexcept {
  report(i.take(next), call);
}

void InstrumentCommands::take(Instrument& i, Call& call, const SweepSettings& next) noexcept {
  report(i.take(next), call);
}

void InstrumentCommands::setting(Instrument& i, Call& call, std::size_t index) noexcept {
  const SettingCommand& command = kCommands[index];
  const SettingField& field = fields_of(i.settings())[command.field];
  if (field.kind == SettingKind::kWholes) {
    seed(i, call);
    return;
  }
  if (field.kind == SettingKind::kNumbers || field.kind == SettingKind::kMoreNumbers) {
    trend_times(i, call);
    return;
  }
  SettingValue value;
  if (!SettingCall(call, command, field, kNarrowed.data(), &i.settings())
           .take(number_in(field, &kDefaultSettings), value)) {
    return;
  }
  Settings next = i.settings();
  store(field, value, &next);
  // What is set already may be set again while it is in use, if it is a plain value.
  if (field.kind == SettingKind::kNumberOrWord || !is_same(field, &next, &i.settings())) {
    take(i, call, next);
  }
}

void InstrumentCommands::sweep_setting(Instrument& i, Call& call, std::size_t index) noexcept {
  const SettingCommand& command = kSweepCommands[index];
  // With the one behind it, which is its uncertainty where it has one.
  const SettingField* field = &fields_of(i.sweep_settings())[command.field];
  const bool has_two = command.next_unit != nullptr;
  double uncertainty = has_two ? number_in(field[1], &i.sweep_settings()) : 0.0;
  // MINimum and others are asked of the value alone.
  const bool answers_both = has_two && call.is_query() && !call.has_more();
  SettingValue value;
  SettingCall setting(call, command, *field, kSweepNarrowed.data(), &i.sweep_settings());
  setting.narrow(i);
  if (!setting.take(default_number(i, *field), value)) {
    if (answers_both) {
      call.answer().number(uncertainty);
    }
    return;
  }
  const bool is_given = has_two && call.has_more();
  if (is_given) {
    const NumberRule rule = {field[1].min, field[1].max, default_number(i, field[1]),
                             command.next_unit};
    if (!call.number(rule, uncertainty)) {
      return;
    }
  }
  take_value(i, call, field, value, is_given ? &uncertainty : nullptr);
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
    i.restart_random();
  }
}

void InstrumentCommands::reference(Instrument& i, Call& call) noexcept {
  const ReferenceCalibration& current = i.sweep_settings().reference;
  if (call.is_query()) {
    call.answer().number(current.sensitivity[0]).number(current.expanded_percent);
    return;
  }
  const ReferenceValue by_default = default_reference(i);
  ReferenceValue value = {0.0, current.expanded_percent};
  const NumberRule sensitivity = {ranges::kSmallest, ranges::kLargest, by_default.sensitivity,
                                  nullptr};
  const NumberRule percent = {0.0, ranges::kMaxPercent, by_default.expanded_percent,
                              scpi::kPercent};
  if (!call.number(sensitivity, value.sensitivity) ||
      (call.has_more() && !call.number(percent, value.expanded_percent))) {
    return;
  }
  take_reference(i, call, value);
}

void InstrumentCommands::reference_table(Instrument& i, Call& call) noexcept {
  const ReferenceCalibration& current = i.sweep_settings().reference;
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(current.frequency_hz[call.item()]);
    call.answer().number(current.sensitivity[call.item()]);
    return;
  }
  if (call.is_query()) {
    call.answer_items(current.count);
    return;
  }
  std::array<double, 2 * kMaxReferencePoints> pairs = {};
  std::size_t count = 0;
  if (!call.numbers({0.0, ranges::kLargest, kNoDefault, nullptr}, Span<double>(pairs), count)) {
    return;
  }
  if (count == 2 && pairs[0] == 0.0) {
    take_reference(i, call, {pairs[1], current.expanded_percent});
    return;
  }
  if (count % 2 != 0 || count < 4) {
    call.fail(ErrorCode::kMissingParameter,
              "2 to " EMAX_TEXT_OF(EMAX_MAX_REFERENCE_POINTS) " pairs of Hz and V/(m/s2)");
    return;
  }
  take_table(i, call, pairs, count / 2);
}

void InstrumentCommands::clear_reference_table(Instrument& i, Call& call) noexcept {
  const ReferenceCalibration& current = i.sweep_settings().reference;
  take_reference(i, call, {current.sensitivity[0], current.expanded_percent});
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
  std::array<double, kMaxPoints> frequency_hz = {};
  std::size_t count = 0;
  if (call.numbers(kFrequency, Span<double>(frequency_hz), count)) {
    take_frequencies(i, call, frequency_hz, count);
  }
}

void InstrumentCommands::default_frequencies(Instrument& i, Call& call) noexcept {
  const SweepSettings by_default = i.default_sweep();
  take_frequencies(i, call, by_default.frequency_hz, by_default.frequency_count);
}

void InstrumentCommands::loopback(Instrument& i, Call& call) noexcept {
  if (!i.provide_loopback(call)) {
    return;
  }
  const LoopbackResults& found = *i.sequencer().loopback();
  for (const double number :
       {found.latency_frames, found.reference_offset_v, found.device_offset_v, found.reference_gain,
        found.device_gain, found.ratio, found.skew_s, found.reference_noise_v, found.device_noise_v,
        found.distortion_percent}) {
    call.answer().number(number);
  }
  call.answer().integer(found.lost_blocks);
}

void InstrumentCommands::acquire_corrections(Instrument& i, Call& call) noexcept {
  const SweepSettings& current = i.sweep_settings();
  if (call.is_query()) {
    call.answer().number(current.ratio_correction).number(current.ratio_expanded_percent);
    call.answer().number(current.skew_s).number(current.skew_expanded_s);
    return;
  }
  if (call.stage() == Call::Stage::kStart) {
    // What a sweep uses is not changed behind it.
    take(i, call, current);
  }
  if (!call.failed() && i.provide_loopback(call)) {
    take_corrections(i, call, *i.sequencer().loopback());
  }
}

bool InstrumentCommands::take_slot(Instrument& i, Call& call, std::uint32_t& slot) noexcept {
  std::int64_t number = 0;
  if (!call.integer({0, kSavedSlots - 1, 0}, number)) {
    return false;
  }
  if (!i.has_store()) {
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
  const double percent = i.common_percent();
  const Status status = i.recall_settings(slot);
  if (status == Status::kNothingStored) {
    call.fail(ErrorCode::kDataCorruptOrStale, "empty or damaged slot: *SAV first");
    return;
  }
  if (status != Status::kOk) {
    call.fail(ErrorCode::kSaveRecallMemoryLost, "set everything anew, *SAV again");
    return;
  }
  // The points at hand are still those of before.
  const double recalled = i.common_percent();
  i.set_common_percent(percent);
  take_common(i, call, recalled);
}

}  // namespace emax::app
