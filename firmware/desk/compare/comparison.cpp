// Devices side by side: the order that their uncertainties carry.
#include "desk/compare/comparison.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "emax/base/elementary.hpp"

#include "desk/cli/console.hpp"

namespace emax::desk {

namespace {

struct NumberCondition {
  double Result::*member;
  const char* name;
  const char* unit;
  const char* option;
};

constexpr NumberCondition kNumbers[] = {
    {&Result::order, "filter order", "", "--order"},
    {&Result::cutoff_hz, "cut-off", " Hz", "--cutoff"},
    {&Result::duration_s, "T", " s", "--time"},
};

constexpr NumberCondition kLimit = {&Result::limit_mps2, "a", " m/s^2", "--limit"};

constexpr NumberCondition kGain = {&Result::gain, "gain", " V/(m/s^2)", "--gain"};
constexpr NumberCondition kProbability = {&Result::probability, "probability", "", "--probability"};

struct WordCondition {
  std::string Result::*member;
  const char* name;
  const char* option;
};

constexpr WordCondition kWordConditions[] = {
    {&Result::criterion, "criterion", "--criterion"},
    {&Result::method, "method", "--method"},
    {&Result::gain_mode, "gain", "--gain"},
};

std::string in_digits(double value, int digits = 10) {
  StringSink sink;
  app::TextWriter(sink).general(value, digits);
  return sink.text();
}

Problem differ(const Result& result, const Result& first, const char* name,
               const std::string& value, const std::string& first_value, const char* option) {
  return bad_input(result.file + ": " + name + " is " + printable(value) + ", and " +
                   printable(first_value) + " in " + first.file +
                   "; expected the same conditions: run emax report with one " + option +
                   " for all");
}

Problem check(const NumberCondition& number, const Result& result, const Result& first) {
  const double value = result.*number.member;
  const double first_value = first.*number.member;
  if (value == first_value) {
    return {};
  }
  constexpr int kDigits = 10;
  constexpr int kAllDigits = 17;
  const bool is_hidden = in_digits(value, kDigits) == in_digits(first_value, kDigits);
  const int digits = is_hidden ? kAllDigits : kDigits;
  return differ(result, first, number.name, in_digits(value, digits) + number.unit,
                in_digits(first_value, digits) + number.unit, number.option);
}

std::string words_of(const Delay& delay) {
  return delay.mode == "given" ? in_digits(delay.time_s) + " s" : delay.mode;
}

Problem check_delay(const Result& result, const Result& first, FigureKind by) {
  const bool is_energy = by == FigureKind::kEnergy;
  const Delay& delay = is_energy ? result.energy_delay : result.delay;
  const Delay& first_delay = is_energy ? first.energy_delay : first.delay;
  return delay.is_like(first_delay) ? Problem{}
                                    : differ(result, first, "the delay taken out", words_of(delay),
                                             words_of(first_delay), "--reference-delay");
}

Problem check_conditions(const Result& result, const Result& first, FigureKind by) {
  for (const WordCondition& word : kWordConditions) {
    if (result.*word.member != first.*word.member) {
      return differ(result, first, word.name, result.*word.member, first.*word.member, word.option);
    }
  }
  for (const NumberCondition& number : kNumbers) {
    if (Problem problem = check(number, result, first)) {
      return problem;
    }
  }
  if (first.gain_mode == "fixed") {
    if (Problem problem = check(kGain, result, first)) {
      return problem;
    }
  }
  if (by == FigureKind::kBand) {
    return {};
  }
  if (Problem problem = check_delay(result, first, by)) {
    return problem;
  }
  return by == FigureKind::kEnergy ? check(kLimit, result, first) : Problem{};
}

// Without an interval there is no probability to differ.
Problem check_probability(const Result& result, const std::vector<Result>& all, FigureKind by) {
  const auto first = std::find_if(
      all.begin(), all.end(), [by](const Result& other) { return other.figure(by).has_interval; });
  return first != all.end() && result.figure(by).has_interval ? check(kProbability, result, *first)
                                                              : Problem{};
}

Problem check_band(const Result& result) {
  if (result.figure(FigureKind::kBand).exists) {
    return {};
  }
  if (!result.band_refused.empty()) {
    return bad_input(result.file + ": holds no in-band figures, as its report says why: " +
                     printable(result.band_refused) + " Leave it out, or give --by energy");
  }
  return bad_input(result.file + ": holds no in-band figures, as emax report wrote it before it " +
                   "knew them; run emax report anew, or give --by energy");
}

bool all_have(const std::vector<Result>& results, FigureKind kind) noexcept {
  return std::all_of(results.begin(), results.end(),
                     [kind](const Result& result) { return result.figure(kind).exists; });
}

bool is_comparable(const Result& result) noexcept {
  return !result.fit_warns && !result.is_simulated;
}

Problem check_all(const std::vector<Result>& results, FigureKind asked, FigureKind by) {
  for (const Result& result : results) {
    if (asked != FigureKind::kEnergy) {
      if (Problem problem = check_band(result)) {
        return problem;
      }
    }
    if (Problem problem = check_conditions(result, results.front(), by)) {
      return problem;
    }
    if (Problem problem = check_probability(result, results, by)) {
      return problem;
    }
  }
  return {};
}

// How far a figure may be off to each side.
struct Reach {
  double down = 0.0;
  double up = 0.0;
};

Reach reach_of(const Result& result, FigureKind by) noexcept {
  const Figure& figure = result.figure(by);
  if (figure.has_range) {
    return {figure.value - figure.low, figure.high - figure.value};
  }
  if (!figure.is_one_sided) {
    return {figure.expanded, figure.expanded};
  }
  constexpr double kUsual = 0.95;
  const Reach reach = {figure.value - figure.low, figure.high - figure.value};
  // An interval of less than what k = 2 stands for tells nothing apart that U does not.
  return result.probability < kUsual
             ? Reach{std::max(reach.down, figure.expanded), std::max(reach.up, figure.expanded)}
             : reach;
}

double together(double one, double other, bool adds_up) noexcept {
  return adds_up ? one + other : sqrt(one * one + other * other);
}

bool has_ends(const Figure& figure) noexcept { return figure.has_uncertainty || figure.has_range; }

// Two devices of one name are told apart by their files.
void mark_namesakes(std::vector<Result>& results) {
  for (Result& result : results) {
    result.has_namesake = std::any_of(results.begin(), results.end(), [&](const Result& other) {
      return &other != &result && other.device == result.device && other.serial == result.serial;
    });
  }
}

void rank_all(Comparison& comparison) {
  const std::vector<Result>& results = comparison.results;
  const std::size_t count = results.size();
  comparison.ranks.assign(count, {1, count});
  comparison.pairs.clear();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const Pair pair = compare(results[i], results[j], comparison.by);
      if (pair.told_apart) {
        --comparison.ranks[i].worst;
        ++comparison.ranks[j].best;
      }
      if (j == i + 1) {
        comparison.pairs.push_back(pair);
      }
    }
  }
}

}  // namespace

bool is_marked(const Result& result) noexcept {
  return result.fit_warns || result.is_simulated || result.has_open_damping;
}

bool is_without_range(const Result& result, FigureKind by) noexcept {
  return result.has_open_damping && !result.figure(by).has_range;
}

bool is_told_from_none(const Result& result, FigureKind by) noexcept {
  return !is_comparable(result) || is_without_range(result, by);
}

double probability_of(const Comparison& comparison) noexcept {
  for (const Result& result : comparison.results) {
    if (comparison.figure(result).has_interval) {
      return result.probability;
    }
  }
  return 0.0;
}

Pair compare(const Result& first, const Result& second, FigureKind by) noexcept {
  const Figure& one = first.figure(by);
  const Figure& other = second.figure(by);
  Pair pair;
  pair.difference = other.value - one.value;
  pair.epsilon = one.epsilon + other.epsilon;
  pair.is_compared = is_comparable(first) && is_comparable(second);
  pair.has_open_damping = is_without_range(first, by) || is_without_range(second, by);
  pair.has_range = one.has_range || other.has_range;
  const bool may_differ = pair.is_compared && !pair.has_open_damping;
  pair.has_uncertainty = has_ends(one) && has_ends(other);
  if (pair.has_uncertainty) {
    pair.expanded = kCoverageFactor * sqrt(one.u * one.u + other.u * other.u);
    pair.is_one_sided = one.is_one_sided || other.is_one_sided;
    const Reach of_one = reach_of(first, by);
    const Reach of_other = reach_of(second, by);
    pair.low = pair.difference - together(of_one.up, of_other.down, pair.has_range);
    pair.high = pair.difference + together(of_one.down, of_other.up, pair.has_range);
    pair.told_apart = may_differ && pair.low > pair.epsilon;
  }
  // A bound is that of the estimates, and proves nothing of other dampings.
  pair.proven = may_differ && !pair.has_range && one.has_bound &&
                one.bound + one.epsilon < other.value - other.epsilon;
  return pair;
}

Problem compare_all(std::vector<Result> results, FigureKind asked, Comparison& comparison) {
  const bool needs_band = asked == FigureKind::kMatched && !all_have(results, FigureKind::kMatched);
  const FigureKind by = needs_band ? FigureKind::kBand : asked;
  if (Problem problem = check_all(results, asked, by)) {
    return problem;
  }
  mark_namesakes(results);
  std::stable_sort(results.begin(), results.end(), [by](const Result& one, const Result& other) {
    return one.figure(by).value < other.figure(by).value;
  });
  comparison.asked = asked;
  comparison.by = by;
  comparison.results = std::move(results);
  rank_all(comparison);
  return {};
}

}  // namespace emax::desk
