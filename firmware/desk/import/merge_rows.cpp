// Rows of a table in the order of frequency, with repeated ones averaged.
#include "desk/import/merge_rows.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::desk {

namespace {

// Sums of values and uncertainties about the first value.
class Mean final {
 public:
  void add(double value, double u) noexcept {
    if (count_ == 0.0) {
      first_ = value;
    }
    const double deviation = value - first_;
    sum_ += deviation;
    squares_ += deviation * deviation;
    u_squares_ += u * u;
    count_ += 1.0;
  }
  bool empty() const noexcept { return count_ == 0.0; }
  double first() const noexcept { return first_; }
  double value() const noexcept { return first_ + sum_ / count_; }
  double u() const noexcept {
    const double stated = u_squares_ / count_;
    if (count_ < 2.0) {
      return sqrt(stated);
    }
    const double rest = squares_ - sum_ * sum_ / count_;
    const double variance = rest > 0.0 ? rest / (count_ - 1.0) : 0.0;
    return sqrt(stated + variance / count_);
  }

 private:
  double first_ = 0.0;
  double sum_ = 0.0;
  double squares_ = 0.0;
  double u_squares_ = 0.0;
  double count_ = 0.0;
};

double near(double phase_rad, double other_rad) noexcept {
  while (phase_rad - other_rad > kPi) {
    phase_rad -= kTwoPi;
  }
  while (phase_rad - other_rad < -kPi) {
    phase_rad += kTwoPi;
  }
  return phase_rad;
}

Row mean_of(const Row* rows, std::size_t count) {
  Mean amplitude;
  Mean phase;
  for (std::size_t i = 0; i < count; ++i) {
    amplitude.add(rows[i].amplitude, rows[i].u_amplitude);
    if (rows[i].has_phase) {
      const double angle =
          phase.empty() ? rows[i].phase_rad : near(rows[i].phase_rad, phase.first());
      phase.add(angle, rows[i].u_phase_rad);
    }
  }
  Row mean = rows[0];
  mean.amplitude = amplitude.value();
  mean.u_amplitude = amplitude.u();
  mean.has_phase = !phase.empty();
  if (mean.has_phase) {
    mean.phase_rad = phase.value();
    mean.u_phase_rad = phase.u();
  }
  return mean;
}

}  // namespace

MergedRows merge_rows(std::vector<Row> rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.frequency_hz < b.frequency_hz; });
  MergedRows merged;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin + 1;
    while (end < rows.size() && rows[end].frequency_hz == rows[begin].frequency_hz) {
      ++end;
    }
    const std::size_t count = end - begin;
    merged.rows.push_back(count == 1 ? rows[begin] : mean_of(&rows[begin], count));
    merged.repeats += count > 1 ? 1U : 0U;
    begin = end;
  }
  return merged;
}

}  // namespace emax::desk
