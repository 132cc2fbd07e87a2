// Why points do not fit a device, in words.
#include "desk/report/fit_causes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "emax/app/report/report.hpp"
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

// The points without which the others fit, the worst first.
struct LonePoints {
  std::vector<double> frequencies_hz;
  double reduced_before = 0.0;
  double reduced_after = 0.0;
};

double size_of(const Wlsp& fit, std::size_t index) {
  const Complex residual = fit.normalised_residual(index);
  return std::hypot(residual.re, residual.im);
}

/// The points of the fit without one, and the frequency of that: the one with the largest residual.
double leave_worst_out(const Wlsp& fit, FrequencyResponse& rest) {
  const FrequencyResponse& all = fit.response();
  std::size_t worst = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    worst = size_of(fit, i) > size_of(fit, worst) ? i : worst;
  }
  std::vector<double> common;
  rest.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i != worst) {
      (void)rest.add(all.points()[i]);
      common.push_back(all.common()[i]);
    }
  }
  (void)rest.set_common(Span<const double>(common.data(), common.size()));
  (void)rest.set_shared(all.shared());
  return all.points()[worst].frequency_hz;
}

LonePoints find_lone_points(const Wlsp& fit, DiagnosisWorkspace& workspace) {
  constexpr std::size_t kMost = 4;
  constexpr std::size_t kOneOf = 8;  // More of them would be no exceptions.
  LonePoints lone;
  const WlspFit* result = &fit.result();
  if (result->dof == 0 || result->status != Status::kOk) {
    return {};
  }
  lone.reduced_before = result->chi2 / result->dof;
  const Wlsp* now = &fit;
  const std::size_t most = std::min(kMost, fit.response().size() / kOneOf);
  while (result->chi2 / result->dof > app::reduced_chi_square_limit(result->dof)) {
    if (lone.frequencies_hz.size() == most) {
      return {};
    }
    lone.frequencies_hz.push_back(leave_worst_out(*now, workspace.response));
    if (workspace.fit.fit(workspace.response) != Status::kOk) {
      return {};
    }
    now = &workspace.fit;
    result = &now->result();
  }
  lone.reduced_after = result->chi2 / result->dof;
  return lone;
}

/// 50 or 60 where all of the frequencies are within 1 Hz of its multiples; else 0.
int mains_of(const std::vector<double>& frequencies_hz) {
  for (const int mains_hz : {50, 60}) {
    const bool are_multiples =
        std::all_of(frequencies_hz.begin(), frequencies_hz.end(), [mains_hz](double frequency_hz) {
          return std::abs(std::remainder(frequency_hz, mains_hz)) <= 1.0;
        });
    if (are_multiples) {
      return mains_hz;
    }
  }
  return 0;
}

// @param[in] is_bent The budget has a linearity, which may be larger than stated.
std::string words_of_lone_points(LonePoints lone, bool is_bent) {
  std::sort(lone.frequencies_hz.begin(), lone.frequencies_hz.end());
  const bool is_one = lone.frequencies_hz.size() == 1;
  std::string list;
  for (std::size_t i = 0; i < lone.frequencies_hz.size(); ++i) {
    const bool is_last = i + 1 == lone.frequencies_hz.size();
    list += i == 0 ? "" : is_last ? " and " : ", ";
    list += number(lone.frequencies_hz[i], 6);
  }
  const int mains_hz = mains_of(lone.frequencies_hz);
  const std::string hum =
      mains_hz == 0 ? "an interference"
                    : "hum (" + std::string(is_one ? "it is a multiple" : "they are multiples") +
                          " of " + std::to_string(mains_hz) + " Hz)";
  return "Without the point" + std::string(is_one ? "" : "s") + " at " + list + " Hz chi2/dof is " +
         number(lone.reduced_after, 2) + ", not " + number(lone.reduced_before, 2) +
         ": likely causes are " + hum + (is_bent ? ", a linearity beyond the stated one" : "") +
         " or a resonance of mounting or cable; move " + (is_one ? "that frequency" : "them") +
         " by 5 Hz: hum stays behind, a resonance does not.";
}

}  // namespace

std::string cause_of_measured(const Wlsp& fit) {
  const auto workspace = std::make_unique<DiagnosisWorkspace>();
  const LonePoints lone = find_lone_points(fit, *workspace);
  return lone.frequencies_hz.empty()
             ? ""
             : words_of_lone_points(lone, fit.response().shared().linearity > 0.0);
}

std::string cause_of(const Wlsp& fit, bool is_phase_unit_named) {
  const auto workspace = std::make_unique<DiagnosisWorkspace>();
  const FitDiagnosis diagnosis = diagnose(fit, *workspace);
  switch (diagnosis.cause) {
    case FitCause::kNone:
      return cause_of_measured(fit);
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
