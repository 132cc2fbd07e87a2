// Why something is not done, as an error of the console.
#pragma once

#include <cstdint>

#include "emax/app/report/report_warnings.hpp"
#include "emax/app/scpi/error_code.hpp"
#include "emax/app/sequencer/sequencer.hpp"
#include "emax/app/settings/settings_error.hpp"
#include "emax/base/status.hpp"

namespace emax::app {

/// An entry of the error queue; true if there is an error.
struct ErrorWords {
  scpi::ErrorCode code = scpi::ErrorCode::kNoError;
  const char* words = nullptr;    ///< What to do, short enough for a line.
  const char* subject = nullptr;  ///< What they are about; null if they say so.

  explicit operator bool() const noexcept { return code != scpi::ErrorCode::kNoError; }
};

/// Without the watchdog nothing would lead the drive to zero should the program hang.
inline constexpr ErrorWords kNoWatchdog = {
    scpi::ErrorCode::kHardwareError,
    "the watchdog does not start: no sweep; switch the board off and on"};

/// After power on; a reset by the watchdog itself says nothing.
inline constexpr ErrorWords kWatchdogReset = {
    scpi::ErrorCode::kSystemError,
    "the watchdog has reset the board: its program hung, or had stopped in a fault"};

/// @returns What stands in the way of this sequencer, or how its last job has ended.
ErrorWords words_of(const Refusal& refusal, const Sequencer& sequencer) noexcept;

/// @returns Settings conflict, with the name of the setting; no error if there is none.
ErrorWords words_of(const SettingsError& error) noexcept;

/// @returns Words for -230 of a sweep, or of its fit, that is done and yet in doubt: kDataSheet,
/// kChange, kFit and kEnded.
const char* words_of(Warning warning) noexcept;

/// @returns The bit of STATus:QUEStionable that a fault of a sweep sets.
std::uint16_t questionable_of(Status fault) noexcept;

}  // namespace emax::app
