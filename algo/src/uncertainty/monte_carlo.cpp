// The Monte Carlo procedure of JCGM 101: statistics and exact coverage intervals in fixed memory.
#include "emax/uncertainty/monte_carlo.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

constexpr double kLargestValue = 1e145;
constexpr double kMaxCount = 4294967295.0;
constexpr double kWholeNumber = 1e-9;
constexpr std::uint64_t kSignBit = std::uint64_t{1} << 63U;

// A key is a whole number that orders as the value does: so a range of values can be cut into equal
// parts down to a single value, whatever the sizes of the numbers in it.
std::uint64_t key_of(double value) noexcept {
  const double unsigned_zero = value + 0.0;
  std::uint64_t bits = 0;
  __builtin_memcpy(&bits, &unsigned_zero, sizeof bits);
  return (bits & kSignBit) != 0 ? ~bits : bits | kSignBit;
}

double value_of(std::uint64_t key) noexcept {
  const std::uint64_t bits = (key & kSignBit) != 0 ? key & ~kSignBit : ~key;
  double value = 0.0;
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

// The smallest whole number not below x, for x in [0, 2^32); a number within rounding of a whole
// one is that one.
std::uint32_t round_up(double x) noexcept {
  const double nearest = floor(x + 0.5);
  if (abs(x - nearest) <= kWholeNumber * x) {
    return static_cast<std::uint32_t>(nearest);
  }
  const double below = floor(x);
  return static_cast<std::uint32_t>(below) + 1U;
}

}  // namespace

std::uint32_t minimum_trials(double probability) noexcept {
  if (!(probability > 0.0) || !(probability < 1.0)) {
    return 0;
  }
  const double trials = 1e4 / (1.0 - probability);
  return trials < kMaxCount ? round_up(trials) : 0;
}

double numerical_tolerance(double u, std::uint32_t significant_digits) noexcept {
  if (!(u > 0.0)) {
    return 0.0;
  }
  double limit = 1.0;
  for (std::uint32_t i = 0; i < significant_digits; ++i) {
    limit *= 10.0;
  }
  limit -= 0.5;
  double unit = 1.0;
  while (u / unit >= limit) {
    unit *= 10.0;
  }
  if (unit > 1.0) {
    return 0.5 * unit;
  }
  double inverse_unit = 1.0;
  while (u * (10.0 * inverse_unit) < limit) {
    inverse_unit *= 10.0;
  }
  return 0.5 / inverse_unit;
}

Status MonteCarlo::start(std::uint32_t trials, double probability,
                         MonteCarloStore& store) noexcept {
  if (!(probability > 0.0) || !(probability < 1.0)) {
    return Status::kInvalidArgument;
  }
  if (trials < kMinTrials) {
    return Status::kTooFewTrials;
  }
  const double share = floor(probability * static_cast<double>(trials) + 0.5);
  if (share < 1.0) {
    return Status::kInvalidArgument;
  }
  if (share >= static_cast<double>(trials)) {
    return Status::kTooFewTrials;
  }
  trials_ = trials;
  covered_ = static_cast<std::uint32_t>(share);
  probability_ = probability;
  origin_ = 0.0;
  mean_ = 0.0;
  squares_ = 0.0;
  minimum_ = 0.0;
  maximum_ = 0.0;
  trial_ = 0;
  trial_of_minimum_ = 0;
  trial_of_maximum_ = 0;
  progress_base_ = 0.0;
  passes_left_ = 3;
  pass_ = 1;
  failed_ = false;
  for (std::uint32_t& bin : store.bins) {
    bin = 0;
  }
  stage_ = Stage::kRange;
  return Status::kOk;
}

void MonteCarlo::add(double value, MonteCarloStore& store) noexcept {
  if (done()) {
    return;
  }
  if (!(value >= -kLargestValue) || !(value <= kLargestValue)) {
    fail();
    return;
  }
  if (stage_ == Stage::kRange) {
    add_to_range(value);
  } else if (value < minimum_ || value > maximum_) {
    fail();
    return;
  } else if (stage_ == Stage::kHistogram) {
    add_to_histogram(value, store);
  } else {
    add_to_targets(value, store);
  }
  ++trial_;
  if (trial_ == trials_) {
    end_pass(store);
  }
}

void MonteCarlo::add_to_range(double value) noexcept {
  if (trial_ == 0 || value < minimum_) {
    minimum_ = value;
    trial_of_minimum_ = trial_;
  }
  if (trial_ == 0 || value > maximum_) {
    maximum_ = value;
    trial_of_maximum_ = trial_;
  }
  if (trial_ == 0) {
    origin_ = value;
  }
  const double difference = value - origin_;
  const double delta = difference - mean_;
  mean_ += delta / (static_cast<double>(trial_) + 1.0);
  squares_ += delta * (difference - mean_);
}

// The pool is free in this pass: it counts the values in the upper half of each bin, two counts to
// a place.
void MonteCarlo::add_to_histogram(double value, MonteCarloStore& store) noexcept {
  const std::size_t half = half_bin_of(value);
  const std::size_t bin = half / 2;
  ++store.bins[bin];
  if (half % 2 != 0) {
    store.pool[bin / 2] += std::uint64_t{1} << (bin % 2 * 32);
  }
}

std::uint32_t MonteCarlo::count_of_half_bin(std::size_t half,
                                            const MonteCarloStore& store) noexcept {
  const std::size_t bin = half / 2;
  const auto upper = static_cast<std::uint32_t>(store.pool[bin / 2] >> (bin % 2 * 32));
  return half % 2 != 0 ? upper : store.bins[bin] - upper;
}

void MonteCarlo::add_to_targets(double value, MonteCarloStore& store) noexcept {
  const std::uint64_t key = key_of(value);
  for (Target& target : targets_) {
    if (target.found || key < target.low_key || key > target.high_key) {
      continue;
    }
    if (!target.collecting) {
      ++store.pool[target.offset + ((key - target.low_key) >> target.shift)];
    } else if (target.filled < target.inside) {
      store.pool[target.offset + target.filled] = key;
    }
    ++target.filled;
  }
}

void MonteCarlo::end_pass(MonteCarloStore& store) noexcept {
  progress_base_ += (1.0 - progress_base_) / static_cast<double>(passes_left_);
  if (stage_ == Stage::kRange) {
    if (minimum_ == maximum_) {
      store.bins[0] = trials_;
      finish();
      return;
    }
    for (std::uint64_t& place : store.pool) {
      place = 0;
    }
    stage_ = Stage::kHistogram;
    passes_left_ = 2;
  } else {
    if (stage_ == Stage::kHistogram) {
      aim(store);
      stage_ = Stage::kSelect;
    } else if (!settle_targets(store)) {
      fail();
      return;
    }
    if (!plan_targets(store)) {
      finish();
      return;
    }
  }
  trial_ = 0;
  ++pass_;
}

// The histogram is complete: names the four order statistics and the bins they lie in.
void MonteCarlo::aim(const MonteCarloStore& store) noexcept {
  const std::uint32_t outside = trials_ - covered_;
  const std::uint32_t symmetric = outside / 2U + outside % 2U;
  const std::uint32_t shortest = shortest_order(store);
  set_target(0, symmetric, store);
  set_target(1, symmetric + covered_, store);
  set_target(2, shortest, store);
  set_target(3, shortest + covered_, store);
}

std::size_t MonteCarlo::half_bin_of(double value) const noexcept {
  const double position =
      (value - minimum_) / (maximum_ - minimum_) * static_cast<double>(kHalfBins);
  const std::size_t half = static_cast<std::size_t>(position);
  return half < kHalfBins ? half : kHalfBins - 1;
}

// By bisection on `half_bin_of()` itself, which rises with the value: so the bins of values and of
// keys are the same ones.
std::uint64_t MonteCarlo::first_key_of_half_bin(std::size_t half) const noexcept {
  std::uint64_t low = key_of(minimum_);
  std::uint64_t high = key_of(maximum_) + 1;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (half_bin_of(value_of(middle)) < half) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

void MonteCarlo::set_target(std::size_t index, std::uint32_t order,
                            const MonteCarloStore& store) noexcept {
  std::uint32_t rank = order - 1;
  std::size_t half = 0;
  while (rank >= count_of_half_bin(half, store)) {
    rank -= count_of_half_bin(half, store);
    ++half;
  }
  Target& target = targets_[index];
  target = Target();
  target.low_key = first_key_of_half_bin(half);
  target.high_key = first_key_of_half_bin(half + 1) - 1;
  target.rank = rank;
  target.inside = count_of_half_bin(half, store);
}

// The r for which y_(r) and y_(r+q) are the fewest half bins apart; among those, the closest if the
// values of each were spread evenly in it. While both ends stay in theirs that distance is linear
// in r, so only the ends of such stretches are looked at.
std::uint32_t MonteCarlo::shortest_order(const MonteCarloStore& store) const noexcept {
  const std::uint32_t last = trials_ - covered_;
  std::size_t i = 0;
  std::size_t j = 0;
  std::uint32_t below_i = 0;
  std::uint32_t below_j = 0;
  std::uint32_t best = 1;
  std::size_t best_gap = kHalfBins;
  double best_distance = 0.0;
  std::uint32_t r = 1;
  while (r <= last) {
    while (r - below_i > count_of_half_bin(i, store)) {
      below_i += count_of_half_bin(i, store);
      ++i;
    }
    while (r + covered_ - below_j > count_of_half_bin(j, store)) {
      below_j += count_of_half_bin(j, store);
      ++j;
    }
    const std::uint32_t inside_i = count_of_half_bin(i, store);
    const std::uint32_t inside_j = count_of_half_bin(j, store);
    const std::uint32_t left_i = below_i + inside_i - r;
    const std::uint32_t left_j = below_j + inside_j - covered_ - r;
    const std::uint32_t stretch = std::min(std::min(left_i, left_j), last - r);
    const std::uint32_t ends[2] = {r, r + stretch};
    for (const std::uint32_t s : ends) {
      const double at_i = (static_cast<double>(s - below_i) - 0.5) / static_cast<double>(inside_i);
      const double at_j =
          (static_cast<double>(s + covered_ - below_j) - 0.5) / static_cast<double>(inside_j);
      const std::size_t gap = j - i;
      const double distance = static_cast<double>(gap) + at_j - at_i;
      if (gap < best_gap || (gap == best_gap && distance < best_distance)) {
        best = s;
        best_gap = gap;
        best_distance = distance;
      }
    }
    r += stretch + 1;
  }
  return best;
}

// Shares the pool out. False if nothing is left to look for.
bool MonteCarlo::plan_targets(MonteCarloStore& store) noexcept {
  std::uint64_t total = 0;
  bool pending = false;
  for (Target& target : targets_) {
    target.found = target.low_key == target.high_key;
    if (!target.found) {
      pending = true;
      total += target.inside;
    }
  }
  const bool all_fit = total <= kPoolSize;
  passes_left_ = all_fit ? 1 : 2;
  std::uint32_t offset = 0;
  for (Target& target : targets_) {
    if (target.found) {
      continue;
    }
    target.filled = 0;
    target.offset = offset;
    target.collecting = all_fit || target.inside <= kSubBins;
    if (target.collecting) {
      offset += target.inside;
      continue;
    }
    target.shift = 0;
    while (((target.high_key - target.low_key) >> target.shift) >= kSubBins) {
      ++target.shift;
    }
    for (std::size_t i = 0; i < kSubBins; ++i) {
      store.pool[offset + i] = 0;
    }
    offset += kSubBins;
  }
  return pending;
}

// Narrows each target to what the pass has shown. False if there were not as many values as in the
// pass before.
bool MonteCarlo::settle_targets(MonteCarloStore& store) noexcept {
  for (Target& target : targets_) {
    if (target.found) {
      continue;
    }
    if (target.filled != target.inside) {
      return false;
    }
    std::uint64_t* const part = store.pool + target.offset;
    if (target.collecting) {
      std::make_heap(part, part + target.inside);
      std::sort_heap(part, part + target.inside);
      target.low_key = part[target.rank];
      target.high_key = target.low_key;
      continue;
    }
    std::uint64_t bin = 0;
    while (target.rank >= part[bin]) {
      target.rank -= static_cast<std::uint32_t>(part[bin]);
      ++bin;
    }
    const std::uint64_t width = std::uint64_t{1} << target.shift;
    target.low_key += bin * width;
    target.high_key = std::min(target.high_key, target.low_key + (width - 1));
    target.inside = static_cast<std::uint32_t>(part[bin]);
  }
  return true;
}

void MonteCarlo::fail() noexcept {
  failed_ = true;
  stage_ = Stage::kDone;
}

void MonteCarlo::finish() noexcept {
  trial_ = 0;
  stage_ = Stage::kDone;
}

MonteCarloResult MonteCarlo::result() const noexcept {
  MonteCarloResult result;
  result.status = Status::kTooFewTrials;
  if (failed_) {
    result.status = Status::kInvalidArgument;
    result.failed_trial = trial_;
    return result;
  }
  result.trials = trials_;
  result.probability = probability_;
  if (stage_ == Stage::kIdle || stage_ == Stage::kRange) {
    return result;
  }
  result.mean = origin_ + mean_;
  result.u = sqrt(squares_ / (static_cast<double>(trials_) - 1.0));
  result.minimum = minimum_;
  result.maximum = maximum_;
  result.trial_of_minimum = trial_of_minimum_;
  result.trial_of_maximum = trial_of_maximum_;
  if (stage_ != Stage::kDone) {
    return result;
  }
  result.status = Status::kOk;
  result.symmetric = {minimum_, minimum_};
  result.shortest = {minimum_, minimum_};
  if (minimum_ != maximum_) {
    result.symmetric = {value_of(targets_[0].low_key), value_of(targets_[1].low_key)};
    result.shortest = {value_of(targets_[2].low_key), value_of(targets_[3].low_key)};
  }
  return result;
}

double MonteCarlo::progress() const noexcept {
  if (stage_ == Stage::kIdle) {
    return 0.0;
  }
  if (stage_ == Stage::kDone) {
    return 1.0;
  }
  const double share = static_cast<double>(trial_) / static_cast<double>(trials_);
  return progress_base_ + (1.0 - progress_base_) * share / static_cast<double>(passes_left_);
}

Span<const std::uint32_t> MonteCarlo::histogram(const MonteCarloStore& store) const noexcept {
  if (stage_ != Stage::kDone || failed_) {
    return {};
  }
  return Span<const std::uint32_t>(store.bins);
}

Status AdaptiveTrials::start(MonteCarlo& engine, MonteCarloStore& store, double probability,
                             std::uint32_t significant_digits, std::uint32_t max_blocks) noexcept {
  if (!(probability > 0.0) || !(probability < 1.0) || significant_digits < 1 ||
      significant_digits > 4 || max_blocks < 2) {
    return Status::kInvalidArgument;
  }
  const double wanted = 100.0 / (1.0 - probability);
  if (!(wanted < kMaxCount)) {
    return Status::kInvalidArgument;
  }
  const std::uint32_t block_size = std::max(round_up(wanted), kMinBlockSize);
  if (std::uint64_t{block_size} * max_blocks > 0xffffffffU) {
    return Status::kInvalidArgument;
  }
  if (engine.start(block_size, probability, store) != Status::kOk) {
    return Status::kInvalidArgument;
  }
  *this = AdaptiveTrials();
  probability_ = probability;
  block_size_ = block_size;
  max_blocks_ = max_blocks;
  digits_ = significant_digits;
  running_ = true;
  return Status::kOk;
}

std::uint32_t AdaptiveTrials::next_trial(const MonteCarlo& engine) const noexcept {
  return running_ ? blocks_ * block_size_ + engine.next_trial() : 0;
}

void AdaptiveTrials::add(double value, MonteCarlo& engine, MonteCarloStore& store) noexcept {
  if (!running_) {
    return;
  }
  engine.add(value, store);
  if (engine.done()) {
    end_block(engine, store);
  }
}

void AdaptiveTrials::end_block(MonteCarlo& engine, MonteCarloStore& store) noexcept {
  const MonteCarloResult block = engine.result();
  if (block.status != Status::kOk) {
    failed_ = true;
    failed_trial_ = blocks_ * block_size_ + block.failed_trial;
    running_ = false;
    return;
  }
  ++blocks_;
  const double h = static_cast<double>(blocks_);
  const double m = static_cast<double>(block_size_);
  const double from_mean = block.mean - scatter_[0].mean;
  squares_ += block.u * block.u * (m - 1.0) + from_mean * from_mean * m * (h - 1.0) / h;
  const double values[kQuantities] = {block.mean, block.u, block.symmetric.low,
                                      block.symmetric.high};
  for (std::size_t i = 0; i < kQuantities; ++i) {
    const double delta = values[i] - scatter_[i].mean;
    scatter_[i].mean += delta / h;
    scatter_[i].squares += delta * (values[i] - scatter_[i].mean);
  }
  stabilised_ = blocks_ > 1 && stable();
  if (stabilised_ || blocks_ == max_blocks_ ||
      engine.start(block_size_, probability_, store) != Status::kOk) {
    running_ = false;
  }
}

double AdaptiveTrials::scatter_of_mean(std::size_t quantity) const noexcept {
  if (blocks_ < 2) {
    return 0.0;
  }
  const double h = static_cast<double>(blocks_);
  return sqrt(scatter_[quantity].squares / (h * (h - 1.0)));
}

double AdaptiveTrials::standard_uncertainty() const noexcept {
  if (blocks_ == 0) {
    return 0.0;
  }
  const double n = static_cast<double>(blocks_) * static_cast<double>(block_size_);
  return sqrt(squares_ / (n - 1.0));
}

bool AdaptiveTrials::stable() const noexcept {
  const double tolerance = numerical_tolerance(standard_uncertainty(), digits_);
  for (std::size_t i = 0; i < kQuantities; ++i) {
    if (2.0 * scatter_of_mean(i) > tolerance) {
      return false;
    }
  }
  return true;
}

AdaptiveResult AdaptiveTrials::result() const noexcept {
  AdaptiveResult result;
  result.status = Status::kTooFewTrials;
  if (failed_) {
    result.status = Status::kInvalidArgument;
    result.failed_trial = failed_trial_;
    return result;
  }
  if (!running_ && blocks_ > 0) {
    result.status = Status::kOk;
  }
  result.stabilised = stabilised_;
  result.blocks = blocks_;
  result.trials = blocks_ * block_size_;
  result.mean = scatter_[0].mean;
  result.u = standard_uncertainty();
  result.tolerance = numerical_tolerance(result.u, digits_);
  result.symmetric = {scatter_[2].mean, scatter_[3].mean};
  result.s_mean = scatter_of_mean(0);
  result.s_u = scatter_of_mean(1);
  result.s_low = scatter_of_mean(2);
  result.s_high = scatter_of_mean(3);
  return result;
}

}  // namespace emax
