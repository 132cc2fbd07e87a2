// Compares what matters: a number that nobody looks at makes no difference.
#include "same_settings.hpp"

#include <algorithm>

namespace emax::app {

bool is_same_generator(const Settings& a, const Settings& b) noexcept {
  bool is_same = a.generator == b.generator;
  for (std::size_t i = 0; i < a.seed.size(); ++i) {
    is_same = is_same && a.seed[i] == b.seed[i];
  }
  return is_same;
}

bool is_same_trials(const Settings& a, const Settings& b) noexcept {
  return is_same_generator(a, b) && a.adaptive == b.adaptive &&
         (a.adaptive || a.trials == b.trials) && a.probability == b.probability &&
         a.distribution == b.distribution && a.birge == b.birge;
}

bool is_same_trend(const Settings& a, const Settings& b) noexcept {
  return a.trend_count == b.trend_count &&
         std::equal(a.trend_s.begin(), a.trend_s.begin() + a.trend_count, b.trend_s.begin());
}

bool is_same_energy(const Settings& a, const Settings& b) noexcept {
  const bool is_fixed_gain = a.gain_mode == GainMode::kFixed;
  const bool is_paper = a.method == Method::kPaper;
  return a.filter_order == b.filter_order && a.cutoff_hz == b.cutoff_hz &&
         a.gain_mode == b.gain_mode && (!is_fixed_gain || a.gain == b.gain) &&
         a.duration_s == b.duration_s && a.limit_is_auto == b.limit_is_auto &&
         (a.limit_is_auto || a.limit_mps2 == b.limit_mps2) && a.criterion == b.criterion &&
         a.method == b.method &&
         (!is_paper || (a.step_s == b.step_s && a.iterations == b.iterations));
}

bool is_same_memory(const void* a, const void* b, std::size_t bytes) noexcept {
  const auto* const first = static_cast<const unsigned char*>(a);
  const auto* const second = static_cast<const unsigned char*>(b);
  bool is_same = true;
  for (std::size_t i = 0; is_same && i < bytes; ++i) {
    is_same = first[i] == second[i];
  }
  return is_same;
}

}  // namespace emax::app
