// Runs the benchmarks and heads their table with the memory that each object takes.
#include <benchmark/benchmark.h>
#include <cstddef>
#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/phi_buffer.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/uncertainty/energy_trials.hpp"
#include "emax/uncertainty/monte_carlo.hpp"

namespace {

template <typename T>
void add_size(const char* name) {
  benchmark::AddCustomContext(std::string("bytes of ") + name, std::to_string(sizeof(T)));
}

}  // namespace

int main(int argc, char** argv) {
  add_size<emax::WichmannHill>("WichmannHill");
  add_size<emax::ModalModel>("ModalModel");
  add_size<emax::SwitchingSignal>("SwitchingSignal");
  add_size<emax::PhiBuffer<emax::kPhiCells>>("PhiBuffer<128>");
  add_size<emax::PhiOperator>("PhiOperator");
  add_size<emax::GridWorkspace>("GridWorkspace");
  add_size<emax::EnergySearch>("EnergySearch");
  add_size<emax::EnergyTrials>("EnergyTrials");
  add_size<emax::FrequencyResponse>("FrequencyResponse");
  add_size<emax::Wlsp>("Wlsp");
  add_size<emax::WlspDraws>("WlspDraws");
  add_size<emax::MonteCarlo>("MonteCarlo");
  add_size<emax::app::EvaluationResults>("app::EvaluationResults");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
