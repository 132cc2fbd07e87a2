// What a board says of itself whose bench is simulated.
#pragma once

#include "emax/app/report/measurement.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::board {

/// @returns What a bench is built from that `SimBench::configure()` is given these settings.
constexpr app::SimulatedBench describe(const sim::BenchSettings& settings) noexcept {
  const sim::Device& device = settings.device;
  return {settings.seed, {device.sensitivity, device.natural_frequency_hz, device.damping}};
}

}  // namespace emax::board
