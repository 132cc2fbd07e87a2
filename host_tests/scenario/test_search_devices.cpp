// The search on random devices against the best of many random starts of another search, and the
// proven bound above both.
//
// By default 12 of 200 devices, against 2000 random starts each. All of them (half a minute of a
// PC, of which the other search takes nearly all), with the table of the worst:
//
//     EMAX_SEARCH_DEVICES=200 build/host/host_tests/scenario/test_search_devices
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "emax/bound/energy_bound.hpp"
#include "emax/energy/energy_search.hpp"

#include "support/sign_pattern.hpp"

namespace emax {
namespace {

constexpr std::size_t kAllDevices = 200;
constexpr std::size_t kDevicesByDefault = 12;
constexpr std::size_t kStartsByDefault = 2000;
/// The part of the energy by which the search may stay below the other one.
constexpr double kPermittedLoss = 1e-3;
/// Ends of the other search that are refined, the best ones.
constexpr std::size_t kRefined = 8;

GridWorkspace workspace;
EnergySearch search;
EnergyBound bound;
double refinement_memory[kRefinementScratch];

std::size_t from_environment(const char* name, std::size_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoul(text, nullptr, 10);
}

struct Case {
  Accelerometer device;
  Butterworth filter;
  double duration_s;
};

/// Device number `index`: all ranges but that of the order evenly filled on a logarithmic scale.
Case case_number(std::size_t index) {
  std::mt19937_64 random(1000 + index);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto between = [&uniform](double low, double high) {
    return low * std::pow(high / low, uniform());
  };
  const double cutoff_hz = between(100.0, 2000.0);
  const double natural_frequency_hz = cutoff_hz * between(2.0, 10.0);
  const double damping = between(0.01, 0.9);
  const int order = 1 + static_cast<int>(15.0 * uniform());
  const double duration_s = between(0.5, 10.0) / cutoff_hz;
  return {{1.0, natural_frequency_hz, damping}, {order, cutoff_hz, 1.0}, duration_s};
}

/// The proven bound for a = 1.
double proven_bound(const ModalModel& model, double duration_s) {
  Status status = bound.start(model, duration_s, workspace);
  while (status == Status::kOk && !bound.done()) {
    status = bound.step(model, workspace);
  }
  EXPECT_EQ(status, Status::kOk);
  return bound.bound();
}

/// Random patterns that each climb by single cells, in the order of the cells, on the full matrix.
class FlipSearch {
 public:
  FlipSearch(const ModalModel& model, double duration_s, std::size_t cells)
      : model_(model), duration_s_(duration_s), cells_(cells), full_(cells * cells) {
    std::vector<double> packed(packed_size(cells));
    EXPECT_EQ(fill_phi(model, duration_s, cells, Span<double>(packed.data(), packed.size())),
              Status::kOk);
    const PhiMatrix phi(Span<const double>(packed.data(), packed.size()), cells);
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = 0; j < cells; ++j) {
        full_[i * cells + j] = phi.at(i, j);
      }
    }
  }

  /// @returns The largest energy of all starts, the best kRefined of them refined.
  double run(std::size_t starts) {
    std::mt19937_64 random(5);
    for (std::size_t start = 0; start < starts; ++start) {
      std::vector<int> x(cells_);
      for (int& sign : x) {
        sign = random() % 2 == 0 ? 1 : -1;
      }
      const double energy = climb(x);
      keep(energy, x);
    }
    double best = 0.0;
    for (const End& end : ends_) {
      SwitchingSignal signal{};
      if (signal.set_signs(test::SignPattern(end.signs).view(), duration_s_) == Status::kOk) {
        best = std::max(best, refine(model_, signal, Span<double>(refinement_memory)).energy);
      }
      best = std::max(best, end.energy);
    }
    return best;
  }

 private:
  struct End {
    double energy;
    std::vector<int> signs;
  };

  double climb(std::vector<int>& x) const {
    std::vector<double> y(cells_, 0.0);
    for (std::size_t i = 0; i < cells_; ++i) {
      add_row(i, x[i], y);
    }
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t i = 0; i < cells_; ++i) {
        // Gains of rounding would go on for ever.
        if (full_[i * cells_ + i] * (1.0 - 1e-12) > x[i] * y[i]) {
          add_row(i, -2.0 * x[i], y);
          x[i] = -x[i];
          moved = true;
        }
      }
    }
    double energy = 0.0;
    for (std::size_t i = 0; i < cells_; ++i) {
      energy += x[i] * y[i];
    }
    return energy;
  }

  void add_row(std::size_t i, double factor, std::vector<double>& y) const {
    const double* row = &full_[i * cells_];
    for (std::size_t j = 0; j < cells_; ++j) {
      y[j] += factor * row[j];
    }
  }

  void keep(double energy, const std::vector<int>& signs) {
    for (const End& end : ends_) {
      if (std::fabs(end.energy - energy) < 1e-10 * energy) {
        return;
      }
    }
    ends_.push_back({energy, signs});
    std::sort(ends_.begin(), ends_.end(),
              [](const End& a, const End& b) { return a.energy > b.energy; });
    if (ends_.size() > kRefined) {
      ends_.pop_back();
    }
  }

  const ModalModel& model_;
  double duration_s_;
  std::size_t cells_;
  std::vector<double> full_;
  std::vector<End> ends_;
};

TEST(SearchDevices, AreAtMostATenthOfAPercentBelowManyRandomStarts) {
  const std::size_t devices = from_environment("EMAX_SEARCH_DEVICES", kDevicesByDefault);
  const std::size_t starts = from_environment("EMAX_SEARCH_STARTS", kStartsByDefault);
  struct Row {
    double loss;
    std::string text;
  };
  std::vector<Row> rows;
  double largest_gap = 0.0;
  for (std::size_t n = 0; n < devices; ++n) {
    const std::size_t index = n * kAllDevices / devices;
    const Case c = case_number(index);
    ModalModel model{};
    ASSERT_EQ(model.set(c.device, c.filter, Criterion::kIntegralSquareError), Status::kOk);
    SearchSettings settings;
    settings.duration_s = c.duration_s;
    ASSERT_EQ(search.start(model, settings), Status::kOk);
    while (!search.done()) {
      ASSERT_EQ(search.step(model, workspace), Status::kOk);
    }
    const MaximumEnergy& found = search.result();
    const double other = FlipSearch(model, c.duration_s, found.cells).run(starts);
    const double loss = 1.0 - found.energy / other;
    EXPECT_LE(loss, kPermittedLoss) << "device " << index;
    const double limit = proven_bound(model, c.duration_s);
    EXPECT_GE(limit, std::fmax(found.energy, other)) << "device " << index;
    largest_gap = std::fmax(largest_gap, limit / found.energy - 1.0);
    char text[200];
    std::snprintf(text, sizeof text,
                  "| %3zu | %7.1f | %5.2f | %6.4f | %2d | %5.2f | %4zu | %3zu | %+.2e |", index,
                  c.filter.cutoff_hz, c.device.natural_frequency_hz / c.filter.cutoff_hz,
                  c.device.damping, c.filter.order, c.duration_s * c.filter.cutoff_hz, found.cells,
                  found.signal.count(), loss);
    rows.push_back({loss, text});
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.loss > b.loss; });
  std::puts("| device | fc in Hz | f0/fc | damping | order | T fc | cells | switches | loss |");
  for (std::size_t i = 0; i < rows.size() && i < 10; ++i) {
    std::puts(rows[i].text.c_str());
  }
  std::printf("largest gap of the proven bound: %.1f %%\n", 100.0 * largest_gap);
}

}  // namespace
}  // namespace emax
