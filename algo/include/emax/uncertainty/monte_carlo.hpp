// The Monte Carlo procedure of JCGM 101: statistics and exact coverage intervals in fixed memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/monte_carlo_store.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {

inline constexpr std::uint32_t kMinTrials = 1000;

/// The number of trials that the paper's relation (3) and JCGM 101 7.2.2 ask for: the smallest M >=
/// 1e4/(1 - p).
///
/// The paper prints M > 1e4/(1 - p) and takes M = 2e5 at p = 0.95, where both sides are equal. So
/// equality counts here, and a quotient within 1e-9 relative of a whole number is that number: 1 -
/// 0.95 is not 0.05 in binary.
///
/// @returns M; 0 if p is not inside (0, 1) or M does not fit into 32 bits.
std::uint32_t minimum_trials(double probability) noexcept;

struct CoverageInterval {
  double low = 0.0;
  double high = 0.0;
};

struct MonteCarloResult {
  Status status = Status::kOk;
  std::uint32_t trials = 0;  ///< M.
  double probability = 0.0;
  double mean = 0.0;  ///< The estimate of the output, JCGM 101 7.6.
  double u = 0.0;     ///< Its standard uncertainty, with the divisor M - 1.
  double minimum = 0.0;
  double maximum = 0.0;
  std::uint32_t trial_of_minimum = 0;  ///< The first of them, from 0.
  std::uint32_t trial_of_maximum = 0;
  CoverageInterval symmetric;  ///< [y_(r), y_(r+q)], r = (M - q)/2: probabilistically symmetric.
  CoverageInterval shortest;   ///< [y_(r), y_(r+q)] with the r that makes it (nearly) the shortest.
  std::uint32_t failed_trial = 0;  ///< With kInvalidArgument: the trial that ended the procedure.
};

/// Takes the values of M trials, several times over, and keeps none.
///
///     monte_carlo.start(trials, probability, store);
///     while (!monte_carlo.done()) {
///       monte_carlo.add(evaluate(monte_carlo.next_trial()), store);
///     }
///
/// Trials replay: `evaluate(t)` gives the same value each time it is asked for trial t, so no store
/// is needed. (A caller with the memory may store the values of the first pass and feed them again
/// in the later ones.) The passes:
///
/// 1. minimum, maximum and their trials, mean and u (Welford's updates, about the first value);
/// 2. a histogram of kBins equal bins from minimum to maximum, and of their halves;
/// 3. the values of the half bins that hold the ends of the intervals, sorted: so the ends are
/// exact order statistics.
///
/// If these half bins hold more than kPoolSize values, they are narrowed first, 256 times in each
/// further pass, up to 8 of them: for a smooth distribution not below about M = 1e6. Values that
/// are all the same need one pass only.
///
/// What is guaranteed: q = pM rounded to the nearest whole number (JCGM 101 7.7.2). Both intervals
/// run from y_(r) to y_(r+q), values that occurred and exact members of the sorted sequence, ties
/// included; so each holds q + 1 of the M values or more. r = (M - q)/2, rounded up from a half,
/// for the symmetric one. The r of the shortest one is chosen from the histogram: no interval from
/// y_(s) to y_(s+q) is shorter by more than one bin width, (maximum - minimum)/kBins. Where the
/// values are many per bin and vary smoothly, the difference is a small part of that.
///
/// 0.3 KiB beside the store, which is the same in each call. Per value: one division in the first
/// pass, one in the second, up to 8 comparisons in the others. At the end of the second pass up to
/// 16 kBins divisions, at the end of the others sorting of up to kPoolSize values.
class MonteCarlo {
 public:
  static constexpr std::size_t kBins = MonteCarloStore::kBins;
  static constexpr std::size_t kPoolSize = MonteCarloStore::kPoolSize;

  /// Starts over.
  ///
  /// @param[in]  trials      M, kMinTrials or more.
  /// @param[in]  probability p inside (0, 1).
  /// @param[out] store       Nobody else's until the results have been taken.
  /// @returns
  /// * kOk: Ready for trial 0.
  /// * kTooFewTrials: Fewer than kMinTrials, or q = pM would be M: no interval holds that share of
  /// so few trials.
  /// * kInvalidArgument: A probability outside (0, 1) or not a number, or q = pM rounds to zero.
  /// On failure a running procedure goes on unchanged.
  Status start(std::uint32_t trials, double probability, MonteCarloStore& store) noexcept;

  /// @returns True before the first `start()`, after the last pass, and after a failure.
  bool done() const noexcept { return stage_ == Stage::kIdle || stage_ == Stage::kDone; }

  /// @returns The number of the trial whose value comes next, from 0 to M - 1, then from 0 again.
  std::uint32_t next_trial() const noexcept { return trial_; }

  /// Takes the value of trial `next_trial()`. Ignored when done.
  ///
  /// A value that is not a number, or beyond ±1e145 (whose squares could overflow), ends the
  /// procedure: `done()` is true, the result's status is kInvalidArgument and `failed_trial` says
  /// which. So does a later pass whose values are not those of the first, as far as that is seen;
  /// `failed_trial` is M where no single value shows it.
  void add(double value, MonteCarloStore& store) noexcept;

  /// @returns All with kOk once `done()`. Before that kTooFewTrials, with zeros except for the
  /// results of the first pass if it is complete. After a failure kInvalidArgument and
  /// `failed_trial`, the rest being zero.
  MonteCarloResult result() const noexcept;

  /// @returns From 0 to 1, never going back. A fourth pass, if needed, shares what is left then.
  double progress() const noexcept;

  /// @returns The pass that runs or was the last, from 1; 0 before the first `start()`.
  std::uint32_t pass() const noexcept { return pass_; }

  /// @returns Once `done()` with kOk, the number of values in each of the kBins equal bins from
  /// `minimum` to `maximum` (the maximum itself counts in the last one); the sum is M. If all
  /// values are the same, all are in the first bin.
  Span<const std::uint32_t> histogram(const MonteCarloStore& store) const noexcept;

 private:
  enum class Stage : std::uint8_t { kIdle, kRange, kHistogram, kSelect, kDone };

  // One wanted order statistic: it lies in the keys from low_key to high_key, `rank` values into
  // them.
  struct Target {
    std::uint64_t low_key;
    std::uint64_t high_key;
    std::uint32_t rank;    // From 0, among the values inside.
    std::uint32_t inside;  // How many values there are inside.
    std::uint32_t offset;  // The first of its places in the pool.
    std::uint32_t filled;
    std::uint8_t shift;  // Key to sub-bin, when narrowing.
    bool collecting;
    bool found;
  };
  static constexpr std::size_t kTargets = 4;
  static constexpr std::size_t kSubBins = 256;
  static constexpr std::size_t kHalfBins = 2 * kBins;
  static_assert(kBins == 2 * kPoolSize);

  std::size_t half_bin_of(double value) const noexcept;
  static std::uint32_t count_of_half_bin(std::size_t half, const MonteCarloStore& store) noexcept;
  std::uint64_t first_key_of_half_bin(std::size_t half) const noexcept;
  void add_to_range(double value) noexcept;
  void add_to_histogram(double value, MonteCarloStore& store) noexcept;
  void add_to_targets(double value, MonteCarloStore& store) noexcept;
  void end_pass(MonteCarloStore& store) noexcept;
  void aim(const MonteCarloStore& store) noexcept;
  void set_target(std::size_t index, std::uint32_t order, const MonteCarloStore& store) noexcept;
  std::uint32_t shortest_order(const MonteCarloStore& store) const noexcept;
  bool plan_targets(MonteCarloStore& store) noexcept;
  bool settle_targets(MonteCarloStore& store) noexcept;
  void fail() noexcept;
  void finish() noexcept;

  Target targets_[kTargets] = {};
  double probability_ = 0.0;
  double origin_ = 0.0;  // The first value; mean and squares are of the differences from it.
  double mean_ = 0.0;
  double squares_ = 0.0;
  double minimum_ = 0.0;
  double maximum_ = 0.0;
  double progress_base_ = 0.0;
  std::uint32_t trials_ = 0;
  std::uint32_t covered_ = 0;  // q.
  std::uint32_t trial_ = 0;
  std::uint32_t trial_of_minimum_ = 0;
  std::uint32_t trial_of_maximum_ = 0;
  std::uint32_t pass_ = 0;
  std::uint32_t passes_left_ = 0;  // With the one that runs.
  Stage stage_ = Stage::kIdle;
  bool failed_ = false;
};

static_assert(std::is_trivially_copyable_v<MonteCarlo>);
static_assert(sizeof(MonteCarlo) <= 384);

struct AdaptiveResult {
  Status status = Status::kOk;
  bool stabilised = false;   ///< False if the limit on blocks came first.
  std::uint32_t trials = 0;  ///< Blocks times the size of a block: the number of trials found.
  std::uint32_t blocks = 0;
  double tolerance = 0.0;      ///< delta, half a unit of the last significant digit of u.
  double mean = 0.0;           ///< Over all trials.
  double u = 0.0;              ///< Over all trials.
  CoverageInterval symmetric;  ///< Each end the mean over blocks.
  double s_mean =
      0.0;  ///< Standard deviations of the means over blocks of y, u(y), y_low and y_high.
  double s_u = 0.0;
  double s_low = 0.0;
  double s_high = 0.0;
  std::uint32_t failed_trial = 0;  ///< With kInvalidArgument.
};

/// The adaptive procedure of JCGM 101 7.9: blocks of trials are added until the results are stable.
///
/// After each block but the first: stop when twice the standard deviation of the mean over blocks
/// of y, u(y), y_low and y_high (probabilistically symmetric interval) is each not above delta =
/// 10^l/2, where u(y) over all trials is c 10^l with c a whole number of the given significant
/// digits.
///
/// Finds the number of trials; run a `MonteCarlo` over that many (the same engine will do) for
/// exact results over all of them. The rule stops too early at times: it looks at few blocks.
///
/// An engine takes each block: the same one in each call, with its store, and no other use of it
/// until `done()`. 120 bytes beside it.
class AdaptiveTrials {
 public:
  static constexpr std::uint32_t kDefaultDigits = 2;
  static constexpr std::uint32_t kDefaultMaxBlocks = 100;

  /// Starts over, with blocks of max(ceil(100/(1 - p)), 1e4) trials.
  ///
  /// @param[in] probability        p inside (0, 1).
  /// @param[in] significant_digits Of u(y): 1 to 4.
  /// @param[in] max_blocks         2 or more; at most 2^32 - 1 trials in all.
  /// @returns
  /// * kOk: Ready for trial 0.
  /// * kInvalidArgument: A value outside its range. Nothing has changed.
  Status start(MonteCarlo& engine, MonteCarloStore& store, double probability,
               std::uint32_t significant_digits = kDefaultDigits,
               std::uint32_t max_blocks = kDefaultMaxBlocks) noexcept;

  bool done() const noexcept { return !running_; }

  /// @returns The number of the trial whose value comes next, counted over all blocks. The trials
  /// of a block are asked for again until the engine has its intervals; then come those of the next
  /// block.
  std::uint32_t next_trial(const MonteCarlo& engine) const noexcept;

  /// @returns The number of trials in the blocks so far, with the one that runs.
  std::uint32_t end_of_block() const noexcept { return (blocks_ + 1) * block_size_; }

  /// As `MonteCarlo::add()`.
  void add(double value, MonteCarlo& engine, MonteCarloStore& store) noexcept;

  /// @returns All with kOk once `done()`, stable or not; before that kTooFewTrials with the blocks
  /// complete so far. After a failure kInvalidArgument and `failed_trial`.
  AdaptiveResult result() const noexcept;

 private:
  // Mean and sum of squares about it, of one quantity over the blocks.
  struct Scatter {
    double mean;
    double squares;
  };
  static constexpr std::size_t kQuantities = 4;
  static constexpr std::uint32_t kMinBlockSize = 10000;

  void end_block(MonteCarlo& engine, MonteCarloStore& store) noexcept;
  double scatter_of_mean(std::size_t quantity) const noexcept;
  double standard_uncertainty() const noexcept;
  bool stable() const noexcept;

  Scatter scatter_[kQuantities] = {};
  double probability_ = 0.0;
  double squares_ = 0.0;  // Of all values about the mean of all values.
  std::uint32_t block_size_ = 0;
  std::uint32_t blocks_ = 0;
  std::uint32_t max_blocks_ = 0;
  std::uint32_t digits_ = 0;
  std::uint32_t failed_trial_ = 0;
  bool running_ = false;
  bool stabilised_ = false;
  bool failed_ = false;
};

static_assert(std::is_trivially_copyable_v<AdaptiveTrials>);

/// @returns delta of JCGM 101 7.9.2: half a unit of the last of the given significant digits of u;
/// 0 for u = 0. u is finite and not negative, digits 1 to 4.
double numerical_tolerance(double u, std::uint32_t significant_digits) noexcept;

}  // namespace emax
