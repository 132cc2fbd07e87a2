// What the names and units above the columns of a table say.
#include "desk/import/table_header.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace emax::desk {

namespace {

constexpr std::string_view kFrequencyWords[] = {
    "f", "freq", "frequency", "frequenz", "fr\xC3\xA9quence", "frequence", "frecuencia"};
constexpr std::string_view kOmegaWords[] = {"omega", "w", "\xCF\x89", "kreisfrequenz"};
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
                                                "\303\274bertragungskoeffizient",
                                                "response",
                                                "sensibilit\xC3\xA9"};
constexpr std::string_view kPhaseWords[] = {
    "phase",  "phi",          "\xCF\x86",   "\xCF\x95",           "angle",
    "winkel", "phasenwinkel", "phasenlage", "phasenverschiebung", "phasengang"};
constexpr std::string_view kUncertaintyWords[] = {
    "u", "unc", "uncert", "uncertainty", "unsicherheit", "messunsicherheit", "incertitude"};
constexpr std::string_view kFillers[] = {"of",    "the",      "in",       "der",      "des",
                                         "abs",   "rel",      "relative", "expanded", "erweiterte",
                                         "shift", "response", "value",    "measured"};
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
  const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  return is_letter || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80 || c == '%';
}

struct Word {
  std::string text;       // In small letters.
  std::size_t begin = 0;  // In the cell.
};

std::vector<Word> words_of(const std::string& cell) {
  std::vector<Word> words;
  for (std::size_t at = 0; at < cell.size(); ++at) {
    if (!is_part_of_word(cell[at])) {
      continue;
    }
    if (at == 0 || !is_part_of_word(cell[at - 1])) {
      words.push_back({"", at});
    }
    const char c = cell[at];
    words.back().text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return words;
}

Role main_role(std::string_view word, Column& column) {
  if (is_one_of(word, kFrequencyWords)) {
    return Role::kFrequency;
  }
  if (is_one_of(word, kOmegaWords)) {
    column.is_omega = true;
    return Role::kFrequency;
  }
  if (is_one_of(word, kAmplitudeWords)) {
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
    if (is_uncertainty_ && (word == "k" || word == "2" || word == "1") && !is_first_) {
      column_.is_standard = column_.is_standard || word == "1";
      return true;
    }
    if (take_role(word)) {
      is_first_ = false;
      return true;
    }
    if (word == "standard" || word == "std") {
      is_standard_ = true;
      return true;
    }
    if (word == "lag" && role_ == Role::kPhase) {
      column_.is_lag = true;
      return true;
    }
    return is_one_of(word, kFillers);
  }

  /// Says what the words have made of the column; a word alone such as "standard" makes nothing.
  void finish(Role before) {
    column_.is_standard = is_uncertainty_ && (is_standard_ || column_.is_standard);
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
      return true;
    }
    if (role_ != Role::kIgnored) {
      return false;
    }
    role_ = main_role(word, column_);
    if (role_ == Role::kIgnored && word.size() > 1 && word.front() == 'u') {
      role_ = main_role(std::string_view(word).substr(1), column_);  // "uA", "uphi".
      is_uncertainty_ = is_uncertainty_ || role_ != Role::kIgnored;
    }
    return role_ != Role::kIgnored;
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
  Role role_ = Role::kIgnored;
  bool is_uncertainty_ = false;
  bool is_standard_ = false;
  bool is_first_ = true;
};

Column read_name(const std::string& cell, Role before) {
  Column column;
  column.name = cell;
  while (!column.name.empty() && (column.name.back() == ',' || column.name.back() == ':')) {
    column.name.pop_back();
  }
  const std::vector<Word> words = words_of(column.name);
  for (const Word& word : words) {
    if (is_one_of(word.text, kOtherWords)) {
      return column;
    }
  }
  NameReader reader(column);
  for (const Word& word : words) {
    if (!reader.take(word.text)) {
      column.unit_spelling = column.name.substr(word.begin);
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

// An uncertainty that does not say of what is not that of which there is a column by name.
void settle_assumptions(std::vector<Column>& columns) {
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

bool is_unit_row(const std::vector<std::string>& cells) {
  std::size_t units = 0;
  for (const std::string& cell : cells) {
    // Columns that are not ours may be in any unit, so the first must be one of ours.
    const bool is_unit = find_unit(cell).is_given() || as_decibel(cell).is_decibel;
    if (&cell == &cells.front() && !is_unit) {
      return false;
    }
    units += is_unit ? 1U : 0U;
  }
  return units >= 2;
}

std::size_t column_of(const std::vector<Column>& columns, Role role) noexcept {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [role](const Column& column) { return column.role == role; });
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace emax::desk
