// One line of CSV text to one point, and words for everything that can be wrong with it.
#include "emax/app/points/points_reader.hpp"

#include "emax/base/capacity.hpp"
#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/status.hpp"
#include "emax/base/units.hpp"

namespace emax::app {
namespace {

constexpr std::size_t kColumns = 5;
// The header of frequency_response.csv from the sixth column on, in small letters; each may be
// missing.
constexpr const char* kMoreColumns[] = {"model_amplitude", "model_phase_deg", "residual_re",
                                        "residual_im",     "u_common",        "level_mps2"};
constexpr double kCoverageFactor = 2.0;
constexpr double kMaxPhase_deg = 360.0;

constexpr char kExpectedColumns[] =
    "expected five numbers separated by commas: f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg";
constexpr char kExpectedColumnsOfHeader[] = "expected as many columns as the header has";
constexpr char kExpectedCommas[] =
    "expected numbers separated by commas, with a point as decimal sign: "
    "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg";
constexpr char kExpectedNumber[] = "expected a number such as 1.03 or 4e3";
constexpr char kExpectedPoints[] = "expected 3 to " EMAX_TEXT_OF(EMAX_MAX_POINTS) " points";
constexpr char kExpectedText[] = "expected lines of text with five numbers separated by commas";

constexpr const char* kFound[] = {
    "there are 0 columns",           "there is 1 column",   "there are 2 columns",
    "there are 3 columns",           "there are 4 columns", "there are 5 columns",
    "there are 6 columns",           "there are 7 columns", "there are 8 columns",
    "there are more than 8 columns",
};
constexpr std::size_t kMostNamed = sizeof kFound / sizeof kFound[0] - 1;

constexpr const char* kMissing[kColumns] = {"f_hz is missing", "amplitude is missing",
                                            "phase_deg is missing", "u_amplitude is missing",
                                            "u_phase_deg is missing"};
constexpr const char* kNotNumber[kColumns] = {
    "f_hz is not a number", "amplitude is not a number", "phase_deg is not a number",
    "u_amplitude is not a number", "u_phase_deg is not a number"};
constexpr const char* kNotFinite[kColumns] = {
    "f_hz is not a finite number", "amplitude is not a finite number",
    "phase_deg is not a finite number", "u_amplitude is not a finite number",
    "u_phase_deg is not a finite number"};
// The phase has no such limit.
constexpr const char* kNotPositive[kColumns] = {
    "f_hz is zero or negative", "amplitude is zero or negative", nullptr,
    "u_amplitude is zero or negative", "u_phase_deg is zero or negative"};
constexpr const char* kExpectedPositive[kColumns] = {
    "expected a frequency above 0 Hz", "expected an amplitude above 0 V/(m/s^2)", nullptr,
    "expected an expanded uncertainty (k = 2) above 0 V/(m/s^2)",
    "expected an expanded uncertainty (k = 2) above 0 degrees"};

constexpr bool is_blank(char character) noexcept { return character == ' ' || character == '\t'; }

constexpr char lower(char character) noexcept {
  return character >= 'A' && character <= 'Z' ? static_cast<char>(character - 'A' + 'a')
                                              : character;
}

constexpr bool is_letter(char character) noexcept {
  return lower(character) >= 'a' && lower(character) <= 'z';
}

constexpr bool is_control(char character) noexcept {
  const auto byte = static_cast<unsigned char>(character);
  return (byte < ' ' && byte != '\t') || byte == 0x7f;
}

Span<const char> trim(Span<const char> text) noexcept {
  while (!text.empty() && is_blank(text[0])) {
    text = text.from(1);
  }
  while (!text.empty() && is_blank(text[text.size() - 1])) {
    text = text.first(text.size() - 1);
  }
  return text;
}

bool starts_with(Span<const char> text, const char* word) noexcept {
  for (std::size_t i = 0; word[i] != '\0'; ++i) {
    if (i >= text.size() || lower(text[i]) != word[i]) {
      return false;
    }
  }
  return true;
}

bool contains(Span<const char> text, char wanted) noexcept {
  for (const char character : text) {
    if (character == wanted) {
      return true;
    }
  }
  return false;
}

/// "nan", "inf", "infinity", with or without a sign: words that elsewhere stand for numbers.
bool is_word_for_no_number(Span<const char> field) noexcept {
  const bool has_sign = !field.empty() && (field[0] == '-' || field[0] == '+');
  const Span<const char> word = has_sign ? field.from(1) : field;
  return (word.size() >= 3 && starts_with(word, "nan")) ||
         (word.size() == 3 && starts_with(word, "inf")) ||
         (word.size() == 8 && starts_with(word, "infinity"));
}

std::size_t count_columns(Span<const char> line) noexcept {
  std::size_t columns = 1;
  for (const char character : line) {
    columns += character == ',' ? 1u : 0u;
  }
  return columns;
}

/// Cuts the text up to the next comma, or all of it, off the line.
Span<const char> take_field(Span<const char>& line) noexcept {
  std::size_t length = 0;
  while (length < line.size() && line[length] != ',') {
    ++length;
  }
  const Span<const char> field = line.first(length);
  line = line.from(length < line.size() ? length + 1 : length);
  return trim(field);
}

bool is_header_line(Span<const char> line) noexcept {
  return is_letter(line[0]) && !is_word_for_no_number(take_field(line));
}

/// The number of columns of a header that emax gives a table of points, 0 if it is none.
std::size_t columns_of_own_header(Span<const char> line) noexcept {
  const std::size_t columns = count_columns(line);
  for (std::size_t column = 0; column < kColumns; ++column) {
    (void)take_field(line);
  }
  std::size_t known = kColumns;
  for (const char* name : kMoreColumns) {
    Span<const char> rest = line;
    if (known < columns && starts_with(take_field(rest), name)) {
      line = rest;
      ++known;
    }
  }
  return known == columns ? columns : 0;
}

/// A tab inside a field, not just around a number: the tab is meant to separate.
bool is_separated_by_tabs(Span<const char> line) noexcept {
  while (!line.empty()) {
    if (contains(take_field(line), '\t')) {
      return true;
    }
  }
  return false;
}

const char* problem_with_number(Span<const char> field, std::size_t column,
                                double* number) noexcept {
  if (field.empty()) {
    return kMissing[column];
  }
  if (is_word_for_no_number(field)) {
    return kNotFinite[column];
  }
  const ParsedNumber parsed = parse_decimal(field);
  if (parsed.status == Status::kSyntax || parsed.length != field.size()) {
    return kNotNumber[column];
  }
  if (parsed.status != Status::kOk) {
    return kNotFinite[column];
  }
  *number = parsed.value;
  return nullptr;
}

}  // namespace

void PointsReader::start() noexcept {
  points_.clear();
  error_ = {};
  line_ = 0;
  columns_ = kColumns;
  header_is_past_ = false;
}

void PointsReader::fail(const char* problem, const char* expectation) noexcept {
  error_ = {line_, problem, expectation};
}

void PointsReader::add_line(Span<const char> line) noexcept {
  if (error_.problem != nullptr) {
    return;
  }
  ++line_;
  if (line_ == 1 && starts_with(line, "\xEF\xBB\xBF")) {
    line = line.from(3);
  }
  if (!line.empty() && line[line.size() - 1] == '\r') {
    line = line.first(line.size() - 1);
  }
  for (const char character : line) {
    if (is_control(character)) {
      fail("this is not a text file: the line holds a control character", kExpectedText);
      return;
    }
  }
  if (line.size() > kMaxLineLength) {
    fail("the line has more than 250 characters", kExpectedText);
    return;
  }
  line = trim(line);
  if (line.empty() || line[0] == '#') {
    return;
  }
  if (contains(line, ';')) {
    fail("the columns are separated by semicolons", kExpectedCommas);
    return;
  }
  if (is_separated_by_tabs(line)) {
    fail("the columns are separated by tabs", kExpectedCommas);
    return;
  }
  const bool is_header = !header_is_past_ && is_header_line(line);
  header_is_past_ = true;
  if (is_header && columns_of_own_header(line) > kColumns) {
    columns_ = columns_of_own_header(line);
  }
  const std::size_t columns = count_columns(line);
  if (columns != columns_) {
    fail(kFound[columns < kMostNamed ? columns : kMostNamed],
         columns_ == kColumns ? kExpectedColumns : kExpectedColumnsOfHeader);
    return;
  }
  if (!is_header) {
    add_numbers(line);
  }
}

void PointsReader::add_numbers(Span<const char> line) noexcept {
  double numbers[kColumns] = {};
  for (std::size_t column = 0; column < kColumns; ++column) {
    const char* problem = problem_with_number(take_field(line), column, &numbers[column]);
    if (problem != nullptr) {
      fail(problem, kExpectedNumber);
      return;
    }
  }
  for (std::size_t column = 0; column < kColumns; ++column) {
    if (kNotPositive[column] != nullptr && !(numbers[column] > 0.0)) {
      fail(kNotPositive[column], kExpectedPositive[column]);
      return;
    }
  }
  add_point(numbers);
}

void PointsReader::add_point(const double* numbers) noexcept {
  if (abs(numbers[2]) > kMaxPhase_deg) {
    fail("phase_deg is outside -360 to 360", "expected a phase in degrees, negative for a lag");
    return;
  }
  ResponsePoint point;
  point.frequency_hz = numbers[0];
  point.amplitude = numbers[1];
  point.phase_rad = numbers[2] * kRadiansPerDegree;
  point.u_amplitude = numbers[3] / kCoverageFactor;
  point.u_phase_rad = numbers[4] / kCoverageFactor * kRadiansPerDegree;
  const std::size_t index = points_.size();
  const Status status = points_.add(point);
  if (status == Status::kNotAscending) {
    fail("f_hz is not above the frequency of the line before",
         "expected ascending frequencies, each one once");
    return;
  }
  if (status == Status::kTooManyPoints) {
    fail("this is one point more than " EMAX_TEXT_OF(EMAX_MAX_POINTS), kExpectedPoints);
    return;
  }
  if (status != Status::kOk) {
    fail("a number is too small to be represented", "expected uncertainties well above 0");
    return;
  }
  lines_[index] = static_cast<std::uint32_t>(line_);
}

PointsError PointsReader::finish() noexcept {
  if (error_.problem != nullptr) {
    return error_;
  }
  line_ = 0;
  if (points_.size() == 0) {
    fail("the table holds no points", kExpectedPoints);
  } else if (points_.size() == 1) {
    fail("the table holds only 1 point", kExpectedPoints);
  } else if (points_.size() < kMinPoints) {
    fail("the table holds only 2 points", kExpectedPoints);
  }
  return error_;
}

}  // namespace emax::app
