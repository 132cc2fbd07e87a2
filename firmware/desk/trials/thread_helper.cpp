// Trials and draws of a fit on all cores of a PC.
#include "desk/trials/thread_helper.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>

#include "desk/trials/paper_trials.hpp"

namespace emax::desk {

namespace {

using Clock = std::chrono::steady_clock;

// The evaluation waits for no longer than some of these, so that progress and Ctrl-C are seen.
constexpr std::chrono::milliseconds kShortest{20};
constexpr std::chrono::milliseconds kLongest{100};
// For each thread, of the first trials and of those of the paper's procedure, where one takes long.
constexpr std::size_t kFirstTrials = 64;

}  // namespace

std::size_t count_cores() noexcept {
  const std::size_t cores = std::thread::hardware_concurrency();
  return std::min(std::max<std::size_t>(cores, 1), kMaxThreads);
}

std::size_t ThreadHelper::make_trials(EnergyTrials& trials, std::uint32_t first,
                                      Span<double> energies) noexcept {
  ahead_ = std::max(ahead_, kFirstTrials * threads_);
  const Span<double> next = energies.first(std::min(ahead_, energies.size()));
  const Clock::time_point start = Clock::now();
  const std::size_t made = trials.search_settings().method == Method::kPaper
                               ? make_paper_trials(trials, first, next)
                               : next.size();
  if (trials.search_settings().method != Method::kPaper) {
    share_out(threads_, next.size(), [this, &trials, first, next](const Share& share) {
      run_share(trials, first, share, next);
    });
    const std::size_t shares = std::min(threads_, next.size());
    for (std::size_t i = 0; i < shares; ++i) {
      trials.join(memory_[i].trials);
    }
  }
  const Clock::duration taken = Clock::now() - start;
  if (taken < kShortest && made == ahead_) {
    ahead_ *= 2;
  } else if (taken > kLongest) {
    ahead_ /= 2;
  }
  return made;
}

void ThreadHelper::run_share(const EnergyTrials& trials, std::uint32_t first, const Share& share,
                             Span<double> energies) {
  Memory& memory = memory_[share.index];
  memory.pieces.resize(trials.pieces_in_use());
  const std::uint32_t begin = first + static_cast<std::uint32_t>(share.begin);
  memory.trials = trials.share(begin, Span<TrialPiece>(memory.pieces.data(), memory.pieces.size()));
  for (std::size_t i = 0; i < share.size; ++i) {
    energies[share.begin + i] =
        memory.trials.energy(begin + static_cast<std::uint32_t>(i), memory.grid);
  }
}

/// Up to the first trial that has no device, with that.
std::size_t ThreadHelper::make_paper_trials(EnergyTrials& trials, std::uint32_t first,
                                            Span<double> energies) {
  std::vector<Accelerometer> devices;
  std::vector<double> scales;
  do {
    const auto trial = static_cast<std::uint32_t>(first + devices.size());
    const Accelerometer device = trials.device(trial);
    trials.set_model(device);
    devices.push_back(trials.model().device());
    scales.push_back(trials.scale_of(device));
  } while (devices.size() < energies.size() && !trials.is_exhausted());
  const std::size_t made = devices.size();
  const PaperProcedure procedure = {trials.search_settings().duration_s, trials.cells(),
                                    trials.search_settings().max_iterations};
  find_paper_energies(trials.model(), procedure, threads_,
                      Span<const Accelerometer>(devices.data(), made), energies.first(made));
  for (std::size_t i = 0; i < made; ++i) {
    energies[i] = scales[i] * energies[i];
  }
  if (trials.is_exhausted()) {
    energies[made - 1] = std::numeric_limits<double>::quiet_NaN();
  }
  return made;
}

void ThreadHelper::make_fit_draws(WlspDraws& draws, const Wlsp& fit) noexcept {
  std::vector<WlspDeviation> deviations(draws.left());
  const Span<WlspDeviation> all(deviations.data(), deviations.size());
  share_out(threads_, all.size(), [&draws, &fit, all](const Share& share) {
    draws.look_ahead(fit, static_cast<std::uint32_t>(share.begin),
                     all.from(share.begin).first(share.size));
  });
  draws.take(fit, Span<const WlspDeviation>(deviations.data(), deviations.size()));
}

}  // namespace emax::desk
