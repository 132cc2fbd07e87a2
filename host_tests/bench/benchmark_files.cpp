// What it takes to read what others have written: time that is linear in the length of the text.
#include <benchmark/benchmark.h>
#include <cstdint>
#include <string>

#include "desk/files/json_reader.hpp"
#include "desk/import/import_points.hpp"

namespace emax::desk {
namespace {

constexpr int kShortest = 1 << 10;  // Rows or members.
constexpr int kLongest = 1 << 17;

/// Rows of 500 frequencies over and over, as a table that is too long would be no points.
std::string table_of(std::int64_t rows) {
  constexpr std::int64_t kFrequencies = 500;
  std::string text = "Frequency [Hz];Sensitivity [mV/g];Phase [deg];U [%];U(phase) [deg]\n";
  for (std::int64_t i = 0; i < rows; ++i) {
    text += std::to_string(20 + i % kFrequencies) + ";100,07;-0,25;1,0;0,5\n";
  }
  return text;
}

std::string object_of(std::int64_t members) {
  std::string text = "{";
  for (std::int64_t i = 0; i < members; ++i) {
    text += (i == 0 ? "\"name " : ",\"name ") + std::to_string(i) + "\": -1.25e-3";
  }
  return text + "}";
}

std::string array_of(std::int64_t elements) {
  std::string text = "[";
  for (std::int64_t i = 0; i < elements; ++i) {
    text += i == 0 ? "0.001047491" : ", 0.001047491";
  }
  return text + "]";
}

void count(benchmark::State& state, const std::string& text) {
  state.SetComplexityN(static_cast<benchmark::IterationCount>(text.size()));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(text.size()));
}

void import_table(benchmark::State& state) {
  const std::string text = table_of(state.range(0));
  ImportedPoints imported;
  for (auto _ : state) {
    if (import_points(text, {}, imported)) {
      state.SkipWithError("the table is not read");
    }
  }
  count(state, text);
}
BENCHMARK(import_table)->RangeMultiplier(4)->Range(kShortest, kLongest)->Complexity();

void read_json(benchmark::State& state, const std::string& text) {
  for (auto _ : state) {
    JsonValue value;
    if (parse_json(text, value).problem != nullptr) {
      state.SkipWithError("the text is not read");
    }
  }
  count(state, text);
}

void json_object(benchmark::State& state) { read_json(state, object_of(state.range(0))); }
BENCHMARK(json_object)->RangeMultiplier(4)->Range(kShortest, kLongest)->Complexity();

void json_array(benchmark::State& state) { read_json(state, array_of(state.range(0))); }
BENCHMARK(json_array)->RangeMultiplier(4)->Range(kShortest, kLongest)->Complexity();

}  // namespace
}  // namespace emax::desk
