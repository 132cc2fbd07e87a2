// The handlers of the instrument's commands, one for each line of the table.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/instrument/instrument.hpp"
#include "emax/app/scpi/call.hpp"
#include "emax/app/scpi/command.hpp"
#include "emax/app/store/saved_state.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// Flag of a row whose setting *LRN? tells: its query answers in one piece.
inline constexpr std::uint8_t kLearned = scpi::kFirstOwnFlag;

/// Handlers take the instrument that they act on and the call.
struct InstrumentCommands {
  using Call = scpi::Call;
  using ErrorCode = scpi::ErrorCode;
  using NumberRule = scpi::NumberRule;
  using IntegerRule = scpi::IntegerRule;

  // Settings

  /// Hands what was refused over to the call.
  static void report(const ErrorWords& words, Call& call) noexcept;

  /// Takes new settings over if they can be had together and nothing that runs needs the old ones.
  static void take(Instrument& i, Call& call, const Settings& next) noexcept;
  static void take(Instrument& i, Call& call, const SweepSettings& next) noexcept;

  /// The command of a row of kSettingRows or kSweepSettingRows: the index counts those that have
  /// one.
  static void setting(Instrument& i, Call& call, std::size_t index) noexcept;
  static void sweep_setting(Instrument& i, Call& call, std::size_t index) noexcept;
  template <std::size_t kIndex>
  static void setting(Instrument& i, Call& call) noexcept {
    setting(i, call, kIndex);
  }
  template <std::size_t kIndex>
  static void sweep_setting(Instrument& i, Call& call) noexcept {
    sweep_setting(i, call, kIndex);
  }

  static void seed(Instrument& i, Call& call) noexcept;
  static void reference(Instrument& i, Call& call) noexcept;
  static void reference_table(Instrument& i, Call& call) noexcept;
  static void clear_reference_table(Instrument& i, Call& call) noexcept;
  static void sweep_frequencies(Instrument& i, Call& call) noexcept;
  static void default_frequencies(Instrument& i, Call& call) noexcept;

  // IEEE 488.2

  static void identify_instrument(Instrument& i, Call& call) noexcept;
  static void reset(Instrument& i, Call& call) noexcept;
  static void clear(Instrument& i, Call& call) noexcept;
  static void operation_complete(Instrument& i, Call& call) noexcept;
  static void wait(Instrument& i, Call& call) noexcept;
  static void options(Instrument& i, Call& call) noexcept;
  static void learn(Instrument& i, Call& call) noexcept;
  static void capability(Instrument& i, Call& call) noexcept;
  static void headers(Instrument& i, Call& call) noexcept;

  // Slots

  static bool take_slot(Instrument& i, Call& call, std::uint32_t& slot) noexcept;
  static void save(Instrument& i, Call& call) noexcept;
  static void recall(Instrument& i, Call& call) noexcept;
  static void self_test(Instrument& i, Call& call) noexcept;

  // Work

  static void progress(Instrument& i, Call& call) noexcept;
  static void abort(Instrument& i, Call& call) noexcept;
  static void initiate_sweep(Instrument& i, Call& call) noexcept;

  template <Goal kGoal>
  static void initiate(Instrument& i, Call& call) noexcept {
    report(i.initiate(kGoal), call);
  }

  // Points

  static std::size_t point_count(const Instrument& i) noexcept;
  static const ResponsePoint& point_at(const Instrument& i, std::size_t index) noexcept;
  /// With the common part.
  static double total_u_amplitude(const Instrument& i, std::size_t index) noexcept;
  static void answer_response(const ResponsePoint& point, scpi::Response& out) noexcept;
  /// @param[in] factor Of the uncertainties: 1, or the coverage factor.
  static void answer_point(const Instrument& i, std::size_t index, double factor,
                           scpi::Response& out) noexcept;
  /// @returns 0 if the query waits or has failed.
  static std::size_t points_to_fetch(Instrument& i, Call& call) noexcept;
  static void fetch(Instrument& i, Call& call) noexcept;
  static void fetch_point(Instrument& i, Call& call) noexcept;
  static void fetch_trace(Instrument& i, Call& call) noexcept;
  static void fetch_json(Instrument& i, Call& call) noexcept;
  static void read(Instrument& i, Call& call) noexcept;
  static double common_percent(const Instrument& i) noexcept;
  static double swept_percent(const Instrument& i) noexcept;
  static double percent_for(const Instrument& i, const FrequencyResponse& points) noexcept;
  static void common_part(Instrument& i, Call& call) noexcept;
  /// Of points that are there already, the uncertainties stay what they are in all.
  static void take_common(Instrument& i, Call& call, double percent) noexcept;
  static bool split_common(const Instrument& i, double percent, FrequencyResponse& points) noexcept;
  static void add_points(Instrument& i, Call& call) noexcept;

  /// @returns What is wrong with the point; null if it was added.
  static const char* add_point(FrequencyResponse& response, const double* numbers) noexcept;
  static void clear_points(Instrument& i, Call& call) noexcept;
  static void count_points(Instrument& i, Call& call) noexcept;

  // Device

  /// The identification that was kept over power off, as long as there are no points.
  static const Identification* kept(const Instrument& i) noexcept;
  static void identify(Instrument& i, Call& call) noexcept;
  static void answer_device(const Device& device, scpi::Response& out) noexcept;
  static Device fitted_device(const EvaluationResults& results) noexcept;
  static void answer_cut_range(const EvaluationResults& results, scpi::Response& out) noexcept;
  static void covariance(Instrument& i, Call& call) noexcept;
  static void model(Instrument& i, Call& call) noexcept;
  /// @returns What is wrong with the device; null if it can be one.
  static const char* problem_of(const Device& device) noexcept;

  // Energy

  static void energy(Instrument& i, Call& call) noexcept;
  static void band(Instrument& i, Call& call) noexcept;
  static void uncertainty(Instrument& i, Call& call) noexcept;
  static void evaluate(Instrument& i, Call& call) noexcept;
  static void fixed_point(Instrument& i, Call& call) noexcept;
  static void absolute_error(Instrument& i, Call& call) noexcept;
  static void settling_time(Instrument& i, Call& call) noexcept;
  static void impulse_response(Instrument& i, Call& call) noexcept;

  /// The item's time is looked for among all that were given.
  static void answer_impulse(Instrument& i, Call& call) noexcept;
  static void monte_carlo(Instrument& i, Call& call) noexcept;
  static void histogram(Instrument& i, Call& call) noexcept;
  static void trend(Instrument& i, Call& call) noexcept;
  static void trend_times(Instrument& i, Call& call) noexcept;
  static bool take_trend(Instrument& i, Call& call) noexcept;
  static void report_text(Instrument& i, Call& call) noexcept;
  static void answer_text(Span<const char> text, Call& call) noexcept;

  // Diagnosis

  static void random(Instrument& i, Call& call) noexcept;
  static void loopback(Instrument& i, Call& call) noexcept;
  /// Loopback, and then ratio and skew as settings.
  static void acquire_corrections(Instrument& i, Call& call) noexcept;
  static void memory(Instrument& i, Call& call) noexcept;
  static void conversion(Instrument& i, Call& call) noexcept;
};

}  // namespace emax::app
