// The contract of hal::AnalogStream as a suite that any implementation must pass: it finds the
// clauses that a stream violates.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "emax/hal/analog_stream.hpp"

namespace emax::test {

/// The clauses of the contract, each of which can be violated by itself.
enum class StreamClause : std::uint8_t {
  kFormat,             ///< The format is within its ranges and does not change.
  kLimitsRefused,      ///< Limits outside their ranges: kInvalidArgument, nothing has changed.
  kLimitsTaken,        ///< Limits at the ends of their ranges are taken, and shown by limits().
  kAlreadyRunning,     ///< A second start: kAlreadyRunning, nothing has changed.
  kNotRunning,         ///< Before start, after stop, after a fault: kNotRunning, nothing happens.
  kZeroAtStart,        ///< The drive is zero from before the start to the first word handed over.
  kFirstFrameZero,     ///< The frame index is 0 after each start.
  kNoGap,              ///< Each block's index follows the one before.
  kGoodBlockTaken,     ///< Blocks at the limits are exchanged with kOk.
  kOneClock,           ///< One block leaves the DAC for each block that comes in.
  kDriveUnchanged,     ///< The words leave the DAC as they were handed over.
  kAmplitudeKept,      ///< Nothing beyond the amplitude leaves the DAC, ever.
  kSlopeKept,          ///< Nothing beyond the slope leaves the DAC, ever: ramps included.
  kBoundedWait,        ///< Two block times; 256 frames and the latency more for an end.
  kBlockSize,          ///< A wrong number of frames: kInvalidArgument, nothing has changed.
  kAmplitude,          ///< A word beyond the amplitude: kDriveLimit.
  kSlope,              ///< A change beyond the slope: kDriveLimit; the first one is from zero.
  kSlopeAcrossBlocks,  ///< Likewise from one block to the next.
  kRefusedBlockStays,  ///< Nothing of a block with a word beyond the limits goes out.
  kZeroIn256,          ///< After stop or a fault, the drive is at zero within 256 frames.
  kStaysAtZero,        ///< And stays there.
  kFaultStops,         ///< After a fault, nothing runs.
  kRestart,            ///< After stop or a fault, the stream starts again.
  kStopCount,          ///< stop() returns the frames that it took.
  kStopTwice,          ///< A second stop() returns 0 and does nothing.
  kLostBlock,          ///< Lost frames: kLostBlock.
  kLateBlock,          ///< No block in time: kLateBlock.
  kHardwareFault,      ///< A board's fault: kHardwareFault.
  kStartFault,         ///< A board that does not start: kHardwareFault, nothing runs.
  kStatedLatency,      ///< A pulse arrives after the stated latency, and not before.
  kConstantLatency,    ///< And always at the same place.
  kZeroIsZero,         ///< Words are signed: zero volts are 0.
  kLeftJustified,      ///< Words are left-justified.
  kTellsZero,          ///< drive_is_at_zero() where nothing runs and the DAC is at 0; only there.
};
inline constexpr std::size_t kStreamClauses = 34;

using StreamViolations = std::bitset<kStreamClauses>;

/// What a bench can be asked to do wrong.
enum class StreamFault : std::uint8_t {
  kNone,
  kLostBlock,
  kLateBlock,
  kHardwareFault,
  kStartFault
};

/// What has left the DAC since the bench was made.
struct DriveProbe {
  hal::Word last = 0;
  std::uint32_t max_amplitude = 0;  ///< Greatest |word|.
  std::uint32_t max_step = 0;       ///< Greatest |change|, the first one from zero.
  std::uint64_t frames = 0;
  std::uint64_t frames_since_nonzero = 0;  ///< Zeros at the end; all of them if there is no other.
};

/// What the suite has to know of a bench.
struct StreamExpectations {
  unsigned input_bits = 16;  ///< Of the converters.
  hal::Word quiet = 0;       ///< Greatest |response| with the drive at zero.
  /// A change of the reference by more than this shows that the drive's pulse of 2^30 has arrived.
  hal::Word arrival = std::int32_t{1} << 28;
  std::uint32_t arrival_spread = 0;  ///< Frames from the stated latency to that change, at most.
  std::uint32_t settle_frames = 0;   ///< From a pulse until the response has died out.
  bool can_lose_block = true;        ///< The faults that the bench can be asked for.
  bool can_be_late = true;
  bool can_fail = true;
  bool can_refuse_start = true;
};

inline const char* name_of(StreamClause clause) {
  static constexpr std::array<const char*, kStreamClauses> kNames = {"format",
                                                                     "limits_refused",
                                                                     "limits_taken",
                                                                     "already_running",
                                                                     "not_running",
                                                                     "zero_at_start",
                                                                     "first_frame_zero",
                                                                     "no_gap",
                                                                     "good_block_taken",
                                                                     "one_clock",
                                                                     "drive_unchanged",
                                                                     "amplitude_kept",
                                                                     "slope_kept",
                                                                     "bounded_wait",
                                                                     "block_size",
                                                                     "amplitude",
                                                                     "slope",
                                                                     "slope_across_blocks",
                                                                     "refused_block_stays",
                                                                     "zero_in_256",
                                                                     "stays_at_zero",
                                                                     "fault_stops",
                                                                     "restart",
                                                                     "stop_count",
                                                                     "stop_twice",
                                                                     "lost_block",
                                                                     "late_block",
                                                                     "hardware_fault",
                                                                     "start_fault",
                                                                     "stated_latency",
                                                                     "constant_latency",
                                                                     "zero_is_zero",
                                                                     "left_justified",
                                                                     "tells_zero"};
  return kNames[static_cast<std::size_t>(clause)];
}

/// @returns The names of all violated clauses, or "none".
inline std::string names_of(const StreamViolations& violations) {
  std::string names;
  for (std::size_t i = 0; i < kStreamClauses; ++i) {
    if (violations[i]) {
      names += (names.empty() ? "" : " ");
      names += name_of(static_cast<StreamClause>(i));
    }
  }
  return names.empty() ? "none" : names;
}

namespace detail {

using hal::DriveLimits;
using hal::Exchange;
using hal::Frame;
using hal::StreamFormat;
using hal::Word;

inline constexpr Word kMost = std::numeric_limits<Word>::max();
inline constexpr Word kLeast = std::numeric_limits<Word>::min();
// Powers of two, so that a DAC of 12 bits or more puts all drives of the suite out unrounded. The
// ramp from the amplitude takes kMaxRampFrames frames, so it cannot afford a detour.
inline constexpr Word kFullDrive = std::int32_t{1} << 30;
inline constexpr Word kStep = std::int32_t{1} << 22;
inline constexpr DriveLimits kSlowLimits = {kFullDrive, kStep};
inline constexpr DriveLimits kPulseLimits = {kFullDrive, kFullDrive};
inline constexpr DriveLimits kGreatestLimits = {kMost, std::int32_t{1} << 23};
// One step of a 12-bit DAC, by which it may widen the slope of words that it has to round.
inline constexpr std::uint32_t kDacRounding = std::uint32_t{1} << 20;

inline bool same(const DriveProbe& a, const DriveProbe& b) {
  return a.last == b.last && a.max_amplitude == b.max_amplitude && a.max_step == b.max_step &&
         a.frames == b.frames && a.frames_since_nonzero == b.frames_since_nonzero;
}

inline bool same(const DriveLimits& a, const DriveLimits& b) {
  return a.amplitude == b.amplitude && a.step_per_frame == b.step_per_frame;
}

inline bool same(const StreamFormat& a, const StreamFormat& b) {
  return a.sample_rate_hz == b.sample_rate_hz && a.drive_full_scale_v == b.drive_full_scale_v &&
         a.input_full_scale_v == b.input_full_scale_v && a.block_frames == b.block_frames &&
         a.latency_frames == b.latency_frames;
}

/// Frames from `before` until the first zero after it.
inline std::uint64_t frames_to_zero(const DriveProbe& before, const DriveProbe& after) {
  if (before.last == 0) {
    return 0;
  }
  return after.frames + 1 - std::min(after.frames, before.frames + after.frames_since_nonzero);
}

/// One bench on its way through a scenario. Every call looks at what holds at all times.
template <typename Bench>
class StreamRun {
 public:
  StreamRun(Bench& bench, const StreamExpectations& expect, StreamViolations& violations)
      : bench_(bench),
        stream_(bench.stream()),
        expect_(expect),
        violations_(violations),
        format_(stream_.format()),
        response_(format_.block_frames) {}

  void require(bool holds, StreamClause clause) {
    if (!holds) {
      violations_.set(static_cast<std::size_t>(clause));
    }
  }

  std::uint32_t block() const { return format_.block_frames; }
  Word drive() const { return drive_; }
  DriveProbe probe() const { return bench_.drive(); }
  const std::vector<Frame>& response() const { return response_; }
  auto& stream() { return stream_; }

  bool start(const DriveLimits& limits, std::uint32_t rounding = 0) {
    const DriveProbe before = probe();
    require(before.last == 0, StreamClause::kZeroAtStart);
    const Status status = stream_.start(limits);
    const bool started = status == Status::kOk && stream_.running();
    require(started, runs_ == 0 ? StreamClause::kLimitsTaken : StreamClause::kRestart);
    require(!started || same(stream_.limits(), limits), StreamClause::kLimitsTaken);
    const DriveProbe after = probe();
    require(after.last == 0 && after.frames - before.frames <= after.frames_since_nonzero,
            StreamClause::kZeroAtStart);
    look_at_zero(after);
    limits_ = limits;
    rounding_ = rounding;
    ++runs_;
    next_frame_ = 0;
    drive_ = 0;
    return started;
  }

  /// From now on, a start that fails is a restart that fails.
  void count_refused_start() { ++runs_; }

  /// Any exchange of `drive`, with a look at the time it takes.
  Exchange exchange(const std::vector<Word>& drive, std::vector<Frame>& response) {
    const double begin_s = bench_.now_s();
    const Exchange result = stream_.exchange(drive_span(drive), response_span(response));
    const double frames = (bench_.now_s() - begin_s) * format_.sample_rate_hz;
    // Time is a sum of frames, so it is right to far less than one.
    const double end = result.status == Status::kOk ? 0.0 : end_frames();
    require(frames <= 2.0 * block() + end + 1e-3, StreamClause::kBoundedWait);
    look_at_drive();
    return result;
  }

  /// A block that has to be taken. @returns False if it was not; the scenario ends there.
  bool good(const std::vector<Word>& drive) {
    const DriveProbe before = probe();
    const Exchange result = exchange(drive, response_);
    if (result.status != Status::kOk) {
      const StreamClause index =
          next_frame_ == 0 ? StreamClause::kFirstFrameZero : StreamClause::kNoGap;
      require(false, result.status == Status::kLostBlock ? index : StreamClause::kGoodBlockTaken);
      return false;
    }
    require(result.first_frame == next_frame_,
            next_frame_ == 0 ? StreamClause::kFirstFrameZero : StreamClause::kNoGap);
    // What the DAC's pipeline needs to fill may come on top of the first block, or lack.
    require(next_frame_ == 0 || probe().frames - before.frames == block(), StreamClause::kOneClock);
    next_frame_ += block();
    drive_ = drive.back();
    for (const Frame& frame : response_) {
      look_at_word(frame.reference);
      look_at_word(frame.device);
    }
    return true;
  }

  /// Goes to `target` along the slope and holds it for the latency and a block more.
  bool go_to(Word target) {
    std::vector<Word> words;
    std::int64_t word = drive_;
    while (word != target) {
      const std::int64_t step = std::int64_t{limits_.step_per_frame};
      word += std::max(-step, std::min(step, std::int64_t{target} - word));
      words.push_back(static_cast<Word>(word));
    }
    words.resize(words.size() + format_.latency_frames + 2 * std::size_t{block()}, target);
    words.resize(words.size() / block() * block());
    for (std::size_t i = 0; i < words.size(); i += block()) {
      const auto first = words.begin() + static_cast<std::ptrdiff_t>(i);
      if (!good({first, first + static_cast<std::ptrdiff_t>(block())})) {
        return false;
      }
    }
    require(rounding_ != 0 || probe().last == target, StreamClause::kDriveUnchanged);
    return true;
  }

  /// Nothing runs, and no call makes anything go out.
  void look_at_rest() {
    const DriveProbe before = probe();
    std::vector<Frame> response(block(), Frame{7, 7});
    const Exchange result = exchange(std::vector<Word>(block(), 0), response);
    require(result.status == Status::kNotRunning && !stream_.running(), StreamClause::kNotRunning);
    require(response.front().device == 7 && response.back().reference == 7,
            StreamClause::kNotRunning);
    require(timed_stop() == 0, StreamClause::kStopTwice);
    const DriveProbe after = probe();
    require(after.last == 0 && after.frames_since_nonzero - before.frames_since_nonzero ==
                                   after.frames - before.frames,
            StreamClause::kStaysAtZero);
  }

  /// After a fault that struck when the DAC was at `before`, `late` frames ago at most.
  void look_at_fault(const DriveProbe& before, std::uint64_t late) {
    require(!stream_.running(), StreamClause::kFaultStops);
    look_at_end(before, late);
  }

  void stop() {
    const DriveProbe before = probe();
    const std::uint32_t count = timed_stop();
    require(count == frames_to_zero(before, probe()), StreamClause::kStopCount);
    require(!stream_.running(), StreamClause::kNotRunning);
    look_at_end(before, 0);
  }

 private:
  static Span<const Word> drive_span(const std::vector<Word>& v) { return {v.data(), v.size()}; }
  static Span<Frame> response_span(std::vector<Frame>& v) { return {v.data(), v.size()}; }

  double end_frames() const {
    return static_cast<double>(hal::kMaxRampFrames) + format_.latency_frames;
  }

  std::uint32_t timed_stop() {
    const double begin_s = bench_.now_s();
    const std::uint32_t count = stream_.stop();
    const double frames = (bench_.now_s() - begin_s) * format_.sample_rate_hz;
    require(frames <= 2.0 * block() + end_frames() + 1e-3, StreamClause::kBoundedWait);
    look_at_drive();
    return count;
  }

  void look_at_end(const DriveProbe& before, std::uint64_t late) {
    const DriveProbe after = probe();
    require(after.last == 0 && frames_to_zero(before, after) <= hal::kMaxRampFrames + late,
            StreamClause::kZeroIn256);
    look_at_rest();
    drive_ = 0;
  }

  void look_at_drive() {
    const DriveProbe now = probe();
    require(now.max_amplitude <= static_cast<std::uint32_t>(limits_.amplitude),
            StreamClause::kAmplitudeKept);
    require(now.max_step <= static_cast<std::uint32_t>(limits_.step_per_frame) + rounding_,
            StreamClause::kSlopeKept);
    look_at_zero(now);
  }

  void look_at_zero(const DriveProbe& now) {
    const bool is_at_zero = now.last == 0 && !stream_.running();
    require(stream_.drive_is_at_zero() == is_at_zero, StreamClause::kTellsZero);
  }

  void look_at_word(Word word) {
    const std::uint32_t unused = expect_.input_bits < 32 ? 0xFFFFFFFFU >> expect_.input_bits : 0;
    require((static_cast<std::uint32_t>(word) & unused) == 0, StreamClause::kLeftJustified);
  }

  Bench& bench_;
  decltype(std::declval<Bench&>().stream()) stream_;
  const StreamExpectations& expect_;
  StreamViolations& violations_;
  const StreamFormat format_;
  std::vector<Frame> response_;
  DriveLimits limits_ = kSlowLimits;
  std::uint32_t rounding_ = 0;
  std::uint64_t next_frame_ = 0;
  std::uint32_t runs_ = 0;
  Word drive_ = 0;
};

/// The scenarios, each on a new bench.
template <typename Make>
class StreamSuite {
 public:
  StreamSuite(const Make& make, const StreamExpectations& expect) : make_(make), expect_(expect) {}

  StreamViolations run() {
    if (!format()) {
      return violations_;
    }
    limits();
    normal_run();
    block_size();
    amplitude();
    slope();
    words_of_32_bits();
    faults();
    latency();
    return violations_;
  }

 private:
  template <typename Scenario>
  void with_bench(const Scenario& scenario, StreamFault fault = StreamFault::kNone,
                  std::uint64_t at_frame = 0) {
    auto bench = make_(fault, at_frame);
    StreamRun<decltype(bench)> run(bench, expect_, violations_);
    scenario(run);
  }

  bool format() {
    bool usable = false;
    with_bench([&](auto& run) {
      const StreamFormat first = run.stream().format();
      usable = first.block_frames >= 1 && first.block_frames <= hal::kMaxBlockFrames;
      usable = usable && first.sample_rate_hz > 0.0 && std::isfinite(first.sample_rate_hz);
      usable = usable && first.drive_full_scale_v > 0.0 && std::isfinite(first.drive_full_scale_v);
      usable = usable && first.input_full_scale_v > 0.0 && std::isfinite(first.input_full_scale_v);
      if (usable && run.start(kSlowLimits)) {
        run.require(same(run.stream().format(), first), StreamClause::kFormat);
        run.stop();
      }
      run.require(usable && same(run.stream().format(), first), StreamClause::kFormat);
    });
    return usable;
  }

  void limits() {
    with_bench([&](auto& run) {
      run.look_at_rest();
      const DriveLimits refused[] = {{0, 1},
                                     {-1, 1},
                                     {kLeast, kMost},
                                     {1, 0},
                                     {1, -1},
                                     {kMost, kLeast},
                                     {257, 1},
                                     {kFullDrive, kStep - 1},
                                     {kMost, kStep},
                                     {-512, -2},
                                     {kMost, (kMost / 256)},
                                     {65537, 256}};
      for (const DriveLimits& limits : refused) {
        const DriveLimits before = run.stream().limits();
        run.require(run.stream().start(limits) == Status::kInvalidArgument &&
                        !run.stream().running() && same(run.stream().limits(), before) &&
                        run.probe().max_amplitude == 0,
                    StreamClause::kLimitsRefused);
        run.stream().stop();
      }
    });
    const DriveLimits taken[] = {kSlowLimits, kPulseLimits,   kGreatestLimits, {1, 1},
                                 {256, 1},    {kMost, kMost}, {65536, 256},    {1, kMost}};
    for (const DriveLimits& limits : taken) {
      with_bench([&](auto& run) {
        if (run.start(limits) && run.good(std::vector<Word>(run.block(), 0))) {
          run.stop();
        }
      });
    }
  }

  void normal_run() {
    with_bench([&](auto& run) {
      run.look_at_rest();
      for (int repeat = 0; repeat < 3; ++repeat) {
        if (!run.start(kSlowLimits)) {
          return;
        }
        const DriveProbe quiet = run.probe();
        const std::uint32_t last = expect_.settle_frames + 1024;
        for (std::uint32_t frames = 0; frames < last; frames += run.block()) {
          if (!run.good(std::vector<Word>(run.block(), 0))) {
            return;
          }
          for (const Frame& frame : run.response()) {
            const bool settled = repeat == 0 || frames >= expect_.settle_frames;
            run.require(!settled || (is_quiet(frame.reference) && is_quiet(frame.device)),
                        StreamClause::kZeroIsZero);
          }
        }
        run.require(run.probe().frames - quiet.frames <= run.probe().frames_since_nonzero,
                    StreamClause::kZeroAtStart);
        const Word stations[] = {kFullDrive, -kFullDrive, kStep, -3 * kStep, kFullDrive / 2};
        for (const Word station : stations) {
          if (!run.go_to(station)) {
            return;
          }
        }
        second_start(run);
        if (!run.go_to(repeat == 1 ? -kFullDrive : kFullDrive)) {
          return;
        }
        run.stop();
      }
      // A drive that is at zero needs no ramp.
      if (run.start(kSlowLimits) && run.go_to(kStep) && run.go_to(0)) {
        run.stop();
      }
    });
  }

  template <typename Run>
  void second_start(Run& run) {
    const DriveProbe before = run.probe();
    for (const DriveLimits& limits : {kPulseLimits, kSlowLimits}) {
      run.require(run.stream().start(limits) == Status::kAlreadyRunning && run.stream().running() &&
                      same(run.stream().limits(), kSlowLimits) && same(run.probe(), before),
                  StreamClause::kAlreadyRunning);
    }
  }

  bool is_quiet(Word word) const {
    return std::int64_t{word} <= expect_.quiet &&
           std::int64_t{word} >= -std::int64_t{expect_.quiet};
  }

  void block_size() {
    with_bench([&](auto& run) {
      if (!run.start(kSlowLimits) || !run.go_to(kFullDrive)) {
        return;
      }
      const std::size_t right = run.block();
      const std::size_t sizes[][2] = {{right - 1, right},
                                      {right + 1, right},
                                      {right, right - 1},
                                      {right, right + 1},
                                      {0, right},
                                      {right, 0},
                                      {0, 0},
                                      {right + 1, right + 1},
                                      {2 * right, 2 * right}};
      for (const auto& size : sizes) {
        const DriveProbe before = run.probe();
        std::vector<Frame> response(size[1], Frame{7, 7});
        const Exchange result =
            run.exchange(std::vector<Word>(size[0], run.drive() - kStep), response);
        bool untouched = true;
        for (const Frame& frame : response) {
          untouched = untouched && frame.reference == 7 && frame.device == 7;
        }
        run.require(result.status == Status::kInvalidArgument && run.stream().running() &&
                        untouched && same(run.probe(), before),
                    StreamClause::kBlockSize);
        if (!run.stream().running() || !run.good(std::vector<Word>(right, run.drive()))) {
          run.require(false, StreamClause::kBlockSize);
          return;
        }
      }
      run.stop();
    });
  }

  /// Goes to `begin` within `limits` and hands over a block of that, into which `prepare` puts
  /// something to refuse.
  template <typename Prepare>
  void refused(const DriveLimits& limits, Word begin, StreamClause clause, const Prepare& prepare,
               std::uint32_t rounding = 0) {
    with_bench([&](auto& run) {
      if (!run.start(limits, rounding) || (begin != 0 && !run.go_to(begin))) {
        return;
      }
      std::vector<Word> drive(run.block(), begin);
      prepare(drive);
      const DriveProbe before = run.probe();
      std::vector<Frame> response(run.block(), Frame{7, 7});
      const Exchange result = run.exchange(drive, response);
      run.require(result.status == Status::kDriveLimit, clause);
      const DriveProbe after = run.probe();
      run.require(after.max_amplitude == before.max_amplitude && response.front().device == 7 &&
                      response.back().reference == 7,
                  result.status == Status::kDriveLimit ? StreamClause::kRefusedBlockStays : clause);
      if (result.status != Status::kDriveLimit) {
        run.stream().stop();
        return;
      }
      run.look_at_fault(before, 0);
      again(run, limits, rounding);
    });
  }

  /// A run after a fault, from zero.
  template <typename Run>
  void again(Run& run, const DriveLimits& limits, std::uint32_t rounding) {
    if (!run.start(limits, rounding)) {
      return;
    }
    if (run.go_to(limits.step_per_frame)) {
      run.stop();
    }
  }

  void amplitude() {
    const auto last_word = [](Word word) {
      return [word](std::vector<Word>& drive) { drive.back() = word; };
    };
    constexpr StreamClause kClause = StreamClause::kAmplitude;
    refused(kSlowLimits, kFullDrive, kClause, last_word(kFullDrive + 1));
    refused(kSlowLimits, -kFullDrive, kClause, last_word(-kFullDrive - 1));
    // Of -2^31, an int has no absolute value.
    refused(kGreatestLimits, -kGreatestLimits.amplitude, kClause, last_word(kLeast), kDacRounding);
    refused(kSlowLimits, kFullDrive, kClause,
            [](std::vector<Word>& drive) { drive.front() = kFullDrive + 1; });
    refused(kPulseLimits, 0, kClause, last_word(kFullDrive + 1));
  }

  void slope() {
    for (const Word sign : {1, -1}) {
      const Word begin = sign * (kFullDrive / 2);
      const auto steps = [sign](std::size_t at) {
        return [sign, at](std::vector<Word>& drive) {
          std::int64_t word = drive.front();
          for (std::size_t i = 0; i < drive.size(); ++i) {
            word += sign * std::int64_t{kStep} + (i == at % drive.size() ? sign : 0);
            drive[i] = static_cast<Word>(word);
          }
        };
      };
      refused(kSlowLimits, 0, StreamClause::kSlope, steps(0));
      refused(kSlowLimits, begin, StreamClause::kSlopeAcrossBlocks, steps(0));
      if (block_frames() > 1) {
        refused(kSlowLimits, begin, StreamClause::kSlope, steps(1));
        refused(kSlowLimits, begin, StreamClause::kSlope, steps(block_frames() - 1));
      }
      // Towards zero and through it.
      refused(kSlowLimits, begin, StreamClause::kSlopeAcrossBlocks,
              [sign](std::vector<Word>& drive) {
                const Word word = drive.front() - sign * (kStep + 1);
                std::fill(drive.begin(), drive.end(), word);
              });
    }
  }

  /// The greatest change of all needs 33 bits: in 32 it looks like -2.
  void words_of_32_bits() {
    refused(
        kGreatestLimits, -kMost, StreamClause::kSlopeAcrossBlocks,
        [](std::vector<Word>& drive) { std::fill(drive.begin(), drive.end(), kMost); },
        kDacRounding);
  }

  void fault(StreamFault kind, StreamClause clause, Status expected) {
    for (const std::uint32_t at_frame : {4000U, 4095U, 4096U}) {
      with_bench(
          [&](auto& run) {
            if (!run.start(kSlowLimits) ||
                !run.go_to(at_frame == 4095U ? -kFullDrive : kFullDrive)) {
              return;
            }
            const std::vector<Word> hold(run.block(), run.drive());
            for (std::uint32_t frames = 0; frames < 8192; frames += run.block()) {
              const DriveProbe before = run.probe();
              std::vector<Frame> response(run.block());
              const Exchange result = run.exchange(hold, response);
              if (result.status == Status::kOk) {
                continue;
              }
              run.require(result.status == expected, clause);
              // The block itself, and what was lost or waited for.
              run.look_at_fault(before, 3 * std::uint64_t{run.block()});
              again(run, kSlowLimits, 0);
              return;
            }
            run.require(false, clause);
            run.stop();
          },
          kind, at_frame);
    }
  }

  void faults() {
    if (expect_.can_lose_block) {
      fault(StreamFault::kLostBlock, StreamClause::kLostBlock, Status::kLostBlock);
    }
    if (expect_.can_be_late) {
      fault(StreamFault::kLateBlock, StreamClause::kLateBlock, Status::kLateBlock);
    }
    if (expect_.can_fail) {
      fault(StreamFault::kHardwareFault, StreamClause::kHardwareFault, Status::kHardwareFault);
    }
    if (!expect_.can_refuse_start) {
      return;
    }
    with_bench(
        [&](auto& run) {
          const Status status = run.stream().start(kSlowLimits);
          run.require(status == Status::kHardwareFault && !run.stream().running() &&
                          run.probe().max_amplitude == 0,
                      StreamClause::kStartFault);
          if (status == Status::kOk) {
            run.stream().stop();
            return;
          }
          run.look_at_rest();
          run.count_refused_start();
          again(run, kSlowLimits, 0);
        },
        StreamFault::kStartFault);
  }

  void latency() {
    with_bench([&](auto& run) {
      const std::uint32_t block = run.block();
      const std::uint32_t places[] = {0, 1, block - 1, block, 5 * block + block / 2, 1000, 4095};
      std::vector<std::int64_t> delays;
      for (const std::uint32_t place : places) {
        if (!run.start(kPulseLimits)) {
          return;
        }
        std::vector<std::int64_t> reference;
        const std::uint32_t stated = run.stream().format().latency_frames;
        // The last run's response dies out first.
        const std::uint32_t begin = place + expect_.settle_frames;
        const std::uint32_t end = begin + stated + expect_.arrival_spread + 256;
        for (std::uint32_t at = 0; at < end; at += block) {
          std::vector<Word> drive(block, 0);
          for (std::uint32_t i = 0; i < block; ++i) {
            drive[i] = at + i >= begin && at + i < begin + kPulseFrames ? kFullDrive : 0;
          }
          if (!run.good(drive)) {
            return;
          }
          for (const Frame& frame : run.response()) {
            reference.push_back(frame.reference);
          }
        }
        delays.push_back(delay_of(reference, begin, stated));
        run.stop();
      }
      const std::int64_t stated = run.stream().format().latency_frames;
      for (const std::int64_t delay : delays) {
        run.require(delay >= stated && delay <= stated + std::int64_t{expect_.arrival_spread},
                    StreamClause::kStatedLatency);
        run.require(delay == delays.front(), StreamClause::kConstantLatency);
      }
    });
  }

  /// Frames from the pulse to the first word that differs from what came before by the threshold;
  /// -1 if there is none.
  std::int64_t delay_of(const std::vector<std::int64_t>& reference, std::uint32_t begin,
                        std::uint32_t stated) const {
    const std::size_t arrival = std::size_t{begin} + stated;
    const std::size_t from = arrival > 32 ? arrival - 32 : 0;
    const std::int64_t before = from < arrival ? reference[from] : 0;
    for (std::size_t i = from; i < reference.size(); ++i) {
      if (std::abs(reference[i] - before) > expect_.arrival) {
        return static_cast<std::int64_t>(i) - begin;
      }
    }
    return -1;
  }

  std::uint32_t block_frames() const {
    auto bench = make_(StreamFault::kNone, std::uint64_t{0});
    return bench.stream().format().block_frames;
  }

  static constexpr std::uint32_t kPulseFrames = 16;

  const Make& make_;
  const StreamExpectations& expect_;
  StreamViolations violations_;
};

}  // namespace detail

/// Takes a stream through the whole contract, on a new bench for each scenario.
///
/// @param[in] make   Called as `make(fault, at_frame)`, returns a bench whose stream was never
///                   started. A lost or late block or a hardware fault strikes once, in the first
///                   exchange whose block contains `at_frame` of the bench's frames, a fault at
///                   start in the first one. A bench has
///                   * `stream()`: the stream by reference, as AnalogStream or as a class with the
///                     same public functions,
///                   * `drive()`: a DriveProbe, at the physical output,
///                   * `now_s()`: the time, virtual or not.
/// @returns The clauses that were seen violated. One mistake may violate more than one; a scenario
///          ends early where it makes no sense any more.
template <typename Make>
StreamViolations violated_clauses(const Make& make, const StreamExpectations& expect = {}) {
  return detail::StreamSuite<Make>(make, expect).run();
}

}  // namespace emax::test
