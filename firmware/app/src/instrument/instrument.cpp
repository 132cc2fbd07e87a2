// The loop of the instrument: bytes, messages, and one step of what runs.
#include "emax/app/instrument/instrument.hpp"

namespace emax::app {
namespace {

// A peer that neither reads nor lets go of its messages is given this long.
constexpr std::uint64_t kDeadlockPatience = 1'000'000;  // In microseconds.
// Items of a long answer that are made in one call.
constexpr int kItemsPerPoll = 16;
constexpr std::size_t kBytesPerPoll = 128;
// Control-C.
constexpr char kDeviceClear = '\x03';

}  // namespace

Instrument::Instrument(const Ports& ports, const Board& board) noexcept
    : ports_(ports), board_(board) {}

void Instrument::start() noexcept {
  session_.power_on();
  reset();
  restore_identification();
  if (ports_.watchdog == nullptr) {
    return;
  }
  if (ports_.watchdog->caused_reset()) {
    session_.status().report(kWatchdogReset.code, kWatchdogReset.words);
    sequencer_.expect_swinging();
  }
  (void)ports_.watchdog->start();
  if (ports_.watchdog->failed()) {
    session_.status().report(kNoWatchdog.code, kNoWatchdog.words);
  }
}

void Instrument::poll() noexcept {
  if (ports_.watchdog != nullptr) {
    ports_.watchdog->kick();
  }
  work();
  converse();
}

void Instrument::converse() noexcept {
  follow_peer();
  receive();
  execute();
  send();
}

// A new peer meets no message, answer or wait of the one before. What runs in the background goes
// on, and *OPC may be waiting for it: many open a connection for each command.
void Instrument::follow_peer() noexcept {
  const bool is_connected = ports_.console.connected();
  if (was_connected_ && !is_connected) {
    session_.forget_peer();
    end_query();
  }
  was_connected_ = is_connected;
}

// What only a query had asked for ends with it.
void Instrument::end_query() noexcept {
  if (is_working() && !is_background_) {
    abort();
  }
}

void Instrument::clear_device() noexcept {
  session_.clear();
  completes_operation_ = false;
  end_query();
}

void Instrument::receive() noexcept {
  if (ports_.console.take_break()) {
    clear_device();
  }
  char bytes[kBytesPerPoll];
  const std::size_t room = session_.room();
  const Span<char> space(bytes, room < kBytesPerPoll ? room : kBytesPerPoll);
  const std::size_t count = ports_.console.read(space);
  std::size_t begin = 0;  // Behind the last device clear.
  for (std::size_t i = 0; i < count; ++i) {
    begin = bytes[i] == kDeviceClear ? i + 1 : begin;
  }
  if (begin > 0) {
    clear_device();
  }
  session_.receive(Span<const char>(bytes + begin, count - begin));
  if (ports_.console.take_lost_count() > 0) {
    session_.status().report(scpi::ErrorCode::kInputBufferOverrun, "send less at a time");
  }
  has_acted_ = count > 0;
}

void Instrument::execute() noexcept {
  bool acted = session_.step(*this, rows());
  for (int i = 0; acted && session_.is_answering() && i < kItemsPerPoll; ++i) {
    (void)session_.step(*this, rows());
  }
  has_acted_ = has_acted_ || acted;
}

void Instrument::send() noexcept {
  const std::size_t count = ports_.console.write(session_.output());
  session_.consume(count);
  has_acted_ = has_acted_ || count > 0;
  if (!session_.is_deadlocked() || count > 0 || ports_.console.waits_for_reader()) {
    is_deadlocked_ = false;
    return;
  }
  const std::uint64_t now_us = ports_.clock.now_us();
  if (!is_deadlocked_) {
    is_deadlocked_ = true;
    deadlock_since_us_ = now_us;
  } else if (now_us - deadlock_since_us_ >= kDeadlockPatience) {
    session_.break_deadlock();
    is_deadlocked_ = false;
    has_acted_ = true;
  }
}

void Instrument::reset() noexcept {
  completes_operation_ = false;  // Before the work ends, or it would be completed.
  abort();
  sequencer_.reset();
  change_device();
  reset_settings();
}

// Settings

void Instrument::reset_settings() noexcept {
  settings_ = kDefaultSettings;
  sweep_settings_ = default_sweep();
  restart_random();
}

SweepSettings Instrument::default_sweep() const noexcept {
  if (board_.bench != nullptr) {
    return *board_.bench;
  }
  return board_.make_bench != nullptr ? board_.make_bench() : default_sweep_settings();
}

void Instrument::restart_random() noexcept {
  (void)generator_.seed(settings_.generator, settings_.seed);  // `check()` has seen the seed.
}

ErrorWords Instrument::conflict_with(Part part) const noexcept {
  return words_of({sequencer_.obstacle_to(part)}, sequencer_);
}

ErrorWords Instrument::take(const Settings& settings) noexcept {
  if (const ErrorWords words = conflict_with(Part::kSettings)) {
    return words;
  }
  if (const ErrorWords words = words_of(check(settings))) {
    return words;
  }
  const bool has_other_numbers =
      settings.seed != settings_.seed || settings.generator != settings_.generator;
  settings_ = settings;
  if (has_other_numbers) {
    restart_random();
  }
  return {};
}

ErrorWords Instrument::take(const SweepSettings& settings) noexcept {
  if (const ErrorWords words = conflict_with(Part::kSweepSettings)) {
    return words;
  }
  if (const ErrorWords words = words_of(check(settings, ports_.analog.format()))) {
    return words;
  }
  sweep_settings_ = settings;
  return {};
}

// The device

ErrorWords Instrument::take(const Device& device) noexcept {
  const ErrorWords words = conflict_with(Part::kDevice);
  if (!words) {
    sequencer_.take(device);
    change_device();
  }
  return words;
}

ErrorWords Instrument::take(const FrequencyResponse& points) noexcept {
  const ErrorWords words = conflict_with(Part::kDevice);
  if (!words) {
    sequencer_.take(points);
    is_fit_kept_ = false;
    change_device();
  }
  return words;
}

ErrorWords Instrument::clear_points() noexcept {
  const ErrorWords words = conflict_with(Part::kDevice);
  if (!words && sequencer_.clear_points()) {
    change_device();
  }
  return words;
}

// What was wrong with the device of before is no matter any more.
void Instrument::change_device() noexcept { session_.status().questionable().set_condition(0); }

}  // namespace emax::app
