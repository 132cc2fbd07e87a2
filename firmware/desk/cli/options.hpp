// The command line of `emax report`: its options, their help and their errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/span.hpp"
#include "emax/sim/sim_bench.hpp"

#include "desk/cli/label_rows.hpp"
#include "desk/cli/option.hpp"
#include "desk/cli/problem.hpp"
#include "desk/import/import_points.hpp"
#include "desk/trials/thread_helper.hpp"

namespace emax::desk {

/// A label of the user's own.
struct OwnLabel {
  std::string name;  ///< Its key in results.json, too.
  std::string words;
};

/// An option with its value, as they were given.
struct GivenText {
  std::string name;  ///< Without dashes.
  std::string value;
};

/// What the command line asks for. The device comes from `points_path`, from `model_text`, or, with
/// neither, from a measurement: of the instrument at a port, or on the simulated bench.
struct ReportOptions {
  app::Settings settings = app::kDefaultSettings;
  ImportOptions import;     ///< What is said of the table in `points_path`.
  double damping = 0.0;     ///< For a table of magnitudes that leaves it open; 0 for none.
  std::string points_path;  ///< "-" for standard input; empty for none.
  std::string instrument;   ///< Its port, if it is to measure; empty for the simulated bench.
  std::string model_text;   ///< As it was given; empty for none.
  app::Device device = {};  ///< What `model_text` says.
  std::size_t seed_count = 4;
  std::uint32_t threads = static_cast<std::uint32_t>(count_cores());
  /// Expanded. Without the option it is what `sweep` says on the bench, and 0 else.
  double reference_uncertainty_percent = 0.0;
  sim::BenchSettings bench;
  app::SweepSettings sweep = app::default_sweep_settings();
  std::string device_name;  ///< This and the next four are labels, empty if not given.
  std::string serial;
  std::string operated_by;
  std::string date;
  std::string note;
  std::array<std::string, kLabelRowCount> certificate;  ///< By `kLabelRows`; empty if not given.
  std::vector<OwnLabel> own_labels;
  std::vector<GivenText> given;  ///< What the command line says, in its order.
  bool in_g = false;
  bool json = false;
  std::string out_directory;  ///< Empty for no files.
  std::string dcc_path;       ///< Of the digital certificate; empty for none.

  /// @returns The value that an option was given; null if it was not given.
  const std::string* given_value(std::string_view name) const noexcept;
  bool measures() const noexcept { return points_path.empty() && model_text.empty(); }
  const std::string& label(CertificateLabel label) const noexcept {
    return certificate[static_cast<std::size_t>(label)];
  }
  /// Those of a certificate that are given, and the user's own. Refers to this object.
  std::vector<app::NamedLabel> more_labels() const;
  /// Refers to this object and to `more`.
  app::Labels labels(const std::vector<app::NamedLabel>& more) const noexcept;
};

/// Reads the arguments behind `emax report` and checks all that can be checked without a file.
///
/// @param[out] options Of no use if there is a problem.
Problem parse_report_options(Span<const std::string_view> arguments, ReportOptions& options);

/// Checks options that were taken, those of other commands too: that they go together, and all
/// settings.
///
/// @param[in]     all     What was given.
/// @param[in,out] options What is said once of bench and sweep is then known to both.
Problem check_report_options(const std::vector<Given>& all, ReportOptions& options);

/// @returns The help of all options, in lines of at most 80 characters.
std::string help_on_report_options();

}  // namespace emax::desk
