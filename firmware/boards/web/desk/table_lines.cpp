// A laboratory's table as messages.
#include "table_lines.hpp"

#include <cstdint>
#include <cstring>

#include "emax/base/decimal.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/base/units.hpp"
#include "emax/identify/frequency_response.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/points_file.hpp"
#include "desk/import/import_options.hpp"
#include "desk/import/import_points.hpp"

namespace emax::web {
namespace {

using desk::Problem;

constexpr double kCoverageFactor = 2.0;
constexpr double kMostPercent = 50.0;

Problem refused(const char* option, std::string_view value, const char* expectation) {
  return desk::bad_input(std::string(option) + ": \"" + desk::printable(value) +
                         "\" given; expected " + expectation);
}

Problem take(const TableOptions& given, desk::ImportOptions& options, double& percent) {
  if (!given.uncertainty.empty() && !desk::take_uncertainty(given.uncertainty, options)) {
    return refused("--uncertainty", given.uncertainty, desk::kExpectedUncertaintyOption);
  }
  if (!given.input_units.empty() && !desk::take_input_units(given.input_units, options)) {
    return refused("--input-units", given.input_units, desk::kExpectedInputUnits);
  }
  if (!given.channel_delay.empty() && !desk::take_channel_delay(given.channel_delay, options)) {
    return refused("--channel-delay", given.channel_delay, desk::kExpectedChannelDelay);
  }
  options.is_inverted = given.is_inverted;
  if (!given.reference_percent.empty()) {
    const std::string_view text = given.reference_percent;
    const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
    percent = number.value;
    if (number.status != Status::kOk || number.length != text.size() || !(percent >= 0.0) ||
        percent > kMostPercent) {
      return refused("--reference-uncertainty", text, "a percentage from 0 to 50");
    }
  }
  return {};
}

double neighbour(double value, int steps) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  bits += static_cast<std::uint64_t>(static_cast<std::int64_t>(steps));
  std::memcpy(&value, &bits, sizeof(bits));
  return value;
}

// The degrees that the instrument turns into just these radians; the nearest if there are none.
double degrees_of(double radians, double factor) {
  constexpr int kSteps = 4;
  const double nearest = radians * kDegreesPerRadian * factor;
  if (radians == 0.0) {
    return nearest;
  }
  for (int step = 0; step <= 2 * kSteps; ++step) {
    const double degrees = neighbour(nearest, step % 2 == 0 ? step / 2 : -(step + 1) / 2);
    if (degrees / factor * kRadiansPerDegree == radians) {
      return degrees;
    }
  }
  return nearest;
}

}  // namespace

Problem write_table_lines(const std::string& name, const TableOptions& given,
                          app::TextWriter& out) {
  desk::ImportOptions options;
  double percent = 0.0;
  if (Problem problem = take(given, options, percent)) {
    return problem;
  }
  // Once with the common part taken out, to be told what the program tells; once as it stands,
  // since the instrument takes it out itself.
  desk::ImportedPoints& imported = *new desk::ImportedPoints();  // Too large for the stack.
  Problem problem = desk::read_points(name, options, percent, imported);
  problem = problem ? problem : desk::read_points(name, options, 0.0, imported);
  if (problem) {
    return problem;
  }
  out.text(imported.understanding.c_str()).line();
  for (const ResponsePoint& point : imported.points.points()) {
    out.text("TRAC:FRES:DATA ").exact(point.frequency_hz).text(",").exact(point.amplitude);
    out.text(",").exact(degrees_of(point.phase_rad, 1.0));
    out.text(",").exact(kCoverageFactor * point.u_amplitude);
    out.text(",").exact(degrees_of(point.u_phase_rad, kCoverageFactor)).line();
  }
  return {};
}

}  // namespace emax::web
