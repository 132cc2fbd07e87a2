// How the columns of a table become numbers in Hz, V/(m/s^2) and rad.
#include "desk/import/conversions.hpp"

#include <string_view>

namespace emax::desk {

namespace {

constexpr char kExpectedUncertainty[] =
    "expected a column with it, or --uncertainty 1%,1deg (expanded, k = 2)";

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

// Of what stands behind a name, without the bracket that the name has opened.
std::string quoted_unit(const std::string& spelling) {
  const std::size_t end = spelling.find_last_not_of(" )]}");
  const bool is_open = spelling.find_first_of("([{") != std::string::npos;
  return quoted(is_open || end == std::string::npos ? spelling : spelling.substr(0, end + 1));
}

// The symbol of the GUM for a standard uncertainty: "u(A)", where an expanded one is "U(A)".
bool is_standard_symbol(const std::string& name) noexcept {
  const std::size_t next = name.find_first_not_of(' ', 1);
  return name.size() > 1 && name[0] == 'u' && next != std::string::npos && name[next] == '(';
}

class ConversionSetter final {
 public:
  ConversionSetter(const FoundTable& table, const ImportOptions& options, Conversions& by)
      : table_(table), options_(options), by_(by) {}

  ImportError run() {
    for (std::size_t i = 0; i < table_.columns.size(); ++i) {
      const Role role = table_.columns[i].role;
      if (role == Role::kIgnored) {
        continue;
      }
      Conversion& conversion = by_.of(role);
      if (conversion.is_there) {
        return error_at(table_.header_line + 1,
                        quoted(conversion.name) + " and " + quoted(table_.columns[i].name) +
                            " name the same quantity",
                        "expected one column of each");
      }
      conversion.is_there = true;
      conversion.is_uncertainty =
          role != Role::kFrequency && role != Role::kAmplitude && role != Role::kPhase;
      conversion.column = i;
      conversion.name = table_.columns[i].name;
      conversion.sign = table_.columns[i].is_lag ? -1.0 : 1.0;
    }
    ImportError error = set_units();
    error = error ? error : set_coverage();
    error = error ? error : check_uncertainties();
    return error ? error : check_phase_options();
  }

 private:
  ImportError set_units() {
    const bool is_omega = table_.columns[by_.frequency().column].is_omega;
    ImportError error = set_unit(by_.frequency(), Quantity::kFrequency, options_.frequency_unit,
                                 is_omega ? kRadiansPerSecond : kHertz);
    if (!error) {
      error = set_amplitude_unit();
    }
    if (!error && by_.phase().is_there) {
      error = set_unit(by_.phase(), Quantity::kPhase, options_.phase_unit, kDegree);
    }
    if (!error && by_.u_amplitude().is_there) {
      error = set_uncertainty_unit(by_.u_amplitude(), by_.amplitude());
    }
    if (!error && by_.u_common().is_there) {
      error = set_uncertainty_unit(by_.u_common(), by_.amplitude());
    }
    if (!error && by_.u_phase().is_there) {
      error =
          set_uncertainty_unit(by_.u_phase(), by_.phase().is_there ? by_.phase() : by_.u_phase());
    }
    return error;
  }

  ImportError unknown_unit(const Conversion& conversion, Quantity quantity) const {
    return error_at(table_.header_line + 1,
                    "the unit " + quoted_unit(table_.columns[conversion.column].unit_spelling) +
                        " of " + quoted(conversion.name) + " is not known",
                    expected_units(quantity));
  }

  ImportError set_unit(Conversion& conversion, Quantity quantity, const Unit& given,
                       const Unit& by_default) const {
    const std::string& spelling = table_.columns[conversion.column].unit_spelling;
    if (spelling.empty()) {
      conversion.unit = given.is_given() ? given : by_default;
      return {};
    }
    conversion.unit = find_unit(spelling);
    if (!conversion.unit.is_given() || conversion.unit.quantity != quantity) {
      return unknown_unit(conversion, quantity);
    }
    const ImportError error = settle_grad(conversion);
    return error ? error : contradiction(conversion, given);
  }

  // Degrees of a German text, or gon?
  ImportError settle_grad(Conversion& conversion) const {
    if (!are_same(conversion.unit, kGrad)) {
      return {};
    }
    if (is_german(table_.columns)) {
      conversion.unit = kDegree;
      return {};
    }
    return error_at(table_.header_line + 1,
                    "the unit " + quoted_unit(table_.columns[conversion.column].unit_spelling) +
                        " of " + quoted(conversion.name) +
                        " may be degrees, as in German, or gon, 400 of which are a turn",
                    "expected deg or gon in its place");
  }

  ImportError contradiction(const Conversion& conversion, const Unit& given) const {
    if (!given.is_given() || std::string_view(given.name) == conversion.unit.name) {
      return {};
    }
    return error_at(table_.header_line + 1,
                    std::string("the header says ") + conversion.unit.name +
                        " and --input-units says " + given.name,
                    "expected --input-units only for columns whose unit is not named");
  }

  // A response in parts of itself, such as 0 dB at 160 Hz, has lost the sensitivity.
  bool is_amplitude_relative(const DecibelUnit& decibel) const {
    const Column& column = table_.columns[by_.amplitude().column];
    const bool has_unit =
        decibel.is_decibel ? !decibel.reference.empty() : !column.unit_spelling.empty();
    const bool has_no_dimension = column.name.find("[-]") != std::string::npos ||
                                  column.name.find("(-)") != std::string::npos;
    return !has_unit && !options_.amplitude_unit.is_given() &&
           (column.is_relative || has_no_dimension);
  }

  ImportError set_amplitude_unit() {
    const DecibelUnit decibel = as_decibel(table_.columns[by_.amplitude().column].unit_spelling);
    if (is_amplitude_relative(decibel)) {
      return error_at(
          table_.header_line + 1,
          quoted(by_.amplitude().name) + " is a ratio, which leaves the sensitivity open",
          "expected amplitudes in a unit such as mV/g; where the numbers are in one, "
          "--input-units names it");
    }
    if (!decibel.is_decibel) {
      const ImportError error = set_unit(by_.amplitude(), Quantity::kAmplitude,
                                         options_.amplitude_unit, kVoltsPerAcceleration);
      return error ? error : check_charge();
    }
    by_.amplitude().is_decibel = true;
    by_.amplitude().unit =
        decibel.reference.empty() ? kVoltsPerAcceleration : find_unit(decibel.reference);
    if (decibel.reference.empty() && options_.amplitude_unit.is_given()) {
      by_.amplitude().unit = options_.amplitude_unit;
    }
    return !by_.amplitude().unit.is_given() || by_.amplitude().unit.quantity != Quantity::kAmplitude
               ? unknown_unit(by_.amplitude(), Quantity::kAmplitude)
               : ImportError{};
  }

  // A charge is in no unit of a voltage, whether that is stated or the one by default.
  ImportError check_charge() const {
    const Column& column = table_.columns[by_.amplitude().column];
    if (!column.is_charge || by_.amplitude().unit.is_charge) {
      return {};
    }
    return error_at(table_.header_line + 1,
                    quoted(column.name) + " is a charge, and its unit " +
                        (column.unit_spelling.empty() ? "is not stated" : "is one of voltage"),
                    "expected pC/(m/s2) or pC/g in the header or by --input-units; 1 pC is then "
                    "taken as 1 V, so E holds for a charge amplifier of 1 V/pC");
  }

  // An uncertainty is in its own unit, in percent or dB, or in the unit of what it belongs to.
  ImportError set_uncertainty_unit(Conversion& u, const Conversion& of) const {
    const std::string& spelling = table_.columns[u.column].unit_spelling;
    const bool is_amplitude = &u != &by_.of(Role::kPhaseUncertainty);
    if (spelling.empty() && is_amplitude && table_.columns[u.column].is_relative) {
      u.unit = kPartOfOne;
      u.is_relative = true;
      return {};
    }
    if (spelling.empty()) {
      u.unit = of.unit.is_given() ? of.unit : kDegree;
      u.is_decibel = of.is_decibel;
      return {};
    }
    u.unit = find_unit(spelling);
    u.is_decibel = is_amplitude && as_decibel(spelling).is_decibel;
    u.is_relative = is_amplitude && u.unit.is_given() && u.unit.quantity == Quantity::kRatio;
    const Quantity wanted = is_amplitude ? Quantity::kAmplitude : Quantity::kPhase;
    const bool is_plain = u.unit.is_given() && u.unit.quantity == wanted;
    if (u.is_decibel) {
      u.unit = kDecibelUnit;
    }
    if (ImportError error = settle_grad(u)) {
      return error;
    }
    return is_plain || u.is_decibel || u.is_relative
               ? ImportError{}
               : unknown_unit(u, is_amplitude ? Quantity::kRatio : Quantity::kPhase);
  }

  ImportError check_uncertainties() {
    const bool is_amplitude_given = options_.amplitude_uncertainty.value > 0.0;
    const bool is_phase_given = options_.phase_uncertainty.value > 0.0;
    if (!by_.u_amplitude().is_there && !is_amplitude_given) {
      return error_at(table_.header_line + 1, "there is no uncertainty of the amplitude",
                      kExpectedUncertainty);
    }
    if (by_.phase().is_there && !by_.u_phase().is_there && !is_phase_given) {
      return error_at(table_.header_line + 1, "there is no uncertainty of the phase",
                      kExpectedUncertainty);
    }
    if (by_.u_amplitude().is_there && is_amplitude_given) {
      return error_at(table_.header_line + 1,
                      "the table has uncertainties of its own for the amplitude",
                      "expected --uncertainty only for what has none");
    }
    if (by_.u_phase().is_there && is_phase_given) {
      return error_at(table_.header_line + 1,
                      "the table has uncertainties of its own for the phase",
                      "expected --uncertainty only for what has none");
    }
    return {};
  }

  // Without a phase there is nothing to turn, and nothing in degrees.
  ImportError check_phase_options() const {
    const char* const option = by_.phase().is_there                     ? nullptr
                               : options_.phase_uncertainty.value > 0.0 ? "--uncertainty"
                               : options_.phase_unit.is_given()         ? "--input-units"
                                                                        : nullptr;
    return option == nullptr
               ? ImportError{}
               : error_at(table_.header_line + 1,
                          std::string("the table has no phase, and ") + option + " speaks of one",
                          "expected a column with it, or the option without it");
  }

  // The name of a column says it, or a line about all of them, or it is 2.
  ImportError set_coverage() {
    const Statements& statements = table_.statements;
    const Conversion* unusual = nullptr;
    const Conversion* silent = nullptr;
    for (Conversion* const u : {&by_.u_amplitude(), &by_.u_phase(), &by_.u_common()}) {
      if (!u->is_there) {
        continue;
      }
      const Column& column = table_.columns[u->column];
      if (column.is_contradictory) {
        return error_at(table_.header_line + 1, quoted(u->name) + " states two coverage factors",
                        "expected one, such as \"U (k=2)\"");
      }
      if (column.coverage > 0.0 && statements.coverage > 0.0 &&
          column.coverage != statements.coverage) {
        return error_at(table_.header_line + 1,
                        quoted(u->name) + " says " + text_of_coverage(column.coverage) +
                            ", and line " + std::to_string(statements.coverage_line) + " says " +
                            text_of_coverage(statements.coverage),
                        "expected one coverage factor");
      }
      u->coverage = column.coverage > 0.0       ? column.coverage
                    : statements.coverage > 0.0 ? statements.coverage
                                                : kImportCoverage;
      if (column.coverage == 0.0 && statements.coverage == 0.0 && statements.doubtful_line == 0 &&
          is_standard_symbol(u->name)) {
        return error_at(table_.header_line + 1,
                        quoted(u->name) +
                            " is the symbol of a standard uncertainty, and nothing states its "
                            "coverage factor",
                        "expected it, such as \"u(A) (k=1)\" or \"U(A) (k=2)\", or a line "
                        "\"k = 1\" before the table");
      }
      unusual = column.coverage > 0.0 && column.coverage != kImportCoverage ? u : unusual;
      silent = column.coverage == 0.0 && statements.coverage == 0.0 ? u : silent;
    }
    if (silent != nullptr && statements.doubtful_line != 0) {
      return error_at(statements.doubtful_line,
                      "this line speaks of a reference and says " +
                          text_of_coverage(statements.doubtful_coverage) +
                          ": of that one, or of the uncertainties in the table",
                      "expected it in the name of each uncertainty, such as \"U (k=2)\"");
    }
    if (unusual == nullptr || silent == nullptr) {
      return {};
    }
    return error_at(table_.header_line + 1,
                    quoted(unusual->name) + " says " + text_of_coverage(unusual->coverage) +
                        ", and " + quoted(silent->name) + " says nothing of its coverage factor",
                    "expected it of each uncertainty, such as \"U (k=2)\"");
  }

  const FoundTable& table_;
  const ImportOptions& options_;
  Conversions& by_;
};

}  // namespace

ImportError set_conversions(const FoundTable& table, const ImportOptions& options,
                            Conversions& conversions) {
  conversions = Conversions();
  return ConversionSetter(table, options, conversions).run();
}

}  // namespace emax::desk
