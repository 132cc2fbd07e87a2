// What `emax compare` needs of a results.json.
#pragma once

#include <string>

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// A device's maximum energy and the conditions that it was found under, all from one file.
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
  std::string criterion;
  std::string method;
  std::string distribution;  ///< Of the trials; empty without trials.

  double sensitivity = 0.0;   ///< In V/(m/s^2).
  double energy_v2s = 0.0;    ///< At the estimates.
  double u_energy_v2s = 0.0;  ///< Standard uncertainty; 0 with `has_uncertainty` false.
  bool has_uncertainty = false;
  double probability = 0.0;  ///< Of the interval.
  double low_v2s = 0.0;
  double high_v2s = 0.0;
  bool has_bound = false;
  double bound_v2s = 0.0;  ///< No signal has more energy.
};

/// Reads a results.json of this version of the program, of at most 4 MiB.
///
/// u(E) is that of the parameters' standard uncertainties: the scatter of the trials, times the
/// root of 3 where they were drawn uniformly within estimate +- u (paper equation (21)), since such
/// a range has a standard deviation of u/sqrt(3). E is smooth over so narrow a range.
///
/// @param[out] result Of no use if there is a problem.
Problem read_result(const std::string& path, Result& result);

}  // namespace emax::desk
