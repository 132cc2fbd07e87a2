// A comparison as JSON.
#include "desk/compare/comparison_json.hpp"

#include <cstddef>

#include "emax/app/base/json_writer.hpp"
#include "emax/app/base/version.hpp"

#include "desk/compare/comparison_words.hpp"
#include "desk/compare/figure_text.hpp"

namespace emax::desk {

namespace {

using app::JsonWriter;

void write_optional(const char* name, bool exists, double value, JsonWriter& json) {
  if (exists) {
    json.number(name, value);
  } else {
    json.null(name);
  }
}

void write_ranked(const Figure& figure, JsonWriter& json) {
  json.number("value", figure.value);
  write_optional("u", figure.has_uncertainty, figure.u, json);
  write_optional("U", figure.has_uncertainty, figure.expanded, json);
  if (figure.has_interval) {
    json.pair("interval", figure.low, figure.high);
  } else {
    json.null("interval");
  }
  if (figure.has_range) {
    json.pair("range", figure.low, figure.high);
  } else {
    json.null("range");
  }
  write_optional("bound", figure.has_bound, figure.bound, json);
}

void write_figures(const Result& result, JsonWriter& json) {
  const Figure& matched = result.figure(FigureKind::kMatched);
  const Figure& band = result.figure(FigureKind::kBand);
  write_optional("matched_percent", matched.exists, matched.value, json);
  if (matched.exists) {
    json.words("delay_mode", result.delay.mode.c_str());
  } else {
    json.null("delay_mode");
  }
  write_optional("delay_s", matched.exists, result.delay.time_s, json);
  write_optional("epsilon_percent", matched.exists, matched.epsilon, json);
  write_optional("band_percent", band.exists, band.value, json);
  // Null for an energy difference below 0.
  json.number("rms_percent", result.rms_percent());
  write_optional("ideal_percent", result.has_ideal, result.ideal_percent, json);
  json.number("E", result.figure(FigureKind::kEnergy).value);
  json.number("rms", result.rms_v());
  json.number("S", result.sensitivity);
  json.number("a", result.limit_mps2);
}

void write_device(const Comparison& comparison, std::size_t index, JsonWriter& json) {
  const Result& result = comparison.results[index];
  json.open(nullptr);
  json.integer("rank_best", comparison.ranks[index].best);
  json.integer("rank_worst", comparison.ranks[index].worst);
  json.words("device", result.device.c_str());
  json.words("serial", result.serial.c_str());
  json.boolean("fit_warns", result.fit_warns);
  json.boolean("simulated", result.is_simulated);
  json.boolean("damping_open", result.has_open_damping);
  write_ranked(comparison.figure(result), json);
  write_figures(result, json);
  json.words("file", result.path.c_str());
  json.close();
}

void write_conditions(const Comparison& comparison, JsonWriter& json) {
  const Result& first = comparison.results.front();
  json.open("conditions");
  json.number("order", first.order);
  json.number("cutoff", first.cutoff_hz);
  json.words("gain_mode", first.gain_mode.c_str());
  write_optional("gain", first.gain_mode == "fixed", first.gain, json);
  json.number("T", first.duration_s);
  json.words("criterion", first.criterion.c_str());
  json.words("method", first.method.c_str());
  const double probability = probability_of(comparison);
  write_optional("probability", probability > 0.0, probability, json);
  json.close();
}

void write_pair(const Comparison& comparison, std::size_t index, JsonWriter& json) {
  const Pair& pair = comparison.pairs[index];
  json.open(nullptr);
  json.number("difference", pair.difference);
  write_optional("U", pair.has_uncertainty && !pair.has_range, pair.expanded, json);
  if (pair.has_uncertainty) {
    json.pair("interval", pair.low, pair.high);
  } else {
    json.null("interval");
  }
  json.number("epsilon", pair.epsilon);
  json.boolean("compared", pair.is_compared);
  json.boolean("told_apart", pair.told_apart);
  json.boolean("proven", pair.proven);
  if (pair.is_compared) {
    json.null("not_compared");
  } else {
    json.words("not_compared", verdict_of(comparison, index).words.c_str());
  }
  json.close();
}

}  // namespace

void write_comparison_json(const Comparison& comparison, app::TextWriter& out) {
  JsonWriter json(out);
  json.open(nullptr);
  json.words("version", app::kVersion);
  json.words("asked_by", figure_words(comparison.asked).option);
  json.words("ranked_by", figure_words(comparison.by).option);
  write_conditions(comparison, json);
  json.open("devices", '[');
  for (std::size_t i = 0; i < comparison.results.size(); ++i) {
    write_device(comparison, i, json);
  }
  json.close(']');
  json.open("pairs", '[');
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    write_pair(comparison, i, json);
  }
  json.close(']');
  json.close();
  out.line();
}

}  // namespace emax::desk
