// What is said of a comparison.
#include "desk/compare/comparison_words.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/elementary.hpp"

#include "desk/cli/console.hpp"
#include "desk/compare/figure_text.hpp"
#include "desk/compare/name_lines.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

constexpr double kPercent = 100.0;

template <typename Write>
std::string text_by(const Write& write) {
  StringSink sink;
  TextWriter out(sink);
  write(out);
  return sink.text();
}

template <typename Has>
std::vector<const Result*> those_that(const Comparison& comparison, const Has& has) {
  std::vector<const Result*> found;
  for (const Result& result : comparison.results) {
    if (has(result)) {
      found.push_back(&result);
    }
  }
  return found;
}

std::vector<const Result*> simulated_of(const Comparison& comparison) {
  return those_that(comparison, [](const Result& result) { return result.is_simulated; });
}

bool has_one_limit(const Comparison& comparison) {
  const double limit = comparison.results.front().limit_mps2;
  return std::all_of(comparison.results.begin(), comparison.results.end(),
                     [limit](const Result& result) { return result.limit_mps2 == limit; });
}

std::string filter_of(const Result& first) {
  return text_by([&](TextWriter& out) {
    out.text("order ").general(first.order, 3).text(", cut-off ");
    out.general(first.cutoff_hz, 10).text(" Hz, gain ");
    if (first.gain_mode == "fixed") {
      out.general(first.gain, 10).text(" V/(m/s^2)");
    } else {
      out.text(first.gain_mode == "track" ? "each trial's S" : "each device's S");
    }
  });
}

std::string signal_of(const Comparison& comparison) {
  const Result& first = comparison.results.front();
  return text_by([&](TextWriter& out) {
    out.text("within +-");
    if (has_one_limit(comparison)) {
      out.general(first.limit_mps2, 10).text(" m/s^2");
    } else {
      out.text("a, each device's own,");
    }
    out.text(" for ").general(1e3 * first.duration_s, 10).text(" ms");
  });
}

// "the sensor's constant delay", or a number.
std::string delay_taken_of(const Delay& delay) {
  return delay.mode != "given" ? "the sensor's constant delay" : text_by([&](TextWriter& out) {
    out.text("a delay of ").general(1e6 * delay.time_s, 10).text(" us");
  });
}

// Of the matched figures; by their ranks they have one kind of delay.
std::string delay_of(const Comparison& comparison) {
  for (const Result& result : comparison.results) {
    if (result.figure(FigureKind::kMatched).exists) {
      return delay_taken_of(result.delay);
    }
  }
  return delay_taken_of({});
}

std::string words_of_rank(const Comparison& comparison) {
  const Result& first = comparison.results.front();
  switch (comparison.by) {
    case FigureKind::kMatched:
      return "in-band error with " + delay_of(comparison) + " taken out, worst rms in % of S a";
    case FigureKind::kBand:
      return "in-band error with the sensor's delay, worst rms in % of S a";
    case FigureKind::kEnergy:
      break;
  }
  return first.criterion == "ise" ? "energy of the paper's criterion"
                                  : "energy of the criterion, E";
}

// What sqrt(E/T) is called; in band it is one of the two figures.
std::string heading_of_rms(const Result& first) {
  if (first.criterion == "band") {
    return "";
  }
  return first.criterion == "difference" ? "sqrt(E/T) %" : "paper's %";
}

// Why devices have no matched figure, in the words of their reports.
std::string reason_of(const std::vector<const Result*>& refused) {
  const std::string& reason = refused.front()->matched_refused;
  const bool is_one = std::all_of(refused.begin(), refused.end(), [&](const Result* result) {
    return result->matched_refused == reason;
  });
  if (!is_one) {
    return " (their reports say why)";
  }
  return reason.empty() ? "" : " (" + printable(reason) + ")";
}

void add_note_on_refusals(const Comparison& comparison, std::vector<Note>& notes) {
  if (comparison.by == comparison.asked) {
    return;
  }
  const std::vector<const Result*> refused = those_that(
      comparison, [](const Result& result) { return !result.figure(FigureKind::kMatched).exists; });
  notes.push_back(
      {"All are ranked by the in-band error with the sensor's delay: there is no "
       "figure with the delay taken out for " +
           list_of(refused) + reason_of(refused) + ".",
       true});
}

// Where they do not rank the matched figures may be of different delays.
void add_note_on_delays(const Comparison& comparison, std::vector<Note>& notes) {
  const Result* first = nullptr;
  for (const Result& result : comparison.results) {
    if (!result.figure(FigureKind::kMatched).exists) {
      continue;
    }
    first = first == nullptr ? &result : first;
    if (!result.delay.is_like(first->delay)) {
      notes.push_back({std::string("The figures under \"") +
                           figure_words(FigureKind::kMatched).heading +
                           "\" cannot be compared: different delays were taken out, " +
                           delay_taken_of(first->delay) + " for " + list_of({first}) + " and " +
                           delay_taken_of(result.delay) + " for " + list_of({&result}) + ".",
                       true});
      return;
    }
  }
}

// As in a report, whose range is of E alone.
std::string ranges_of(const std::vector<const Result*>& open) {
  std::string words;
  for (const Result* result : open) {
    const Figure& energy = result->figure(FigureKind::kEnergy);
    if (energy.has_range && energy.low > 0.0) {
      words += text_by([&](TextWriter& out) {
        out.text("; over the range ")
            .text(result->criterion == "ise" ? "the paper's figure" : "sqrt(E/T)")
            .text(" of ");
        out.text(list_of({result}).c_str()).text(" is ");
        out.general(result->rms_percent(energy.low), 4).text(" to ");
        out.general(result->rms_percent(energy.high), 4).text(" % of S a");
      });
    }
  }
  return words;
}

constexpr const char* kFigureOfOpen =
    ". The figure is that of the estimate, or of the nearest damping that a device may have";

void add_notes_on_marks(const Comparison& comparison, std::vector<Note>& notes) {
  const std::vector<const Result*> warned =
      those_that(comparison, [](const Result& result) { return result.fit_warns; });
  if (!warned.empty()) {
    notes.push_back(
        {"Told apart from no other, because chi-square of the fit warns: " + list_of(warned) +
             ". The points do not follow the model within their uncertainties, so the "
             "figure and its U mean little.",
         true});
  }
  const FigureKind by = comparison.by;
  const std::vector<const Result*> open =
      those_that(comparison, [by](const Result& result) { return is_without_range(result, by); });
  if (!open.empty()) {
    notes.push_back({"Told apart from no other, because the points leave the damping open: " +
                         list_of(open) + kFigureOfOpen + ranges_of(open) + ".",
                     true});
  }
  const std::vector<const Result*> ranged =
      those_that(comparison, [by](const Result& result) { return result.figure(by).has_range; });
  if (!ranged.empty()) {
    notes.push_back({"The points leave the damping open: " + list_of(ranged) + kFigureOfOpen +
                         "; what tells it apart is its range over these dampings.",
                     true});
  }
  const std::vector<const Result*> simulated = simulated_of(comparison);
  if (!simulated.empty()) {
    notes.push_back({"Told apart from no other, because the bench was simulated: " +
                         list_of(simulated) + ". The figures say nothing about a real sensor.",
                     true});
  }
}

// What the reports warn of beside that, each once with the devices that it is about.
void add_notes_on_reports(const Comparison& comparison, std::vector<Note>& notes) {
  std::vector<std::string> said;
  for (const Result& result : comparison.results) {
    for (const std::string& words : result.other_warnings) {
      if (std::find(said.begin(), said.end(), words) != said.end()) {
        continue;
      }
      said.push_back(words);
      const std::vector<const Result*> warned = those_that(comparison, [&](const Result& other) {
        return std::find(other.other_warnings.begin(), other.other_warnings.end(), words) !=
               other.other_warnings.end();
      });
      notes.push_back(
          {"The report of " + list_of(warned) + " warns: " + printable(words) + ".", true});
    }
  }
}

// Whether two devices that can be told apart stand the other way round in percent.
bool differs_by_percent(const Comparison& comparison) {
  const std::vector<Result>& results = comparison.results;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (std::size_t j = i + 1; j < results.size(); ++j) {
      if (compare(results[i], results[j], comparison.by).told_apart &&
          results[i].rms_percent() > results[j].rms_percent()) {
        return true;
      }
    }
  }
  return false;
}

void add_notes_on_energy(const Comparison& comparison, std::vector<Note>& notes) {
  if (comparison.by != FigureKind::kEnergy) {
    return;
  }
  const std::vector<const Result*> of_box =
      those_that(comparison, [](const Result& result) { return result.energy_u_is_of_box; });
  if (!of_box.empty()) {
    notes.push_back(
        {"u(E) is that over the box of the trials times the root of 3, without the "
         "correlation of S, f0 and beta, for " +
             list_of(of_box) + ".",
         false});
  }
  if (differs_by_percent(comparison)) {
    notes.push_back(
        {"By the rms error in percent of S a the order is another one: the devices "
         "differ in S, and E grows with its square.",
         false});
  }
}

// The figures of an ideal sensor differ a little where the gain is fixed.
std::string ideal_of(const Comparison& comparison) {
  std::vector<double> all;
  for (const Result& result : comparison.results) {
    if (result.has_ideal) {
      all.push_back(result.ideal_percent);
    }
  }
  if (all.empty()) {
    return "";
  }
  std::sort(all.begin(), all.end());
  const std::string least = number_text(all.front(), 0.0, FigureKind::kBand);
  const std::string most = number_text(all.back(), 0.0, FigureKind::kBand);
  return "; an ideal sensor has " + (least == most ? least : least + " to " + most) + " %";
}

std::string reason_not_compared(const Result& first, const Result& second) {
  std::string reason;
  const auto add = [&reason](const std::string& words) {
    reason += reason.empty() ? words : "; " + words;
  };
  for (const Result* result : {&first, &second}) {
    const std::string name = short_name_of(*result);
    if (result->fit_warns) {
      add("chi-square of the fit of " + name + " warns");
    }
    if (result->is_simulated) {
      add("the bench of " + name + " was simulated");
    }
  }
  return reason;
}

constexpr const char* kGiveDamping =
    "; emax report --damping takes the damping that a maker states";

std::string open_damping_of(const Result& first, const Result& second, FigureKind by) {
  std::string words;
  for (const Result* result : {&first, &second}) {
    if (!is_without_range(*result, by)) {
      continue;
    }
    const Figure& energy = result->figure(FigureKind::kEnergy);
    words += (words.empty() ? "the points of " : "; those of ") + short_name_of(*result) +
             " leave its damping open";
    words += ", and no range of the figure that ranks is known";
    if (energy.has_range) {
      words += "; E from " + interval_text(energy, FigureKind::kEnergy) + " V^2 s";
    }
  }
  return words.empty() ? words : words + kGiveDamping;
}

// Where a figure is: over the dampings that its points leave open, or with its U.
std::string place_of(const Result& result, FigureKind by) {
  const Figure& figure = result.figure(by);
  const std::string name = short_name_of(result);
  const std::string unit = figure_words(by).unit;
  if (figure.has_range) {
    return name + " has " + interval_text(figure, by) + unit +
           " over the dampings that its points leave open";
  }
  if (figure.is_one_sided) {
    return name + " has " + interval_text(figure, by) + unit;
  }
  return name + " has " + value_text(figure, by) + unit + " with U = " + expanded_text(figure, by);
}

// Of two devices, where one or both have a range.
Fact verdict_by_range(const Result& first, const Result& second, const Pair& pair, FigureKind by) {
  const std::string places = place_of(first, by) + ", and " + place_of(second, by);
  return pair.told_apart ? Fact{"told apart", places}
                         : Fact{"CANNOT BE TOLD APART", places + kGiveDamping};
}

// Of a difference to the first of two figures.
std::string ratio_of(double ratio) {
  constexpr double kMostInPercent = 2.0;
  return text_by([&](TextWriter& out) {
    if (ratio > kMostInPercent) {
      out.text("a factor of ").general(1.0 + ratio, 3);
    } else {
      out.general(kPercent * ratio, 3).text(" % of the first");
    }
  });
}

std::string difference_of(const Comparison& comparison, const Result& first, const Pair& pair) {
  const FigureKind by = comparison.by;
  const char* unit = figure_words(by).unit;
  const double value = comparison.figure(first).value;
  if (is_rounding(pair.difference, value) && is_rounding(pair.expanded, value)) {
    return "the difference is 0 but for rounding";
  }
  return text_by([&](TextWriter& out) {
    out.text("the difference is ").text(number_text(pair.difference, pair.expanded, by).c_str());
    out.text(unit);
    if (value != 0.0) {
      out.text(" (").text(ratio_of(pair.difference / abs(value)).c_str()).text(")");
    }
    if (pair.is_one_sided) {
      const double reach = std::max(pair.difference - pair.low, pair.high - pair.difference);
      out.text(", its interval from ").text(number_text(pair.low, reach, by).c_str());
      out.text(" to ").text(number_text(pair.high, reach, by).c_str()).text(unit);
      return;
    }
    out.text(", its expanded uncertainty (k = 2) ");
    out.text(number_text(pair.expanded, pair.expanded, by).c_str()).text(unit);
  });
}

// Of the energy of the in-band error; else nothing.
std::string delay_of_energy(const Result& result) {
  if (result.criterion != "band") {
    return "";
  }
  return result.energy_delay.mode == "none"
             ? " with the sensor's delay"
             : " with " + delay_taken_of(result.energy_delay) + " taken out";
}

std::string heading_of_expanded(FigureKind by) {
  return by == FigureKind::kEnergy ? "U(E)" : "U(" + std::string(figure_words(by).option) + ")";
}

std::vector<std::string> headings_of(const Comparison& comparison, bool has_marks) {
  std::vector<std::string> headings = {"rank", "device"};
  if (has_marks) {
    headings.emplace_back("mark");
  }
  headings.emplace_back(figure_words(FigureKind::kMatched).heading);
  headings.emplace_back(figure_words(FigureKind::kBand).heading);
  const std::string rms = heading_of_rms(comparison.results.front());
  if (!rms.empty()) {
    headings.push_back(rms);
  }
  if (comparison.by == FigureKind::kEnergy) {
    headings.emplace_back(figure_words(comparison.by).heading);
  }
  headings.push_back(heading_of_expanded(comparison.by));
  const double probability = probability_of(comparison);
  headings.push_back(probability > 0.0 ? text_by([&](TextWriter& out) {
    out.text("interval (").general(kPercent * probability, 6).text(" %)");
  })
                                       : "interval");
  headings.emplace_back("bound");
  return headings;
}

std::vector<std::string> row_of(const Comparison& comparison, std::size_t index, bool has_marks) {
  const Result& result = comparison.results[index];
  const Figure& ranked = comparison.figure(result);
  std::vector<std::string> row = {text_of(comparison.ranks[index]), name_of(result)};
  if (has_marks) {
    row.push_back(mark_of(result));
  }
  for (const FigureKind kind : {FigureKind::kMatched, FigureKind::kBand}) {
    row.push_back(value_text(result.figure(kind), kind));
  }
  if (!heading_of_rms(result).empty()) {
    row.push_back(paper_text(result));
  }
  if (comparison.by == FigureKind::kEnergy) {
    row.push_back(value_text(ranked, comparison.by));
  }
  row.push_back(expanded_text(ranked, comparison.by));
  row.push_back(interval_text(ranked, comparison.by));
  row.push_back(bound_text(ranked, comparison.by));
  return row;
}

// Where the interval of a figure stands in the place of its U, and what it is mostly made of.
std::string words_on_one_side(const Comparison& comparison) {
  const bool any =
      std::any_of(comparison.results.begin(), comparison.results.end(),
                  [&](const Result& result) { return comparison.figure(result).is_one_sided; });
  if (!any) {
    return "";
  }
  return std::string(" Where there is no U, U says too little: it is above the figure, or the ") +
         "interval reaches farther to one side. The interval decides there." +
         (comparison.by == FigureKind::kMatched
              ? " The delay taken out stays that of the estimate: what the sensor's own differs by "
                "counts as error."
              : "");
}

bool has_marks(const Comparison& comparison) {
  return std::any_of(comparison.results.begin(), comparison.results.end(), is_marked);
}

bool shares_ranks(const Comparison& comparison) {
  return std::any_of(comparison.ranks.begin(), comparison.ranks.end(),
                     [](const Rank& rank) { return rank.best != rank.worst; });
}

std::string if_gain_of(const Result& result) {
  return result.gain_mode == "fixed" ? " if its S is the filter's gain" : "";
}

// Of U, interval and bound: of those that there are.
Fact legend_of_uncertainty(const Comparison& comparison) {
  const std::size_t count = comparison.results.size();
  const std::size_t without = those_that(comparison, [&](const Result& result) {
                                const Figure& figure = comparison.figure(result);
                                return !figure.has_uncertainty && !figure.has_range;
                              }).size();
  const std::string bound = "At the estimates no signal has more than the bound.";
  if (without == count) {
    return {heading_of_expanded(comparison.by) + ", interval",
            "none, as no report has an uncertainty of the figure that ranks. " + bound};
  }
  return {heading_of_expanded(comparison.by),
          std::string("expanded uncertainty (k = 2) of the figure that ranks, from those of S, ") +
              "f0 and beta; interval and bound are of that figure, too. " + bound +
              words_on_one_side(comparison) +
              (without > 0 ? " Without both: its report has no uncertainty of that figure." : "")};
}

}  // namespace

std::string text_of(const Rank& rank) {
  const std::string best = std::to_string(rank.best);
  return rank.best == rank.worst ? best : best + "-" + std::to_string(rank.worst);
}

std::string mark_of(const Result& result) {
  std::string mark;
  const auto add = [&mark](bool is_due, const char* word) {
    if (is_due) {
      mark += mark.empty() ? word : std::string(" ") + word;
    }
  };
  add(result.fit_warns, "fit");
  add(result.has_open_damping, "beta");
  add(result.is_simulated, "sim");
  return mark;
}

std::string criterion_of(const Comparison& comparison) {
  const Result& first = comparison.results.front();
  const bool has_one_delay = std::all_of(
      comparison.results.begin(), comparison.results.end(),
      [&](const Result& other) { return other.energy_delay.is_like(first.energy_delay); });
  return has_one_delay ? criterion_of(first)
                       : "in-band error, for some with a delay taken out and for some without";
}

std::string criterion_of(const Result& result) {
  constexpr std::pair<std::string_view, const char*> kWords[] = {
      {"ise", "integral-square error"},
      {"difference", "energy difference"},
      {"band", "in-band error"},
  };
  for (const auto& words : kWords) {
    if (result.criterion == words.first) {
      return words.second + delay_of_energy(result);
    }
  }
  return printable(result.criterion);
}

std::string banner_of(const Comparison& comparison) {
  const std::size_t count = simulated_of(comparison).size();
  if (count == 0) {
    return "";
  }
  return "SIMULATION: " + (count == comparison.results.size() ? std::string("no") : "not every") +
         " result was measured on a real bench";
}

std::vector<Fact> conditions_of(const Comparison& comparison) {
  const Result& first = comparison.results.front();
  return {{"Filter", filter_of(first)},
          {"Signal", signal_of(comparison)},
          {"Criterion",
           criterion_of(comparison) +
               (first.method == "paper" ? ", the paper's method" : ", the best signal found")},
          {"Ranked by", words_of_rank(comparison)}};
}

ComparisonTable table_of(const Comparison& comparison) {
  ComparisonTable table;
  const bool marks = has_marks(comparison);
  table.names = 1;
  table.headings = headings_of(comparison, marks);
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    table.rows.push_back(row_of(comparison, i, marks));
  }
  return table;
}

std::vector<Fact> legend_of(const Comparison& comparison) {
  const Result& first = comparison.results.front();
  const bool is_given = first.delay.mode == "given";
  std::vector<Fact> legend;
  if (shares_ranks(comparison)) {
    legend.push_back({"rank", "1-2 is first or second: the uncertainties do not say which."});
  }
  legend.push_back({figure_words(FigureKind::kMatched).heading,
                    "the largest rms error within the filter's band, " + delay_of(comparison) +
                        " taken out, in percent of S a." +
                        (is_given ? "" : " An ideal sensor has 0" + if_gain_of(first) + ".")});
  legend.push_back(
      {figure_words(FigureKind::kBand).heading,
       "the same with the sensor's delay." +
           (is_given ? " An ideal sensor has 0 there" + if_gain_of(first) + "." : std::string())});
  if (first.criterion == "difference") {
    legend.push_back({heading_of_rms(first),
                      "root of the largest energy difference over T, in "
                      "percent of S a" +
                          ideal_of(comparison) + "."});
  } else if (first.criterion != "band") {
    legend.push_back({heading_of_rms(first),
                      "rms error, sqrt(E/T) in percent of S a; mostly the delay of the filter and "
                      "what it keeps out" +
                          ideal_of(comparison) + "."});
  }
  legend.push_back(legend_of_uncertainty(comparison));
  if (has_marks(comparison)) {
    legend.push_back({"mark",
                      "fit: chi-square of the fit warns; sim: the bench was simulated. Such a "
                      "device shares the rank of its neighbours, whatever its numbers. beta: its "
                      "points leave the damping open. The interval is then the range of its figure "
                      "over these dampings, and nothing in it is more likely than the rest; "
                      "without a range it shares the rank of its neighbours, too."});
  }
  return legend;
}

std::vector<Note> notes_of(const Comparison& comparison) {
  std::vector<Note> notes;
  add_note_on_refusals(comparison, notes);
  add_note_on_delays(comparison, notes);
  add_notes_on_marks(comparison, notes);
  add_notes_on_reports(comparison, notes);
  add_notes_on_energy(comparison, notes);
  return notes;
}

Fact verdict_of(const Comparison& comparison, std::size_t index) {
  const Result& first = comparison.results[index];
  const Result& second = comparison.results[index + 1];
  const Pair& pair = comparison.pairs[index];
  if (!pair.is_compared) {
    return {"CANNOT BE TOLD APART", reason_not_compared(first, second)};
  }
  if (pair.has_open_damping) {
    return {"CANNOT BE TOLD APART", open_damping_of(first, second, comparison.by)};
  }
  if (!pair.has_uncertainty) {
    const bool has_one =
        comparison.figure(first).has_uncertainty || comparison.figure(second).has_uncertainty;
    return {"CANNOT BE RANKED", std::string("no uncertainty is known for ") +
                                    (has_one ? "one of them" : "either") +
                                    "; give u of S, f0 and beta, or measured points"};
  }
  if (pair.has_range) {
    return verdict_by_range(first, second, pair, comparison.by);
  }
  const std::string difference = difference_of(comparison, first, pair);
  if (!pair.told_apart) {
    return {"CANNOT BE TOLD APART", difference};
  }
  return {"told apart",
          difference + (pair.proven ? "; at the estimates it is proven for signals of any shape: "
                                      "the upper bound of the first is below the figure of the "
                                      "second"
                                    : "")};
}

}  // namespace emax::desk
