// What a report says to be a certificate.
#include "desk/page/certificate_part.hpp"

#include <array>
#include <cstdint>

#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report_warnings.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/label_rows.hpp"
#include "desk/page/html_markup.hpp"

namespace emax::desk {

namespace {

constexpr std::uint32_t kShownBelowPages = 40;

std::string in_one_line(const char* words) {
  StringSink sink;
  app::TextWriter out(sink);
  out.one_line(words, kShownBelowPages);
  return sink.text();
}

void append_row(std::string& html, const char* name, const std::string& words) {
  html += std::string("<tr><th scope=\"row\">") + name + "</th><td>" + words + "</td></tr>\n";
}

std::string method_of(const app::EvaluationResults& results, const app::ReportContext& context) {
  std::string words;
  if (is_simulated(context)) {
    words = "Simulated comparison with a reference sensor, by stepped sines. ";
  } else if (context.measurement != nullptr) {
    words =
        "Comparison with a reference sensor, back to back, by stepped sines, in the manner of "
        "ISO 16063-21. ";
  }
  words += results.source == app::Source::kPoints ? "Parameters by weighted least squares"
                                                  : "Parameters as given";
  words +=
      "; the largest error of any signal within ±a after K. Tomczyk, Energies 2020, 13(7), "
      "1552.";
  const char* const procedure = label_of(context.labels, CertificateLabel::kProcedure);
  return procedure == nullptr ? words : words + " Procedure: " + quoted(procedure) + ".";
}

// What ISO/IEC 17025 asks a certificate for, beside what stands below.
struct Asked {
  const char* option;
  const char* name;
  const char* words;
};

using AskedLabels = std::array<Asked, 12>;

AskedLabels asked_of(const app::Labels& labels) {
  const auto of = [&labels](CertificateLabel label) { return label_of(labels, label); };
  return {{
      {"laboratory", "Laboratory", of(CertificateLabel::kLaboratory)},
      {"customer", "Customer", of(CertificateLabel::kCustomer)},
      {"device", "Device", labels.device},
      {"serial", "Serial number", labels.serial},
      {"maker", "Manufacturer", of(CertificateLabel::kMaker)},
      {"model-name", "Model", of(CertificateLabel::kModel)},
      {"date", "Date of the calibration", labels.date},
      {"operator", "Who measured", labels.operated_by},
      {"procedure", "Procedure", of(CertificateLabel::kProcedure)},
      {"place", "Place of the measurement", of(CertificateLabel::kPlace)},
      {"issue-date", "Date of issue", of(CertificateLabel::kIssueDate)},
      {"approved-by", "Approved by", of(CertificateLabel::kApprover)},
  }};
}

void append_missing(std::string& html, const app::Labels& labels) {
  for (const Asked& asked : asked_of(labels)) {
    if (asked.words == nullptr) {
      append_row(html, asked.name, "Not stated.");
    }
  }
}

// What ISO/IEC 17025 asks for besides, and no option of its own takes.
constexpr const char* kNotRecorded =
    "The condition of the item, the date of its receipt, deviations from the procedure and, of a "
    "table, who provided it, unless a note or another label says so.";

// Who takes responsibility, on a line to sign on.
void append_signature(std::string& html, const app::Labels& labels) {
  const char* const approver = label_of(labels, CertificateLabel::kApprover);
  html += "<p class=\"signature sign\">Date and signature of who approves: " +
          (approver == nullptr ? std::string("name not stated") : quoted(approver)) + "</p>\n";
}

// What a poor fit means for U.
std::string words_on_birge(const app::EvaluationResults& results,
                           const app::ReportContext& context) {
  const bool is_widened = results.trial_scale() > 1.0;
  if (!is_widened && !holds(app::Warning::kFit, results, context)) {
    return "";
  }
  StringSink sink;
  app::TextWriter out(sink);
  if (is_widened) {
    out.text(" U of parameters and errors is also times the Birge ratio, ");
    out.general(results.trial_scale(), 3).text("; U of each point is as stated.");
  } else {
    out.text(
        " U of parameters and errors is not widened, though the points do not fit: it is too ");
    out.text("small by about the Birge ratio, ").general(results.fit.result().birge_ratio, 3);
    out.text(", and 95.45 % do not hold for it.");
  }
  return sink.text();
}

}  // namespace

const char* certificate_number(const app::Labels& labels) noexcept {
  return label_of(labels, CertificateLabel::kNumber);
}

std::string uncertainty_statement(const app::EvaluationResults& results,
                                  const app::ReportContext& context) {
  std::string words =
      "U is the standard uncertainty times the coverage factor k = 2. For a normal distribution "
      "that covers 95.45 %; the errors need not have one. Standard uncertainties are propagated as "
      "JCGM 100 and JCGM 101 describe. U of an error is that of the error found, by the "
      "parameters' uncertainties, and leaves the search out: a signal with a larger error may "
      "exist, up to the bound that is proven at the estimates, where there is one.";
  words += words_on_birge(results, context);
  if (context.measurement != nullptr) {
    words +=
        " U takes the reference's phase, and a change of its sensitivity over frequency beyond its "
        "table, as exactly known.";
  } else if (context.source_name != nullptr && !results.fit.response().has_common()) {
    words +=
        " What the points have in common, such as the reference's sensitivity, was not stated: if "
        "the table's uncertainties contain it, U of the sensitivity is too small.";
  }
  return words;
}

std::string chi_square_statement(const app::EvaluationResults& results) {
  if (!results.fit.response().shared().is_explained()) {
    return "";
  }
  return "Of the parameters and the sizes of stated crosstalk, linearity and skew that make it "
         "least "
         "together, not of the estimates printed, which are fitted without those effects.";
}

std::string gain_statement(const app::EvaluationResults& results) {
  if (results.settings.gain_mode == app::GainMode::kFixed) {
    return "U of all errors is at the filter gain G given.";
  }
  const bool follows = results.settings.gain_mode == app::GainMode::kTrack;
  return std::string(
             "U of the errors in band: the filter gain G follows the sensitivity, whose "
             "error is left out. U of the energy, and of the error against the reference "
             "filter: G ") +
         (follows ? "follows the sensitivity, too."
                  : "stays, so an error of the sensitivity counts.");
}

std::string validity_statement(const app::ReportContext& context) {
  if (is_simulated(context)) {
    return "The results are those of a simulated bench: no item was tested.";
  }
  if (!is_of_item(context)) {
    return "The results are computed from parameters as given: no item was tested.";
  }
  std::string words = "The results apply to the item tested only, as it was when it was tested.";
  if (context.measurement == nullptr) {
    words +=
        " The points and their uncertainties are those of a table, as it was provided; the "
        "results depend on them.";
  }
  return words;
}

std::string traceability_statement(const app::ReportContext& context) {
  if (is_simulated(context)) {
    return "None: the bench was simulated.";
  }
  if (!is_of_item(context)) {
    return "None: the parameters were given.";
  }
  const char* const reference = label_of(context.labels, CertificateLabel::kReference);
  return reference == nullptr
             ? "Not stated: the reference sensor and its calibration were not named."
             : std::string("By the reference sensor ") + reference + ".";
}

std::string labels_not_stated(const app::ReportContext& context) {
  std::string list;
  if (certificate_number(context.labels) == nullptr || !is_of_item(context)) {
    return list;
  }
  const auto add = [&list](const char* option, const char* words) {
    if (words == nullptr) {
      list += (list.empty() ? "--" : ", --") + std::string(option);
    }
  };
  for (const Asked& asked : asked_of(context.labels)) {
    add(asked.option, asked.words);
  }
  add("reference-id", label_of(context.labels, CertificateLabel::kReference));
  add("conditions", label_of(context.labels, CertificateLabel::kConditions));
  return list;
}

std::string running_words(const app::ReportContext& context) {
  const app::Labels& labels = context.labels;
  const char* const number = certificate_number(labels);
  const char* const kind = is_simulated(context) ? "Simulation "
                           : is_of_item(context) ? "Certificate "
                                                 : "Computation ";
  std::string words = number == nullptr ? "Report" : kind + in_one_line(number);
  words += ", " + (labels.device == nullptr ? "accelerometer" : in_one_line(labels.device));
  return words + (labels.serial == nullptr ? ", serial number not given"
                                           : ", serial number " + in_one_line(labels.serial));
}

std::string certificate_of(const app::EvaluationResults& results,
                           const app::ReportContext& context) {
  const char* const conditions = label_of(context.labels, CertificateLabel::kConditions);
  const bool has_number = certificate_number(context.labels) != nullptr;
  std::string html =
      "<section id=\"certificate\" class=\"certificate\">\n<h2>About these results</h2>\n"
      "<table class=\"rows\">\n";
  if (has_number) {
    append_missing(html, context.labels);
  }
  append_row(html, "Method", method_of(results, context));
  append_row(html, "Traceability", quoted(traceability_statement(context).c_str()));
  append_row(html, "Conditions", conditions == nullptr ? "Not stated." : quoted(conditions));
  append_row(html, "Uncertainty", uncertainty_statement(results, context));
  if (results.has_uncertainty()) {
    append_row(html, "Gain", gain_statement(results));
  }
  append_row(html, "Validity", validity_statement(context));
  if (has_number && is_of_item(context)) {
    append_row(html, "Not recorded", kNotRecorded);
  }
  if (has_number) {
    append_row(html, "Reproduction", kReproduction);
  }
  html += "</table>\n";
  if (has_number) {
    append_signature(html, context.labels);
  }
  html += has_number && is_of_item(context) ? "<p class=\"end\">End of the certificate</p>\n"
                                            : "<p class=\"end\">End of the report</p>\n";
  return html + "</section>\n";
}

}  // namespace emax::desk
