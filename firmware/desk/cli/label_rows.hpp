// What a certificate names beyond the labels of every instrument: a row each.
#pragma once

#include <cstddef>

#include "emax/app/report/report_context.hpp"

namespace emax::desk {

/// A label as option, in results.json and in what is to be read.
struct LabelRow {
  const char* option;
  const char* key;
  const char* name;
  const char* expectation;
  const char* help;  ///< Lines of at most 55 characters.
};

enum class CertificateLabel : std::size_t {
  kNumber,
  kLaboratory,
  kCountry,
  kCustomer,
  kMaker,
  kModel,
  kReference,
  kConditions,
  kProcedure,
  kPlace,
  kIssueDate,
  kApprover,
};

/// In the order of `CertificateLabel`.
inline constexpr LabelRow kLabelRows[] = {
    {"certificate-number", "certificate_number", "Certificate number", "a number or a name",
     "makes the page a certificate of this number"},
    {"laboratory", "laboratory", "Laboratory", "a name and an address",
     "name and address of the calibration laboratory"},
    {"country", "country", "Country", "two capital letters",
     "country of the laboratory, two letters (ISO 3166): DE"},
    {"customer", "customer", "Customer", "a name and an address",
     "name and address of the customer"},
    {"maker", "maker", "Manufacturer", "a name", "manufacturer of the device"},
    {"model-name", "model_name", "Model", "a name",
     "type of the device, as its manufacturer names it"},
    {"reference-id", "reference_id", "Reference sensor", "a name",
     "the reference sensor and its certificate, to which\n"
     "the results are traceable"},
    {"conditions", "conditions", "Conditions", "a text",
     "temperature, humidity, mounting and torque"},
    {"procedure", "procedure", "Procedure", "a text",
     "procedure of the laboratory, such as its number"},
    {"place", "place", "Place of the measurement", "a text",
     "where it was measured: laboratory, customer, or a place"},
    {"issue-date", "issue_date", "Date of issue", "YYYY-MM-DD",
     "day on which a certificate is issued"},
    {"approved-by", "approved_by", "Approved by", "a name",
     "who authorises a certificate, beside who measured"},
};
inline constexpr std::size_t kLabelRowCount = sizeof kLabelRows / sizeof kLabelRows[0];

/// @returns What is given for a row; null if nothing is.
const char* label_of(const app::Labels& labels, CertificateLabel label) noexcept;

}  // namespace emax::desk
