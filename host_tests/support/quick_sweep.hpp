// A sweep for tests that are about what comes after it.
#pragma once

#include <algorithm>

#include "emax/app/settings/sweep_settings.hpp"

namespace emax::test {

/// Five frequencies and short records: a sweep in tens of milliseconds.
inline app::SweepSettings quick_sweep() {
  app::SweepSettings settings = app::default_sweep_settings();
  settings.frequency_count = 5;
  const double frequencies_hz[] = {200.0, 1000.0, 2500.0, 4000.0, 5500.0};
  std::copy_n(frequencies_hz, 5, settings.frequency_hz.begin());
  settings.repeats = 3;
  return settings;
}

}  // namespace emax::test
