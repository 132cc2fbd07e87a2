// A table of measured points as a laboratory has it: text in, points or a complaint out.
#include "desk/import/import_points.hpp"

#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/status.hpp"
#include "emax/base/units.hpp"

#include "desk/import/conversions.hpp"
#include "desk/import/doubts.hpp"
#include "desk/import/find_table.hpp"
#include "desk/import/merge_rows.hpp"
#include "desk/import/read_rows.hpp"
#include "desk/import/shared_effects.hpp"
#include "desk/import/table_layout.hpp"
#include "desk/import/understanding.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMinPoints = 3;

// The delay of the channel and the polarity are taken out.
void turn(const ImportOptions& options, ResponsePoint& point) {
  if (options.channel_delay_s == 0.0 && !options.is_inverted) {
    return;
  }
  const double half_turn = options.is_inverted ? kPi : 0.0;
  const SinCos angle =
      sincos(point.phase_rad + half_turn + kTwoPi * point.frequency_hz * options.channel_delay_s);
  point.phase_rad = atan2(angle.sin, angle.cos);
}

ImportError add_point(const Row& row, const ImportOptions& options, ImportedPoints& imported) {
  ResponsePoint point;
  point.frequency_hz = row.frequency_hz;
  point.amplitude = row.amplitude;
  point.u_amplitude = row.u_amplitude;
  point.u_phase_rad = kUnknownPhase_rad;
  if (row.has_phase) {
    point.phase_rad = row.phase_rad;
    point.u_phase_rad = row.u_phase_rad;
    turn(options, point);
  }
  const Status status = imported.points.add(point);
  if (status == Status::kTooManyPoints) {
    return error_at(row.line, "this is one point more than " EMAX_TEXT_OF(EMAX_MAX_POINTS),
                    kExpectedPoints);
  }
  if (status != Status::kOk) {
    return error_at(row.line, "a number is too small or too large to be represented",
                    "expected uncertainties well above 0");
  }
  imported.lines.push_back(row.line);
  return {};
}

ImportError add_points(const MergedRows& merged, const ImportOptions& options,
                       ImportedPoints& imported) {
  for (const Row& row : merged.rows) {
    if (ImportError error = add_point(row, options, imported)) {
      return error;
    }
  }
  const std::size_t count = imported.points.size();
  if (count >= kMinPoints) {
    return {};
  }
  return error_at(
      0,
      count == 0 ? "the table holds no points" : "the table holds only " + count_of(count, "point"),
      kExpectedPoints);
}

ImportError set_common(const MergedRows& merged, ImportedPoints& imported) {
  std::vector<double> common;
  for (const Row& row : merged.rows) {
    common.push_back(row.u_common);
  }
  const Status status =
      imported.points.set_common(Span<const double>(common.data(), common.size()));
  return status == Status::kOk
             ? ImportError{}
             : error_at(merged.rows.front().line,
                        "what all points have in common is not below 100 %", "expected less");
}

ImportError set_shared(const FoundTable& table, ImportedPoints& imported) {
  SharedEffects shared;
  for (std::size_t i = 0; i < table.text.lines.size(); ++i) {
    if (read_shared(table.text.lines[i], shared) == SharedLine::kWrong) {
      return error_at(i + 1, "what all points share is not readable",
                      "expected the line as emax has written it, or none");
    }
  }
  (void)imported.points.set_shared(shared);
  return {};
}

// A delay and a polarity are in the phases.
ImportError check_turn(const ImportOptions& options, const ImportedPoints& imported) {
  const char* const option = options.channel_delay_s != 0.0 ? "--channel-delay"
                             : options.is_inverted          ? "--invert"
                                                            : nullptr;
  return option == nullptr || imported.points.known_phases() > 0
             ? ImportError{}
             : error_at(0, std::string("there are no phases that ") + option + " could change",
                        "expected phases, or no such option");
}

}  // namespace

ImportError import_points(std::string_view text, const ImportOptions& options,
                          ImportedPoints& imported) {
  imported = ImportedPoints();
  FoundTable table;
  if (ImportError error = find_table(text, table)) {
    return error;
  }
  Conversions conversions;
  if (ImportError error = set_conversions(table, options, conversions)) {
    return error;
  }
  std::vector<Row> rows;
  if (ImportError error = read_rows(table, conversions, options, rows)) {
    return error;
  }
  const MergedRows merged = merge_rows(rows);
  if (ImportError error = add_points(merged, options, imported)) {
    return error;
  }
  const Conversion& phase = conversions.phase();
  imported.names_phase_unit =
      phase.is_there &&
      (!table.columns[phase.column].unit_spelling.empty() || options.phase_unit.is_given());
  imported.states_common = conversions.u_common().is_there;
  ImportError error = imported.states_common ? set_common(merged, imported) : ImportError{};
  error = error ? error : set_shared(table, imported);
  error = error ? error : check_turn(options, imported);
  if (error) {
    return error;
  }
  imported.understanding = understanding_of(table, conversions, options, merged);
  imported.doubt = doubts_of(table, conversions, options, merged.rows);
  return {};
}

}  // namespace emax::desk
