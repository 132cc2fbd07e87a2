// The pictures of a report: which there are, what they show, and the script that draws them.
#pragma once

#include <string>
#include <vector>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::desk {

struct Picture {
  const char* file;  ///< "signal.svg".
  app::ReportSection section;
  std::string title;    ///< With the device's name, in one line.
  std::string caption;  ///< What to look at.
  bool in_g = false;    ///< Accelerations also in standard gravity.
};

inline constexpr const char* kPictureScript = "pictures.gp";
/// Every name that `pictures_of()` can give, for those of an earlier run.
inline constexpr const char* kPictureFiles[] = {"frequency_response.svg", "impulse_response.svg",
                                                "signal.svg", "histogram.svg", "trend.svg"};

/// @param[in] results    With the stage kDone.
/// @returns The pictures that there are numbers for, in the order of the report.
std::vector<Picture> pictures_of(const app::EvaluationResults& results,
                                 const app::ReportContext& context);

/// Writes the script for gnuplot 5.4 that draws these pictures from the tables beside it.
void write_picture_script(const std::vector<Picture>& pictures,
                          const app::EvaluationResults& results, app::TextWriter& out);

/// impulse_response.csv goes on until T and until the device has settled, in a fixed number of
/// rows. Where these are too few for a curve there is a table for the picture alone, which has the
/// part of it that the picture shows.
inline constexpr const char* kStartTable = "impulse_response_start.csv";
bool has_start_table(const app::EvaluationResults& results);
/// t_s,k,ka,kf.
void write_start_table(const app::EvaluationResults& results, app::TextWriter& out);

}  // namespace emax::desk
