// One piece of memory for what is counted one after the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "emax/app/base/in_place.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/base/signs.hpp"
#include "emax/bound/energy_bound.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/identify/frame_sine_fit.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace emax::cost {

inline constexpr std::size_t kStoredCells = 128;
/// The paper's cells of 2 us in 2 ms.
inline constexpr std::size_t kPaperCells = 1000;

struct Kernels {
  ModalModel model;
  FrameSineFit frame_fit;
  PhiBuffer<kStoredCells> stored_phi;
  PhiOperator phi;
  std::array<std::uint32_t, sign_words(kPaperCells)> signs = {};
  std::array<std::uint32_t, sign_words(kPaperCells)> best_signs = {};
  std::array<double, kPaperCells> product = {};
};

struct Energies {
  ModalModel model;
  EnergySearch search;
  EnergyBound bound;
  EnergyTrials trials;
  GridWorkspace grid;
};

struct Evaluations {
  FrequencyResponse points;
  app::EvaluationResults results;
  app::EvaluationWorkspace workspace;
};

struct Sweeps {
  app::SweepResults results;
  app::SweepWorkspace workspace;
};

union Memory {
  constexpr Memory() noexcept : none{} {}

  char none;
  app::InPlace<Kernels> kernels;
  app::InPlace<Energies> energies;
  app::InPlace<Evaluations> evaluations;
  app::InPlace<Sweeps> sweeps;
};

Memory& memory() noexcept;

}  // namespace emax::cost
