// Why points do not fit a device, in words.
#include "desk/report/fit_causes.hpp"

#include <cmath>
#include <cstdio>
#include <memory>

#include "emax/identify/fit_diagnosis.hpp"

namespace emax::desk {

namespace {

std::string number(double value, int digits) {
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string change_of(const FitDiagnosis& diagnosis) {
  return "would bring chi2/dof from " + number(diagnosis.reduced_before, 2) + " to " +
         (diagnosis.reduced_after < 0.01 ? "below 0.01" : number(diagnosis.reduced_after, 2));
}

std::string words_of_delay(const FitDiagnosis& diagnosis) {
  const bool is_ahead = diagnosis.delay_s < 0.0;
  return std::string("A delay of ") + number(1e3 * std::abs(diagnosis.delay_s), 2) + " ms of the " +
         (is_ahead ? "reference's" : "device's") + " channel " + change_of(diagnosis) +
         ": find it in the conditioners and filters; a known one is taken out by --channel-delay " +
         number(diagnosis.delay_s, 4) + ".";
}

std::string words_of_sign(const FitDiagnosis& diagnosis) {
  constexpr double kGood = 3.0;
  return std::string(diagnosis.reduced_before < kGood ? "All else fits, but the" : "The") +
         " phases lead: a lag must be negative, so change their sign (or name the column a lag), "
         "or take out what makes the device's channel early.";
}

}  // namespace

std::string cause_of(const Wlsp& fit, bool is_phase_unit_named) {
  const auto workspace = std::make_unique<DiagnosisWorkspace>();
  const FitDiagnosis diagnosis = diagnose(fit, *workspace);
  switch (diagnosis.cause) {
    case FitCause::kNone:
      return "";
    case FitCause::kPhaseSign:
      return words_of_sign(diagnosis);
    case FitCause::kDelay:
      return words_of_delay(diagnosis);
    case FitCause::kCoupling:
      return "An AC coupling (high-pass) with its corner at " + number(diagnosis.corner_hz, 2) +
             " Hz " + change_of(diagnosis) +
             ": leave the lowest frequencies out, or couple the device's channel as the "
             "reference's.";
    case FitCause::kRadians:
      return "Taking the phases for radians and not for degrees " + change_of(diagnosis) +
             ": name their unit in the header, or by --input-units rad.";
    case FitCause::kMayBeRadians:
      return is_phase_unit_named
                 ? ""
                 : "No unit of the phase is named, and degrees were taken. As radians they fit as "
                   "well, with beta = " +
                       number(diagnosis.damping, 3) +
                       ": name their unit in the header, or by --input-units.";
  }
  return "";
}

}  // namespace emax::desk
