// Values of the options that say what a table does not.
#pragma once

#include <string_view>

#include "desk/import/input_units.hpp"

namespace emax::desk {

/// An expanded uncertainty (k = 2) for tables without a column of it.
struct GivenUncertainty {
  double value = 0.0;  ///< In `unit`; 0 for none given.
  Unit unit;
};

/// What the command line says about a table.
struct ImportOptions {
  GivenUncertainty amplitude_uncertainty;
  GivenUncertainty phase_uncertainty;
  Unit frequency_unit;  ///< For columns whose unit the header does not name.
  Unit amplitude_unit;
  Unit phase_unit;
  double channel_delay_s = 0.0;  ///< Of the device's channel behind the reference's; removed.
  bool is_inverted = false;      ///< 180 degrees are added to every phase.
};

/// Reads "1%,1deg": expanded uncertainties (k = 2) of amplitude and phase, in this order or the
/// other, one or both; of the amplitude in percent, dB or a unit of its own, of the phase in deg,
/// rad, mrad or gon.
///
/// @returns False for anything else; nothing has changed then.
bool take_uncertainty(std::string_view text, ImportOptions& options);

/// Reads "mV/g" or "kHz,mV/g,rad": units of frequency, amplitude and phase, each at most once.
///
/// @returns False for anything else; nothing has changed then.
bool take_input_units(std::string_view text, ImportOptions& options);

/// Reads a number of seconds, of at most 1 s in size.
///
/// @returns False for anything else; nothing has changed then.
bool take_channel_delay(std::string_view text, ImportOptions& options);

inline constexpr char kExpectedUncertaintyOption[] =
    "expanded uncertainties (k = 2) with their units, such as 1%,1deg (deg or gon, not grad)";
inline constexpr char kExpectedInputUnits[] =
    "known units, such as mV/g or kHz,mV/(m/s2),rad (deg or gon, not grad)";
inline constexpr char kExpectedChannelDelay[] = "a number of seconds from -1 to 1";

}  // namespace emax::desk
