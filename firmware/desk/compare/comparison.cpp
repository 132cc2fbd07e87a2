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
    {&Result::limit_mps2, "a", " m/s^2", "--limit"},
    {&Result::duration_s, "T", " s", "--time"},
};

struct WordCondition {
  std::string Result::*member;
  const char* name;
  const char* option;
};

constexpr WordCondition kWords[] = {
    {&Result::criterion, "criterion", "--criterion"},
    {&Result::method, "method", "--method"},
    {&Result::gain_mode, "gain", "--gain"},
};

std::string in_digits(double value) {
  StringSink sink;
  app::TextWriter(sink).general(value, 10);
  return sink.text();
}

Problem differ(const Result& result, const Result& first, const char* name,
               const std::string& value, const std::string& first_value, const char* option) {
  return bad_input(result.file + ": " + name + " is " + printable(value) + ", and " +
                   printable(first_value) + " in " + first.file +
                   "; expected the same conditions: run emax report with one " + option +
                   " for all");
}

// Where there is no Monte Carlo run, there is no distribution or probability to differ.
Problem check_trials(const Result& result, const Result& first) {
  if (!result.has_uncertainty || !first.has_uncertainty) {
    return {};
  }
  if (result.distribution != first.distribution) {
    return differ(result, first, "distribution", result.distribution, first.distribution,
                  "--distribution");
  }
  return result.probability == first.probability
             ? Problem{}
             : differ(result, first, "probability", in_digits(result.probability),
                      in_digits(first.probability), "--probability");
}

Problem check_conditions(const Result& result, const Result& first) {
  for (const WordCondition& word : kWords) {
    if (result.*word.member != first.*word.member) {
      return differ(result, first, word.name, result.*word.member, first.*word.member, word.option);
    }
  }
  for (const NumberCondition& number : kNumbers) {
    if (result.*number.member != first.*number.member) {
      return differ(result, first, number.name, in_digits(result.*number.member) + number.unit,
                    in_digits(first.*number.member) + number.unit, number.option);
    }
  }
  if (result.gain_mode == "fixed" && result.gain != first.gain) {
    return differ(result, first, "gain", in_digits(result.gain) + " V/(m/s^2)",
                  in_digits(first.gain) + " V/(m/s^2)", "--gain");
  }
  return {};
}

}  // namespace

const Result& first_with_trials(const std::vector<Result>& results) noexcept {
  const auto found = std::find_if(results.begin(), results.end(),
                                  [](const Result& result) { return result.has_uncertainty; });
  return found != results.end() ? *found : results.front();
}

Pair compare(const Result& first, const Result& second) noexcept {
  Pair pair;
  pair.difference_v2s = second.energy_v2s - first.energy_v2s;
  pair.has_uncertainty = first.has_uncertainty && second.has_uncertainty;
  if (pair.has_uncertainty) {
    const double u1 = first.u_energy_v2s;
    const double u2 = second.u_energy_v2s;
    pair.expanded_v2s = kCoverageFactor * sqrt(u1 * u1 + u2 * u2);
    pair.told_apart = abs(pair.difference_v2s) > pair.expanded_v2s;
  }
  pair.proven = first.has_bound && first.bound_v2s < second.energy_v2s;
  return pair;
}

Problem compare_all(std::vector<Result> results, Comparison& comparison) {
  for (const Result& result : results) {
    if (Problem problem = check_conditions(result, results.front())) {
      return problem;
    }
    if (Problem problem = check_trials(result, first_with_trials(results))) {
      return problem;
    }
  }
  std::stable_sort(results.begin(), results.end(), [](const Result& one, const Result& other) {
    return one.energy_v2s < other.energy_v2s;
  });
  const std::size_t count = results.size();
  comparison.ranks.assign(count, {1, count});
  comparison.pairs.clear();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const Pair pair = compare(results[i], results[j]);
      if (pair.told_apart) {
        --comparison.ranks[i].worst;
        ++comparison.ranks[j].best;
      }
      if (j == i + 1) {
        comparison.pairs.push_back(pair);
      }
    }
  }
  comparison.results = std::move(results);
  return {};
}

}  // namespace emax::desk
