// The memory that searches, bounds and trials work in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/monte_carlo_store.hpp"
#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/refinement.hpp"
#include "emax/energy/switching_signal.hpp"

namespace emax {

/// How many numbers a workspace holds: the packed triangle of Phi with kPhiCells cells, which is
/// what a bound works in, or more where a product or a refinement takes more.
inline constexpr std::size_t kWorkspaceNumbers =
    std::max({packed_size(kPhiCells), kMaxCells, kRefinementScratch});

/// Memory for signals: what every search and every trial needs while it runs, and nothing
/// afterwards. 68 KiB with the capacities of a board. The product, a refinement and a bound are
/// never needed together and share their place. While trials run, a part of it is the store of the
/// Monte Carlo procedure.
class GridWorkspace {
 public:
  /// As much of a product as there is room for beside a `MonteCarloStore`.
  static constexpr std::size_t kMaxTrialCells = kRefinementScratch;

  /// Makes all of the memory one place for numbers again; what was in it is lost. Searches and
  /// bounds begin with it.
  void share_nothing() noexcept {
    has_store_ = false;
    memory_.numbers[0] = 0.0;  // From here on this is the member of the union that is alive.
  }
  /// Sets a part aside as the store, until `share_nothing()`.
  void share_with_store() noexcept {
    has_store_ = true;
    memory_.shared.refinement[0] = 0.0;
  }
  /// After `share_with_store()`.
  MonteCarloStore& store() noexcept { return memory_.shared.store; }

  /// For a bound, in place of a product; not beside a store.
  Span<double> numbers() noexcept { return Span<double>(memory_.numbers); }
  /// For the climbs of a search and a proposal, in place of `numbers()`: twice as many.
  Span<float> singles() noexcept { return Span<float>(memory_.singles); }
  /// Phi x, one number per cell; beside a store at most kMaxTrialCells.
  Span<double> product(std::size_t cells) noexcept { return all().first(cells); }
  /// For a refinement, when the product is not needed any more.
  Span<double> refinement() noexcept { return all().first(kRefinementScratch); }
  Signs signs(std::size_t cells) noexcept { return Signs(Span<std::uint32_t>(signs_), cells); }
  Signs best_signs(std::size_t cells) noexcept {
    return Signs(Span<std::uint32_t>(best_signs_), cells);
  }
  /// The signal that is being refined.
  SwitchingSignal& signal() noexcept { return signal_; }

 private:
  // No initialisers, so that an assignment to a member brings it to life.
  struct Shared {
    double refinement[kRefinementScratch];
    MonteCarloStore store;
  };
  union Memory {
    double numbers[kWorkspaceNumbers];
    float singles[2 * kWorkspaceNumbers];
    Shared shared;
  };
  static_assert(!kHasDefaultCapacities || sizeof(Shared) <= sizeof(double) * kWorkspaceNumbers);

  Span<double> all() noexcept {
    return has_store_ ? Span<double>(memory_.shared.refinement) : Span<double>(memory_.numbers);
  }

  Memory memory_ = {};
  std::uint32_t signs_[sign_words(kMaxCells)] = {};
  std::uint32_t best_signs_[sign_words(kMaxCells)] = {};
  SwitchingSignal signal_ = {};
  bool has_store_ = false;
};

static_assert(std::is_trivially_copyable_v<GridWorkspace>);

}  // namespace emax
