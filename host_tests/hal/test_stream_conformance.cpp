// The suite for analog streams passes good ones and finds, clause by clause, what broken ones
// violate.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "emax/hal/analog_stream.hpp"

#include "hal/stream_conformance.hpp"
#include "support/loopback_stream.hpp"

namespace emax::test {
namespace {

using hal::AnalogStream;
using hal::DriveLimits;
using hal::Exchange;
using hal::Frame;
using hal::StreamFormat;
using hal::Word;

constexpr Word kMost = std::numeric_limits<Word>::max();
constexpr Word kLeast = std::numeric_limits<Word>::min();

/// What a board's `do_...` functions can get wrong. The public functions are the real ones.
enum class BoardDefect : std::uint8_t {
  kNone,
  kNoRate,
  kBlockTooLong,
  kDriveAtStart,
  kOldDriveAtRestart,
  kCountsFromOne,
  kSkipsIndex,
  kHidesLostFrames,
  kExtraDacFrame,
  kHalvesDrive,
  kClipsDrive,
  kInvertsDrive,
  kDoublesDrive,
  kFineStepsDropped,
  kTakesThreeBlockTimes,
  kWaitsForeverWhenLate,
  kRampWaitsForInputs,
  kLateUnnoticed,
  kFaultUnnoticed,
  kRampSlow,
  kRampSlowAtFullDrive,
  kRampJumps,
  kRampMissing,
  kRampStopsShort,
  kRampTakesDetour,
  kRampCountWrong,
  kDriveAfterStop,
  kNoRestart,
  kNoRestartAfterFault,
  kRefusedStartDrives,
  kRefusedStartUnnoticed,
  kLatencyOneMore,
  kLatencyOneLess,
  kLatencyOfRun,
  kLatencyOfBlock,
  kOffsetBinary,
  kRightJustified,
  kDirtyLowBits,
  kNeverAtZero,
  kRampMissingUnnoticed,
};

StreamFormat format_of(BoardDefect defect) {
  StreamFormat format = kLoopbackFormat;
  if (defect == BoardDefect::kNoRate) {
    format.sample_rate_hz = std::numeric_limits<double>::quiet_NaN();
  }
  if (defect == BoardDefect::kBlockTooLong) {
    format.block_frames = hal::kMaxBlockFrames + 1;
  }
  return format;
}

class BrokenBoard final : public AnalogStream {
 public:
  BrokenBoard(BoardDefect defect, StreamFault fault, std::uint64_t at_frame)
      : AnalogStream(format_of(defect)),
        defect_(defect),
        loopback_(latency(), kLoopbackFormat.sample_rate_hz, fault, at_frame) {}

  BrokenBoard& stream() { return *this; }
  DriveProbe drive() const { return loopback_.drive(); }
  double now_s() const { return loopback_.now_s(); }

 private:
  bool has(BoardDefect defect) const { return defect_ == defect; }

  std::uint32_t latency() const {
    const bool odd_run = has(BoardDefect::kLatencyOfRun) && starts_ % 2 == 0;
    const bool odd_block = has(BoardDefect::kLatencyOfBlock) && exchanges_ >= 60;
    const std::uint32_t more = has(BoardDefect::kLatencyOneMore) || odd_run || odd_block ? 1 : 0;
    const std::uint32_t less = has(BoardDefect::kLatencyOneLess) ? 1 : 0;
    return kLoopbackFormat.latency_frames + more - less;
  }

  Status do_start() noexcept override {
    if (has(BoardDefect::kNoRestart) && starts_ > 0) {
      return Status::kHardwareFault;
    }
    if (has(BoardDefect::kNoRestartAfterFault) && failed_) {
      return Status::kHardwareFault;
    }
    if (has(BoardDefect::kDriveAtStart) ||
        (has(BoardDefect::kOldDriveAtRestart) && last_handed_ != 0)) {
      loopback_.put(1);
    }
    const Status status = loopback_.power_on();
    if (has(BoardDefect::kRefusedStartDrives) && status != Status::kOk) {
      loopback_.put(1);
      loopback_.put(0);
    }
    ++starts_;
    exchanges_ = 0;
    loopback_.set_latency(latency());
    return has(BoardDefect::kRefusedStartUnnoticed) ? Status::kOk : status;
  }

  Word distorted(Word word) const {
    if (has(BoardDefect::kHalvesDrive)) {
      return word / 2;
    }
    if (has(BoardDefect::kClipsDrive)) {
      return std::min(word, Word{1} << 29);
    }
    if (has(BoardDefect::kInvertsDrive)) {
      return -word;
    }
    if (has(BoardDefect::kDoublesDrive)) {
      return static_cast<Word>(std::clamp<std::int64_t>(2 * std::int64_t{word}, -kMost, kMost));
    }
    if (has(BoardDefect::kFineStepsDropped)) {
      return word / (Word{1} << 23) * (Word{1} << 23);
    }
    return word;
  }

  Word converted(Word word) const {
    const auto bits = static_cast<std::uint32_t>(word);
    if (has(BoardDefect::kOffsetBinary)) {
      return static_cast<Word>(bits ^ 0x80000000U);
    }
    if (has(BoardDefect::kRightJustified)) {
      return word / 65536;
    }
    return has(BoardDefect::kDirtyLowBits) ? static_cast<Word>(bits | 1U) : word;
  }

  Exchange do_exchange(Span<const Word> drive, Span<Frame> response) noexcept override {
    std::vector<Word> words;
    for (const Word word : drive) {
      words.push_back(distorted(word));
    }
    loopback_.set_latency(latency());
    ++exchanges_;
    last_handed_ = words.back();
    const std::uint64_t frames_before = loopback_.drive().frames;
    Exchange result = loopback_.transfer({words.data(), words.size()}, response);
    if (has(BoardDefect::kExtraDacFrame) && exchanges_ % 7 == 0) {
      loopback_.put(words.back());
    }
    if (has(BoardDefect::kTakesThreeBlockTimes)) {
      loopback_.wait(2 * drive.size());
    }
    if (has(BoardDefect::kWaitsForeverWhenLate) && result.status == Status::kLateBlock) {
      loopback_.wait(1000000);
    }
    if ((has(BoardDefect::kLateUnnoticed) && result.status == Status::kLateBlock) ||
        (has(BoardDefect::kFaultUnnoticed) && result.status == Status::kHardwareFault)) {
      result.status = Status::kOk;
    }
    failed_ = failed_ || result.status != Status::kOk;
    dead_ = result.status == Status::kLateBlock;
    lost_ += loopback_.drive().frames - frames_before > drive.size() ? drive.size() : 0;
    for (Frame& frame : response) {
      frame = {converted(frame.reference), converted(frame.device)};
    }
    if (has(BoardDefect::kCountsFromOne)) {
      ++result.first_frame;
    }
    if (has(BoardDefect::kSkipsIndex) && exchanges_ > 5) {
      result.first_frame += drive.size();
    }
    if (has(BoardDefect::kHidesLostFrames)) {
      result.first_frame -= lost_;
    }
    return result;
  }

  std::uint32_t do_ramp_to_zero(Word step) noexcept override {
    const Word last = loopback_.drive().last;
    if (has(BoardDefect::kRampWaitsForInputs) && dead_) {
      loopback_.wait(1000000);
    }
    if (has(BoardDefect::kRampMissing) || has(BoardDefect::kRampMissingUnnoticed)) {
      return 0;
    }
    if (has(BoardDefect::kRampJumps)) {
      return loopback_.ramp_to_zero(kMost);
    }
    if (has(BoardDefect::kRampSlow)) {
      return loopback_.ramp_to_zero(std::max(step / 2, Word{1}));
    }
    if (has(BoardDefect::kRampSlowAtFullDrive) && std::abs(last) == Word{1} << 30) {
      return loopback_.ramp_to_zero(step - 1);
    }
    if (has(BoardDefect::kRampStopsShort) && last > step) {
      return ramp_to(step, step);
    }
    std::uint32_t frames = 0;
    if (has(BoardDefect::kRampTakesDetour) && last > 0) {
      frames = ramp_to(last - step, step);
      frames += ramp_to(last, step);
    }
    frames += loopback_.ramp_to_zero(step);
    return has(BoardDefect::kRampCountWrong) ? frames + 1 : frames;
  }

  /// Adds `step` until it is at `end`, or takes it away.
  std::uint32_t ramp_to(Word end, Word step) {
    const Word direction = end < loopback_.drive().last ? -std::abs(step) : std::abs(step);
    std::uint32_t frames = 0;
    for (; loopback_.drive().last != end && frames < 1024; ++frames) {
      loopback_.put(loopback_.drive().last + direction);
    }
    return frames;
  }

  void do_stop() noexcept override {
    loopback_.power_off();
    if (has(BoardDefect::kDriveAfterStop)) {
      loopback_.put(1);
    }
  }

  bool do_drive_is_at_zero() const noexcept override {
    return !has(BoardDefect::kNeverAtZero) &&
           (loopback_.drive().last == 0 || has(BoardDefect::kRampMissingUnnoticed));
  }

  const BoardDefect defect_;
  std::uint32_t starts_ = 0;
  std::uint32_t exchanges_ = 0;
  std::uint64_t lost_ = 0;
  Word last_handed_ = 0;
  bool failed_ = false;
  bool dead_ = false;
  Loopback loopback_;
};

/// What the checks in the public functions can get wrong.
enum class CheckDefect : std::uint8_t {
  kNone,
  kFormatChanges,
  kTakesAnyLimits,
  kTakesNegativeStep,
  kTakesSlowRamp,
  kRampLimitBy32Bits,
  kKeepsRefusedLimits,
  kRefusesExactRamp,
  kStartsTwice,
  kSecondStartSetsLimits,
  kSecondStartStops,
  kRunsUnstarted,
  kRunsOnAfterStop,
  kTakesAnySize,
  kWrongSizeStops,
  kWrongSizeCountsFrames,
  kWrongSizeClearsResponse,
  kTakesAmplitude,
  kTakesNegativeAmplitude,
  kRefusesFullAmplitude,
  kTakesLeastWord,
  kTakesSlope,
  kTakesFirstSlope,
  kTakesBorderSlope,
  kRefusesFullSlope,
  kSlopeBy32Bits,
  kSendsUntilViolation,
  kClearsResponseOnViolation,
  kViolationRunsOn,
  kViolationJumpsToZero,
  kViolationKeepsDrive,
  kGapUnnoticed,
  kLateRunsOn,
  kStopsTwice,
  kIndexGoesOn,
  kSlopeFromLastRun,
  kAtZeroWhileRunning,
};

/// A second implementation of the public functions, which can leave out any one check.
class BrokenChecks {
 public:
  BrokenChecks(CheckDefect defect, StreamFault fault, std::uint64_t at_frame)
      : defect_(defect),
        loopback_(format_.latency_frames, format_.sample_rate_hz, fault, at_frame) {}

  BrokenChecks& stream() { return *this; }
  DriveProbe drive() const { return loopback_.drive(); }
  double now_s() const { return loopback_.now_s(); }

  const StreamFormat& format() const { return format_; }
  const DriveLimits& limits() const { return limits_; }
  bool running() const { return running_; }
  bool drive_is_at_zero() const {
    return loopback_.drive().last == 0 && (!running_ || has(CheckDefect::kAtZeroWhileRunning));
  }

  Status start(const DriveLimits& limits) {
    if (running_ && !has(CheckDefect::kStartsTwice)) {
      limits_ = has(CheckDefect::kSecondStartSetsLimits) ? limits : limits_;
      running_ = !has(CheckDefect::kSecondStartStops);
      return Status::kAlreadyRunning;
    }
    limits_ = has(CheckDefect::kKeepsRefusedLimits) ? limits : limits_;
    if (!usable(limits)) {
      return Status::kInvalidArgument;
    }
    if (loopback_.power_on() != Status::kOk) {
      loopback_.power_off();
      return Status::kHardwareFault;
    }
    limits_ = limits;
    next_ = 0;
    base_ = has(CheckDefect::kIndexGoesOn) ? base_ + last_count_ : 0;
    last_count_ = 0;
    last_ = has(CheckDefect::kSlopeFromLastRun) ? last_ : 0;
    format_.latency_frames += has(CheckDefect::kFormatChanges) ? 1U : 0U;
    running_ = true;
    return Status::kOk;
  }

  Exchange exchange(Span<const Word> drive, Span<Frame> response) {
    if (!running_ && !has(CheckDefect::kRunsUnstarted)) {
      return {Status::kNotRunning, next_};
    }
    const std::uint32_t right = format_.block_frames;
    if (drive.size() != right || response.size() != right) {
      return wrong_size(drive, response);
    }
    const std::size_t good = frames_within_limits(drive);
    if (good != drive.size()) {
      return violation(drive.first(good), response);
    }
    const Exchange answer = loopback_.transfer(drive, response);
    if (answer.status != Status::kOk) {
      if (!has(CheckDefect::kLateRunsOn)) {
        halt();
      }
      return {answer.status, next_};
    }
    if (answer.first_frame != next_ && !has(CheckDefect::kGapUnnoticed)) {
      halt();
      return {Status::kLostBlock, answer.first_frame};
    }
    last_ = drive[right - 1];
    next_ = answer.first_frame + right;
    last_count_ += right;
    return {Status::kOk, base_ + answer.first_frame};
  }

  std::uint32_t stop() {
    if (!running_) {
      return has(CheckDefect::kStopsTwice) ? stop_count_ : 0;
    }
    stop_count_ = halt();
    running_ = has(CheckDefect::kRunsOnAfterStop);
    return stop_count_;
  }

 private:
  bool has(CheckDefect defect) const { return defect_ == defect; }

  bool usable(const DriveLimits& limits) const {
    const std::int64_t amplitude = limits.amplitude;
    const std::int64_t step = limits.step_per_frame;
    if (has(CheckDefect::kTakesAnyLimits)) {
      return true;
    }
    if (has(CheckDefect::kTakesNegativeStep)) {
      return amplitude >= 1 && std::abs(step) * 256 >= amplitude;
    }
    if (has(CheckDefect::kTakesSlowRamp)) {
      return amplitude >= 1 && step >= 1;
    }
    if (has(CheckDefect::kRampLimitBy32Bits)) {
      return amplitude >= 1 && step >= 1 && step >= amplitude / 256;
    }
    if (has(CheckDefect::kRefusesExactRamp)) {
      return amplitude >= 1 && step >= 1 && step * 256 > amplitude;
    }
    return amplitude >= 1 && step >= 1 && step * 256 >= amplitude;
  }

  Exchange wrong_size(Span<const Word> drive, Span<Frame> response) {
    if (has(CheckDefect::kTakesAnySize)) {
      return {Status::kOk, next_};
    }
    if (has(CheckDefect::kWrongSizeStops)) {
      halt();
    }
    if (has(CheckDefect::kWrongSizeCountsFrames)) {
      next_ += drive.size();
    }
    if (has(CheckDefect::kWrongSizeClearsResponse)) {
      std::fill(response.begin(), response.end(), Frame{});
    }
    return {Status::kInvalidArgument, next_};
  }

  Exchange violation(Span<const Word> good, Span<Frame> response) {
    if (has(CheckDefect::kSendsUntilViolation)) {
      for (const Word word : good) {
        loopback_.put(word);
      }
    }
    if (has(CheckDefect::kClearsResponseOnViolation)) {
      std::fill(response.begin(), response.end(), Frame{});
    }
    if (has(CheckDefect::kViolationJumpsToZero)) {
      loopback_.put(0);
    }
    if (has(CheckDefect::kViolationKeepsDrive)) {
      running_ = false;
    } else if (!has(CheckDefect::kViolationRunsOn)) {
      halt();
    }
    return {Status::kDriveLimit, next_};
  }

  std::size_t frames_within_limits(Span<const Word> drive) const {
    for (std::size_t i = 0; i < drive.size(); ++i) {
      if (!amplitude_is_good(drive[i]) || !slope_is_good(drive, i)) {
        return i;
      }
    }
    return drive.size();
  }

  bool amplitude_is_good(std::int64_t word) const {
    const std::int64_t amplitude = limits_.amplitude;
    if (has(CheckDefect::kTakesAmplitude)) {
      return true;
    }
    if (has(CheckDefect::kTakesNegativeAmplitude)) {
      return word <= amplitude;
    }
    if (has(CheckDefect::kRefusesFullAmplitude)) {
      return std::abs(word) < amplitude;
    }
    if (has(CheckDefect::kTakesLeastWord) && word == kLeast) {
      return true;
    }
    return std::abs(word) <= amplitude;
  }

  bool slope_is_good(Span<const Word> drive, std::size_t i) const {
    const std::int64_t change = std::int64_t{drive[i]} - (i == 0 ? last_ : drive[i - 1]);
    const std::int64_t step = limits_.step_per_frame;
    if (has(CheckDefect::kTakesSlope) || (has(CheckDefect::kTakesBorderSlope) && i == 0) ||
        (has(CheckDefect::kTakesFirstSlope) && i == 0 && next_ == 0)) {
      return true;
    }
    if (has(CheckDefect::kRefusesFullSlope)) {
      return std::abs(change) < step;
    }
    if (has(CheckDefect::kSlopeBy32Bits)) {
      const auto low = static_cast<std::uint32_t>(static_cast<std::uint64_t>(change));
      return std::abs(std::int64_t{static_cast<std::int32_t>(low)}) <= step;
    }
    return std::abs(change) <= step;
  }

  std::uint32_t halt() {
    running_ = false;
    const std::uint32_t frames = loopback_.ramp_to_zero(limits_.step_per_frame);
    loopback_.power_off();
    return frames;
  }

  const CheckDefect defect_;
  StreamFormat format_ = kLoopbackFormat;
  DriveLimits limits_;
  std::uint64_t next_ = 0;
  std::uint64_t base_ = 0;
  std::uint64_t last_count_ = 0;
  std::uint32_t stop_count_ = 0;
  Word last_ = 0;
  bool running_ = false;
  Loopback loopback_;
};

/// A broken stream: the clause that it was made to violate, then those that go with it.
template <typename Defect>
struct Case {
  Defect defect;
  std::vector<StreamClause> violated;
};

using C = StreamClause;

const Case<BoardDefect> kBrokenBoards[] = {
    {BoardDefect::kNoRate, {C::kFormat}},
    {BoardDefect::kBlockTooLong, {C::kFormat}},
    {BoardDefect::kDriveAtStart, {C::kZeroAtStart, C::kSlopeKept, C::kStaysAtZero, C::kStartFault}},
    {BoardDefect::kOldDriveAtRestart, {C::kZeroAtStart}},
    {BoardDefect::kCountsFromOne, {C::kFirstFrameZero}},
    {BoardDefect::kSkipsIndex, {C::kNoGap}},
    {BoardDefect::kHidesLostFrames, {C::kLostBlock}},
    {BoardDefect::kExtraDacFrame, {C::kOneClock}},
    {BoardDefect::kHalvesDrive, {C::kDriveUnchanged}},
    {BoardDefect::kClipsDrive, {C::kDriveUnchanged}},
    {BoardDefect::kInvertsDrive, {C::kDriveUnchanged}},
    {BoardDefect::kDoublesDrive,
     {C::kAmplitudeKept, C::kDriveUnchanged, C::kSlopeKept, C::kBoundedWait, C::kZeroIn256}},
    {BoardDefect::kFineStepsDropped, {C::kSlopeKept, C::kDriveUnchanged}},
    {BoardDefect::kTakesThreeBlockTimes, {C::kBoundedWait}},
    {BoardDefect::kWaitsForeverWhenLate, {C::kBoundedWait}},
    {BoardDefect::kRampWaitsForInputs, {C::kBoundedWait}},
    {BoardDefect::kLateUnnoticed, {C::kLateBlock}},
    {BoardDefect::kFaultUnnoticed, {C::kHardwareFault}},
    {BoardDefect::kRampSlow, {C::kZeroIn256, C::kBoundedWait}},
    {BoardDefect::kRampSlowAtFullDrive, {C::kZeroIn256}},
    {BoardDefect::kRampJumps, {C::kSlopeKept}},
    {BoardDefect::kRampMissing,
     {C::kZeroIn256, C::kZeroAtStart, C::kSlopeKept, C::kStaysAtZero, C::kStopCount}},
    {BoardDefect::kRampStopsShort,
     {C::kZeroIn256, C::kZeroAtStart, C::kStaysAtZero, C::kStopCount}},
    {BoardDefect::kRampTakesDetour, {C::kZeroIn256}},
    {BoardDefect::kRampCountWrong, {C::kStopCount}},
    {BoardDefect::kDriveAfterStop,
     {C::kStaysAtZero, C::kZeroAtStart, C::kRefusedBlockStays, C::kZeroIn256, C::kStopCount,
      C::kStartFault}},
    {BoardDefect::kNoRestart, {C::kRestart}},
    {BoardDefect::kNoRestartAfterFault, {C::kRestart}},
    {BoardDefect::kRefusedStartDrives, {C::kStartFault}},
    {BoardDefect::kRefusedStartUnnoticed, {C::kStartFault}},
    {BoardDefect::kLatencyOneMore, {C::kStatedLatency}},
    {BoardDefect::kLatencyOneLess, {C::kStatedLatency}},
    {BoardDefect::kLatencyOfRun, {C::kConstantLatency, C::kStatedLatency}},
    {BoardDefect::kLatencyOfBlock, {C::kConstantLatency, C::kStatedLatency}},
    {BoardDefect::kOffsetBinary, {C::kZeroIsZero}},
    {BoardDefect::kRightJustified, {C::kLeftJustified, C::kStatedLatency}},
    {BoardDefect::kDirtyLowBits, {C::kLeftJustified, C::kZeroIsZero}},
    {BoardDefect::kNeverAtZero, {C::kTellsZero}},
    {BoardDefect::kRampMissingUnnoticed,
     {C::kTellsZero, C::kZeroIn256, C::kZeroAtStart, C::kSlopeKept, C::kStaysAtZero,
      C::kStopCount}},
};

const Case<CheckDefect> kBrokenChecks[] = {
    {CheckDefect::kFormatChanges, {C::kFormat, C::kStatedLatency}},
    {CheckDefect::kTakesAnyLimits, {C::kLimitsRefused}},
    {CheckDefect::kTakesNegativeStep, {C::kLimitsRefused}},
    {CheckDefect::kTakesSlowRamp, {C::kLimitsRefused}},
    {CheckDefect::kRampLimitBy32Bits, {C::kLimitsRefused}},
    {CheckDefect::kKeepsRefusedLimits, {C::kLimitsRefused}},
    {CheckDefect::kRefusesExactRamp, {C::kLimitsTaken, C::kRestart, C::kStartFault}},
    {CheckDefect::kStartsTwice, {C::kAlreadyRunning, C::kGoodBlockTaken}},
    {CheckDefect::kSecondStartSetsLimits, {C::kAlreadyRunning}},
    {CheckDefect::kSecondStartStops, {C::kAlreadyRunning, C::kGoodBlockTaken}},
    {CheckDefect::kRunsUnstarted, {C::kNotRunning}},
    {CheckDefect::kRunsOnAfterStop, {C::kNotRunning, C::kRestart}},
    {CheckDefect::kTakesAnySize, {C::kBlockSize}},
    {CheckDefect::kWrongSizeStops, {C::kBlockSize}},
    {CheckDefect::kWrongSizeCountsFrames, {C::kBlockSize, C::kNoGap}},
    {CheckDefect::kWrongSizeClearsResponse, {C::kBlockSize}},
    {CheckDefect::kTakesAmplitude, {C::kAmplitude, C::kAmplitudeKept}},
    {CheckDefect::kTakesNegativeAmplitude, {C::kAmplitude, C::kAmplitudeKept}},
    {CheckDefect::kRefusesFullAmplitude, {C::kGoodBlockTaken}},
    {CheckDefect::kTakesLeastWord, {C::kAmplitude, C::kAmplitudeKept}},
    {CheckDefect::kTakesSlope, {C::kSlope, C::kSlopeKept, C::kSlopeAcrossBlocks}},
    {CheckDefect::kTakesFirstSlope, {C::kSlope, C::kSlopeKept}},
    {CheckDefect::kTakesBorderSlope, {C::kSlopeAcrossBlocks, C::kSlopeKept, C::kSlope}},
    {CheckDefect::kRefusesFullSlope, {C::kGoodBlockTaken}},
    {CheckDefect::kSlopeBy32Bits, {C::kSlopeAcrossBlocks, C::kSlopeKept}},
    {CheckDefect::kSendsUntilViolation, {C::kRefusedBlockStays, C::kZeroIn256}},
    {CheckDefect::kClearsResponseOnViolation, {C::kRefusedBlockStays}},
    {CheckDefect::kViolationRunsOn,
     {C::kFaultStops, C::kNotRunning, C::kZeroIn256, C::kStaysAtZero, C::kStopTwice}},
    {CheckDefect::kViolationJumpsToZero, {C::kSlopeKept}},
    {CheckDefect::kViolationKeepsDrive,
     {C::kZeroIn256, C::kZeroAtStart, C::kStaysAtZero, C::kRestart}},
    {CheckDefect::kGapUnnoticed, {C::kLostBlock}},
    {CheckDefect::kLateRunsOn, {C::kFaultStops, C::kNotRunning, C::kZeroIn256, C::kStaysAtZero}},
    {CheckDefect::kStopsTwice, {C::kStopTwice}},
    {CheckDefect::kIndexGoesOn, {C::kFirstFrameZero, C::kNoGap}},
    {CheckDefect::kSlopeFromLastRun, {C::kGoodBlockTaken}},
    {CheckDefect::kAtZeroWhileRunning, {C::kTellsZero}},
};

StreamViolations set_of(const std::vector<StreamClause>& clauses) {
  StreamViolations set;
  for (const StreamClause clause : clauses) {
    set.set(static_cast<std::size_t>(clause));
  }
  return set;
}

template <typename Broken, typename Defect>
StreamViolations violated_with(Defect defect) {
  const auto make = [defect](StreamFault fault, std::uint64_t at_frame) {
    return Broken(defect, fault, at_frame);
  };
  return violated_clauses(make);
}

StreamViolations violated_by_loopback(const StreamFormat& format) {
  const auto make = [&format](StreamFault fault, std::uint64_t at_frame) {
    return LoopbackStream(format, fault, at_frame);
  };
  return violated_clauses(make);
}

TEST(StreamConformance, GoodStreamsViolateNothing) {
  EXPECT_EQ(names_of(violated_by_loopback(kLoopbackFormat)), "none");
  EXPECT_EQ(names_of(violated_with<BrokenBoard>(BoardDefect::kNone)), "none");
  EXPECT_EQ(names_of(violated_with<BrokenChecks>(CheckDefect::kNone)), "none");
}

TEST(StreamConformance, AnyBlockLengthAndLatencyPasses) {
  for (const std::uint32_t block : {1U, 2U, 7U, 63U, 64U}) {
    for (const std::uint32_t latency : {0U, 1U, 64U, 255U}) {
      EXPECT_EQ(names_of(violated_by_loopback({48000.0, 5.0, 2.5, block, latency})), "none")
          << block << " frames, latency " << latency;
    }
  }
}

TEST(StreamConformance, BrokenBoardsAreFound) {
  for (const auto& broken : kBrokenBoards) {
    const StreamViolations violated = violated_with<BrokenBoard>(broken.defect);
    EXPECT_EQ(names_of(violated), names_of(set_of(broken.violated)))
        << "defect " << static_cast<int>(broken.defect);
  }
}

TEST(StreamConformance, BrokenChecksAreFound) {
  for (const auto& broken : kBrokenChecks) {
    const StreamViolations violated = violated_with<BrokenChecks>(broken.defect);
    EXPECT_EQ(names_of(violated), names_of(set_of(broken.violated)))
        << "defect " << static_cast<int>(broken.defect);
  }
}

TEST(StreamConformance, EveryClauseHasABrokenStream) {
  StreamViolations proven;
  for (const auto& broken : kBrokenBoards) {
    proven |= set_of({broken.violated.front()});
  }
  for (const auto& broken : kBrokenChecks) {
    proven |= set_of({broken.violated.front()});
  }
  EXPECT_EQ(names_of(~proven), "none");
}

/// A board that answers as it is told.
class ToldStream final : public AnalogStream {
 public:
  explicit ToldStream(const StreamFormat& format) : AnalogStream(format) {}

  Status start_answer = Status::kOk;
  Status exchange_answer = Status::kOk;
  int starts = 0;
  int ramps = 0;
  int stops = 0;

 private:
  Status do_start() noexcept override {
    ++starts;
    return start_answer;
  }
  Exchange do_exchange(Span<const Word>, Span<Frame>) noexcept override {
    return {exchange_answer, 0};
  }
  std::uint32_t do_ramp_to_zero(Word) noexcept override {
    ++ramps;
    return 0;
  }
  void do_stop() noexcept override { ++stops; }
  bool do_drive_is_at_zero() const noexcept override { return true; }
};

constexpr DriveLimits kSomeLimits = {1 << 20, 1 << 20};

TEST(AnalogStream, StartsWithAnyFormatWithinItsRanges) {
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  constexpr double kHuge = std::numeric_limits<double>::max();
  for (const StreamFormat& format :
       {StreamFormat{kTiny, kTiny, kTiny, 1, 0}, StreamFormat{kHuge, kHuge, kHuge, 64, 0}}) {
    ToldStream stream(format);
    EXPECT_EQ(stream.start(kSomeLimits), Status::kOk);
    EXPECT_TRUE(stream.running());
  }
}

TEST(AnalogStream, DoesNotStartWithAFormatOutsideItsRanges) {
  const StreamFormat good = {1.0, 1.0, 1.0, 1, 0};
  std::vector<StreamFormat> bad = {{1.0, 1.0, 1.0, 0, 0}, {1.0, 1.0, 1.0, 65, 0}};
  for (const double value : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    for (double StreamFormat::*const member :
         {&StreamFormat::sample_rate_hz, &StreamFormat::drive_full_scale_v,
          &StreamFormat::input_full_scale_v}) {
      bad.push_back(good);
      bad.back().*member = value;
    }
  }
  for (const StreamFormat& format : bad) {
    ToldStream stream(format);
    EXPECT_EQ(stream.start(kSomeLimits), Status::kHardwareFault);
    EXPECT_FALSE(stream.running());
    EXPECT_EQ(stream.starts, 0) << "the board is not asked";
  }
}

TEST(AnalogStream, AnyRefusalOfTheBoardIsAHardwareFault) {
  for (const Status answer : {Status::kHardwareFault, Status::kLateBlock, Status::kNotRunning}) {
    ToldStream stream({1.0, 1.0, 1.0, 1, 0});
    stream.start_answer = answer;
    EXPECT_EQ(stream.start(kSomeLimits), Status::kHardwareFault);
    EXPECT_FALSE(stream.running());
    EXPECT_EQ(stream.stops, 1);
  }
}

// Late and lost blocks are told apart; any other answer counts as a fault of the hardware.
TEST(AnalogStream, FaultsOfAnExchangeKeepTheirNames) {
  const struct {
    Status answer;
    Status expected;
  } cases[] = {{Status::kLateBlock, Status::kLateBlock},
               {Status::kLostBlock, Status::kLostBlock},
               {Status::kHardwareFault, Status::kHardwareFault},
               {Status::kInvalidArgument, Status::kHardwareFault},
               {Status::kDriveLimit, Status::kHardwareFault}};
  for (const auto& one : cases) {
    ToldStream stream({1.0, 1.0, 1.0, 1, 0});
    ASSERT_EQ(stream.start(kSomeLimits), Status::kOk);
    const Word drive[] = {0};
    Frame response[1];
    stream.exchange_answer = one.answer;
    EXPECT_EQ(stream.exchange(drive, response).status, one.expected);
    EXPECT_FALSE(stream.running());
    EXPECT_EQ(stream.ramps, 1);
    EXPECT_EQ(stream.stops, 1);
  }
}

}  // namespace
}  // namespace emax::test
