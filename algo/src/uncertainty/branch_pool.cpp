// Distinct signals, told apart by their energies, and which of them matter.
#include "emax/uncertainty/branch_pool.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

/// Energies at one place that differ by less than this part are of the same signal.
constexpr double kSame = 1e-9;
/// The part of the change of a distance that is left as room for what lies between the places.
constexpr double kRoom = 0.5;
constexpr double kTimeParts = 65536.0;

}  // namespace

void BranchPool::clear() noexcept {
  count_ = 0;
  has_best_ = 0;
  has_lost_ = false;
  is_crowded_ = false;
}

/// A switch that falls on another one takes both away, as a refinement would.
void BranchPool::add(std::size_t place, const SwitchingSignal& signal) noexcept {
  Branch& branch = branches_[count_];
  const double scale = kTimeParts / signal.duration_s();
  std::size_t count = 0;
  for (const double time_s : signal.times_s()) {
    const double part = floor(time_s * scale + 0.5);
    if (part < 1.0 || part > kTimeParts - 1.0) {
      continue;
    }
    const auto whole = static_cast<std::uint16_t>(static_cast<std::uint32_t>(part));
    if (count > 0 && branch.parts[count - 1] == whole) {
      --count;
      continue;
    }
    branch.parts[count++] = whole;
  }
  branch.count = static_cast<std::uint16_t>(count);
  branch.known = 0;
  branch.home = static_cast<std::uint16_t>(place);
  ++count_;
}

void BranchPool::load(std::size_t index, double duration_s, Span<double> scratch,
                      SwitchingSignal& signal) const noexcept {
  const Branch& branch = branches_[index];
  const Span<double> times_s = scratch.first(branch.count);
  for (std::size_t i = 0; i < branch.count; ++i) {
    times_s[i] = duration_s * (static_cast<double>(branch.parts[i]) / kTimeParts);
  }
  // Cannot fail: the parts ascend inside (0, 1).
  (void)signal.set(times_s, duration_s);
}

void BranchPool::remove(std::size_t branch) noexcept {
  std::copy(branches_ + branch + 1, branches_ + count_, branches_ + branch);
  --count_;
}

void BranchPool::take_best(std::size_t place, double energy) noexcept {
  const auto bit = static_cast<std::uint16_t>(1U << place);
  if ((has_best_ & bit) == 0 || energy > best_at_[place]) {
    best_at_[place] = energy;
  }
  has_best_ = static_cast<std::uint16_t>(has_best_ | bit);
}

void BranchPool::know(std::size_t index, std::size_t place, double energy) noexcept {
  Branch& branch = branches_[index];
  branch.energies[place] = energy;
  branch.known = static_cast<std::uint16_t>(branch.known | 1U << place);
  take_best(place, energy);
}

void BranchPool::offer(std::size_t place, const SwitchingSignal& signal, double energy) noexcept {
  for (std::size_t b = 0; b < count_; ++b) {
    if (knows(b, place) && abs(branches_[b].energies[place] - energy) <= kSame * abs(energy)) {
      return;
    }
  }
  take_best(place, energy);
  const double best = best_at_[place];
  const double below = (best - energy) / abs(best);
  if (below > kWorthKeeping) {
    return;
  }
  if (count_ == kCapacity) {
    std::size_t weakest = 0;
    double farthest = -1.0;
    for (std::size_t b = 0; b < count_; ++b) {
      const double least = distance(branches_[b]).least;
      if (least > farthest) {
        farthest = least;
        weakest = b;
      }
    }
    note_lost(below > farthest ? below : farthest);
    if (below >= farthest) {
      return;
    }
    remove(weakest);
  }
  add(place, signal);
  know(count_ - 1, place, energy);
}

void BranchPool::note_lost(double distance) noexcept {
  nearest_lost_ = has_lost_ && nearest_lost_ < distance ? nearest_lost_ : distance;
  has_lost_ = true;
}

BranchPool::Distance BranchPool::distance(const Branch& branch) const noexcept {
  Distance result;
  bool has_any = false;
  for (std::size_t place = 0; place < kPlaces; ++place) {
    if ((branch.known >> place & 1U) == 0) {
      continue;
    }
    const double best = best_at_[place];
    const double below = (best - branch.energies[place]) / abs(best);
    result.least = has_any && result.least < below ? result.least : below;
    result.most = has_any && result.most > below ? result.most : below;
    has_any = true;
  }
  return result;
}

double BranchPool::variation() const noexcept {
  double smallest = 0.0;
  double largest = 0.0;
  bool has_any = false;
  for (std::size_t place = 0; place < kPlaces; ++place) {
    if ((has_best_ >> place & 1U) == 0) {
      continue;
    }
    const double best = best_at_[place];
    smallest = has_any && smallest < best ? smallest : best;
    largest = has_any && largest > best ? largest : best;
    has_any = true;
  }
  return largest > smallest ? (largest - smallest) / abs(largest) : 0.0;
}

void BranchPool::drop_low() noexcept {
  // A refinement that has fallen down to another signal says nothing about the distance.
  const double most_change = variation();
  double largest_change = 0.0;
  for (std::size_t b = count_; b-- > 0;) {
    const Distance below = distance(branches_[b]);
    const double change = std::min(below.most - below.least, most_change);
    largest_change = std::max(largest_change, change);
    if (below.least > kRoom * change + kSame) {
      remove(b);
    }
  }
  is_crowded_ = has_lost_ && nearest_lost_ <= (1.0 + kRoom) * largest_change + kSame;
}

}  // namespace emax
