// What a computer with several cores may do for an evaluation, ahead of its turn.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace emax::app {

/// Computes trials and draws of a fit that the evaluation would else compute one after the other,
/// to the same bits. An evaluation waits for it.
class EvaluationHelper {
 public:
  EvaluationHelper(const EvaluationHelper&) = delete;
  EvaluationHelper& operator=(const EvaluationHelper&) = delete;

  /// Makes the trials `first`, `first + 1` and so on, as many as take a moment.
  ///
  /// @param[in,out] trials   `ready()`; what it counts is then as if it had made them.
  /// @param[out]    energies Of a = 1, from `first` on; not empty.
  /// @returns How many have been made: 1 or more.
  virtual std::size_t make_trials(EnergyTrials& trials, std::uint32_t first,
                                  Span<double> energies) noexcept = 0;

  /// Makes all draws that are left.
  virtual void make_fit_draws(WlspDraws& draws, const Wlsp& fit) noexcept = 0;

 protected:
  constexpr EvaluationHelper() noexcept = default;
  ~EvaluationHelper() = default;
};

}  // namespace emax::app
