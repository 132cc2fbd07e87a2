// The results as a Digital Calibration Certificate.
#include "desk/dcc/certificate_xml.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "emax/app/base/version.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/units.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/label_rows.hpp"
#include "desk/dcc/xml_writer.hpp"
#include "desk/files/rounding.hpp"
#include "desk/page/certificate_part.hpp"
#include "desk/report/warning_words.hpp"

namespace emax::desk {

namespace {

using app::EvaluationResults;
using app::kCoverageFactor;

// Units as D-SI writes them.
constexpr const char* kSensitivityUnit = "\\volt\\metre\\tothe{-1}\\second\\tothe{2}";
constexpr const char* kEnergyUnit = "\\volt\\tothe{2}\\second";

constexpr const char* kCoverageProbability = "0.9545";  // Of a normal distribution within 2 u.

// A decimal number keeps so many digits through a double.
constexpr int kMostDigits = 15;

constexpr double kPercent = 100.0;

std::string number(double value) {
  StringSink sink;
  app::TextWriter(sink).general(value, kMostDigits);
  return sink.text();
}

// Decimals that leave `expanded` two digits; below 0 they are tens and hundreds.
int decimals_of_two_digits(double expanded) {
  return 1 - static_cast<int>(std::floor(std::log10(expanded)));
}

double rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

// The nearest one with so many decimals.
std::string number(double value, int decimals) {
  const double nearest = rounded(value, decimals);
  if (decimals > kMostDigits) {
    return number(nearest);
  }
  StringSink sink;
  app::TextWriter(sink).fixed(nearest, std::max(decimals, 0));
  return sink.text();
}

void add_text(XmlWriter& xml, const char* name, const std::string& words) {
  xml.open(name).element("dcc:content", words, "lang=\"en\"").close();
}

// Administrative data

void add_software(XmlWriter& xml) {
  xml.open("dcc:dccSoftware").open("dcc:software");
  add_text(xml, "dcc:name", "emax");
  xml.element("dcc:release", app::kVersion).element("dcc:type", "application").close().close();
}

// One of the schema's words for where the measurement was made; "other" is no claim.
std::string location_of(const app::Labels& labels) {
  const char* const place = label_of(labels, CertificateLabel::kPlace);
  const std::string words = place == nullptr ? "" : xml_text(place);
  return words == "laboratory" || words == "customer" ? words : "other";
}

void add_core_data(XmlWriter& xml, const app::ReportContext& context) {
  const app::Labels& labels = context.labels;
  const std::string date = xml_text(labels.date);
  const std::string mark = is_simulated(context) ? "SIMULATION " : "";
  xml.open("dcc:coreData");
  xml.element("dcc:countryCodeISO3166_1", xml_text(label_of(labels, CertificateLabel::kCountry)));
  xml.element("dcc:usedLangCodeISO639_1", "en").element("dcc:mandatoryLangCodeISO639_1", "en");
  xml.element("dcc:uniqueIdentifier", mark + xml_text(label_of(labels, CertificateLabel::kNumber)));
  xml.element("dcc:beginPerformanceDate", date).element("dcc:endPerformanceDate", date);
  xml.element("dcc:performanceLocation", location_of(labels));
  if (const char* const issued = label_of(labels, CertificateLabel::kIssueDate)) {
    xml.element("dcc:issueDate", xml_text(issued));
  }
  xml.close();
}

void add_item(XmlWriter& xml, const app::Labels& labels) {
  const char* const maker = label_of(labels, CertificateLabel::kMaker);
  const char* const model = label_of(labels, CertificateLabel::kModel);
  xml.open("dcc:items").open("dcc:item");
  add_text(xml, "dcc:name", xml_text(labels.device));
  if (maker != nullptr) {
    xml.open("dcc:manufacturer");
    add_text(xml, "dcc:name", xml_text(maker));
    xml.close();
  }
  if (model != nullptr) {
    xml.element("dcc:model", xml_text(model));
  }
  xml.open("dcc:identifications").open("dcc:identification");
  xml.element("dcc:issuer", "manufacturer").element("dcc:value", xml_text(labels.serial));
  add_text(xml, "dcc:name", "Serial number");
  xml.close().close().close().close();
}

// Name and address are one text here, which stands in both places.
void add_contact(XmlWriter& xml, const char* element, const std::string& words,
                 const char* country) {
  xml.open(element);
  add_text(xml, "dcc:name", words);
  xml.open("dcc:location");
  if (country != nullptr) {
    xml.element("dcc:countryCode", xml_text(country));
  }
  add_text(xml, "dcc:further", words);
  xml.close().close();
}

void add_statement(XmlWriter& xml, const char* name, const std::string& words) {
  xml.open("dcc:statement");
  add_text(xml, "dcc:name", name);
  add_text(xml, "dcc:declaration", words);
  xml.close();
}

// What a reader of the page is warned of, too.
void add_warnings(XmlWriter& xml, const EvaluationResults& results,
                  const app::ReportContext& context) {
  for (const app::Warning warning : app::kWarnings) {
    if (holds(warning, results, context)) {
      add_statement(xml, "Warning",
                    xml_text(sentence_of(warning, results, context.leading_settling_s).c_str()));
    }
  }
  if (context.other_criterion != nullptr) {
    add_statement(xml, "Warning", xml_text(context.other_criterion));
  }
  const std::string note = note_on_time(results, context.leading_settling_s);
  if (!note.empty()) {
    add_statement(xml, "Length of the signals", note);
  }
}

void add_statements(XmlWriter& xml, const EvaluationResults& results,
                    const app::ReportContext& context) {
  const app::Labels& labels = context.labels;
  xml.open("dcc:statements");
  if (is_simulated(context)) {
    add_statement(xml, "Simulation", app::kSimulationBanner);
  }
  add_warnings(xml, results, context);
  add_statement(xml, "Uncertainty", uncertainty_statement(results, context));
  add_statement(xml, "Validity", validity_statement(context));
  add_statement(xml, "Traceability", xml_text(traceability_statement(context).c_str()));
  add_statement(xml, "Reproduction", kReproduction);
  if (const char* const place = label_of(labels, CertificateLabel::kPlace)) {
    add_statement(xml, "Place of the measurement", xml_text(place));
  }
  if (labels.note != nullptr) {
    add_statement(xml, "Note", xml_text(labels.note));
  }
  xml.close();
}

void add_person(XmlWriter& xml, const char* name, const char* role, bool signs) {
  xml.open("dcc:respPerson").open("dcc:person");
  add_text(xml, "dcc:name", xml_text(name));
  xml.close().element("dcc:role", role);
  if (signs) {
    xml.element("dcc:mainSigner", "true");
  }
  xml.close();
}

void add_administrative_data(XmlWriter& xml, const EvaluationResults& results,
                             const app::ReportContext& context) {
  const app::Labels& labels = context.labels;
  xml.open("dcc:administrativeData");
  add_software(xml);
  add_core_data(xml, context);
  add_item(xml, labels);
  xml.open("dcc:calibrationLaboratory");
  add_contact(xml, "dcc:contact", xml_text(label_of(labels, CertificateLabel::kLaboratory)),
              label_of(labels, CertificateLabel::kCountry));
  xml.close().open("dcc:respPersons");
  add_person(xml, labels.operated_by, "measured", false);
  if (const char* const approver = label_of(labels, CertificateLabel::kApprover)) {
    add_person(xml, approver, "approved", true);
  }
  xml.close();
  add_contact(xml, "dcc:customer", xml_text(label_of(labels, CertificateLabel::kCustomer)),
              nullptr);
  add_statements(xml, results, context);
  xml.close();
}

// Results

// What is known of a value: nothing, U, or the interval that stands in its place.
struct Known {
  double u = 0.0;
  bool is_one_sided = false;
  CoverageInterval interval = {};
  double probability = 0.0;
  bool is_normal = false;
};

constexpr const char* kInsteadOfU =
    "The coverage interval stands in the place of U, which says too little here: the value is near "
    "one end of what the uncertainties allow.";

bool is_known(const Known& known) { return known.u > 0.0 && std::isfinite(known.u); }

// Two digits of U, or of u where an interval stands in its place: outwards.
void add_known(XmlWriter& xml, const Known& known, int decimals) {
  if (known.is_one_sided) {
    const double half = 0.5 * std::pow(10.0, -decimals);
    xml.open("si:coverageInterval").element("si:standardUnc", number(known.u, decimals));
    xml.element("si:intervalMin", number(std::max(known.interval.low - half, 0.0), decimals));
    xml.element("si:intervalMax", number(known.interval.high + half, decimals));
    xml.element("si:coverageProbability", number(known.probability)).close();
    return;
  }
  xml.open("si:expandedUnc").element("si:uncertainty", number(kCoverageFactor * known.u, decimals));
  xml.element("si:coverageFactor", "2").element("si:coverageProbability", kCoverageProbability);
  if (known.is_normal) {
    xml.element("si:distribution", "normal");
  }
  xml.close();
}

void add_quantity(XmlWriter& xml, const char* name, double value, const char* unit,
                  const Known& known = {}, const std::string& description = "") {
  const int decimals =
      is_known(known)
          ? decimals_of_two_digits(known.is_one_sided ? known.u : kCoverageFactor * known.u)
          : 0;
  xml.open("dcc:quantity");
  add_text(xml, "dcc:name", name);
  if (known.is_one_sided) {
    add_text(xml, "dcc:description", kInsteadOfU);
  } else if (!description.empty()) {
    add_text(xml, "dcc:description", description);
  }
  xml.open("si:real");
  xml.element("si:value", is_known(known) ? number(value, decimals) : number(value));
  xml.element("si:unit", unit);
  if (is_known(known)) {
    add_known(xml, known, decimals);
  }
  xml.close().close();
}

void open_result(XmlWriter& xml, const char* name) {
  xml.open("dcc:result");
  add_text(xml, "dcc:name", name);
  xml.open("dcc:data");
}

Known known_of_percent(const EvaluationResults& results, const app::EnergyUncertainty& known,
                       double energy_v2s) {
  if (!known.exists()) {
    return {};
  }
  return {known.u_percent, energy_v2s >= 0.0 && results.is_one_sided(known, energy_v2s),
          results.interval_percent_of(known.shortest_of_percent(), energy_v2s),
          results.settings.probability};
}

// No signal has more, so upwards.
void add_bound(XmlWriter& xml, const char* name, bool exists, double bound, const char* unit) {
  constexpr int kDigits = 4;
  if (exists) {
    add_quantity(xml, name, rounded_up(bound, kDigits - 1), unit);
  }
}

void add_figure(XmlWriter& xml, const char* name, const char* name_of_bound,
                const EvaluationResults& results, const app::FigureResults& figure) {
  if (!figure.exists()) {
    return;
  }
  add_quantity(xml, name, results.percent_of(figure.energy_v2s), "\\percent",
               known_of_percent(results, figure.uncertainty, figure.energy_v2s));
  add_bound(xml, name_of_bound, figure.has_bound, results.percent_of(figure.bound_v2s),
            "\\percent");
}

// As in the report: an interval, where U says too little.
Known known_of_energy(const EvaluationResults& results) {
  const app::EnergyUncertainty& known = results.uncertainty;
  if (!known.exists() || results.is_damping_open()) {
    return {};
  }
  const double energy = results.energy_v2s();
  return {known.u_v2s, energy >= 0.0 && results.is_one_sided(known, energy),
          app::widened(known.shortest, energy), results.settings.probability};
}

const char* name_of_energy(Criterion criterion) {
  switch (criterion) {
    case Criterion::kIntegralSquareError:
      return "Largest energy found of the error of signals within the limit";
    case Criterion::kEnergyDifference:
      return "Largest energy difference found of signals within the limit";
    case Criterion::kInBandError:
      break;
  }
  return "Largest energy found of the in-band error of signals within the limit";
}

// Of the criterion, as a part of what it may be at most.
void add_papers_figure(XmlWriter& xml, const EvaluationResults& results) {
  const double energy = results.energy_v2s();
  if (energy < 0.0 || results.settings.criterion != Criterion::kIntegralSquareError) {
    return;
  }
  add_quantity(xml, "Worst rms error against the reference filter, of sensitivity times limit",
               results.percent_of(energy), "\\percent",
               is_known(known_of_energy(results))
                   ? known_of_percent(results, results.uncertainty, energy)
                   : Known{});
}

// The symmetric one, with the digits of U; nothing where an interval stands in the place of U.
std::string interval_of_energy(const EvaluationResults& results) {
  const Known known = known_of_energy(results);
  if (!is_known(known) || known.is_one_sided) {
    return "";
  }
  const int decimals = decimals_of_two_digits(kCoverageFactor * known.u);
  const CoverageInterval& interval = results.uncertainty.symmetric;
  return "Coverage interval of " + number(kPercent * results.settings.probability) +
         " %: " + number(interval.low, decimals) + " to " + number(interval.high, decimals) +
         " V^2 s.";
}

const char* words_on_criterion(Criterion criterion) {
  switch (criterion) {
    case Criterion::kIntegralSquareError:
      return "Criterion: integral-square error, the energy of the sensor's output less that of the "
             "reference filter.";
    case Criterion::kEnergyDifference:
      return "Criterion: energy difference, the energy of the sensor's output less the energy of "
             "the filter's.";
    case Criterion::kInBandError:
      break;
  }
  return "Criterion: in-band error, the energy of the sensor's output less G x, behind the filter.";
}

void add_errors(XmlWriter& xml, const EvaluationResults& results) {
  open_result(xml, "Largest errors");
  add_text(xml, "dcc:text", words_on_criterion(results.settings.criterion));
  add_text(xml, "dcc:text", gain_statement(results));
  const bool is_given = results.settings.delay_choice == app::DelayChoice::kGiven;
  add_figure(
      xml,
      is_given ? "Worst rms error in band, the given delay taken out, of sensitivity times limit"
               : "Worst rms error in band, constant delay taken out, of sensitivity times limit",
      "Proven at the estimates for that error: no signal has more", results, results.matched);
  if (results.matched.exists()) {
    add_quantity(xml, "Delay taken out", results.matched.delay_s, "\\second");
  }
  add_figure(xml, "Worst rms error in band, with its delay, of sensitivity times limit",
             "Proven at the estimates with the delay: no signal has more", results, results.band);
  add_papers_figure(xml, results);
  add_quantity(xml, name_of_energy(results.settings.criterion), results.energy_v2s(), kEnergyUnit,
               known_of_energy(results), interval_of_energy(results));
  add_bound(xml, "Proven at the estimates for that energy: no signal has more", results.has_bound,
            results.bound_v2s, kEnergyUnit);
  add_quantity(xml, "Limit of the signals", results.limit_mps2, "\\metre\\second\\tothe{-2}");
  add_quantity(xml, "Length of the signals", results.settings.duration_s, "\\second");
  add_quantity(xml, "Order of the reference filter, Butterworth",
               static_cast<double>(results.settings.filter_order), "\\one");
  add_quantity(xml, "Cutoff of the reference filter", results.settings.cutoff_hz, "\\hertz");
  xml.close().close();
}

// How well the points and the model agree; --birge widens all U alike.
void add_quality(XmlWriter& xml, const EvaluationResults& results) {
  if (results.source != app::Source::kPoints) {
    return;
  }
  const WlspFit& fit = results.fit.result();
  open_result(xml, "Quality of the fit");
  if (results.trial_scale() > 1.0) {
    add_text(
        xml, "dcc:text",
        "U of the parameters and of the errors is times the Birge ratio; U of the points is as "
        "stated.");
  }
  constexpr int kDecimals = 3;
  const auto add = [&xml](const char* name, double value) {
    add_quantity(xml, name, rounded(value, kDecimals), "\\one");
  };
  add_quantity(xml, "Chi-square", rounded(fit.chi2, kDecimals), "\\one", {},
               chi_square_statement(results));
  add("Degrees of freedom", static_cast<double>(fit.dof));
  add("Birge ratio", fit.birge_ratio);
  if (!results.is_damping_open()) {
    const auto correlation = [&results](std::size_t i, std::size_t j) {
      const double scale = std::sqrt(results.covariance(i, i) * results.covariance(j, j));
      return scale > 0.0 ? results.covariance(i, j) / scale : 0.0;
    };
    add("Correlation of sensitivity and natural frequency", correlation(0, 1));
    add("Correlation of sensitivity and damping ratio", correlation(0, 2));
    add("Correlation of natural frequency and damping ratio", correlation(1, 2));
  }
  xml.close().close();
}

// Jointly normal as stated, which a fit that warns belies; the errors are a function of them.
void add_parameters(XmlWriter& xml, const EvaluationResults& results,
                    const app::ReportContext& context) {
  const Accelerometer& device = results.device.estimate;
  const bool is_normal = !holds(app::Warning::kFit, results, context);
  const auto known = [&results, is_normal](std::size_t i) {
    const double u = results.trial_scale() * std::sqrt(results.covariance(i, i));
    return Known{u, false, {}, 0.0, is_normal};
  };
  open_result(xml, "Parameters of the model of second order");
  add_quantity(xml, "Sensitivity", device.sensitivity, kSensitivityUnit, known(0));
  add_quantity(xml, "Natural frequency", device.natural_frequency_hz, "\\hertz", known(1));
  if (!results.is_damping_open()) {
    add_quantity(xml, "Damping ratio", device.damping, "\\one", known(2));
  }
  xml.close().close();
}

// A column of the response: values, and expanded uncertainties unless they are empty.
struct Column {
  const char* name;
  const char* unit;
  std::string values;
  std::string uncertainties;
  std::string description = "";
};

void append_number(std::string& list, double value) {
  list += (list.empty() ? "" : " ") + number(value);
}

// U with two digits, and the value with as many decimals.
void append_known(Column& column, double value, double expanded) {
  const int decimals = decimals_of_two_digits(expanded);
  column.values += (column.values.empty() ? "" : " ") + number(value, decimals);
  column.uncertainties += (column.uncertainties.empty() ? "" : " ") + number(expanded, decimals);
}

// Which part of U moves all amplitudes alike.
std::string words_on_common_part(const FrequencyResponse& response) {
  if (!response.has_common()) {
    return "";
  }
  constexpr int kDigits = 3;
  StringSink sink;
  app::TextWriter out(sink);
  out.text("U of each amplitude holds ");
  out.general(kCoverageFactor * kPercent * response.common()[0], kDigits);
  out.text(" % (k = 2) that all have in common: one effect, which moves them alike.");
  return sink.text();
}

void add_column(XmlWriter& xml, const Column& column) {
  xml.open("dcc:quantity");
  add_text(xml, "dcc:name", column.name);
  if (!column.description.empty()) {
    add_text(xml, "dcc:description", column.description);
  }
  xml.open("si:realListXMLList").element("si:valueXMLList", column.values);
  xml.element("si:unitXMLList", column.unit);
  if (!column.uncertainties.empty()) {
    xml.open("si:expandedUncXMLList").element("si:uncertaintyXMLList", column.uncertainties);
    xml.element("si:coverageFactorXMLList", "2");
    xml.element("si:coverageProbabilityXMLList", kCoverageProbability).close();
  }
  xml.close().close();
}

void add_response(XmlWriter& xml, const EvaluationResults& results) {
  if (results.source != app::Source::kPoints) {
    return;
  }
  const FrequencyResponse& response = results.fit.response();
  Column frequency = {"Frequency", "\\hertz", "", ""};
  Column amplitude = {"Amplitude", kSensitivityUnit, "", "", words_on_common_part(response)};
  Column phase = {"Phase", "\\degree", "", ""};
  bool has_phases = true;
  for (std::size_t i = 0; i < response.size(); ++i) {
    const ResponsePoint& point = response.points()[i];
    const Complex beside = results.fit.shared_beside(i);
    const double u = std::hypot(point.u_amplitude, response.common()[i] * point.amplitude,
                                beside.re * point.amplitude);
    const double u_phase_deg = kDegreesPerRadian * std::hypot(point.u_phase_rad, beside.im);
    append_number(frequency.values, point.frequency_hz);
    append_known(amplitude, point.amplitude, kCoverageFactor * u);
    has_phases = has_phases && is_phase_known(point);
    if (is_phase_known(point)) {
      append_known(phase, kDegreesPerRadian * point.phase_rad, kCoverageFactor * u_phase_deg);
    }
  }
  open_result(xml, "Frequency response");
  xml.open("dcc:list");
  add_column(xml, frequency);
  add_column(xml, amplitude);
  if (has_phases) {
    add_column(xml, phase);
  }
  xml.close().close().close();
}

void add_methods(XmlWriter& xml, const app::ReportContext& context) {
  const char* const procedure = label_of(context.labels, CertificateLabel::kProcedure);
  xml.open("dcc:usedMethods");
  if (is_simulated(context)) {
    xml.open("dcc:usedMethod");
    add_text(xml, "dcc:name", "Simulated comparison with a reference sensor, stepped sine");
    xml.close();
  } else if (context.measurement != nullptr) {
    xml.open("dcc:usedMethod");
    add_text(xml, "dcc:name", "Comparison with a reference sensor, back to back, stepped sine");
    xml.element("dcc:norm", "ISO 16063-21").close();
  }
  xml.open("dcc:usedMethod");
  add_text(xml, "dcc:name", "Largest error of any signal within a limit");
  xml.element("dcc:norm", "JCGM 101:2008");
  xml.element("dcc:reference", "K. Tomczyk, Energies 2020, 13(7), 1552");
  if (procedure != nullptr) {
    xml.element("dcc:reference", xml_text(procedure));
  }
  xml.close().close();
}

void add_measuring(XmlWriter& xml, const app::ReportContext& context) {
  const app::Labels& labels = context.labels;
  const char* const reference =
      is_of_item(context) ? label_of(labels, CertificateLabel::kReference) : nullptr;
  const char* const conditions = label_of(labels, CertificateLabel::kConditions);
  if (reference != nullptr) {
    xml.open("dcc:measuringEquipments").open("dcc:measuringEquipment");
    add_text(xml, "dcc:name", "Reference sensor: " + xml_text(reference));
    xml.close().close();
  }
  if (conditions != nullptr) {
    xml.open("dcc:influenceConditions").open("dcc:influenceCondition");
    add_text(xml, "dcc:name", "Conditions");
    xml.open("dcc:data");
    add_text(xml, "dcc:text", xml_text(conditions));
    xml.close().close().close();
  }
}

// Checks

bool has_form(const std::string& text, std::string_view form) {
  bool fits = text.size() == form.size();
  for (std::size_t i = 0; fits && i < form.size(); ++i) {
    const char c = text[i];
    fits = form[i] == '0'   ? c >= '0' && c <= '9'
           : form[i] == 'A' ? c >= 'A' && c <= 'Z'
                            : c == form[i];
  }
  return fits;
}

bool is_date(const std::string& text) {
  constexpr int kMonths = 12;
  constexpr int kDays[kMonths] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  if (!has_form(text, "0000-00-00")) {
    return false;
  }
  const int month = std::stoi(text.substr(5, 2));
  const int day = std::stoi(text.substr(8, 2));
  return month >= 1 && month <= kMonths && day >= 1 && day <= kDays[month - 1];
}

}  // namespace

Problem check_certificate_labels(const app::Labels& labels) {
  struct Needed {
    const char* option;
    const char* words;
  };
  const Needed all[] = {
      {"device", labels.device},
      {"serial", labels.serial},
      {"operator", labels.operated_by},
      {"date", labels.date},
      {"certificate-number", label_of(labels, CertificateLabel::kNumber)},
      {"laboratory", label_of(labels, CertificateLabel::kLaboratory)},
      {"country", label_of(labels, CertificateLabel::kCountry)},
      {"customer", label_of(labels, CertificateLabel::kCustomer)},
  };
  std::string missing;
  for (const Needed& needed : all) {
    if (needed.words == nullptr || xml_text(needed.words).empty()) {
      missing += (missing.empty() ? "--" : ", --") + std::string(needed.option);
    }
  }
  if (!missing.empty()) {
    return bad_input("--dcc: a digital certificate names more; expected also " + missing);
  }
  if (!is_date(xml_text(labels.date))) {
    return bad_input("--date: \"" + printable(labels.date) +
                     "\" given; expected YYYY-MM-DD with --dcc");
  }
  const char* const issued = label_of(labels, CertificateLabel::kIssueDate);
  if (issued != nullptr && !is_date(xml_text(issued))) {
    return bad_input("--issue-date: \"" + printable(issued) +
                     "\" given; expected YYYY-MM-DD with --dcc");
  }
  const char* const country = label_of(labels, CertificateLabel::kCountry);
  return has_form(xml_text(country), "AA")
             ? Problem{}
             : bad_input("--country: \"" + printable(country) +
                         "\" given; expected two capital letters, as DE, with --dcc");
}

std::string certificate_xml(const EvaluationResults& results, const app::ReportContext& context) {
  XmlWriter xml;
  xml.open("dcc:digitalCalibrationCertificate",
           "xmlns:dcc=\"https://ptb.de/dcc\" xmlns:si=\"https://ptb.de/si\"\n"
           "  xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n"
           "  xsi:schemaLocation=\"https://ptb.de/dcc https://ptb.de/dcc/v3.2.1/dcc.xsd\"\n"
           "  schemaVersion=\"3.2.1\"");
  add_administrative_data(xml, results, context);
  xml.open("dcc:measurementResults").open("dcc:measurementResult");
  add_text(xml, "dcc:name", "Largest error of an accelerometer");
  add_methods(xml, context);
  add_measuring(xml, context);
  xml.open("dcc:results");
  add_errors(xml, results);
  add_parameters(xml, results, context);
  add_quality(xml, results);
  add_response(xml, results);
  xml.close().close().close().close();
  return xml.text();
}

}  // namespace emax::desk
