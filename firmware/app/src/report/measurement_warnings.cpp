// What contradicts in a measurement, apart from the other warnings: a board's report has no others.
#include "emax/app/report/report_warnings.hpp"

namespace emax::app {
namespace {

constexpr double kMuchChange = 0.01;
constexpr double kBeyondNoise = 10.0;  // Of the lowest frequency, whose record is the longest.
constexpr double kNearSheet2 = 1.44;   // A factor of 1.2, squared.

// Out of line, for its size.
[[gnu::noinline]] bool is_off_sheet(double found2, double sheet) noexcept {
  const double sheet2 = sheet * sheet;
  return found2 * sheet > 0.0 && (found2 > kNearSheet2 * sheet2 || found2 * kNearSheet2 < sheet2);
}

// Its ends are held beyond them.
bool is_beyond_table(const SweepSettings& settings) noexcept {
  const ReferenceCalibration& table = settings.reference;
  return table.count > 1 && (settings.frequency_hz[0] < table.frequency_hz[0] ||
                             settings.frequency_hz[settings.frequency_count - 1] >
                                 table.frequency_hz[table.count - 1]);
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
  if (warning == Warning::kBeyondTable) {
    return is_beyond_table(sweep.settings);
  }
  // Near its resonance a device is off by itself: then its lowest frequency is not.
  const double sheet = sweep.settings.expected_sensitivity;
  const double lowest = sweep.table[0].point.amplitude;
  return is_off_sheet(norm(sweep.check_before), sheet) &&
         (sweep.point_count == 0 || is_off_sheet(lowest * lowest, sheet));
}

const char* words_of_contradiction(Warning warning) noexcept {
  if (warning == Warning::kEnded) {
    return "a fault has ended the sweep: the points before it are used";
  }
  if (warning == Warning::kChange) {
    return "the check's ratio has changed: a gain was switched, or a cable or mounting is loose, "
           "or hum is near";
  }
  if (warning == Warning::kBeyondTable) {
    return "the reference's table does not span the sweep's frequencies: beyond it its first or "
           "last "
           "sensitivity is used";
  }
  return "the device is 20 % or more off its data sheet: check gains and reference set, and that "
         "f0 is not near the check frequency";
}

}  // namespace emax::app
