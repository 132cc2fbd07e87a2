// How the columns of a table become numbers in Hz, V/(m/s^2) and rad.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "desk/import/find_table.hpp"
#include "desk/import/import_error.hpp"
#include "desk/import/import_options.hpp"
#include "desk/import/input_units.hpp"
#include "desk/import/table_header.hpp"

namespace emax::desk {

/// Of every expanded uncertainty.
inline constexpr double kImportCoverage = 2.0;

/// One column.
struct Conversion {
  std::size_t column = 0;
  std::string name;
  Unit unit;
  double sign = 1.0;                  ///< -1 for a lag that is positive.
  double coverage = kImportCoverage;  ///< Of an uncertainty.
  bool is_there = false;
  bool is_uncertainty = false;
  bool is_relative = false;  ///< An uncertainty in percent.
  bool is_decibel = false;
};

/// All columns that are used, by their roles.
class Conversions final {
 public:
  Conversion& of(Role role) noexcept { return all_[static_cast<std::size_t>(role)]; }
  const Conversion& of(Role role) const noexcept { return all_[static_cast<std::size_t>(role)]; }

  const Conversion& frequency() const noexcept { return of(Role::kFrequency); }
  const Conversion& amplitude() const noexcept { return of(Role::kAmplitude); }
  const Conversion& phase() const noexcept { return of(Role::kPhase); }
  const Conversion& u_amplitude() const noexcept { return of(Role::kAmplitudeUncertainty); }
  const Conversion& u_phase() const noexcept { return of(Role::kPhaseUncertainty); }
  const Conversion& u_common() const noexcept { return of(Role::kCommonUncertainty); }
  Conversion& frequency() noexcept { return of(Role::kFrequency); }
  Conversion& amplitude() noexcept { return of(Role::kAmplitude); }
  Conversion& phase() noexcept { return of(Role::kPhase); }
  Conversion& u_amplitude() noexcept { return of(Role::kAmplitudeUncertainty); }
  Conversion& u_phase() noexcept { return of(Role::kPhaseUncertainty); }
  Conversion& u_common() noexcept { return of(Role::kCommonUncertainty); }

 private:
  static constexpr std::size_t kRoles = static_cast<std::size_t>(Role::kCommonUncertainty) + 1;

  std::array<Conversion, kRoles> all_;
};

/// Sets them from the header, the lines around the table and the options. Refused are units that
/// are not known, that may be one of two or that the options contradict, two columns of one
/// quantity, coverage factors that contradict each other or are stated of one uncertainty only, a
/// table whose uncertainties nobody states or two state, and options about columns that the table
/// does not have.
///
/// @param[out] conversions Of no use after an error.
ImportError set_conversions(const FoundTable& table, const ImportOptions& options,
                            Conversions& conversions);

}  // namespace emax::desk
