// What a report says beside the numbers of an evaluation, and the marks for a page that shows it.
#pragma once

#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::app {

struct Measurement;

/// A label beyond those that every instrument takes, such as what a certificate names.
struct NamedLabel {
  const char* key;    ///< In results.json.
  const char* name;   ///< In text and page.
  const char* words;  ///< As given.
};

/// What a laboratory calls its device and its work; null for what was not given. UTF-8 of any
/// length: the text of a report shows the first kLabelShown characters in one line, with what is
/// not printable replaced.
struct Labels {
  const char* device = nullptr;
  const char* serial = nullptr;
  const char* operated_by = nullptr;
  const char* date = nullptr;
  const char* note = nullptr;
  Span<const NamedLabel> more = {};

  constexpr bool any() const noexcept {
    return device != nullptr || serial != nullptr || operated_by != nullptr || date != nullptr ||
           note != nullptr || !more.empty();
  }
};

inline constexpr std::uint32_t kLabelShown = 240;

/// The rows of the figures that a warning may concern.
inline constexpr std::uint32_t kRowBand = 1;
inline constexpr std::uint32_t kRowMatched = 2;
inline constexpr std::uint32_t kRowEnergy = 4;

/// Refers to what it describes; made for one call. `{}` is an evaluation of known parameters.
struct ReportContext {
  const char* source_name = nullptr;         ///< Of the file with the points; null if none.
  const Measurement* measurement = nullptr;  ///< Null if the points were not measured here.
  Labels labels = {};
  bool in_g = false;              ///< Accelerations and sensitivities also in standard gravity.
  const char* cause = nullptr;    ///< Why the points do not fit a device; null if nobody knows.
  const char* read_as = nullptr;  ///< What was understood of a table of points; null for nothing.
  const char* mark = nullptr;     ///< What the star at the figures means; null for no star.
  std::uint32_t marked = 0;       ///< The rows with a star: a sum of `kRow...`.
  /// A warning that the results are those of another criterion than was asked for; null if not.
  const char* other_criterion = nullptr;
  bool rounds_to_u = false;  ///< Two digits of U and values to match, as on a certificate.
  /// Settling time of the error in band that leads the figures; 0 for none, or if nobody knows.
  double leading_settling_s = 0.0;
  /// What is unlikely in units that a table does not name, in sentences; null for nothing.
  const char* doubt = nullptr;
};

/// m/s^2, exactly (ISO 80000-3).
inline constexpr double kStandardGravity_mps2 = 9.80665;

enum class ReportSection : std::uint8_t {
  kTitle,
  kLabels,
  kFigures,
  kInput,
  kFault,
  kMeasurement,
  kFit,
  kErrorSystem,
  kEnergy,
  kInBand,
  kUncertainty,
  kMonteCarlo,
  kTrend,
};

enum class ReportPart : std::uint8_t {
  kRow,      ///< A name and, after it, its value.
  kMore,     ///< A further line of that value.
  kText,     ///< A sentence or two.
  kNote,     ///< A sentence to be noticed.
  kWarning,  ///< One that no reader may miss.
  kTable,    ///< Followed by its lines.
  kHead,     ///< A line of headings.
  kLine,     ///< A line of numbers.
  kCell,     ///< Of a line.
};

/// Told where each part of a report begins, so that it can set marks around the words. A part ends
/// where the next one begins, or the report.
class ReportMarkup {
 public:
  ReportMarkup(const ReportMarkup&) = delete;
  ReportMarkup& operator=(const ReportMarkup&) = delete;

  /// @param[in] heading Null for kTitle.
  virtual void begin(ReportSection section, const char* heading) noexcept = 0;
  /// @param[in] name Of a row; null for every other part.
  virtual void begin(ReportPart part, const char* name) noexcept = 0;
  /// Takes words that others wrote, as they are: a label, or the name of a file.
  virtual void quote(const char* text) noexcept = 0;

 protected:
  constexpr ReportMarkup() noexcept = default;
  ~ReportMarkup() = default;
};

}  // namespace emax::app
