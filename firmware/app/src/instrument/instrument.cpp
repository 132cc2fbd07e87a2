// The loop of the instrument: bytes, messages, and one step of what runs.
#include "emax/app/instrument/instrument.hpp"

namespace emax::app {
namespace {

// A peer that neither reads nor lets go of its messages is given this long.
constexpr std::uint64_t kDeadlockPatience = 1'000'000;  // In microseconds.
// Items of a long answer that are made in one call.
constexpr int kItemsPerPoll = 16;
constexpr std::size_t kBytesPerPoll = 128;

}  // namespace

Instrument::Instrument(const Ports& ports, const Board& board) noexcept
    : ports_(ports), board_(board) {}

void Instrument::start() noexcept {
  session_.power_on();
  reset();
  restore_identification();
  if (ports_.watchdog != nullptr) {
    (void)ports_.watchdog->start();  // Without one the board runs on; *TST? tells.
  }
}

void Instrument::poll() noexcept {
  if (ports_.watchdog != nullptr) {
    ports_.watchdog->kick();
  }
  work();
  follow_peer();
  receive();
  execute();
  send();
}

// A new peer meets no message, answer or wait of the one before. What runs in the background goes
// on; a computation that only a query had asked for ends with it.
void Instrument::follow_peer() noexcept {
  const bool is_connected = ports_.console.connected();
  if (was_connected_ && !is_connected) {
    session_.clear();
    completes_operation_ = false;
    if (job_ != Job::kNone && !is_background_) {
      abort();
    }
  }
  was_connected_ = is_connected;
}

void Instrument::receive() noexcept {
  char bytes[kBytesPerPoll];
  const std::size_t room = session_.room();
  const Span<char> space(bytes, room < kBytesPerPoll ? room : kBytesPerPoll);
  const std::size_t count = ports_.console.read(space);
  session_.receive(Span<const char>(bytes, count));
  if (ports_.console.take_lost_count() > 0) {
    session_.status().report(scpi::ErrorCode::kInputBufferOverrun, "send less at a time");
  }
  has_acted_ = count > 0;
}

void Instrument::execute() noexcept {
  bool acted = session_.step(*this, commands());
  for (int i = 0; acted && session_.is_answering() && i < kItemsPerPoll; ++i) {
    (void)session_.step(*this, commands());
  }
  has_acted_ = has_acted_ || acted;
}

void Instrument::send() noexcept {
  const std::size_t count = ports_.console.write(session_.output());
  session_.consume(count);
  has_acted_ = has_acted_ || count > 0;
  if (!session_.is_deadlocked() || count > 0) {
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
  origin_ = Origin::kNothing;
  points_.clear();
  points_origin_ = Origin::kNothing;
  device_ = {};
  has_identification_ = false;
  invalidate(Change::kDevice);
  reset_settings();
}

void Instrument::reset_settings() noexcept {
  settings_ = kDefaultSettings;
  sweep_settings_ = default_sweep();
  invalidate(Change::kEnergy);
  seed_generator();
}

SweepSettings Instrument::default_sweep() const noexcept {
  return board_.bench != nullptr ? *board_.bench : default_sweep_settings();
}

void Instrument::seed_generator() noexcept {
  (void)generator_.seed(settings_.generator, settings_.seed);  // `check()` has seen the seed.
}

Instrument::Refusal Instrument::conflict_with(Change change) const noexcept {
  constexpr Refusal kSweepRuns = {scpi::ErrorCode::kSettingsConflict, "a sweep runs: ABOR or *WAI"};
  constexpr Refusal kWorkRuns = {scpi::ErrorCode::kSettingsConflict,
                                 "computing: ABOR or *WAI first"};
  const bool uses_points = change == Change::kSweep || change == Change::kDevice;
  if (job_ == Job::kSweep && uses_points) {
    return kSweepRuns;
  }
  const bool is_computing = job_ == Job::kEvaluation || job_ == Job::kFixedPoint;
  return is_computing && change != Change::kSweep ? kWorkRuns : Refusal{};
}

void Instrument::invalidate(Change change) noexcept {
  if (change == Change::kPaper && settings_.method != Method::kPaper) {
    return;
  }
  switch (change) {
    case Change::kSweep:
      return;
    case Change::kTrials:
      are_trials_valid_ = false;
      break;
    case Change::kTrend:
      is_trend_valid_ = false;
      break;
    case Change::kPaper:
    case Change::kEnergy:
    case Change::kDevice:
      is_evaluation_valid_ = false;
      are_trials_valid_ = false;
      is_trend_valid_ = false;
      break;
  }
  is_report_valid_ = false;
  if (change == Change::kDevice) {
    session_.status().questionable().set_condition(0);
  }
}

bool Instrument::has(Goal goal) const noexcept {
  if (!is_evaluation_valid_) {
    return false;
  }
  switch (goal) {
    case Goal::kModel:
      return evaluation_.has_model();
    case Goal::kEnergy:
      return evaluation_.has_energy() && evaluation_.is_bound_done();
    case Goal::kMonteCarlo:
      return are_trials_valid_ && evaluation_.has_monte_carlo();
    case Goal::kTrend:
      return is_trend_valid_ && evaluation_.has_trend();
    case Goal::kReport:
      return is_report_valid_;
  }
  return false;
}

}  // namespace emax::app
