// What a report says to be a certificate.
#include "desk/page/certificate_part.hpp"

#include <cstdint>

#include "emax/app/report/measurement.hpp"

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

std::string method_of(const app::ReportContext& context) {
  std::string words;
  if (context.measurement != nullptr) {
    words =
        "Comparison with a reference sensor, back to back, by stepped sines, in the manner of "
        "ISO 16063-21. ";
  }
  words +=
      "Parameters by weighted least squares or as given; the largest error of any signal "
      "within ±a after K. Tomczyk, Energies 2020, 13(7), 1552.";
  const char* const procedure = label_of(context.labels, CertificateLabel::kProcedure);
  return procedure == nullptr ? words : words + " Procedure: " + quoted(procedure) + ".";
}

// What ISO/IEC 17025 asks a certificate for, beside what stands below.
void append_missing(std::string& html, const app::Labels& labels) {
  struct Asked {
    const char* name;
    const char* words;
  };
  const Asked all[] = {
      {"Laboratory", label_of(labels, CertificateLabel::kLaboratory)},
      {"Customer", label_of(labels, CertificateLabel::kCustomer)},
      {"Device", labels.device},
      {"Serial number", labels.serial},
      {"Manufacturer", label_of(labels, CertificateLabel::kMaker)},
      {"Model", label_of(labels, CertificateLabel::kModel)},
      {"Date of the calibration", labels.date},
      {"Who measured", labels.operated_by},
      {"Procedure", label_of(labels, CertificateLabel::kProcedure)},
  };
  for (const Asked& asked : all) {
    if (asked.words == nullptr) {
      append_row(html, asked.name, "Not stated.");
    }
  }
}

std::string traceability_of(const app::ReportContext& context) {
  const char* const reference = label_of(context.labels, CertificateLabel::kReference);
  return reference == nullptr
             ? "Not stated: the reference sensor and its calibration were not named."
             : "By the reference sensor " + quoted(reference) + ".";
}

}  // namespace

const char* certificate_number(const app::Labels& labels) noexcept {
  return label_of(labels, CertificateLabel::kNumber);
}

std::string running_words(const app::ReportContext& context) {
  const app::Labels& labels = context.labels;
  const char* const number = certificate_number(labels);
  std::string words = number == nullptr ? "Report" : "Certificate " + in_one_line(number);
  words += ", " + (labels.device == nullptr ? "accelerometer" : in_one_line(labels.device));
  return words + (labels.serial == nullptr ? ", serial number not given"
                                           : ", serial number " + in_one_line(labels.serial));
}

std::string certificate_of(const app::ReportContext& context) {
  const char* const conditions = label_of(context.labels, CertificateLabel::kConditions);
  std::string html =
      "<section id=\"certificate\" class=\"certificate\">\n<h2>About these results</h2>\n"
      "<table class=\"rows\">\n";
  if (certificate_number(context.labels) != nullptr) {
    append_missing(html, context.labels);
  }
  append_row(html, "Method", method_of(context));
  append_row(html, "Traceability", traceability_of(context));
  append_row(html, "Conditions", conditions == nullptr ? "Not stated." : quoted(conditions));
  append_row(html, "Uncertainty",
             "U is the standard uncertainty times the coverage factor k = 2. For a normal "
             "distribution that covers about 95 %. Standard uncertainties are propagated as JCGM "
             "100 and JCGM 101 describe.");
  const bool is_of_item = context.measurement != nullptr || context.source_name != nullptr;
  append_row(html, "Validity",
             is_of_item ? "The results apply to the item tested only, as it was when it was "
                          "tested. Copies are complete ones."
                        : "The results are computed from parameters as given: no item was tested.");
  html += "</table>\n";
  if (certificate_number(context.labels) != nullptr) {
    const char* const name = context.labels.operated_by;
    html += "<p class=\"signature sign\">Date and signature" +
            (name == nullptr ? std::string() : ": " + quoted(name)) + "</p>\n";
  }
  return html + "</section>\n";
}

void append_end(std::string& html, const app::ReportContext& context) {
  html += certificate_number(context.labels) != nullptr
              ? "<p class=\"end\">End of the certificate</p>\n"
              : "<p class=\"end\">End of the report</p>\n";
}

}  // namespace emax::desk
