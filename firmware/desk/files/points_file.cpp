// A table of measured points from a file or from standard input.
#include "desk/files/points_file.hpp"

#include <string_view>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/points/reference_uncertainty.hpp"
#include "emax/base/capacity.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/text_file.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxPointsFileSize = std::size_t{1} << 20;

Problem describe(const std::string& name, const desk::ImportError& error) {
  if (!error) {
    return {};
  }
  const std::string line = error.line == 0 ? "" : ":" + std::to_string(error.line);
  return bad_input(name + line + ": " + printable(error.problem) + "; " +
                   printable(error.expectation));
}

Problem take_common(const std::string& name, double reference_percent,
                    desk::ImportedPoints& imported) {
  FrequencyResponse& points = imported.points;
  if (imported.states_common && reference_percent > 0.0) {
    return bad_input(name +
                     ": the column u_common says what all points have in common, and so does "
                     "--reference-uncertainty; expected one of them");
  }
  const SharedEffects shared = points.shared();
  const app::CommonRemoval removal = app::remove_common(points, reference_percent);
  if (removal.status == Status::kOk) {
    (void)points.set_shared(shared);
    return {};
  }
  const ResponsePoint& point = points.points()[removal.bad_point];
  StringSink sink;
  app::TextWriter line(sink);
  line.text(":").integer(imported.lines[removal.bad_point]).text(": the uncertainty at ");
  line.general(point.frequency_hz, 7).text(" Hz is ");
  line.general(200.0 * point.u_amplitude / point.amplitude, 4);
  line.text(" % of the amplitude, not above the reference's ").general(reference_percent, 4);
  line.text(" %; expected totals (k = 2) that contain it, or a smaller --reference-uncertainty");
  return bad_input(name + sink.text());
}

}  // namespace

Problem read_points(const std::string& path, const desk::ImportOptions& options,
                    double reference_percent, desk::ImportedPoints& imported) {
  const std::string name = name_of_input(path);
  std::string text;
  if (Problem problem = read_text_file(
          path, kMaxPointsFileSize,
          "expected a table of at most " EMAX_TEXT_OF(EMAX_MAX_POINTS) " points", text)) {
    return problem;
  }
  if (text.empty()) {
    return bad_input(name + ": the file is empty; expected a table of 3 to " EMAX_TEXT_OF(
                                EMAX_MAX_POINTS) " points");
  }
  if (Problem problem = describe(name, desk::import_points(text, options, imported))) {
    return problem;
  }
  return take_common(name, reference_percent, imported);
}

}  // namespace emax::desk
