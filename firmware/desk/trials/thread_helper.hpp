// Trials and draws of a fit on all cores of a PC.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "emax/app/evaluate/evaluation_helper.hpp"
#include "emax/energy/grid_workspace.hpp"

#include "desk/trials/shares.hpp"

namespace emax::desk {

/// The most threads that may be asked for.
inline constexpr std::size_t kMaxThreads = 64;

/// @returns The number of cores, from 1 to kMaxThreads.
std::size_t count_cores() noexcept;

/// Shares trials and draws out to threads; those of the paper's procedure to the lanes of vectors
/// too (`find_paper_energies()`). Each number depends on that of its trial alone, and sums are made
/// in the order of trials, so no bit depends on how many threads there are.
///
/// Some 1.3 MB for each thread where the ranges are cut into pieces.
class ThreadHelper final : public app::EvaluationHelper {
 public:
  /// @param[in] threads 1 to kMaxThreads.
  explicit ThreadHelper(std::size_t threads) : threads_(threads), memory_(threads) {}

  std::size_t make_trials(EnergyTrials& trials, std::uint32_t first,
                          Span<double> energies) noexcept override;
  void make_fit_draws(WlspDraws& draws, const Wlsp& fit) noexcept override;

 private:
  /// Of a thread.
  struct Memory {
    std::vector<TrialPiece> pieces;
    GridWorkspace grid;
    EnergyTrials trials;
  };

  void run_share(const EnergyTrials& trials, std::uint32_t first, const Share& share,
                 Span<double> energies);
  std::size_t make_paper_trials(EnergyTrials& trials, std::uint32_t first, Span<double> energies);

  std::size_t threads_;
  std::size_t ahead_ = 0;  // So many trials take a moment; 0 if not known yet.
  std::vector<Memory> memory_;
};

}  // namespace emax::desk
