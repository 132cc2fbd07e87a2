// Prints how the Monte Carlo trials, mostly polynomials, compare with a whole search in every
// trial: for all cases, or for those whose name holds one of the arguments.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "emax/energy/energy_search.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace {

using namespace emax;

constexpr std::uint32_t kTrials = 200;
constexpr std::uint32_t kSeed[] = {123456789, 345678901, 567890123, 789012345};
// Beyond this the two do not agree.
constexpr double kAgreement = 1e-6;

struct Case {
  std::string name;
  Accelerometer device;
  ParameterBox u;
  int order;
  double cutoff_hz;
  double duration_s;
};

GridWorkspace workspace;
EnergySearch search;
EnergyTrials trials;
std::vector<TrialPiece> pieces(EnergyTrials::kManyPieces);

struct Figure {
  const char* name;
  ErrorMeasure measure;
};

constexpr Figure kError = {"ise", {Criterion::kIntegralSquareError, {}}};
constexpr Figure kDifference = {"difference", {Criterion::kEnergyDifference, {}}};
constexpr Figure kMatched = {"matched", {Criterion::kInBandError, {DelayMode::kOfSensor, 0.0}}};

bool search_whole(const ModalModel& model, const SearchSettings& settings, MaximumEnergy& found) {
  Status status = search.start(model, settings);
  while (status == Status::kOk && !search.done()) {
    status = search.step(model, workspace);
  }
  found = search.result();
  return status == Status::kOk;
}

TrialSettings settings_of(const Case& c, Distribution distribution, bool gain_follows) {
  TrialSettings settings;
  settings.distribution = distribution;
  settings.box = c.u;
  settings.covariance[0][0] = c.u.sensitivity * c.u.sensitivity;
  settings.covariance[1][1] = c.u.natural_frequency_hz * c.u.natural_frequency_hz;
  settings.covariance[2][2] = c.u.damping * c.u.damping;
  (void)settings.generator.seed(Generator::k2006, kSeed);
  settings.gain_follows = gain_follows;
  settings.search.duration_s = c.duration_s;
  settings.pieces = TrialPieces({pieces.data(), pieces.size()});
  return settings;
}

// Largest, standard deviation and the symmetric 95 % interval of some energies.
struct Summary {
  double largest, u, low, high;
};

Summary summary_of(std::vector<double> energies) {
  std::sort(energies.begin(), energies.end());
  double mean = 0.0;
  double squares = 0.0;
  for (const double e : energies) {
    mean += e / static_cast<double>(energies.size());
  }
  for (const double e : energies) {
    squares += (e - mean) * (e - mean);
  }
  const std::size_t outside = energies.size() / 40;
  return {energies.back(), std::sqrt(squares / static_cast<double>(energies.size() - 1)),
          energies[outside], energies[energies.size() - 1 - outside]};
}

double apart(double a, double b) { return b == 0.0 ? std::fabs(a) : std::fabs(a / b - 1.0); }

void compare(const Case& c, const Figure& figure, Distribution distribution, bool gain_follows) {
  std::printf("%-34s %-10s %-6s %-7s", c.name.c_str(), figure.name,
              distribution == Distribution::kBox ? "box" : "normal",
              gain_follows ? "follows" : "fixed");
  ModalModel model{};
  if (model.set(c.device, butterworth({c.order, c.cutoff_hz, c.device.sensitivity}),
                figure.measure) != Status::kOk) {
    std::printf(" no such error system\n");
    return;
  }
  const TrialSettings settings = settings_of(c, distribution, gain_follows);
  MaximumEnergy best;
  if (!search_whole(model, settings.search, best)) {
    std::printf(" the search failed\n");
    return;
  }
  if (trials.start(model, best, settings) != Status::kOk) {
    std::printf(" refused: the ranges leave what a device may be\n");
    return;
  }
  while (!trials.ready()) {
    trials.prepare(search, workspace);
  }
  std::vector<double> found, expected;
  int refined = 0;
  int less = 0;
  int more = 0;
  double worst = 0.0;
  for (std::uint32_t t = 0; t < kTrials; ++t) {
    trials.begin(t, workspace);
    refined += trials.done() ? 0 : 1;
    while (!trials.done()) {
      trials.step(workspace);
    }
    found.push_back(trials.energy());
    const Accelerometer device = trials.device(t);
    ModalModel moved = model;
    MaximumEnergy whole;
    if (moved.set_device(device) != Status::kOk ||
        (gain_follows && moved.set_gain(device.sensitivity) != Status::kOk) ||
        !search_whole(moved, settings.search, whole)) {
      std::printf(" trial %u has no whole search", t);
      whole.energy = found.back();
    }
    expected.push_back(whole.energy);
    const double difference = found.back() / whole.energy - 1.0;
    worst = std::max(worst, std::fabs(difference));
    less += difference < -kAgreement ? 1 : 0;
    more += difference > kAgreement ? 1 : 0;
  }
  const Summary a = summary_of(found);
  const Summary b = summary_of(expected);
  const BranchNotes notes = trials.notes();
  std::printf(" %8.1e %8.1e %8.1e %8.1e %5d %5d %7d %6u %8.1e\n", apart(a.largest, b.largest),
              apart(a.u, b.u), std::max(apart(a.low, b.low), apart(a.high, b.high)), worst, less,
              more, refined, notes.rough_trials, static_cast<double>(notes.rough_part));
  std::fflush(stdout);
}

std::vector<Case> cases() {
  const Accelerometer paper = {1.037, 4073.0, 0.3182};
  const ParameterBox u = {0.003, 6.0, 0.0004};
  std::vector<Case> all;
  for (const double ms : {2.0, 4.0, 6.0, 8.0, 10.0}) {
    all.push_back({"Table 2, " + std::to_string(static_cast<int>(ms)) + " ms", paper, u, 10, 1000.0,
                   ms * 1e-3});
  }
  all.push_back({"u(f0) 80 Hz, u(beta) 0.016", paper, {0.003, 80.0, 0.016}, 10, 1000.0, 2e-3});
  all.push_back({"order 12", paper, u, 12, 1000.0, 2e-3});
  all.push_back({"f0/fc = 60", {1.0, 60000.0, 0.02}, {0.003, 60.0, 0.0004}, 4, 1000.0, 2e-3});
  // Ten devices from low to high f0 and damping, each parameter with u = 1 %.
  const double f0_hz[] = {700.0,  1500.0,  2500.0,  4073.0,  6000.0,
                          8000.0, 12000.0, 16000.0, 25000.0, 40000.0};
  const double damping[] = {0.7, 0.3, 0.1, 0.6, 0.05, 0.9, 0.2, 0.4, 0.1, 0.5};
  for (int i = 0; i < 10; ++i) {
    char name[64];
    std::snprintf(name, sizeof name, "u = 1 %%: f0 %g Hz, beta %g", f0_hz[i], damping[i]);
    all.push_back({name,
                   {1.0, f0_hz[i], damping[i]},
                   {0.01, 0.01 * f0_hz[i], 0.01 * damping[i]},
                   6,
                   1000.0,
                   2e-3});
  }
  return all;
}

bool is_wanted(const Case& c, int argc, char** argv) {
  const auto holds = [&](const char* word) { return c.name.find(word) != std::string::npos; };
  return argc < 2 || std::any_of(argv + 1, argv + argc, holds);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("%u trials each; relative differences from a whole search in every trial\n\n",
              kTrials);
  std::printf("%-34s %-10s %-6s %-7s %8s %8s %8s %8s %5s %5s %7s %6s %8s\n", "device", "criterion",
              "drawn", "gain", "E_max", "u(E)", "interval", "worst", "less", "more", "refined",
              "rough", "by");
  for (const Case& c : cases()) {
    if (!is_wanted(c, argc, argv)) {
      continue;
    }
    compare(c, kError, Distribution::kBox, false);
    compare(c, kError, Distribution::kNormal, false);
    compare(c, kError, Distribution::kBox, true);
    compare(c, kMatched, Distribution::kNormal, true);
    compare(c, kDifference, Distribution::kBox, false);
  }
  std::printf(
      "\nless, more: trials whose energy is that much below or above the whole search's by 1e-6 "
      "and more;\n"
      "refined: trials that polynomials do not answer; rough: trials accepted with less accuracy "
      "than 1e-6 of\n"
      "u(E), off by up to that part of u(E)\n"
      "%.0f s of a processor\n",
      static_cast<double>(std::clock()) / CLOCKS_PER_SEC);
}
