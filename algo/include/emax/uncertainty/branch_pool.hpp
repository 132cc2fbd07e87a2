// The few signals that may be the worst one somewhere within the ranges of the parameters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/span.hpp"
#include "emax/energy/switching_signal.hpp"

namespace emax {

/// Keeps distinct signals with their energies at some places: the estimate and the corners of the
/// ranges. Two signals are the same one if their energies at a place are.
///
/// A switching time takes 16 bits, as a part of T: enough for a refinement to find the exact one.
/// 4.8 KiB with the default capacities.
class BranchPool {
 public:
  static constexpr std::size_t kCapacity = 8;
  static constexpr std::size_t kPlaces = 9;
  /// A signal that stays this part below the best one at a place is not offered by it.
  static constexpr double kWorthKeeping = 0.01;

  /// Makes it empty.
  void clear() noexcept;

  std::size_t count() const noexcept { return count_; }
  std::size_t switches(std::size_t branch) const noexcept { return branches_[branch].count; }

  /// The place that a branch has been found at: its signal is refined there.
  std::size_t home(std::size_t branch) const noexcept { return branches_[branch].home; }

  /// Adds a signal that is refined at a place; there must be room.
  void add(std::size_t place, const SwitchingSignal& signal) noexcept;
  /// Sets a signal to a branch, with the duration that it is given.
  ///
  /// @param scratch kMaxSwitches doubles.
  void load(std::size_t index, double duration_s, Span<double> scratch,
            SwitchingSignal& signal) const noexcept;
  /// Later branches move up.
  void remove(std::size_t branch) noexcept;

  bool knows(std::size_t branch, std::size_t place) const noexcept {
    return (branches_[branch].known >> place & 1U) != 0;
  }
  /// Takes the energy of a branch at a place.
  void know(std::size_t index, std::size_t place, double energy) noexcept;

  /// Takes a signal that is refined at a place, unless it is known or low. If there is no room, the
  /// one that comes least near to the best has to go, be it this one.
  void offer(std::size_t place, const SwitchingSignal& signal, double energy) noexcept;

  /// With all energies known at the places that count: drops those that stay below the best
  /// everywhere by more than half of what their distance from it changes from place to place.
  void drop_low() noexcept;

  /// @returns By how much the best energy changes from place to place, as part of it.
  double variation() const noexcept;
  /// @returns After `drop_low()`, whether a signal had to go that might be the best somewhere.
  bool is_crowded() const noexcept { return is_crowded_; }
  /// The largest energy at a place; 0 before any.
  double best_at(std::size_t place) const noexcept { return best_at_[place]; }

 private:
  struct Branch {
    double energies[kPlaces];
    std::uint16_t parts[kMaxSwitches];  // Of T.
    std::uint16_t count;
    std::uint16_t known;  // A bit for each place.
    std::uint16_t home;
  };
  struct Distance {
    double least = 0.0;  // Below the best, at the place where it is nearest.
    double most = 0.0;
  };

  void take_best(std::size_t place, double energy) noexcept;
  Distance distance(const Branch& branch) const noexcept;
  void note_lost(double distance) noexcept;

  Branch branches_[kCapacity] = {};
  double best_at_[kPlaces] = {};
  double nearest_lost_ = 0.0;
  std::size_t count_ = 0;
  std::uint16_t has_best_ = 0;  // A bit for each place.
  bool has_lost_ = false;
  bool is_crowded_ = false;
};

static_assert(std::is_trivially_copyable_v<BranchPool>);

}  // namespace emax
