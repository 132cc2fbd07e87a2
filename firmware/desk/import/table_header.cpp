// What the names and units above the columns of a table say.
#include "desk/import/table_header.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "emax/base/decimal.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

#include "desk/import/letters.hpp"

namespace emax::desk {

namespace {

constexpr std::string_view kFrequencyWords[] = {"f",
                                                "freq",
                                                "frequency",
                                                "frequenz",
                                                "messfrequenz",
                                                "pr\303\274ffrequenz",
                                                "anregungsfrequenz",
                                                "fr\303\251quence",
                                                "frequence",
                                                "frecuencia",
                                                "frequenza"};
constexpr std::string_view kOmegaWords[] = {"omega", "w", "\317\211", "kreisfrequenz"};
constexpr std::string_view kAmplitudeWords[] = {"a",
                                                "amp",
                                                "ampl",
                                                "amplitude",
                                                "magnitude",
                                                "mag",
                                                "s",
                                                "sens",
                                                "sensitivity",
                                                "empfindlichkeit",
                                                "betrag",
                                                "k",
                                                "h",
                                                "sua",
                                                "sqa",
                                                "\303\274bertragungskoeffizient",
                                                "\303\274bertragungskoeffizienten",
                                                "\303\274bertragungsfaktor",
                                                "\303\274bertragungsfaktors",
                                                "amplitudengang",
                                                "response",
                                                "sensibilit\303\251",
                                                "sensibilite",
                                                "sensibilidad",
                                                "sensibilit\303\240",
                                                "sensibilita",
                                                "module",
                                                "m\303\263dulo",
                                                "modulo",
                                                "amplitud",
                                                "ampiezza"};
// What may stand before some of them, in the same word.
constexpr std::string_view kChargePrefixes[] = {"ladungs"};
constexpr std::string_view kVoltagePrefixes[] = {"spannungs"};
constexpr std::string_view kPhaseWords[] = {"phase",
                                            "phi",
                                            "\317\206",
                                            "\317\225",
                                            "\317\206ua",
                                            "\317\206qa",
                                            "arg",
                                            "angle",
                                            "winkel",
                                            "phasenwinkel",
                                            "phasenlage",
                                            "phasenverschiebung",
                                            "phasenverschiebungswinkel",
                                            "phasengang",
                                            "d\303\251phasage",
                                            "dephasage",
                                            "fase",
                                            "sfasamento",
                                            "desfase",
                                            "\303\241ngulo",
                                            "angulo",
                                            "angolo"};
constexpr std::string_view kUncertaintyWords[] = {"u",
                                                  "u95",
                                                  "uc",
                                                  "unc",
                                                  "uncert",
                                                  "uncertainty",
                                                  "unsicherheit",
                                                  "messunsicherheit",
                                                  "standardunsicherheit",
                                                  "standardmessunsicherheit",
                                                  "incertitude",
                                                  "incertidumbre",
                                                  "incertezza"};
// Of an uncertainty with k = 1, as words of their own or behind the uncertainty.
constexpr std::string_view kStandardNames[] = {"standard", "std", "uc", "standardunsicherheit",
                                               "standardmessunsicherheit"};
constexpr std::string_view kStandardNamesBehind[] = {
    "type", "tipo", "t\303\255pica", "tipica", "est\303\241ndar", "estandar"};
constexpr std::string_view kRelativeWords[] = {"rel",      "relative", "relativer", "relativen",
                                               "relativa", "relativo", "relatif"};
constexpr std::string_view kChargeWords[] = {"charge", "ladung"};
constexpr std::string_view kGermanWords[] = {"frequenz",
                                             "messfrequenz",
                                             "pr\303\274ffrequenz",
                                             "anregungsfrequenz",
                                             "kreisfrequenz",
                                             "empfindlichkeit",
                                             "betrag",
                                             "amplitudengang",
                                             "winkel",
                                             "phasenwinkel",
                                             "phasenlage",
                                             "phasenverschiebung",
                                             "phasenverschiebungswinkel",
                                             "phasengang",
                                             "unsicherheit",
                                             "messunsicherheit",
                                             "standardunsicherheit",
                                             "standardmessunsicherheit",
                                             "erweiterte"};
constexpr std::string_view kFillers[] = {"of",          "the",
                                         "in",          "der",
                                         "des",         "abs",
                                         "expanded",    "combined",
                                         "voltage",     "erweiterte",
                                         "kombinierte", "shift",
                                         "response",    "value",
                                         "measured",    "wert",
                                         "und",         "and",
                                         "erweitert",   "\303\251largie",
                                         "elargie",     "compos\303\251e",
                                         "composee",    "expandida",
                                         "ampliada",    "combinada",
                                         "estesa",      "composta",
                                         "combinata",   "de",
                                         "del",         "della",
                                         "di",          "la"};
// A column with one of these is none of ours.
constexpr std::string_view kOtherWords[] = {
    "deviation",   "dev",      "error", "abweichung", "residual", "model",
    "fit",         "stdrd",    "stdev", "sd",         "sigma",    "coherence",
    "temperature", "humidity", "time",  "date",       "accel",    "acceleration",
    "harmonic",    "thd",      "noise", "ref"};

template <std::size_t kCount>
bool is_one_of(std::string_view word, const std::string_view (&words)[kCount]) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

bool is_part_of_word(char c) noexcept {
  return is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 0x80 || c == '%';
}

struct Word {
  std::string text;       // In small letters.
  std::size_t begin = 0;  // In the cell.
};

// Of A to Z and of the letters with accents of Latin-1.
char small_letter_at(std::string_view cell, std::size_t at) noexcept {
  constexpr unsigned kFirst = 0x80;
  constexpr unsigned kLast = 0x9E;
  constexpr unsigned kDistance = 0x20;
  const char c = cell[at];
  const unsigned byte = static_cast<unsigned char>(c);
  const bool is_accented = at > 0 && cell[at - 1] == '\xC3' && byte >= kFirst && byte <= kLast;
  return is_accented ? static_cast<char>(byte + kDistance) : small_letter(c);
}

std::vector<Word> words_of(const std::string& cell) {
  std::vector<Word> words;
  for (std::size_t at = 0; at < cell.size(); ++at) {
    if (!is_part_of_word(cell[at])) {
      continue;
    }
    if (at == 0 || !is_part_of_word(cell[at - 1])) {
      words.push_back({"", at});
    }
    words.back().text += small_letter_at(cell, at);
  }
  return words;
}

template <std::size_t kCount>
bool drop_prefix(std::string_view& word, const std::string_view (&prefixes)[kCount]) {
  for (const std::string_view prefix : prefixes) {
    if (word.size() > prefix.size() && word.substr(0, prefix.size()) == prefix) {
      word.remove_prefix(prefix.size());
      return true;
    }
  }
  return false;
}

std::string_view without_prefix(std::string_view word, Column& column) {
  column.is_charge = column.is_charge || drop_prefix(word, kChargePrefixes);
  (void)drop_prefix(word, kVoltagePrefixes);
  return word;
}

Role main_role(std::string_view word, Column& column) {
  if (is_one_of(word, kFrequencyWords)) {
    return Role::kFrequency;
  }
  if (is_one_of(word, kOmegaWords)) {
    column.is_omega = true;
    return Role::kFrequency;
  }
  if (is_one_of(without_prefix(word, column), kAmplitudeWords)) {
    return Role::kAmplitude;
  }
  return is_one_of(word, kPhaseWords) ? Role::kPhase : Role::kIgnored;
}

// What the words before the unit say.
class NameReader final {
 public:
  explicit NameReader(Column& column) noexcept : column_(column) {}

  /// @returns False for a word that is no part of a name: the unit starts there.
  bool take(const std::string& word) {
    if (is_uncertainty_ && word == "k" && !is_first_) {
      return true;
    }
    if (take_role(word)) {
      is_first_ = false;
      return true;
    }
    if (is_one_of(word, kStandardNames) ||
        (is_uncertainty_ && is_one_of(word, kStandardNamesBehind))) {
      is_standard_ = true;
      return true;
    }
    if (is_one_of(word, kChargeWords)) {
      column_.is_charge = true;
      return true;
    }
    if (word == "lag" && role_ == Role::kPhase) {
      column_.is_lag = true;
      return true;
    }
    if (is_one_of(word, kRelativeWords)) {
      column_.is_relative = true;
      return true;
    }
    if (is_uncertainty_ && (word == "common" || word == "shared")) {
      is_common_ = true;
      return true;
    }
    return is_one_of(word, kFillers);
  }

  void remember(const std::string& word) { last_ = word; }

  /// Says what the words have made of the column; a word alone such as "standard" makes nothing.
  void finish(Role before) {
    if (is_uncertainty_ && is_standard_) {
      column_.is_contradictory = column_.coverage != 0.0 && column_.coverage != 1.0;
      column_.coverage = 1.0;
    }
    if (is_common_) {
      column_.role = Role::kCommonUncertainty;
      return;
    }
    if (!is_uncertainty_) {
      column_.role = is_standard_ ? Role::kIgnored : role_;
      return;
    }
    const Role target = role_ == Role::kIgnored ? role_of_unit(before) : role_;
    column_.is_assumed = role_ == Role::kIgnored;
    column_.role = target == Role::kAmplitude ? Role::kAmplitudeUncertainty
                   : target == Role::kPhase   ? Role::kPhaseUncertainty
                                              : Role::kIgnored;
  }

 private:
  bool take_role(const std::string& word) {
    if (is_one_of(word, kUncertaintyWords)) {
      is_uncertainty_ = true;
      is_standard_ = is_standard_ || is_one_of(word, kStandardNames);
      return true;
    }
    if (role_ != Role::kIgnored) {
      return take_second_role(word);
    }
    role_ = main_role(word, column_);
    if (role_ == Role::kIgnored && word.size() > 1 && word.front() == 'u') {
      role_ = main_role(std::string_view(word).substr(1), column_);  // "uA", "uphi".
      is_uncertainty_ = is_uncertainty_ || role_ != Role::kIgnored;
    }
    return role_ != Role::kIgnored;
  }

  // "Frequency response amplitude", "phase of sensitivity", "sensitivity magnitude".
  bool take_second_role(const std::string& word) {
    Column other;
    const Role role = word.size() > 2 ? main_role(word, other) : Role::kIgnored;
    const bool is_wider = role == Role::kPhase || role == Role::kAmplitude;
    role_ = is_wider && role_ != Role::kPhase ? role : role_;
    // Of the letter behind "arg" or "of", and of the symbol behind a name: "Frequency f". An "A"
    // may be a unit.
    const Role symbol = main_role(word, other);
    const bool is_named = last_ == "arg" || last_ == "of" || last_ == "von";
    const bool names_quantity =
        symbol != Role::kIgnored && (is_named || (symbol == role_ && word != "a" && word != "w"));
    return is_wider || names_quantity;
  }

  // What an uncertainty without a name belongs to: its unit knows (nobody states a phase in
  // percent), else what stands before it.
  Role role_of_unit(Role before) const {
    const Unit unit = find_unit(column_.unit_spelling);
    if (as_decibel(column_.unit_spelling).is_decibel ||
        (unit.is_given() &&
         (unit.quantity == Quantity::kAmplitude || unit.quantity == Quantity::kRatio))) {
      return Role::kAmplitude;
    }
    return unit.is_given() && unit.quantity == Quantity::kPhase ? Role::kPhase : before;
  }

  Column& column_;
  std::string last_;
  Role role_ = Role::kIgnored;
  bool is_uncertainty_ = false;
  bool is_standard_ = false;
  bool is_common_ = false;
  bool is_first_ = true;
};

bool has_uncertainty_word(const std::vector<Word>& words) {
  return std::any_of(words.begin(), words.end(), [](const Word& word) {
    Column column;
    return is_one_of(word.text, kUncertaintyWords) ||
           (word.text.size() > 1 && word.text.front() == 'u' &&
            main_role(std::string_view(word.text).substr(1), column) != Role::kIgnored);
  });
}

// Takes what states a coverage factor out of a name.
std::string without_coverage(const std::string& name, Column& column) {
  std::string text = name;
  if (!has_uncertainty_word(words_of(text))) {
    return text;
  }
  for (CoverageFactor found = find_coverage(text, true); found.value > 0.0;
       found = find_coverage(text, true)) {
    column.is_contradictory = column.coverage > 0.0 && column.coverage != found.value;
    column.coverage = found.value;
    text.erase(found.begin, found.length);
    if (column.is_contradictory) {
      break;
    }
  }
  return text;
}

// "H(f)" is "H", and an angle sign is "arg".
std::string without_argument(std::string name) {
  constexpr std::string_view kAngle = "\xE2\x88\xA0";
  constexpr std::string_view kSymbols = "HhKkSs";
  constexpr std::string_view kArguments[] = {"(f)",        "(w)",         "(jw)",       "(iw)",
                                             "(\xCF\x89)", "(j\xCF\x89)", "(i\xCF\x89)"};
  for (std::size_t at = name.find(kAngle); at != std::string::npos; at = name.find(kAngle)) {
    name.replace(at, kAngle.size(), "arg ");
  }
  if (name.compare(0, 3, "u_c") == 0 && (name.size() == 3 || !is_part_of_word(name[3]))) {
    name.erase(1, 1);
  }
  for (const std::string_view argument : kArguments) {
    const std::size_t at = name.find(argument);
    const bool is_behind_symbol = at != std::string::npos && at > 0 &&
                                  kSymbols.find(name[at - 1]) != std::string_view::npos &&
                                  (at == 1 || !is_part_of_word(name[at - 2]));
    if (is_behind_symbol) {
      name.erase(at, argument.size());
    }
  }
  return name;
}

Column read_name(const std::string& cell, Role before) {
  Column column;
  column.name = cell;
  while (!column.name.empty() && (column.name.back() == ',' || column.name.back() == ':')) {
    column.name.pop_back();
  }
  const std::string name = without_argument(without_coverage(column.name, column));
  const std::vector<Word> words = words_of(name);
  for (const Word& word : words) {
    if (is_one_of(word.text, kOtherWords)) {
      return column;
    }
  }
  NameReader reader(column);
  for (const Word& word : words) {
    const bool is_taken = reader.take(word.text);
    reader.remember(word.text);
    if (!is_taken) {
      column.unit_spelling = name.substr(word.begin);
      break;
    }
  }
  reader.finish(before);
  return column;
}

bool is_named(const std::vector<Column>& columns, Role role) {
  return std::any_of(columns.begin(), columns.end(), [role](const Column& column) {
    return column.role == role && !column.is_assumed;
  });
}

// Two uncertainties that do not say of what, behind both values, are in their order.
void settle_pair(std::vector<Column>& columns) {
  std::vector<Column*> assumed;
  for (Column& column : columns) {
    const bool is_uncertainty =
        column.role == Role::kAmplitudeUncertainty || column.role == Role::kPhaseUncertainty;
    if (is_uncertainty && column.is_assumed) {
      assumed.push_back(&column);
    }
  }
  const bool is_pair = assumed.size() == 2 && assumed[0]->role == assumed[1]->role &&
                       assumed[0]->unit_spelling.empty() && assumed[1]->unit_spelling.empty();
  if (is_pair) {
    const bool is_phase_last = assumed[0]->role == Role::kPhaseUncertainty;
    assumed[0]->role = is_phase_last ? Role::kAmplitudeUncertainty : Role::kPhaseUncertainty;
  }
}

// An uncertainty that does not say of what is not that of which there is a column by name.
void settle_assumptions(std::vector<Column>& columns) {
  settle_pair(columns);
  for (Column& column : columns) {
    if (!column.is_assumed || !is_named(columns, column.role)) {
      continue;
    }
    const bool is_amplitude = column.role == Role::kAmplitudeUncertainty;
    const Role other = is_amplitude ? Role::kPhaseUncertainty : Role::kAmplitudeUncertainty;
    column.role = is_named(columns, other) ? column.role : other;
    column.is_assumed = false;
  }
}

}  // namespace

bool is_german(const std::vector<Column>& columns) {
  return std::any_of(columns.begin(), columns.end(), [](const Column& column) {
    const std::vector<Word> words = words_of(column.name);
    return std::any_of(words.begin(), words.end(),
                       [](const Word& word) { return is_one_of(word.text, kGermanWords); });
  });
}

Column read_column_name(const std::string& cell) { return read_name(cell, Role::kIgnored); }

Header read_header(const std::vector<std::string>& cells) {
  Header header;
  Role before = Role::kIgnored;
  for (const std::string& cell : cells) {
    header.columns.push_back(read_name(cell, before));
    const Role role = header.columns.back().role;
    before = role == Role::kAmplitude || role == Role::kPhase ? role : before;
  }
  settle_assumptions(header.columns);
  const std::size_t count = header.columns.size();
  const bool has_frequency = column_of(header.columns, Role::kFrequency) < count;
  const bool has_amplitude = column_of(header.columns, Role::kAmplitude) < count;
  header.is_complete = has_frequency && has_amplitude;
  header.is_header =
      has_frequency || has_amplitude || column_of(header.columns, Role::kPhase) < count;
  return header;
}

bool continues_header(const std::vector<std::string>& cells) {
  const auto is_ours = [](const std::string& cell) {
    if (find_unit(cell).is_given() || as_decibel(cell).is_decibel) {
      return true;
    }
    const std::vector<Word> words = words_of(cell);
    return !words.empty() && std::all_of(words.begin(), words.end(), [](const Word& word) {
      Column column;
      return main_role(word.text, column) != Role::kIgnored || has_uncertainty_word({word}) ||
             is_one_of(word.text, kFillers) || find_unit(word.text).is_given();
    });
  };
  // Columns that are not ours may have any words, so the first must be one of ours.
  return (cells.front().empty() || is_ours(cells.front())) &&
         std::any_of(cells.begin(), cells.end(), is_ours);
}

std::vector<std::string> join_names(const std::vector<std::string>& names,
                                    const std::vector<std::string>& below) {
  std::vector<std::string> joined;
  std::string group;
  for (std::size_t i = 0; i < std::max(names.size(), below.size()); ++i) {
    const std::string name = i < names.size() ? names[i] : "";
    const std::string cell = i < below.size() ? below[i] : "";
    group = name.empty() ? group : name;
    const std::string& upper = cell.empty() ? name : group;
    if (upper.empty() || cell.empty()) {
      joined.push_back(upper + cell);
      continue;
    }
    // The unit goes to the end; one of the second line is nearer to the numbers.
    const std::string unit = read_name(upper, Role::kIgnored).unit_spelling;
    const std::size_t end = unit.empty() ? std::string::npos : upper.rfind(unit);
    const std::string_view words = std::string_view(upper).substr(0, end);
    const bool has_own = find_unit(cell).is_given() || as_decibel(cell).is_decibel ||
                         !read_name(cell, Role::kIgnored).unit_spelling.empty();
    joined.push_back(std::string(words) + " " + cell +
                     (has_own || end == std::string::npos ? "" : " " + unit));
  }
  return joined;
}

namespace {

// A number of the form 2, 2.0 or 2,00 at the beginning of a text.
struct SmallNumber {
  double value = 0.0;
  std::size_t length = 0;
};

SmallNumber small_number(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_sign = (text[i] == '.' || text[i] == ',') && i > 0 && i + 1 < text.size() &&
                         is_digit(text[i + 1]) && plain.find('.') == std::string::npos;
    if (!is_digit(text[i]) && !is_sign) {
      break;
    }
    plain += is_sign ? '.' : text[i];
  }
  const ParsedNumber parsed = parse_decimal(Span<const char>(plain.data(), plain.size()));
  return parsed.status == Status::kOk ? SmallNumber{parsed.value, plain.size()} : SmallNumber{};
}

std::size_t skip_blanks(std::string_view text, std::size_t at) noexcept {
  while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) {
    ++at;
  }
  return at;
}

bool is_letter_of_word(char c) noexcept { return is_part_of_word(c) && !is_digit(c) && c != '%'; }

// At a small k that is a word: "k = 2", "k=2,00"; "k2" and "k 2" where `is_uncertainty`.
CoverageFactor coverage_at_k(std::string_view text, std::size_t at, bool is_uncertainty) {
  std::size_t next = skip_blanks(text, at + 1);
  const bool has_sign = next < text.size() && (text[next] == '=' || text[next] == ':');
  next = has_sign ? skip_blanks(text, next + 1) : next;
  const SmallNumber number = small_number(text.substr(std::min(next, text.size())));
  const std::size_t end = next + number.length;
  const bool is_whole = end >= text.size() || !is_letter_of_word(text[end]);
  if (number.length == 0 || !is_whole || !(has_sign || is_uncertainty)) {
    return {};
  }
  return {number.value, at, end - at};
}

// "2 sigma", and the level that two of them stand for, "95 %".
CoverageFactor coverage_by_words(std::string_view text, std::size_t at, bool is_uncertainty) {
  constexpr double kTwoSigmaPercent = 95.0;
  const SmallNumber number = small_number(text.substr(at));
  std::size_t next = skip_blanks(text, at + number.length);
  next += next < text.size() && text[next] == '-' ? 1U : 0U;
  for (const std::string_view word : {"sigma", "Sigma", "\xCF\x83"}) {
    if (text.substr(std::min(next, text.size()), word.size()) == word) {
      return {number.value, at, next + word.size() - at};
    }
  }
  const bool is_percent = next < text.size() && text[next] == '%';
  if (is_uncertainty && is_percent && number.value >= kTwoSigmaPercent &&
      number.value < kTwoSigmaPercent + 1.0) {
    return {2.0, at, next + 1 - at};
  }
  return {};
}

}  // namespace

CoverageFactor find_coverage(std::string_view text, bool is_uncertainty) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool begins = at == 0 || !is_part_of_word(text[at - 1]);
    CoverageFactor found;
    if (begins && text[at] == 'k') {
      found = coverage_at_k(text, at, is_uncertainty);
    } else if (begins && is_digit(text[at])) {
      found = coverage_by_words(text, at, is_uncertainty);
    }
    if (found.value > 0.0) {
      return found;
    }
  }
  return {};
}

std::size_t column_of(const std::vector<Column>& columns, Role role) noexcept {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [role](const Column& column) { return column.role == role; });
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace emax::desk
