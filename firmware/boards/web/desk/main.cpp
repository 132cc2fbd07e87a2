// What the PC program does beside the instrument, for the page: reading tables and comparing
// devices. Requests and answers are texts.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "emax/app/base/text_writer.hpp"

#include "arena.hpp"
#include "desk/cli/console.hpp"
#include "desk/compare/comparison.hpp"
#include "desk/compare/comparison_csv.hpp"
#include "desk/compare/comparison_json.hpp"
#include "desk/compare/comparison_report.hpp"
#include "desk/files/points_file.hpp"
#include "page_files.hpp"
#include "table_lines.hpp"

namespace emax::web {
namespace {

using desk::Problem;
using Words = std::vector<std::string_view>;
using Writer = void (*)(const desk::Comparison&, app::TextWriter&);

char* request = nullptr;
std::string* answer = nullptr;

// A request is words, each behind its length: four bytes, the lowest first.
Words words_of(std::string_view text) {
  constexpr std::size_t kLengthBytes = 4;
  Words words;
  while (text.size() >= kLengthBytes) {
    std::size_t length = 0;
    for (std::size_t i = kLengthBytes; i-- > 0;) {
      length = length * 256 + static_cast<unsigned char>(text[i]);
    }
    words.push_back(text.substr(kLengthBytes, length));
    text.remove_prefix(std::min(text.size(), kLengthBytes + length));
  }
  return words;
}

// table, name, text, uncertainties, units, delay, "1" to invert, the reference's percent
Problem read_table(const Words& words, app::TextWriter& out) {
  const std::string name(words[1]);
  add_file(name, words[2]);
  return write_table_lines(name, {words[3], words[4], words[5], words[6] == "1", words[7]}, out);
}

// compare, figure, form, name, text, name, text, ...
Problem compare(const Words& words, app::TextWriter& out) {
  constexpr std::size_t kFirst = 3;
  constexpr std::array<std::string_view, desk::kFigureKinds> kFigures = {"matched", "band",
                                                                         "energy"};
  desk::FigureKind by = desk::FigureKind::kMatched;
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    by = words[1] == kFigures[i] ? static_cast<desk::FigureKind>(i) : by;
  }
  std::vector<desk::Result> results;
  for (std::size_t i = kFirst; i + 1 < words.size(); i += 2) {
    const std::string name(words[i]);
    add_file(name, words[i + 1]);
    results.emplace_back();
    if (Problem problem = desk::read_result(name, results.back())) {
      return problem;
    }
  }
  desk::Comparison comparison;
  if (Problem problem = desk::compare_all(std::move(results), by, comparison)) {
    return problem;
  }
  const Writer write = words[2] == "json"  ? desk::write_comparison_json
                       : words[2] == "csv" ? desk::write_comparison_csv
                                           : desk::write_comparison;
  write(comparison, out);
  return {};
}

struct Request {
  std::string_view name;
  std::size_t words;
  Problem (*run)(const Words&, app::TextWriter&);
};

constexpr Request kRequests[] = {{"table", 8, read_table}, {"compare", 7, compare}};

Problem run(const Words& words, app::TextWriter& out) {
  for (const Request& known : kRequests) {
    if (!words.empty() && words[0] == known.name && words.size() >= known.words) {
      return known.run(words, out);
    }
  }
  return desk::fault("no such request, or too few words");
}

}  // namespace
}  // namespace emax::web

extern "C" {

/// Begins a request; what was answered before is gone.
///
/// @returns Where its `size` bytes go.
char* emax_request(std::size_t size) noexcept {
  emax::web::clear_arena();
  emax::web::request = static_cast<char*>(emax::web::take_from_arena(size));
  return emax::web::request;
}

/// Answers the request.
///
/// @returns 0, or the exit status of the program `emax`, and then the answer is what it complains
/// of.
std::int32_t emax_answer(std::size_t size) noexcept {
  using namespace emax;
  web::forget_files();
  desk::StringSink sink;
  app::TextWriter out(sink);
  const desk::Problem problem = web::run(web::words_of(std::string_view(web::request, size)), out);
  web::answer = new std::string(problem ? problem.line : sink.text());
  return static_cast<std::int32_t>(problem.status);
}

const char* emax_answer_text() noexcept { return emax::web::answer->data(); }
std::size_t emax_answer_size() noexcept { return emax::web::answer->size(); }

}  // extern "C"
