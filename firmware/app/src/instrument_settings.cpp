// The commands that set something and answer what is set.
#include <limits>

#include "instrument_commands.hpp"

namespace emax::app {
namespace {

using scpi::IntegerRule;
using scpi::NumberRule;

constexpr double kNoDefault = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxPercent = 50.0;
constexpr std::int64_t kMaxSeed = 4294967295;
constexpr NumberRule kGain = {0.0, kMaxGain, kNoDefault, nullptr};
constexpr NumberRule kLimit = {kMinLimit_mps2, kMaxLimit_mps2, kNoDefault,
                               scpi::kMetrePerSecondSquared};
constexpr NumberRule kFrequency = {0.1, 1e9, kNoDefault, scpi::kHertz};
constexpr IntegerRule kCycles = {1, 1000, 3};
constexpr NumberRule kSensitivity = {1e-9, 1e9, 0.1, nullptr};
constexpr NumberRule kExpandedPercent = {0.0, kMaxPercent, 0.5, scpi::kPercent};
constexpr const char* kGainWords[] = {"AUTO", "TRACk"};
constexpr const char* kLimitWords[] = {"AUTO"};

}  // namespace

void InstrumentCommands::take(Instrument& i, Call& call, const Settings& next,
                              Change change) noexcept {
  if (const Refusal refusal = i.conflict_with(change)) {
    call.fail(refusal.code, refusal.words);
    return;
  }
  const SettingsError error = check(next);
  if (error.setting != nullptr) {
    call.fail(ErrorCode::kSettingsConflict, error.expectation);
    return;
  }
  const bool has_other_numbers =
      next.seed != i.settings_.seed || next.generator != i.settings_.generator;
  i.settings_ = next;
  i.invalidate(change);
  if (has_other_numbers) {
    i.seed_generator();
  }
}

void InstrumentCommands::take(Instrument& i, Call& call, const SweepSettings& next) noexcept {
  if (const Refusal refusal = i.conflict_with(Change::kSweep)) {
    call.fail(refusal.code, refusal.words);
    return;
  }
  const SettingsError error = check(next, i.ports_.analog.format());
  if (error.setting != nullptr) {
    call.fail(ErrorCode::kSettingsConflict, error.expectation);
    return;
  }
  i.sweep_settings_ = next;
}

void InstrumentCommands::sweep_cycles(Instrument& i, Call& call) noexcept {
  std::int64_t value = 0;
  if (call.integer_setting(kCycles, i.sweep_settings_.cycles, value)) {
    SweepSettings next = i.sweep_settings_;
    next.cycles = static_cast<std::uint32_t>(value);
    take(i, call, next);
  }
}

void InstrumentCommands::filter_gain(Instrument& i, Call& call) noexcept {
  const Settings& current = i.settings_;
  if (call.is_query()) {
    if (current.gain_mode == GainMode::kFixed) {
      call.answer().number(current.gain);
    } else {
      const bool tracks = current.gain_mode == GainMode::kTrack;
      call.answer().short_form(kGainWords[tracks ? 1 : 0]);
    }
    return;
  }
  scpi::NumberOrWord given;
  if (!call.number_or_word(kGain, scpi::Words(kGainWords), given)) {
    return;
  }
  constexpr GainMode kModes[] = {GainMode::kAuto, GainMode::kTrack, GainMode::kFixed};
  Settings next = current;
  next.gain_mode = kModes[given.word];
  next.gain = given.number;
  take(i, call, next, Change::kEnergy);
}

void InstrumentCommands::energy_limit(Instrument& i, Call& call) noexcept {
  const Settings& current = i.settings_;
  if (call.is_query()) {
    if (current.limit_is_auto) {
      call.answer().word(kLimitWords[0]);
    } else {
      call.answer().number(current.limit_mps2);
    }
    return;
  }
  scpi::NumberOrWord given;
  if (call.number_or_word(kLimit, scpi::Words(kLimitWords), given)) {
    Settings next = current;
    next.limit_is_auto = given.word == 0;
    next.limit_mps2 = given.number;
    take(i, call, next, Change::kEnergy);
  }
}

void InstrumentCommands::seed(Instrument& i, Call& call) noexcept {
  if (call.is_query()) {
    for (const std::uint32_t part : i.settings_.seed) {
      call.answer().integer(part);
    }
    return;
  }
  Settings next = i.settings_;
  for (std::uint32_t& part : next.seed) {
    std::int64_t value = 0;
    if (!call.integer({1, kMaxSeed, 1}, value)) {
      return;
    }
    part = static_cast<std::uint32_t>(value);
  }
  take(i, call, next, Change::kTrials);
  if (!call.failed()) {
    i.seed_generator();
  }
}

void InstrumentCommands::reference(Instrument& i, Call& call) noexcept {
  const ReferenceCalibration& current = i.sweep_settings_.reference;
  if (call.is_query()) {
    call.answer().number(current.sensitivity[0]).number(current.expanded_percent);
    return;
  }
  SweepSettings next = i.sweep_settings_;
  if (!call.number(kSensitivity, next.reference.sensitivity[0]) ||
      (call.has_more() && !call.number(kExpandedPercent, next.reference.expanded_percent))) {
    return;
  }
  next.reference.count = 1;
  take(i, call, next);
}

void InstrumentCommands::sweep_frequencies(Instrument& i, Call& call) noexcept {
  const SweepSettings& current = i.sweep_settings_;
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
  if (const Refusal refusal = i.conflict_with(Change::kSweep)) {
    call.fail(refusal.code, refusal.words);
    return;
  }
  const SweepSettings by_default = i.default_sweep();
  i.sweep_settings_.frequency_hz = by_default.frequency_hz;
  i.sweep_settings_.frequency_count = by_default.frequency_count;
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
    call.fail(ErrorCode::kDataCorruptOrStale, "empty slot: *SAV first");
  } else if (status != Status::kOk) {
    call.fail(ErrorCode::kSaveRecallMemoryLost, "set everything anew, *SAV again");
  }
}

}  // namespace emax::app
