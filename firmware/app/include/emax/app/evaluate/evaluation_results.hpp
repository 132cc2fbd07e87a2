// What an evaluation leaves: fit, error system, maximum energy, trials and trend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/stage.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/identify/fit_judgement.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/model/accelerometer.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/model/response_scan.hpp"
#include "emax/uncertainty/energy_branches.hpp"
#include "emax/uncertainty/energy_guard.hpp"
#include "emax/uncertainty/energy_trials.hpp"
#include "emax/uncertainty/monte_carlo.hpp"
#include "emax/uncertainty/trend.hpp"

namespace emax::app {

/// A device with the standard uncertainties of its parameters.
struct Device {
  Accelerometer estimate;
  ParameterBox u;  ///< Standard uncertainties; also the half-widths of paper equation (21).
};

enum class Source : std::uint8_t { kPoints, kModel };

/// k of every expanded uncertainty U = k u.
inline constexpr double kCoverageFactor = 2.0;

/// T shorter than this part of the settling time is much shorter: the error has then hardly begun.
inline constexpr double kMuchShorter = 0.4;

/// More cells than a length of the default trend may take: a search on four times as many takes a
/// minute of a PC. Who gives lengths of his own has all the room there is.
inline constexpr std::size_t kMostDefaultCells = kMaxCells < 16384 ? kMaxCells : 16384;

/// The largest energy for one duration of the trend.
struct TrendPoint {
  double duration_s = 0.0;
  double energy_v2s = 0.0;
};

/// Rows of the histogram of the trials' energies.
inline constexpr std::size_t kHistogramRows = 64;

/// What is kept of the trials: the results and a coarse histogram. Energies in V^2 s.
struct TrialResults {
  MonteCarloResult result;
  /// Normal draws that were no device and were made again; more than 1 % deserve a warning.
  std::uint32_t redraws = 0;
  BranchNotes branches;  ///< The signals that the trials took the largest energy of.
  std::uint32_t rows[kHistogramRows] = {};

  /// The number of values in equal bins from the smallest to the largest.
  Span<const std::uint32_t> histogram() const noexcept { return Span<const std::uint32_t>(rows); }

  /// Takes over the results of a procedure that is done.
  void take(const MonteCarlo& monte_carlo, const MonteCarloStore& store) noexcept;
};

/// How the full searches went that were made for some of the trials.
struct GuardResults {
  std::uint16_t searches = 0;  ///< 0 for Method::kPaper, whose trials are full runs.
  std::uint16_t disagreements = 0;
  float largest_excess = 0.0F;  ///< As `EnergyGuard::largest_excess()`.
};

/// What is kept of a guard that is done.
GuardResults results_of(const EnergyGuard& guard) noexcept;

/// What is known of the uncertainty of a largest energy: JCGM 101, jointly normal with the fit's
/// covariance, or independent normals where parameters were given.
struct EnergyUncertainty {
  bool is_done = false;
  Status status = Status::kOk;  ///< With `is_done`; unless it is kOk, there are no numbers.
  std::uint32_t trials = 0;
  std::uint32_t redraws = 0;       ///< Draws that were no device and were made again.
  std::uint32_t rough_trials = 0;  ///< As in `BranchNotes`,
  float rough_part = 0.0F;         ///< this too.
  GuardResults guard;
  double mean_v2s = 0.0;
  double u_v2s = 0.0;
  CoverageInterval symmetric;  ///< In V^2 s.
  CoverageInterval shortest;
  /// Standard deviation of 100 sqrt(E/T)/(S a), S being each trial's; not a number where a trial's
  /// energy difference is below 0.
  double u_percent = 0.0;
  /// With a gain that is a number: the intervals of E (S/S_t)^2, S_t being each trial's S, which
  /// percentages are of. Else E varies with no S, or as the square of it, and has one kind alone.
  bool has_relative = false;
  CoverageInterval relative_symmetric;
  CoverageInterval relative_shortest;

  /// @returns What percentages are made of.
  const CoverageInterval& symmetric_of_percent() const noexcept {
    return has_relative ? relative_symmetric : symmetric;
  }
  const CoverageInterval& shortest_of_percent() const noexcept {
    return has_relative ? relative_shortest : shortest;
  }
  bool exists() const noexcept { return is_done && status == Status::kOk; }
  /// @returns U of that percentage; 0 if there is none.
  double expanded_percent() const noexcept { return exists() ? kCoverageFactor * u_percent : 0.0; }
};

/// @returns Whether +-U says little of a figure that the trials leave mostly on one side, and an
/// interval has to stand in its place: U is above the figure, or one end of the interval is more
/// than twice as far from it as the other.
///
/// @param[in] interval That holds the figure.
bool is_one_sided(double figure, double expanded, const CoverageInterval& interval) noexcept;

/// @returns The interval, widened to hold the figure: no less likely.
CoverageInterval widened(const CoverageInterval& interval, double figure) noexcept;

/// A largest energy beside that of the criterion: an in-band error.
///
/// Its uncertainty is for a gain of the filter that follows S: S stays at its estimate and f0 and
/// beta are drawn. The uncertainty of S itself is a common error of gain and is shown beside it.
/// With GainMode::kFixed the gain is the number given, and S is drawn too.
struct FigureResults {
  /// How many switching times are kept: 32 on a board, 256 on a PC.
  static constexpr std::size_t kTimes = kMaxSwitches / 8;

  bool is_done = false;         ///< Looked for, with its bound.
  Status status = Status::kOk;  ///< With `is_done`; unless it is kOk, why there is none.
  bool has_bound = false;
  bool is_short = false;         ///< There is none, and T is much shorter than its settling time.
  std::uint16_t switches = 0;    ///< Of the signal; the first kTimes are kept.
  double energy_v2s = 0.0;       ///< With a delay that of the continued filter.
  double rounding_v2s = 0.0;     ///< What rounding may have changed of it.
  double bound_v2s = 0.0;        ///< With `has_bound`: of any signal, for the true delay.
  double delay_s = 0.0;          ///< Taken out of the reference.
  double epsilon_percent = 0.0;  ///< By which the true delay may change the rms, in % of S a.
  EnergyUncertainty uncertainty;
  bool is_range_done = false;  ///< Where the points leave the damping open: looked for.
  bool has_range = false;      ///< False where a search within the range has failed.
  double least_v2s = 0.0;      ///< With `has_range`: over these dampings, for the S of the
  double greatest_v2s = 0.0;   ///< estimate. A delay that is the sensor's is each one's own.
  double times_kept_s[kTimes] = {};

  bool exists() const noexcept { return is_done && status == Status::kOk; }
  /// @returns Why there is none. Never null.
  const char* refusal() const noexcept;
  Span<const double> times_s() const noexcept {
    return Span<const double>(times_kept_s, switches < kTimes ? switches : kTimes);
  }
  /// Forgets all, in place.
  void clear() noexcept;
};

/// The largest energy of an ideal sensor, K = S at every frequency, for the same criterion: what a
/// largest energy is to be compared with.
struct IdealResults {
  bool is_done = false;
  Status status = Status::kOk;
  /// The larger of what was found and of what ever faster switching tends to.
  double energy_v2s = 0.0;

  bool exists() const noexcept { return is_done && status == Status::kOk; }
};

/// The results of an evaluation, while it runs and afterwards, each part complete once its flag is
/// set. 12 KiB, all zero before the first one.
///
/// They know what they were made from: `holds()` and `is_of()` are the only truth on what may be
/// shown as the answer for a device and settings.
struct EvaluationResults {
  /// How many energies of the fixed point are kept: some more than the report shows.
  static constexpr std::size_t kTraceLength = 16;

  // Large ones last: what is near the front is reached by shorter instructions.
  Settings settings = kNoSettings;  ///< That they were made with.
  Source source = Source::kPoints;
  Stage stage = Stage::kIdle;
  bool is_accepted = false;  ///< Device and model.
  /// The error system with its peak, settling time and largest absolute error is there.
  bool has_model = false;
  /// Not for a T in which k moves more often than `AbsoluteError` takes samples.
  bool has_absolute_error = false;
  bool has_fit_draws = false;
  bool has_energy = false;
  bool has_bound = false;      ///< False where no upper bound passed its check.
  bool is_bound_done = false;  ///< A bound was looked for: proven or given up.
  bool has_monte_carlo = false;
  bool has_cut_range = false;  ///< False where a search at an end of the range has failed.
  bool is_cut_done = false;    ///< The range of energies was looked for: found or given up.
  bool has_trend = false;
  std::size_t trace_count = 0;
  std::size_t trend_count = 0;
  std::uint32_t trend_looked_at = 0;  ///< Times of the trend, from the first.
  /// A bit for each time of the trend that needs more cells or switches than there is room for.
  std::uint32_t trend_left_out = 0;
  Failure failure;
  Device device;
  double limit_mps2 = 0.0;  ///< a.
  Peak peak;
  SettlingTime settling_time;     ///< To 5 % of the peak.
  SettlingTime band_settling;     ///< The same of the in-band error with its delay.
  double absolute_error_v = 0.0;  ///< The largest |y(t)| of any signal within +-a of this T.
  double bound_v2s = 0.0;         ///< No signal within +-a of this T has more; with `has_bound`.
  double cut_low_v2s = 0.0;       ///< With `has_cut_range`: the energies over the dampings that
  double cut_high_v2s = 0.0;      ///< the points leave open.
  GuardResults guard;
  AdaptiveResult adaptive;
  Accelerometer device_at_maximum;               ///< Of the trial with the largest energy.
  FitJudgement judgement;                        ///< What the points determine.
  Trend trend;                                   ///< Energies in V^2 s.
  WlspDrawsResult fit_draws;                     ///< With `has_fit_draws`.
  TrialResults trials;                           ///< With `has_monte_carlo`.
  TrendPoint trend_table[kMaxTrendPoints] = {};  ///< `trend_points()` is the part in use.
  EnergyUncertainty uncertainty;                 ///< Of `energy_v2s()`.
  IdealResults ideal;
  double given_covariance[3][3] = {};   ///< Source::kModel only.
  FigureResults band;                   ///< The in-band error without a delay of the reference.
  FigureResults matched;                ///< With the sensor's delay, or the one given, taken out.
  double trace_v2s[kTraceLength] = {};  ///< `trace()` is the part in use.
  MaximumEnergy maximum;  ///< Its energy is for a = 1; `energy_v2s()` is the one to show.
  ModalModel model;       ///< At the estimate.
  Wlsp fit;               ///< Source::kPoints only.

  /// Forgets everything but the settings, in place: nothing passes over the stack.
  void clear() noexcept;
  /// Forgets these parts of them.
  void drop_trials() noexcept;
  void drop_trend() noexcept;
  void drop_uncertainties() noexcept;

  bool done() const noexcept { return stage == Stage::kDone || stage == Stage::kFailed; }
  Status status() const noexcept { return failure.status; }
  bool has_fit() const noexcept { return is_accepted && source == Source::kPoints; }
  /// @returns Whether the points leave the damping open. There are no trials then, but the range of
  /// the energies over the dampings that they leave.
  bool is_damping_open() const noexcept {
    return source == Source::kPoints && judgement.determined == Determined::kAllButDamping;
  }
  /// @returns Whether points were refused because they determine the sensitivity alone.
  bool is_sensitivity_alone() const noexcept {
    return source == Source::kPoints && stage == Stage::kFailed &&
           judgement.determined == Determined::kSensitivity;
  }
  /// @returns Whether there is an uncertainty for trials, which need a range for each parameter.
  bool has_uncertainty() const noexcept;
  /// @returns Whether both in-band errors and the ideal sensor were looked for.
  bool has_figures() const noexcept { return ideal.is_done && band.is_done && matched.is_done; }
  /// @returns Whether the ranges of both in-band errors were looked for, where the damping is open.
  bool has_figure_ranges() const noexcept;
  /// @returns Whether nothing can be added to the uncertainties.
  bool has_uncertainties() const noexcept;

  /// @returns Whether everything that this goal asks for is there and would come out the same with
  /// these settings. For kMonteCarlo and kTrend false where there are no trials and no times; for
  /// kReport these are no part of it then.
  bool holds(Goal goal, const Settings& wanted) const noexcept;
  /// @returns Whether error system and energy would come out the same with these settings, so that
  /// `Evaluation::pursue()` may go on from here.
  bool holds_energy_of(const Settings& wanted) const noexcept;
  /// @returns Whether they are those of this device, given by its parameters.
  bool is_of(const Device& other) const noexcept;
  /// @returns Whether they are those of the device that these points give.
  bool is_of(const FrequencyResponse& points) const noexcept;

  /// @returns Element (i, j) of the covariance of S, f0 and beta: that of the fit, or the squares
  /// of the given uncertainties on the diagonal.
  double covariance(std::size_t i, std::size_t j) const noexcept;
  /// @returns What the uncertainties are multiplied by for the trials: 1, or the Birge ratio.
  double trial_scale(const Settings& wanted) const noexcept;
  double trial_scale() const noexcept { return trial_scale(settings); }

  double a2() const noexcept { return limit_mps2 * limit_mps2; }
  double energy_v2s() const noexcept { return a2() * maximum.energy; }
  /// @returns xi = E/(a^2 T), paper equation (7), in (V/(m/s^2))^2.
  double xi() const noexcept { return maximum.energy / settings.duration_s; }
  /// @returns 100 sqrt(E/T)/(S a) of an energy, S being the estimate; not a number below 0.
  double percent_of(double energy_v2s) const noexcept;
  /// @returns The shortest interval of a figure that has an uncertainty, widened to hold the
  /// figure, in percent as by `percent_of()`.
  CoverageInterval interval_percent_of(const CoverageInterval& energies_v2s,
                                       double energy_v2s) const noexcept;
  /// @returns Whether that interval has to stand in the place of +-U.
  bool is_one_sided(const EnergyUncertainty& known, double energy_v2s) const noexcept;
  /// @returns Whether an uncertainty that exists is that of fewer trials than asked for, as many of
  /// them take a refinement (`EnergyTrials::most_trials()`).
  bool has_fewer_trials(const EnergyUncertainty& known) const noexcept {
    return known.trials != 0 &&
           known.trials < (settings.adaptive ? adaptive.trials : settings.trials);
  }
  bool is_one_sided(const FigureResults& figure) const noexcept {
    return is_one_sided(figure.uncertainty, figure.energy_v2s);
  }
  /// @returns sqrt(E/T) in V; not a number for an energy difference below 0.
  double rms_error_v() const noexcept;
  /// @returns The output y(t) for the signal found with its limit a, in V.
  double output_v(double time_s) const noexcept {
    return limit_mps2 * error_output(model, maximum.signal, time_s);
  }
  /// @returns E_0, E_1, ... of the fixed point in V^2 s; Method::kPaper only.
  Span<const double> trace() const noexcept { return Span<const double>(trace_v2s, trace_count); }
  Span<const TrendPoint> trend_points() const noexcept {
    return Span<const TrendPoint>(trend_table, trend_count);
  }

 private:
  // Defaults that are not zero would take flash for the whole object.
  static constexpr Settings kNoSettings = {0,
                                           0.0,
                                           GainMode::kAuto,
                                           0.0,
                                           0.0,
                                           false,
                                           0.0,
                                           Criterion::kIntegralSquareError,
                                           DelayChoice::kAuto,
                                           0.0,
                                           {},
                                           0.0,
                                           0,
                                           0,
                                           false,
                                           0.0,
                                           {},
                                           false,
                                           {},
                                           {},
                                           {},
                                           0};
};

static_assert(std::is_trivially_copyable_v<EvaluationResults>);

}  // namespace emax::app
