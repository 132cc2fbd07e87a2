// Search, bound and trials, called as the evaluation calls them.
#include "emax/board/instruction_counter.hpp"
#include "emax/bound/energy_bound.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/uncertainty/energy_trials.hpp"

#include "memory.hpp"
#include "rows.hpp"

namespace emax::cost {
namespace {

constexpr std::uint32_t kTrials = 64;
constexpr std::uint32_t kSeed[] = {123456789, 345678901, 567890123, 789012345};

Status count_search(const SearchSettings& settings, Energies& energies, Ticks& ticks) noexcept {
  Status status = energies.search.start(energies.model, settings);
  while (status == Status::kOk && !energies.search.done()) {
    ticks += ticks_of([&] { status = energies.search.step(energies.model, energies.grid); });
  }
  return status;
}

Status count_bound(double duration_s, Energies& energies, Ticks& ticks) noexcept {
  Status status = Status::kOk;
  ticks +=
      ticks_of([&] { status = energies.bound.start(energies.model, duration_s, energies.grid); });
  while (status == Status::kOk && !energies.bound.done()) {
    ticks += ticks_of([&] { status = energies.bound.step(energies.model, energies.grid); });
  }
  return status;
}

}  // namespace

Status count_energies(std::uint32_t duration_ms, Rows& rows) noexcept {
  Energies& energies = memory().energies.make();
  SearchSettings search;
  search.duration_s = static_cast<double>(duration_ms) / 1000.0;
  Status status = energies.model.set(kDevice, kFilter, Criterion::kIntegralSquareError);
  Ticks search_ticks = 0;
  if (status == Status::kOk) {
    status = count_search(search, energies, search_ticks);
  }
  rows.add("search", duration_ms, instructions_of(search_ticks));

  Ticks bound_ticks = 0;
  if (status == Status::kOk) {
    status = count_bound(search.duration_s, energies, bound_ticks);
  }
  rows.add("bound", duration_ms, instructions_of(bound_ticks));

  const MaximumEnergy& best = energies.search.result();
  TrialSettings settings;
  settings.box = {0.003, 6.0, 0.0004};
  settings.search = search;
  if (status == Status::kOk) {
    status = settings.generator.seed(Generator::k2006, kSeed);
  }
  if (status == Status::kOk) {
    status = energies.trials.start(energies.model, best, settings);
  }
  Ticks prepare_ticks = 0;
  while (status == Status::kOk && !energies.trials.ready()) {
    prepare_ticks += ticks_of([&] { energies.trials.prepare(energies.search, energies.grid); });
  }
  rows.add("prepare", duration_ms, instructions_of(prepare_ticks));
  Ticks trial_ticks = 0;
  volatile double energy = 0.0;
  for (std::uint32_t trial = 0; trial < kTrials && status == Status::kOk; ++trial) {
    trial_ticks += ticks_of([&] { energy = energies.trials.energy(trial, energies.grid); });
  }
  rows.add("trial", duration_ms, instructions_of((trial_ticks + kTrials / 2) / kTrials));
  return status;
}

}  // namespace emax::cost
