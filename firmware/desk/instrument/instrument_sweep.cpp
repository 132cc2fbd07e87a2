// The answer of FETCh:JSON? as the sweep that it was.
#include <algorithm>
#include <cmath>

#include "emax/app/settings/setting_field.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/json_reader.hpp"
#include "desk/instrument/instrument_client.hpp"

namespace emax::desk {

namespace {

using app::SettingField;
using app::SettingKind;
using app::SweepPoint;
using app::SweepResults;
using app::SweepSettings;

constexpr std::size_t kRowFields = 8;
constexpr std::size_t kBudgetFields = 8;

// The numbers of an array; none if it is no array of that many.
std::vector<double> numbers_in(const JsonValue& array, std::size_t count) {
  std::vector<double> numbers;
  for (const JsonValue& element : array.elements()) {
    if (!element.is_number()) {
      return {};
    }
    numbers.push_back(element.number());
  }
  return numbers.size() == count ? numbers : std::vector<double>{};
}

bool take_list(const SettingField& field, const JsonValue& value, SweepSettings& settings) {
  const std::size_t count = value.elements().size();
  const std::vector<double> numbers = numbers_in(value, count);
  if (count == 0 || count > field.last || numbers.empty()) {
    return false;
  }
  std::copy(numbers.begin(), numbers.end(), &app::member_at<double>(&settings, field.offset));
  if (field.kind == SettingKind::kNumbers) {
    app::member_at<std::size_t>(&settings, field.beside) = count;
  }
  return true;
}

bool take_setting(const SettingField& field, const JsonValue& value, SweepSettings& settings) {
  switch (field.kind) {
    case SettingKind::kNumbers:
    case SettingKind::kMoreNumbers:
      return take_list(field, value, settings);
    case SettingKind::kNumber:
      app::member_at<double>(&settings, field.offset) = value.number();
      return value.is_number();
    case SettingKind::kWhole:
      app::member_at<std::uint32_t>(&settings, field.offset) =
          static_cast<std::uint32_t>(value.number());
      return value.is_number() && value.number() >= 0.0 && value.number() <= 1e9;
    case SettingKind::kSwitch:
    case SettingKind::kChoice:
    case SettingKind::kNumberOrWord:
    case SettingKind::kWholes:
      break;
  }
  return true;
}

bool take_points(const JsonValue& json, SweepResults& sweep) {
  const std::vector<JsonValue>& points = json["points"].elements();
  const std::vector<JsonValue>& rows = json["sweep"]["rows"].elements();
  const std::vector<JsonValue>& budgets = json["bench"]["budget"].elements();
  if (points.size() > sweep.table.size() || rows.size() != points.size() ||
      budgets.size() != points.size()) {
    return false;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<double> row = numbers_in(rows[i], kRowFields);
    const std::vector<double> budget = numbers_in(budgets[i], kBudgetFields);
    if (row.empty() || budget.empty()) {
      return false;
    }
    SweepPoint& point = sweep.table[i];
    point.point = {points[i]["f_hz"].number(), points[i]["amplitude"].number(), row[0], row[1],
                   row[2]};
    point.budget = {budget[1], budget[2], budget[3], budget[4], budget[6]};
    point.acceleration_mps2 = row[3];
    point.drive_v = row[4];
    point.residual_percent = static_cast<float>(row[5]);
    point.flagged = row[6] != 0.0;
    point.scatters = row[7] != 0.0;
    if (validate(point.point) != Status::kOk) {
      return false;
    }
  }
  const JsonValue& shared = json["bench"]["shared"];
  sweep.shared = {shared["skew"].number(),      shared["clock"].number(),
                  shared["drift"].number(),     shared["corner"].number(),
                  shared["images"].number(),    shared["leak"].number(),
                  shared["leak_back"].number(), shared["linearity"].number()};
  sweep.point_count = points.size();
  return true;
}

bool take_silence(const JsonValue& channel, app::SilentChannel& silent) {
  const std::vector<double> numbers = numbers_in(channel, 3 + app::kHumLines);
  if (numbers.empty()) {
    return false;
  }
  silent.offset_v = numbers[0];
  silent.drift_v = numbers[1];
  silent.noise_v = numbers[2];
  std::copy(numbers.begin() + 3, numbers.end(), silent.hum_v.begin());
  return true;
}

bool take_rest(const JsonValue& json, SweepResults& sweep) {
  const JsonValue& exact = json["sweep"];
  const JsonValue& common = json["bench"]["common"];
  sweep.common = {common["reference"].number(), common["gain"].number(),
                  common["mounting"].number(), common["drift"].number(), common["total"].number()};
  const std::vector<double> check = numbers_in(exact["check"], 4);
  const std::vector<double> noise = numbers_in(exact["noise"], 3);
  const std::vector<JsonValue>& silence = exact["silence"].elements();
  if (!common["total"].is_number() || check.empty() || noise.empty() || silence.size() != 2 ||
      !take_silence(silence[0], sweep.inputs.silent_reference) ||
      !take_silence(silence[1], sweep.inputs.silent_device)) {
    return false;
  }
  sweep.check_before = {check[0], check[1]};
  sweep.check_after = {check[2], check[3]};
  sweep.noise = {noise[0], noise[1], static_cast<std::uint32_t>(noise[2])};
  sweep.failed_frequency_hz = json["bench"]["fault"]["frequency"].number();
  sweep.inputs.sample_rate_hz = json["bench"]["sample_rate"].number();
  const double status = exact["status"].number();
  const double stage = exact["stage"].number();
  if (!(status >= 0.0 && status <= 255.0) || !(stage >= 0.0) ||
      !(stage <= static_cast<double>(app::SweepStage::kFailed))) {
    return false;
  }
  sweep.status = static_cast<Status>(static_cast<int>(status));
  sweep.stage = static_cast<app::SweepStage>(static_cast<int>(stage));
  return sweep.done();
}

}  // namespace

std::string read_instrument_sweep(const std::string& json, InstrumentSweep& sweep) {
  JsonValue value;
  if (const JsonError error = parse_json(json, value); error.line != 0) {
    return "FETC:JSON? answers no JSON at line " + std::to_string(error.line) + ": " +
           error.problem;
  }
  sweep.results = {};
  for (const SettingField& field : fields_of(sweep.results.settings)) {
    if (!take_setting(field, value["sweep"]["settings"][field.name], sweep.results.settings)) {
      return std::string("FETC:JSON? does not tell the setting \"") + field.name +
             "\"; expected an emax of this version";
    }
  }
  if (!take_points(value, sweep.results) || !take_rest(value, sweep.results)) {
    return "FETC:JSON? tells no complete sweep; expected an emax of this version";
  }
  sweep.format.sample_rate_hz = value["bench"]["sample_rate"].number();
  const JsonValue& truth = value["bench"]["truth"];
  sweep.is_simulated = truth.is_object();
  sweep.simulated = {static_cast<std::uint64_t>(value["bench"]["seed"].number()),
                     {truth["S"].number(), truth["f0"].number(), truth["beta"].number()}};
  sweep.unstruck = printable(value["bench"]["unstruck"].text());
  return "";
}

}  // namespace emax::desk
