// Any bytes as a results.json: a tree of values, or where the text stops being JSON.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "desk/files/json_reader.hpp"

namespace {

using namespace emax::desk;

void require(bool holds, const char* what) {
  if (!holds) {
    (void)std::fprintf(stderr, "%s\n", what);
    std::abort();
  }
}

std::size_t values_in(const JsonValue& value, std::size_t depth) {
  require(depth <= kMaxJsonDepth, "deeper than is permitted");
  std::size_t count = 1;
  for (const JsonValue& element : value.elements()) {
    count += values_in(element, depth + 1);
  }
  return count;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text += static_cast<char>(data[i]);
  }
  JsonValue value;
  const JsonError error = parse_json(text, value);
  if (error.problem != nullptr) {
    require(error.line >= 1 && error.line <= size + 1, "the error is behind the text");
    require(error.column >= 1 && error.column <= size + 1, "the error is behind its line");
    return 0;
  }
  require(values_in(value, 0) <= size, "more values than characters");
  (void)value["energy"]["E"].number();
  return 0;
}
