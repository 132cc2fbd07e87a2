// What lines around a table say of it: the coverage factor, and units that its header leaves out.
#include "desk/import/table_statements.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

#include "emax/base/decimal.hpp"

#include "desk/import/conversions.hpp"
#include "desk/import/input_units.hpp"
#include "desk/import/letters.hpp"

namespace emax::desk {

namespace {

// What may be a coverage factor.
constexpr double kLeastCoverage = 1.0;
constexpr double kMostCoverage = 4.0;

constexpr std::string_view kCoverageWords[] = {"coverage factor", "erweiterungsfaktor",
                                               "facteur d'\xC3\xA9largissement",
                                               "facteur d'elargissement", "factor de cobertura"};
constexpr std::string_view kUncertaintyStems[] = {"uncertaint",    "unsicherheit", "incertitude",
                                                  "incertidumbre", "coverage",     "erweiterungs",
                                                  "largissement"};
constexpr std::string_view kStandardPhrases[] = {"standard uncertaint", "standardunsicherheit",
                                                 "standardmessunsicherheit", "incertitude-type",
                                                 "incertitude type"};
constexpr std::string_view kExpandedWords[] = {"expanded", "erweitert", "multipli", "largie"};
constexpr std::string_view kReferenceWords[] = {"referen", "f\xC3\xA9rence", "des normals"};
constexpr std::string_view kUnitWords[] = {"units",         "unit",         "einheiten", "einheit",
                                           "unit\xC3\xA9s", "unit\xC3\xA9", "unidades"};

bool is_letter_of_stem(char c) noexcept {
  return is_small_letter(c) || static_cast<unsigned char>(c) >= 0x80;
}

std::string small(std::string_view text) {
  std::string result;
  for (const char c : text) {
    result += small_letter(c);
  }
  return result;
}

template <std::size_t kCount>
bool has_any(std::string_view text, const std::string_view (&words)[kCount]) {
  return std::any_of(std::begin(words), std::end(words), [text](std::string_view word) {
    return text.find(word) != std::string_view::npos;
  });
}

std::string_view trim_statement(std::string_view text) noexcept {
  constexpr std::string_view kAround = " \t\"#%:=";
  const std::size_t begin = text.find_first_not_of(kAround);
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(" \t\"") + 1 - begin);
}

// Behind one of the words: where the rest of the line begins; the end of the line for none.
template <std::size_t kCount>
std::size_t behind(std::string_view text, const std::string_view (&words)[kCount]) {
  for (const std::string_view word : words) {
    const std::size_t at = text.find(word);
    const std::size_t end = at + word.size();
    if (at != std::string_view::npos && (at == 0 || !is_letter_of_stem(text[at - 1])) &&
        (end == text.size() || !is_letter_of_stem(text[end]))) {
      return end;
    }
  }
  return text.size();
}

std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find_first_of(",;\t");
    const std::string_view part = trim_statement(text.substr(0, end));
    if (!part.empty()) {
      parts.push_back(part);
    }
    if (end == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(end + 1);
  }
}

// Of a unit by itself.
Role role_of(std::string_view spelling) {
  if (as_decibel(spelling).is_decibel) {
    return Role::kAmplitude;
  }
  const Unit unit = find_unit(spelling);
  if (!unit.is_given()) {
    return Role::kIgnored;
  }
  switch (unit.quantity) {
    case Quantity::kFrequency:
      return Role::kFrequency;
    case Quantity::kAmplitude:
      return Role::kAmplitude;
    case Quantity::kPhase:
      return Role::kPhase;
    case Quantity::kRatio:
    case Quantity::kDecibel:
      break;
  }
  return Role::kIgnored;
}

// "Coverage factor: 2", "coverage factor (k) is 2": the first number behind the words.
double number_behind_words(std::string_view line) {
  const std::size_t begin = behind(line, kCoverageWords);
  const std::size_t digit = line.find_first_of("0123456789", begin);
  return digit == std::string_view::npos
             ? 0.0
             : find_coverage("k=" + std::string(line.substr(digit)), true).value;
}

// "k;2": a name and its value in two cells.
double number_in_second_cell(std::string_view line) {
  const std::vector<std::string_view> parts = parts_of(line);
  const bool is_pair = parts.size() >= 2 && (parts[0] == "k" || parts[0] == "(k)");
  return is_pair ? find_coverage("k=" + std::string(parts[1]), true).value : 0.0;
}

double coverage_in(std::string_view line) {
  const std::string letters = small(line);
  const CoverageFactor found = find_coverage(line, false);
  if (found.value > 0.0) {
    // A unit or a word behind it makes it another k, but where the line is about uncertainties.
    const std::string_view rest = trim_statement(line.substr(found.begin + found.length));
    const bool is_alone = rest.empty() || rest.front() == ')' || rest.front() == '(' ||
                          rest.front() == ',' || rest.front() == ';' || rest.front() == '.';
    if (is_alone || has_any(letters, kUncertaintyStems)) {
      return found.value;
    }
  }
  const double behind_words = number_behind_words(letters);
  return behind_words > 0.0 ? behind_words : number_in_second_cell(line);
}

}  // namespace

std::string text_of_number(double value) {
  char text[24];
  return {text, format_general(value, 6, text)};
}

std::string text_of_coverage(double coverage) { return "k = " + text_of_number(coverage); }

bool is_statement(std::string_view text) {
  const std::string letters = small(text);
  return coverage_in(text) > 0.0 || has_any(letters, kStandardPhrases) ||
         behind(letters, kUnitWords) < letters.size();
}

ImportError StatementReader::take(std::size_t line, std::string_view text) {
  ImportError error = take_coverage(line, text);
  return error ? error : take_units(line, text);
}

ImportError StatementReader::take_coverage(std::size_t line, std::string_view text) {
  const std::string letters = small(text);
  if (has_any(letters, kReferenceWords)) {
    take_doubtful(line, text);
    return {};
  }
  speaks_of_expanded_ = speaks_of_expanded_ || has_any(letters, kExpandedWords);
  standard_line_ =
      standard_line_ == 0 && has_any(letters, kStandardPhrases) ? line : standard_line_;
  const double coverage = coverage_in(text);
  if (!(coverage >= kLeastCoverage) || !(coverage <= kMostCoverage)) {
    return {};
  }
  if (statements_.coverage > 0.0 && statements_.coverage != coverage) {
    return error_at(line,
                    "this line says " + text_of_coverage(coverage) + ", and line " +
                        std::to_string(statements_.coverage_line) + " says " +
                        text_of_coverage(statements_.coverage),
                    "expected one coverage factor, or one in the name of each uncertainty");
  }
  statements_.coverage = coverage;
  statements_.coverage_line = line;
  return {};
}

void StatementReader::take_doubtful(std::size_t line, std::string_view text) {
  const double stated = coverage_in(text);
  const double coverage = stated > 0.0                             ? stated
                          : has_any(small(text), kStandardPhrases) ? 1.0
                                                                   : 0.0;
  if (coverage >= kLeastCoverage && coverage <= kMostCoverage && coverage != kImportCoverage) {
    statements_.doubtful_coverage = coverage;
    statements_.doubtful_line = line;
  }
}

ImportError StatementReader::take_unit(std::size_t line, Role role, const std::string& spelling) {
  StatedUnit* const unit = role == Role::kFrequency   ? &statements_.frequency
                           : role == Role::kAmplitude ? &statements_.amplitude
                           : role == Role::kPhase     ? &statements_.phase
                                                      : nullptr;
  if (unit == nullptr) {
    return {};
  }
  const std::string_view name = find_unit(spelling).name;
  if (!unit->spelling.empty() && name != find_unit(unit->spelling).name) {
    return error_at(line,
                    "this line says " + spelling + ", and line " + std::to_string(unit->line) +
                        " says " + unit->spelling,
                    "expected one unit of each quantity");
  }
  *unit = {spelling, line};
  return {};
}

ImportError StatementReader::take_units(std::size_t line, std::string_view text) {
  const std::size_t begin = behind(small(text), kUnitWords);
  const bool is_list = begin < text.size();
  for (const std::string_view part : parts_of(is_list ? text.substr(begin) : text)) {
    const Column column = read_column_name(std::string(part));
    const std::string& spelling = column.unit_spelling;
    const Role by_unit = role_of(is_list ? part : std::string_view(spelling));
    ImportError error;
    if (is_list && by_unit != Role::kIgnored) {
      error = take_unit(line, by_unit, std::string(part));
    } else if (!spelling.empty() && column.role == role_of(spelling)) {
      error = take_unit(line, column.role, spelling);
    }
    if (error) {
      return error;
    }
  }
  return {};
}

const Statements& StatementReader::finish() {
  if (statements_.coverage == 0.0 && standard_line_ != 0 && !speaks_of_expanded_) {
    statements_.coverage = 1.0;
    statements_.coverage_line = standard_line_;
  }
  return statements_;
}

}  // namespace emax::desk
