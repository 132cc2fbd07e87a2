// What `emax compare` needs of a results.json.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "emax/app/evaluate/evaluation_results.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// What devices can be ranked by.
enum class FigureKind : std::uint8_t {
  kMatched,  ///< Error within the filter's band, the sensor's constant delay taken out.
  kBand,     ///< Error within the filter's band, with its delay.
  kEnergy,   ///< The energy of the paper's criterion.
};

inline constexpr std::size_t kFigureKinds = 3;

using app::kCoverageFactor;

/// One figure of a device: the two of the band as rms errors in percent of S a, the energy in V^2
/// s.
struct Figure {
  bool exists = false;
  double value = 0.0;  ///< At the estimates.
  bool has_uncertainty = false;
  double u = 0.0;         ///< Standard uncertainty.
  double expanded = 0.0;  ///< U, with kCoverageFactor.
  bool has_interval = false;
  /// Low and high are those of the dampings that the points leave open, and there is no u.
  bool has_range = false;
  double low = 0.0;  ///< Of the coverage interval, of a probability of `Result::probability`.
  double high = 0.0;
  /// The interval is the shortest one, which holds the figure, and +-U says little.
  bool is_one_sided = false;
  bool has_bound = false;
  double bound = 0.0;  ///< No signal has more.
  /// How far the true figure can be from `value` by the way it is computed, beside U.
  double epsilon = 0.0;
};

/// What was taken out of a figure.
struct Delay {
  std::string mode;  ///< "none", "auto" (the sensor's, so each device has its own) or "given".
  double time_s = 0.0;

  /// @returns Whether figures with the one and the other can be compared.
  bool is_like(const Delay& other) const noexcept {
    return mode == other.mode && (mode != "given" || time_s == other.time_s);
  }
};

/// A device's figures and the conditions that they were found under, all from one file.
struct Result {
  std::string path;
  std::string file;    ///< For people.
  std::string device;  ///< Its label; else the file's name.
  std::string serial;  ///< Empty if there is none.

  // Conditions.
  double order = 0.0;
  double cutoff_hz = 0.0;
  std::string gain_mode;  ///< "auto", "fixed" or "track".
  double gain = 0.0;      ///< In V/(m/s^2).
  double limit_mps2 = 0.0;
  double duration_s = 0.0;
  std::string criterion;  ///< Of the energy.
  Delay energy_delay;     ///< Of its reference; "none" but for the in-band error.
  std::string method;

  double sensitivity = 0.0;  ///< In V/(m/s^2).
  std::array<Figure, kFigureKinds> figures = {};
  Delay delay;                              ///< That has been taken out of the matched figure.
  std::string band_refused;                 ///< Why there are no figures of the band, the same.
  std::string matched_refused;              ///< Why there is no matched figure; empty if not known.
  bool has_ideal = false;                   ///< The next is known.
  double ideal_percent = 0.0;               ///< Root of E/T of an ideal sensor, in percent of S a.
  double probability = 0.0;                 ///< Of the intervals; 0 where there are none.
  bool energy_u_is_of_box = false;          ///< u(E) follows from the trials over the box.
  bool fit_warns = false;                   ///< The points do not follow the fitted model.
  bool is_simulated = false;                ///< The bench was.
  bool has_open_damping = false;            ///< The points do not determine beta.
  std::vector<std::string> other_warnings;  ///< What else its report warns of, a line each.
  bool has_namesake = false;                ///< Another result has the same device and number.

  const Figure& figure(FigureKind kind) const noexcept {
    return figures[static_cast<std::size_t>(kind)];
  }
  Figure& figure(FigureKind kind) noexcept { return figures[static_cast<std::size_t>(kind)]; }
  /// @returns Root of E/T in V; not a number for an energy difference below 0.
  double rms_v() const noexcept;
  /// @returns The same in percent of S a.
  double rms_percent() const noexcept;
  /// @returns That of another energy in V^2 s.
  double rms_percent(double energy_v2s) const noexcept;
};

/// Reads a results.json of this version of the program, of at most 4 MiB.
///
/// u(E) is that of the block "uncertainty". Where that is null, it is the scatter of the trials,
/// times the root of 3 where they were drawn uniformly within estimate +- u (paper equation (21)):
/// such a range has a standard deviation of u/sqrt(3), and E is smooth over so narrow a range.
/// Where the points leave the damping open there is none, and the range of E in its place.
/// A file without the block "band" has no figures of the band; one without "warnings" has its fit
/// judged as the report does. Numbers that cannot be, such as an rms or an uncertainty below 0, are
/// refused.
///
/// @param[out] result Of no use if there is a problem.
Problem read_result(const std::string& path, Result& result);

}  // namespace emax::desk
