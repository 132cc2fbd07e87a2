// Any bytes as a table of points: points that are all valid, or words about the first that is not.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "emax/app/points/points_reader.hpp"
#include "emax/identify/frequency_response.hpp"

namespace {

using emax::ResponsePoint;
using emax::Span;
using emax::app::PointsError;
using emax::app::PointsReader;

void require(bool holds, const char* what) {
  if (!holds) {
    (void)std::fprintf(stderr, "%s\n", what);
    std::abort();
  }
}

void check_points(const PointsReader& reader, std::size_t lines) {
  double last_hz = 0.0;
  for (std::size_t i = 0; i < reader.points().size(); ++i) {
    const ResponsePoint& point = reader.points().points()[i];
    require(emax::validate(point) == emax::Status::kOk, "a point is not valid");
    require(point.frequency_hz > last_hz, "the frequencies do not ascend");
    require(reader.line_of(i) >= 1 && reader.line_of(i) <= lines, "a point has no line");
    last_hz = point.frequency_hz;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(size, '\0');
  std::transform(data, data + size, text.begin(),
                 [](std::uint8_t byte) { return static_cast<char>(byte); });
  PointsReader reader;
  reader.start();
  std::size_t lines = 0;
  for (std::size_t begin = 0; begin < text.size(); ++lines) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    reader.add_line(Span<const char>(text.data() + begin, end - begin));
    begin = end + 1;
  }
  const PointsError error = reader.finish();
  check_points(reader, lines);
  if (error.problem == nullptr) {
    require(reader.points().size() >= PointsReader::kMinPoints, "too few points");
    require(reader.points().size() <= emax::kMaxPoints, "too many points");
  } else {
    require(error.expectation != nullptr, "nothing is said about what was expected");
    require(error.line <= lines, "the error is behind the text");
  }
  return 0;
}
