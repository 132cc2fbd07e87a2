// The result of an evaluation as a report to read, as JSON and as CSV tables.
#pragma once

#include <cstddef>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// Writes the report, in the manner of a calibration result: what was put in, the measurement with
/// its uncertainty budget if it was measured on a bench, the fit and its quality, the error system,
/// the maximum energy with its signal, Monte Carlo, trend; all with units. Plain ASCII, lines of at
/// most 100 characters, but 130 with accelerations in g; the name of a file or a label may bring
/// other characters and make its line longer.
///
/// Nothing is kept between calls, so the same evaluation gives the same text again: once to count
/// the characters, once to send them.
///
/// @param[in] results    With the stage kDone.
/// @param[in] context    Its measurement has come to a good end, and its points were handed to
///                       `start_from_points()`.
/// @param[in] markup     Null for the text as it is to be read. Otherwise it sets its marks, and
///                       `out` gets the words and numbers between them.
void write_report(const EvaluationResults& results, const ReportContext& context, TextWriter& out,
                  ReportMarkup* markup = nullptr) noexcept;

/// Writes results.json. Always valid JSON in ASCII: a number that is not finite, or that does not
/// exist for this evaluation, is null.
///
/// With a measurement there is an object `bench`. Its `common`, `budget` and `truth` are relative
/// standard uncertainties and the truth of a simulated bench; a row of `budget` is frequency,
/// noise, quantisation, hum, distortion, phase (rad); percentages are expanded (k = 2). With a
/// label there is an object `labels` of the five, null for those not given, and of `more`. Names
/// and labels are read as UTF-8; U+FFFD stands for what is not valid.
///
/// @param[in] results    With the stage kDone.
/// @param[in] context    As for the report.
void write_json(const EvaluationResults& results, const ReportContext& context,
                TextWriter& out) noexcept;

/// What an instrument has at the moment. Refers to what it describes; made for one call.
struct InstrumentState {
  const EvaluationResults& evaluation;
  const Measurement* measurement;  ///< Null if the points were not measured here.
  const FrequencyResponse& points;
  bool has_model;  ///< And so on: whether this result is there, and that of the device of now.
  bool has_energy;
  bool has_band;
  bool has_uncertainty;
  bool has_trials;
  bool has_trend;
};

/// Writes what there is, with the objects of results.json, null for the rest; and before them
///
/// * `points`: objects of f_hz, amplitude, phase_deg, u_amplitude, u_phase_deg, with expanded total
///   uncertainties (k = 2).
/// * `sweep`, with a measurement: what a front end needs to go on with it as if it were its own,
/// all
///   numbers to the last bit. `status` and `stage` as the instrument counts them; `settings` by
///   their names; a row of `rows` is phase in rad, u of the amplitude and of the phase in rad (each
///   without the common part, standard), peak acceleration, peak drive, residual in percent, 1 if
///   flagged, 1 if it scatters; `silence` has offset, drift, noise and hum of either channel;
///   `check` the complex ratios before and after; `noise` both channels' and its degrees of
///   freedom.
void write_instrument_json(const InstrumentState& state, TextWriter& out) noexcept;

/// Writes the report of points that determine the sensitivity alone: there is no energy.
///
/// @param[in] results    That has refused them with Determined::kSensitivity.
void write_sensitivity_report(const EvaluationResults& results, const ReportContext& context,
                              TextWriter& out, ReportMarkup* markup = nullptr) noexcept;

/// The same as results.json, with null for all that there is not.
void write_sensitivity_json(const EvaluationResults& results, const ReportContext& context,
                            TextWriter& out) noexcept;

/// Writes one sentence, without line feed, on why an evaluation was refused or has ended early,
/// with the T or the fitted values that it is about; nothing if it has not failed.
void write_failure(const EvaluationResults& results, TextWriter& out) noexcept;

// Tables for other programs, each with a header line. The evaluation has the stage kDone. Tables of
// what there is none of (points, trials, trend) are the header alone.

/// f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,model_amplitude,model_phase_deg,residual_re,
/// residual_im: expanded uncertainties (k = 2) as in the table of points, normalised residuals of
/// 1/K. A part that is common to all points is within u_amplitude: the file can be read as a table
/// of points, with the common part as the reference's uncertainty, in the column u_common. Points
/// of a sweep have the peak acceleration that they were measured at in level_mps2, which is for
/// other readers: a table of points is read without it.
///
/// @param[in] sweep Whose points they are; null for others.
void write_frequency_response_csv(const EvaluationResults& results, const SweepResults* sweep,
                                  TextWriter& out) noexcept;

/// t_s,k,ka,kf: kResponseRows rows from 0 to T or to the settling time, whichever is later.
void write_impulse_response_csv(const EvaluationResults& results, TextWriter& out) noexcept;
inline constexpr std::size_t kResponseRows = 1001;

/// t_s,x_mps2,y_v: equally spaced rows from 0 to T, kSignalRows or as many as give the fastest
/// oscillation 20 rows per period, and two for each switch, before and after it.
void write_signal_csv(const EvaluationResults& results, TextWriter& out) noexcept;
inline constexpr std::size_t kSignalRows = 2001;

/// T_s,E,fit: E and the straight line in V^2 s.
void write_trend_csv(const EvaluationResults& results, TextWriter& out) noexcept;

/// E_low,E_high,count: kHistogramRows equal bins from the smallest to the largest E of the trials,
/// in V^2 s. If all trials gave the same E, one row.
void write_histogram_csv(const EvaluationResults& results, TextWriter& out) noexcept;

/// The value of chi2/dof that is exceeded once in a hundred fits where the model and the stated
/// uncertainties hold; the report warns above it. By the approximation of Wilson and Hilferty,
/// within 1 % for 3 degrees of freedom and closer for more.
///
/// @returns 0 for no degrees of freedom.
double reduced_chi_square_limit(std::size_t dof) noexcept;

}  // namespace emax::app
