// The commands that set something and answer what is set.
#include <array>
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
constexpr std::int64_t kMaxCycles = 1000;
constexpr const char* kGainWords[] = {"AUTO", "TRACk"};
constexpr const char* kLimitWords[] = {"AUTO"};

}  // namespace

void InstrumentCommands::take(Instrument& i, Call& call, const Settings& next) noexcept {
  report(i.take(next), call);
}

void InstrumentCommands::take(Instrument& i, Call& call, const SweepSettings& next) noexcept {
  report(i.take(next), call);
}

void InstrumentCommands::sweep_number(Instrument& i, Call& call, double SweepSettings::*member,
                                      NumberRule rule) noexcept {
  SweepSettings next = i.default_sweep();
  rule.by_default = next.*member;
  next = i.sweep_settings();
  if (call.setting(rule, next.*member, next.*member)) {
    take(i, call, next);
  }
}

void InstrumentCommands::sweep_cycles(Instrument& i, Call& call) noexcept {
  SweepSettings next = i.default_sweep();
  const IntegerRule rule = {1, kMaxCycles, next.cycles};
  next = i.sweep_settings();
  std::int64_t value = 0;
  if (call.integer_setting(rule, next.cycles, value)) {
    next.cycles = static_cast<std::uint32_t>(value);
    take(i, call, next);
  }
}

void InstrumentCommands::filter_gain(Instrument& i, Call& call) noexcept {
  constexpr GainMode kModes[] = {GainMode::kAuto, GainMode::kTrack, GainMode::kFixed};
  const GainMode mode = i.settings().gain_mode;
  const std::size_t word = mode == GainMode::kAuto ? 0 : mode == GainMode::kTrack ? 1 : 2;
  scpi::NumberOrWord gain{i.settings().gain, word};
  if (call.number_or_word_setting(kGain, scpi::Words(kGainWords), gain, gain)) {
    Settings next = i.settings();
    next.gain_mode = kModes[gain.word];
    next.gain = gain.number;
    take(i, call, next);
  }
}

void InstrumentCommands::energy_limit(Instrument& i, Call& call) noexcept {
  scpi::NumberOrWord limit{i.settings().limit_mps2, i.settings().limit_is_auto ? 0U : 1U};
  if (call.number_or_word_setting(kLimit, scpi::Words(kLimitWords), limit, limit)) {
    Settings next = i.settings();
    next.limit_is_auto = limit.word == 0;
    next.limit_mps2 = limit.number;
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
    i.restart_random();
  }
}

void InstrumentCommands::reference(Instrument& i, Call& call) noexcept {
  const ReferenceCalibration& current = i.sweep_settings().reference;
  if (call.is_query()) {
    call.answer().number(current.sensitivity[0]).number(current.expanded_percent);
    return;
  }
  SweepSettings next = i.default_sweep();
  const NumberRule sensitivity = {1e-9, 1e9, next.reference.sensitivity[0], nullptr};
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
  SweepSettings next = i.default_sweep();
  const std::array<double, kMaxPoints> frequency_hz = next.frequency_hz;
  const std::size_t count = next.frequency_count;
  next = i.sweep_settings();
  next.frequency_hz = frequency_hz;
  next.frequency_count = count;
  take(i, call, next);
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
  const Status status = i.recall_settings(slot);
  if (status == Status::kNothingStored) {
    call.fail(ErrorCode::kDataCorruptOrStale, "empty or damaged slot: *SAV first");
  } else if (status != Status::kOk) {
    call.fail(ErrorCode::kSaveRecallMemoryLost, "set everything anew, *SAV again");
  }
}

}  // namespace emax::app
