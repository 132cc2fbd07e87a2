// A sweep with what a report says of the bench it ran on, also where it did not come to a good end.
#pragma once

#include <cstdint>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax::app {

/// What a simulated bench was built from, and a real one is not told.
struct SimulatedBench {
  std::uint64_t seed = 0;
  Accelerometer truth;
  /// The scripted faults that the last sweep's end came before, in words; null if there are none.
  /// For FETCh:JSON?.
  const char* unstruck = nullptr;
};

/// Refers to what it describes; made for one call.
struct Measurement {
  const SweepResults& sweep;  ///< That is `done()`.
  const hal::StreamFormat& format;
  const SimulatedBench* simulated = nullptr;  ///< Null for a real bench.
};

/// What stands above all that comes from a simulated bench.
inline constexpr char kSimulationBanner[] = "SIMULATION: no real sensor was measured.";

/// @returns Whether the bench of a report was a simulated one.
constexpr bool is_simulated(const ReportContext& context) noexcept {
  return context.measurement != nullptr && context.measurement->simulated != nullptr;
}

/// @returns "swapped channels", "lost block" and so on: what a sweep has failed with, in two or
/// three words. Never null.
const char* name_of_fault(Status status) noexcept;

/// Writes the report of a measurement that led to no result: the fault, where, what to check, and
/// everything that was measured before it. Like `write_report()` in all else.
///
/// @param[in] context With a measurement.
/// @param[in] refused The evaluation that has refused the points; null if the sweep failed.
void write_measurement(const ReportContext& context, const EvaluationResults* refused,
                       TextWriter& out, ReportMarkup* markup = nullptr) noexcept;

/// The same as results.json, with null for all that there is not.
void write_measurement_json(const ReportContext& context, const EvaluationResults* refused,
                            TextWriter& out) noexcept;

/// The points so far as f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg, with expanded total
/// uncertainties (k = 2): the first five columns of frequency_response.csv.
void write_measured_points_csv(const Measurement& measurement, TextWriter& out) noexcept;

}  // namespace emax::app
