// The largest error energy of one accelerometer, in static memory and in short steps.
#include "emax/energy/energy_search.hpp"

#if __STDC_HOSTED__
#include <cstdio>
#endif

static emax::ModalModel model;
static emax::EnergySearch search;
static emax::GridWorkspace workspace;
static double energy_v2s;

// What your firmware calls. Returns whether there is a result.
extern "C" bool find_largest_energy() {
  const emax::Accelerometer device = {1.037, 4073.0, 0.3182};  // V/(m/s^2), Hz, damping.
  const emax::Butterworth filter = {10, 1000.0, 1.037};        // Order, Hz, V/(m/s^2).
  emax::Status status = model.set(device, filter, emax::Criterion::kIntegralSquareError);
  const emax::SearchSettings settings = {emax::Method::kBest, 0.002, 0.0, 0};  // T = 2 ms.
  status = status == emax::Status::kOk ? search.start(model, settings) : status;
  while (status == emax::Status::kOk && !search.done()) {
    status = search.step(model, workspace);
    // Here the firmware does the rest of its work.
  }
  energy_v2s = 1.037 * 1.037 * search.result().energy;  // For signals within 1.037 m/s^2.
  return status == emax::Status::kOk;
}

#if __STDC_HOSTED__  // On a PC, to look at it.
int main() {
  const bool is_found = find_largest_energy();
  std::printf("E = %.13g V^2 s\n", energy_v2s);
  return is_found ? 0 : 1;
}
#endif
