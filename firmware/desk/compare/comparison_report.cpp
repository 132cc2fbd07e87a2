// A comparison to read, as CSV and as JSON.
#include "desk/compare/comparison_report.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "emax/app/base/json_writer.hpp"
#include "emax/app/base/version.hpp"
#include "emax/base/elementary.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

// Of the columns whose width follows from what is in them.
struct Widths {
  std::size_t rank = 7;
  std::size_t name = 10;
};

constexpr std::size_t kNameShown = 36;
// What follows longer names of a pair starts a line of its own.
constexpr std::size_t kPairShown = 48;

// Not a number for an energy difference below 0.
double rms_v(const Result& result) noexcept { return sqrt(result.energy_v2s / result.duration_s); }

double rms_percent(const Result& result) noexcept {
  return 100.0 * rms_v(result) / (result.sensitivity * result.limit_mps2);
}

void write_conditions(const Result& first, TextWriter& out) {
  out.text("  Filter                    order ").general(first.order, 3).text(", cut-off ");
  out.general(first.cutoff_hz, 10).text(" Hz, gain ");
  if (first.gain_mode == "fixed") {
    out.general(first.gain, 10).text(" V/(m/s^2)\n");
  } else {
    out.text(first.gain_mode == "track" ? "each trial's S\n" : "each device's S\n");
  }
  out.text("  Signal                    within +-").general(first.limit_mps2, 10);
  out.text(" m/s^2 for ").general(1e3 * first.duration_s, 10).text(" ms\n");
  out.text("  Criterion                 ");
  out.text(first.criterion == "ise" ? "integral-square error" : "energy difference");
  out.text(first.method == "paper" ? ", the paper's method\n\n" : ", the best signal found\n\n");
}

// As much of a name as lines have room for.
std::string short_name_of(const Result& result) { return shortened(name_of(result), kNameShown); }

void write_row(const Result& result, const Rank& rank, const Widths& widths, TextWriter& out) {
  out.text("  ").left(widths.rank).text(text_of(rank).c_str());
  out.left(widths.name)
      .text(short_name_of(result).c_str())
      .right(17)
      .scientific(result.energy_v2s, 8);
  if (result.has_uncertainty) {
    out.right(11).scientific(result.u_energy_v2s, 2);
  } else {
    out.right(11).text("-");
  }
  if (result.energy_v2s >= 0.0) {
    out.right(9).fixed(rms_percent(result), 2);
  } else {
    out.right(9).text("-");
  }
  if (result.has_bound) {
    out.right(12).scientific(rounded_up(result.bound_v2s, 4), 4);
  } else {
    out.right(12).text("-");
  }
  if (result.has_uncertainty) {
    out.right(13).scientific(result.low_v2s, 5).text(" to ").scientific(result.high_v2s, 5);
  }
  out.line();
}

void write_pair(const Result& first, const Result& second, const Pair& pair, TextWriter& out) {
  const std::string names = short_name_of(first) + " and " + short_name_of(second);
  out.text("  ").text(names.c_str());
  if (!pair.has_uncertainty) {
    out.text(": CANNOT BE RANKED: no uncertainty of E is known for ");
    out.text(first.has_uncertainty || second.has_uncertainty ? "one of them" : "either");
    out.text(";\n    give u of S, f0 and beta, or measured points\n");
    return;
  }
  out.text(pair.told_apart ? ": told apart:" : ": CANNOT BE TOLD APART:");
  out.text(characters_in(names) > kPairShown ? "\n    " : " ");
  out.text("the difference is ").scientific(pair.difference_v2s, 3).text(" V^2 s (");
  out.general(100.0 * pair.difference_v2s / abs(first.energy_v2s), 3);
  out.text(" %),\n    its expanded uncertainty (k = 2) ").scientific(pair.expanded_v2s, 3);
  out.text(" V^2 s\n");
  if (pair.told_apart && pair.proven) {
    out.text("    and no signal of any shape can turn that round at the estimates: the upper\n");
    out.text("    bound of the first is below E of the second\n");
  }
}

// Whether two devices that can be told apart stand the other way round in percent.
bool differs_by_percent(const Comparison& comparison) {
  const std::vector<Result>& results = comparison.results;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (std::size_t j = i + 1; j < results.size(); ++j) {
      if (compare(results[i], results[j]).told_apart &&
          rms_percent(results[i]) > rms_percent(results[j])) {
        return true;
      }
    }
  }
  return false;
}

// Spreadsheets take a field that begins with one of these for a formula and run it; an apostrophe
// before it makes it text. Control characters become blanks.
std::string harmless(const std::string& text) {
  constexpr std::string_view kFormula = "=+-@";
  std::string field;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    field += byte < ' ' || byte == 0x7F ? ' ' : c;
  }
  const std::size_t first = field.find_first_not_of(' ');
  const bool is_formula =
      first != std::string::npos && kFormula.find(field[first]) != std::string_view::npos;
  return is_formula ? "'" + field : field;
}

// RFC 4180: quotes around all that might be more than a word.
void write_field(const std::string& words, TextWriter& out) {
  const std::string text = harmless(words);
  if (text.find_first_of("\",\r\n") == std::string::npos) {
    out.text(text.c_str());
    return;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  out.text((quoted + "\"").c_str());
}

void write_optional(bool exists, double value, TextWriter& out) {
  out.text(",");
  if (exists) {
    out.exact(value);
  }
}

void write_optional(const char* name, bool exists, double value, app::JsonWriter& json) {
  if (exists) {
    json.number(name, value);
  } else {
    json.null(name);
  }
}

void write_device(const Result& result, const Rank& rank, app::JsonWriter& json) {
  json.open(nullptr);
  json.integer("rank_best", rank.best);
  json.integer("rank_worst", rank.worst);
  json.words("device", result.device.c_str());
  json.words("serial", result.serial.c_str());
  json.number("E", result.energy_v2s);
  write_optional("u", result.has_uncertainty, result.u_energy_v2s, json);
  json.number("rms", rms_v(result));
  json.number("rms_percent", rms_percent(result));
  write_optional("bound", result.has_bound, result.bound_v2s, json);
  if (result.has_uncertainty) {
    json.pair("interval", result.low_v2s, result.high_v2s);
  } else {
    json.null("interval");
  }
  json.words("file", result.path.c_str());
  json.close();
}

}  // namespace

std::string name_of(const Result& result) {
  return printable(result.serial.empty() ? result.device : result.device + " " + result.serial);
}

std::string text_of(const Rank& rank) {
  const std::string best = std::to_string(rank.best);
  return rank.best == rank.worst ? best : best + "-" + std::to_string(rank.worst);
}

void write_comparison(const Comparison& comparison, TextWriter& out) {
  const Result& first = comparison.results.front();
  Widths widths;
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    widths.rank = std::max(widths.rank, text_of(comparison.ranks[i]).size() + 1);
    widths.name = std::max(widths.name, characters_in(short_name_of(comparison.results[i])) + 1);
  }
  out.text("COMPARISON OF ").integer(comparison.results.size());
  out.text(" DEVICES (emax ").text(app::kVersion).text(")\n");
  write_conditions(first, out);
  out.text("  ").left(widths.rank).text("rank").left(widths.name).text("device");
  out.right(17).text("E in V^2 s").right(11).text("u(E)").right(9).text("rms in %");
  out.right(12).text("bound").text("  interval");
  const Result& with_trials = first_with_trials(comparison.results);
  if (with_trials.has_uncertainty) {
    out.text(" (").general(100.0 * with_trials.probability, 6).text(" %)");
  }
  out.line();
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    write_row(comparison.results[i], comparison.ranks[i], widths, out);
  }
  out.text("  E: at the estimates; rms: sqrt(E/T) in percent of S a; bound: no signal has more\n");
  out.text(
      "  u(E): from the standard uncertainties of S, f0 and beta. A rank of 1-2 is first or\n");
  out.text("  second: the uncertainties do not say which.\n\nNEIGHBOURS\n");
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    write_pair(comparison.results[i], comparison.results[i + 1], comparison.pairs[i], out);
  }
  if (differs_by_percent(comparison)) {
    out.text(
        "\n  NOTE: by rms error in percent of S a the order is another one: the devices differ\n");
    out.text("  in S, and E grows with its square.\n");
  }
}

void write_comparison_csv(const Comparison& comparison, TextWriter& out) {
  out.text("rank_best,rank_worst,device,serial,E,u,rms,rms_percent,bound,low,high,file\n");
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    const Result& result = comparison.results[i];
    out.integer(comparison.ranks[i].best).text(",").integer(comparison.ranks[i].worst).text(",");
    write_field(result.device, out);
    out.text(",");
    write_field(result.serial, out);
    out.text(",").exact(result.energy_v2s);
    write_optional(result.has_uncertainty, result.u_energy_v2s, out);
    write_optional(result.energy_v2s >= 0.0, rms_v(result), out);
    write_optional(result.energy_v2s >= 0.0, rms_percent(result), out);
    write_optional(result.has_bound, result.bound_v2s, out);
    write_optional(result.has_uncertainty, result.low_v2s, out);
    write_optional(result.has_uncertainty, result.high_v2s, out);
    out.text(",");
    write_field(result.path, out);
    out.line();
  }
}

void write_comparison_json(const Comparison& comparison, TextWriter& out) {
  const Result& first = comparison.results.front();
  app::JsonWriter json(out);
  json.open(nullptr);
  json.words("version", app::kVersion);
  json.open("conditions");
  json.number("order", first.order);
  json.number("cutoff", first.cutoff_hz);
  json.words("gain_mode", first.gain_mode.c_str());
  write_optional("gain", first.gain_mode == "fixed", first.gain, json);
  json.number("a", first.limit_mps2);
  json.number("T", first.duration_s);
  json.words("criterion", first.criterion.c_str());
  json.words("method", first.method.c_str());
  const Result& with_trials = first_with_trials(comparison.results);
  write_optional("probability", with_trials.has_uncertainty, with_trials.probability, json);
  json.close();
  json.open("devices", '[');
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    write_device(comparison.results[i], comparison.ranks[i], json);
  }
  json.close(']');
  json.open("pairs", '[');
  for (const Pair& pair : comparison.pairs) {
    json.open(nullptr);
    json.number("difference", pair.difference_v2s);
    write_optional("expanded", pair.has_uncertainty, pair.expanded_v2s, json);
    json.boolean("told_apart", pair.told_apart);
    json.boolean("proven", pair.proven);
    json.close();
  }
  json.close(']');
  json.close();
  out.line();
}

}  // namespace emax::desk
