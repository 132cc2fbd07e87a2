// Any bytes as a laboratory's table: points that are all valid, or words about what is wrong.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "emax/base/capacity.hpp"
#include "emax/identify/frequency_response.hpp"

#include "desk/import/import_options.hpp"
#include "desk/import/import_points.hpp"

namespace {

using emax::ResponsePoint;
using emax::desk::ImportedPoints;
using emax::desk::ImportError;
using emax::desk::ImportOptions;

void require(bool holds, const char* what) {
  if (!holds) {
    (void)std::fprintf(stderr, "%s\n", what);
    std::abort();
  }
}

// The first byte switches options on.
ImportOptions options_of(std::uint8_t bits) {
  ImportOptions options;
  if ((bits & 1U) != 0) {
    require(take_uncertainty("1%,1deg", options), "an option is refused");
  }
  if ((bits & 2U) != 0) {
    require(take_input_units("kHz,mV/g,rad", options), "an option is refused");
  }
  options.channel_delay_s = (bits & 4U) != 0 ? 1e-4 : 0.0;
  options.is_inverted = (bits & 8U) != 0;
  return options;
}

void check_points(const ImportedPoints& imported) {
  const emax::FrequencyResponse& points = imported.points;
  require(points.size() >= 3 && points.size() <= emax::kMaxPoints, "too few or too many points");
  require(imported.lines.size() == points.size(), "a point has no line");
  require(imported.understanding.compare(0, 8, "read as ") == 0, "nothing was understood");
  double last_hz = 0.0;
  for (const ResponsePoint& point : points.points()) {
    require(emax::validate(point) == emax::Status::kOk, "a point is not valid");
    require(point.frequency_hz > last_hz, "the frequencies do not ascend");
    last_hz = point.frequency_hz;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  std::string text(size - 1, '\0');
  std::transform(data + 1, data + size, text.begin(),
                 [](std::uint8_t byte) { return static_cast<char>(byte); });
  const auto imported = std::make_unique<ImportedPoints>();
  const ImportError error = emax::desk::import_points(text, options_of(data[0]), *imported);
  if (!error) {
    check_points(*imported);
    return 0;
  }
  require(!error.expectation.empty(), "nothing is said about what was expected");
  require(error.line <= size, "the error is behind the text");
  return 0;
}
