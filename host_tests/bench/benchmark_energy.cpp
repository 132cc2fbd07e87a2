// What each step towards the maximum energy costs, on the device of the paper's Table 2.
#include <benchmark/benchmark.h>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "emax/base/elementary.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/uncertainty/energy_trials.hpp"

#include "desk/trials/paper_trials.hpp"
#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::paper_model;

GridWorkspace workspace;
EnergySearch search;
EnergyTrials trials;
PhiBuffer<kPhiCells> phi_buffer;

double duration_s(const benchmark::State& state) {
  return 1e-3 * static_cast<double>(state.range(0));
}

/// Runs the whole search.
const MaximumEnergy& maximum(const SearchSettings& settings) {
  const ModalModel model = paper_model();
  (void)search.start(model, settings);
  while (!search.done()) {
    (void)search.step(model, workspace);
  }
  return search.result();
}

void elementary_exp(benchmark::State& state) {
  volatile double x = -3.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(exp(x));
  }
}
BENCHMARK(elementary_exp);

void elementary_sincos(benchmark::State& state) {
  volatile double x = 1.7;
  for (auto _ : state) {
    benchmark::DoNotOptimize(sincos(x));
  }
}
BENCHMARK(elementary_sincos);

void model_new_device(benchmark::State& state) {
  ModalModel model = paper_model();
  for (auto _ : state) {
    benchmark::DoNotOptimize(model.set_device(test::kPaperDevice));
  }
}
BENCHMARK(model_new_device);

void exact_energy(benchmark::State& state) {
  const ModalModel model = paper_model();
  SwitchingSignal signal{};
  const bool short_time = state.range(0) == 2;
  (void)signal.set(short_time ? Span<const double>(test::kBestTimes2ms)
                              : Span<const double>(test::kBestTimes10ms),
                   duration_s(state));
  for (auto _ : state) {
    benchmark::DoNotOptimize(energy(model, signal));
  }
}
BENCHMARK(exact_energy)->Arg(2)->Arg(10);

void phi_fill(benchmark::State& state) {
  const ModalModel model = paper_model();
  const std::size_t cells = static_cast<std::size_t>(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(phi_buffer.fill(model, 2e-3, cells));
  }
}
BENCHMARK(phi_fill)->Arg(98)->Arg(128);

void iteration_stored_phi(benchmark::State& state) {
  const std::size_t cells = 98;
  (void)phi_buffer.fill(paper_model(), 2e-3, cells);
  const Signs signs = workspace.signs(cells);
  signs_of_column(phi_buffer.matrix(), 0, signs, workspace.product(cells));
  for (auto _ : state) {
    phi_buffer.matrix().multiply(signs, workspace.product(cells));
    benchmark::ClobberMemory();
  }
}
BENCHMARK(iteration_stored_phi);

void iteration_applied_phi(benchmark::State& state) {
  const std::size_t cells = static_cast<std::size_t>(state.range(0));
  const ModalModel model = paper_model();
  PhiOperator phi{};
  (void)phi.set(model, 2e-6 * static_cast<double>(cells), cells);
  const Signs signs = workspace.signs(cells);
  signs_of_column(phi, 0, signs, workspace.product(cells));
  for (auto _ : state) {
    phi.multiply(signs, workspace.product(cells));
    benchmark::ClobberMemory();
  }
}
BENCHMARK(iteration_applied_phi)->Arg(98)->Arg(1000)->Arg(5000);

void whole_search(benchmark::State& state) {
  SearchSettings settings;
  settings.duration_s = duration_s(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(maximum(settings).energy);
  }
}
BENCHMARK(whole_search)->Arg(2)->Arg(10)->Unit(benchmark::kMillisecond);

void one_trial(benchmark::State& state, Method method) {
  TrialSettings settings;
  settings.box = {0.003, 6.0, 0.0004};
  const std::uint32_t seed[] = {123456789, 345678901, 567890123, 789012345};
  (void)settings.generator.seed(Generator::k2006, seed);
  settings.search.method = method;
  settings.search.duration_s = duration_s(state);
  settings.search.step_s = 2e-6;
  settings.search.max_iterations = 30;
  const MaximumEnergy best = maximum(settings.search);
  (void)trials.start(paper_model(), best, settings);
  while (!trials.ready()) {
    trials.prepare(search, workspace);
  }
  std::uint32_t trial = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(trials.energy(trial++, workspace));
  }
  state.counters["trials/s"] =
      benchmark::Counter(static_cast<double>(trial), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(one_trial, best, Method::kBest)->Arg(2)->Arg(10);
BENCHMARK_CAPTURE(one_trial, paper, Method::kPaper)->Arg(2)->Arg(10);

/// As the program on a PC makes them: several at a time in the lanes of a vector; here on one core.
void paper_trials(benchmark::State& state) {
  constexpr std::size_t kDevices = 64;
  std::vector<Accelerometer> devices;
  for (std::size_t i = 0; i < kDevices; ++i) {
    const double place = 2.0 * static_cast<double>(i) / (kDevices - 1.0) - 1.0;
    devices.push_back({1.037 + 0.003 * place, 4073.0 - 6.0 * place, 0.3182 + 0.0004 * place});
  }
  std::vector<double> energies(kDevices);
  const auto cells = static_cast<std::size_t>(500 * state.range(0));  // Of 2 us.
  std::uint64_t made = 0;
  for (auto _ : state) {
    desk::find_paper_energies(paper_model(), {duration_s(state), cells, 30}, 1,
                              Span<const Accelerometer>(devices.data(), devices.size()),
                              Span<double>(energies.data(), energies.size()));
    benchmark::DoNotOptimize(energies.data());
    made += kDevices;
  }
  state.counters["trials/s"] =
      benchmark::Counter(static_cast<double>(made), benchmark::Counter::kIsRate);
}
BENCHMARK(paper_trials)->Arg(2)->Arg(10)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace emax
