// A table of measured points from a file or from standard input.
#include "desk/files/points_file.hpp"

#include <algorithm>
#include <string_view>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/points/points_reader.hpp"
#include "emax/app/points/reference_uncertainty.hpp"
#include "emax/base/capacity.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/text_file.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxFileSize = std::size_t{1} << 20;

Problem describe(const std::string& name, const app::PointsError& error) {
  if (error.problem == nullptr) {
    return {};
  }
  std::string line = name;
  if (error.line != 0) {
    line += ":" + std::to_string(error.line);
  }
  line += std::string(": ") + error.problem;
  if (error.expectation != nullptr) {
    line += std::string("; ") + error.expectation;
  }
  return bad_input(line);
}

app::PointsError parse(std::string_view text, app::PointsReader& reader) {
  reader.start();
  while (!text.empty() && reader.error().problem == nullptr) {
    const std::string_view line = text.substr(0, text.find('\n'));
    reader.add_line(Span<const char>(line.data(), line.size()));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return reader.finish();
}

Problem take_common(const std::string& name, const app::PointsReader& reader,
                    double reference_percent, FrequencyResponse& points) {
  const app::CommonRemoval removal = app::remove_common(points, reference_percent);
  if (removal.status == Status::kOk) {
    return {};
  }
  const ResponsePoint& point = points.points()[removal.bad_point];
  StringSink sink;
  app::TextWriter line(sink);
  line.text(":").integer(reader.line_of(removal.bad_point)).text(": the uncertainty at ");
  line.general(point.frequency_hz, 7).text(" Hz is ");
  line.general(200.0 * point.u_amplitude / point.amplitude, 4);
  line.text(" % of the amplitude, not above the reference's ").general(reference_percent, 4);
  line.text(" %; expected totals (k = 2) that contain it, or a smaller --reference-uncertainty");
  return bad_input(name + sink.text());
}

}  // namespace

Problem read_points(const std::string& path, double reference_percent, FrequencyResponse& points) {
  const std::string name = name_of_input(path);
  std::string text;
  if (Problem problem = read_text_file(path, kMaxFileSize,
                                       "expected a CSV file of at most 64 measured points", text)) {
    return problem;
  }
  if (text.empty()) {
    return bad_input(name + ": the file is empty; expected a table of 3 to " EMAX_TEXT_OF(
                                EMAX_MAX_POINTS) " points");
  }
  static app::PointsReader reader;
  const app::PointsError error = parse(text, reader);
  points = reader.points();
  if (Problem problem = describe(name, error)) {
    return problem;
  }
  return take_common(name, reader, reference_percent, points);
}

}  // namespace emax::desk
