// What contradicts in a measurement, apart from the other warnings: a board's report has no others.
#include "emax/app/report/report_warnings.hpp"

namespace emax::app {
namespace {

constexpr double kMuchChange = 0.01;
constexpr double kBeyondNoise = 10.0;  // Of the lowest frequency, whose record is the longest.
constexpr double kNearSheet2 = 1.44;   // A factor of 1.2, squared.

bool is_off_sheet(double found2, double sheet) noexcept {
  const double sheet2 = sheet * sheet;
  return found2 * sheet > 0.0 && (found2 > kNearSheet2 * sheet2 || found2 * kNearSheet2 < sheet2);
}

}  // namespace

bool contradicts(Warning warning, const SweepResults& sweep) noexcept {
  if (warning == Warning::kEnded) {
    return sweep.status != Status::kOk;
  }
  if (warning == Warning::kChange) {
    const Span<const SweepPoint> points = sweep.points();
    return !points.empty() && sweep.shared.drift > kMuchChange &&
           sweep.shared.drift > kBeyondNoise * points[0].budget.noise;
  }
  return is_off_sheet(norm(sweep.check_before), sweep.settings.expected_sensitivity);
}

const char* words_of_contradiction(Warning warning) noexcept {
  if (warning == Warning::kEnded) {
    return "a fault has ended the sweep: the points before it are used";
  }
  if (warning == Warning::kChange) {
    return "the check's ratio has changed: a gain was switched, or a cable or mounting is loose, "
           "or hum is near";
  }
  return "the device is 20 % or more off its data sheet: check gains and reference set";
}

}  // namespace emax::app
