// The parts of the report that lead: the figures side by side, the in-band errors, and the
// uncertainty of E.
#pragma once

#include <cstdint>

#include "emax/app/evaluate/evaluation_results.hpp"

#include "report_parts.hpp"

namespace emax::app {

/// As many decimals, at most 12, as give `value` this many significant digits.
int decimals_of(double value, int digits) noexcept;

/// A number that is no less in so many decimals, and one that is no more.
double rounded_up(double value, int decimals) noexcept;
double rounded_down(double value, int decimals) noexcept;

/// The figures that tell sensors apart, in percent of S a.
/// A figure that a warning concerns has a star, and a line below the table says which.
void write_figures(const EvaluationResults& results, const ReportContext& context,
                   ReportWriter& out) noexcept;

/// "5 % settling time", and what a T shorter than that is worth.
///
/// @param[in] name What the settling time is called in the middle of a sentence.
void write_settling_time(const char* label, const SettlingTime& settling,
                         ReportWriter& out) noexcept;
void write_short_time(const char* name, const SettlingTime& settling,
                      const EvaluationResults& results, ReportWriter& out) noexcept;

/// The in-band errors, in V^2 s and with their signals.
void write_in_band(const EvaluationResults& results, double leading_settling_s,
                   ReportWriter& out) noexcept;

/// What JCGM 101 gives for the energy of the criterion.
void write_uncertainty(const EvaluationResults& results, ReportWriter& out) noexcept;

/// What full searches made of some of the trials.
void write_guard(const GuardResults& guard, ReportWriter& out) noexcept;
/// How many trials are polynomials that are off by more than 1e-6 u(E), and by how much at most,
/// with a warning above kMostRough; nothing if there are none.
///
/// @param[in] part Of u(E).
void write_rough_trials(std::uint32_t trials, float part, ReportWriter& out) noexcept;

/// What no signal exceeds at the estimates, in V^2 s.
void write_upper_bound(bool exists, double bound_v2s, ReportWriter& out) noexcept;

/// "+a from the start, n switches, at (ms)" and the times.
///
/// @param[in] switches The number of them all; `times_s` may hold fewer.
void write_switching_times(std::size_t switches, Span<const double> times_s,
                           ReportWriter& out) noexcept;

}  // namespace emax::app
