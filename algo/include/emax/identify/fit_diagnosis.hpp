// Why points do not fit a device: known faults of a measuring chain, tried one by one.
#pragma once

#include <cstdint>

#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"

namespace emax {

enum class FitCause : std::uint8_t {
  kNone,       ///< None of those below has its signature.
  kPhaseSign,  ///< The phases have the wrong sign, or the device's channel is ahead.
  kDelay,      ///< One channel is late.
  kCoupling,   ///< A high-pass of first order, as an AC coupling is, stands before the converter.
  kRadians,    ///< The phases were taken for degrees and are radians.
  kMayBeRadians,  ///< Both fit, but as degrees the damping is far below that of any sensor.
};

struct FitDiagnosis {
  FitCause cause = FitCause::kNone;
  double delay_s = 0.0;         ///< kDelay: of the device's channel behind the reference's.
  double corner_hz = 0.0;       ///< kCoupling: where the high-pass is 3 dB down.
  double damping = 0.0;         ///< kRadians, kMayBeRadians: that of the fit to radians.
  double reduced_before = 0.0;  ///< chi2/dof of the fit; 0 if it has none.
  double reduced_after = 0.0;   ///< The same with the cause taken out.
};

/// Memory for the fits of `diagnose()`, lent by the caller; may hold anything between calls.
struct DiagnosisWorkspace {
  FrequencyResponse response;
  Wlsp fit;
};

/// Tries the causes where a fit has failed for a damping below zero or has a chi2/dof above 3:
/// takes each of a range of delays and each of a range of corners out of the phases and
/// magnitudes, reads phases within a turn of radians as radians, and fits again. A cause is named
/// where that brings chi2/dof down to a tenth or below 1.5. The sign cannot change chi2: it is
/// named where the damping is below zero by more than 2 u and nothing else explains the points.
/// kMayBeRadians is named for a fit that holds, with a damping below 0.002 and expanded phase
/// uncertainties below 0.05 degrees, as radians look.
///
/// Delays up to eight periods of the highest frequency, corners from a hundredth of the lowest
/// frequency to ten times it. About 800 fits: 10 ms per 100 points on a PC. The magnitudes alone
/// have no signature: a fit without phases is not tried.
///
/// @param[in] fit A fit with its points.
FitDiagnosis diagnose(const Wlsp& fit, DiagnosisWorkspace& workspace) noexcept;

}  // namespace emax
