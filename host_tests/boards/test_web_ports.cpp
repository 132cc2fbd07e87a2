// The ports of a browser, over a page that this test stands in for, pass the suites of all ports.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "hal/board_conformance.hpp"
#include "ports.hpp"

namespace {

using emax::hal::StoreFormat;

/// What the worker's imports work on.
struct Page {
  std::string input;
  std::string output;
  bool asks_for_clear = false;
  double now_us = 0.0;
  std::vector<std::uint8_t> store;
};

Page page;

}  // namespace

extern "C" {

std::size_t emax_read(char* bytes, std::size_t size) noexcept {
  const std::size_t count = std::min(size, page.input.size());
  std::copy_n(page.input.begin(), count, bytes);
  page.input.erase(0, count);
  return count;
}

void emax_write(const char* bytes, std::size_t size) noexcept { page.output.append(bytes, size); }

std::int32_t emax_take_break() noexcept {
  const bool asked = page.asks_for_clear;
  page.asks_for_clear = false;
  return asked ? 1 : 0;
}

double emax_now_us() noexcept { return page.now_us; }

void emax_store_read(std::size_t offset, std::uint8_t* bytes, std::size_t size) noexcept {
  std::copy_n(&page.store[offset], size, bytes);
}

void emax_store_write(std::size_t offset, const std::uint8_t* bytes, std::size_t size) noexcept {
  std::copy_n(bytes, size, &page.store[offset]);
}

}  // extern "C"

namespace {

TEST(WebPorts, HandOnEveryByteBothWays) {
  page = {};
  emax::web::PageStream stream;
  std::string all;
  for (int value = 0; value < 256; ++value) {
    all += static_cast<char>(value);
  }
  page.input = all;
  std::string found(300, '#');
  EXPECT_EQ(stream.read({&found[0], 100}), 100U);
  EXPECT_EQ(stream.read({&found[100], 200}), 156U);
  EXPECT_EQ(found, all + std::string(44, '#'));
  EXPECT_EQ(stream.read({&found[0], 300}), 0U);
  EXPECT_EQ(stream.write({all.data(), all.size()}), all.size());
  EXPECT_EQ(page.output, all);
  EXPECT_TRUE(stream.connected());
  EXPECT_TRUE(stream.waits_for_reader());
  EXPECT_FALSE(stream.take_break());
  page.asks_for_clear = true;
  EXPECT_TRUE(stream.take_break());
  EXPECT_FALSE(stream.take_break());
}

TEST(WebPorts, ReadTheClockOfThePage) {
  page = {};
  emax::web::PageClock clock;
  page.now_us = 1e15 + 0.5;
  EXPECT_EQ(clock.now_us(), 1'000'000'000'000'000U);
  page.now_us = 5.0;
  EXPECT_EQ(clock.now_us(), 1'000'000'000'000'000U) << "never back";
}

/// Power that never fails: what the browser has taken it keeps.
class StoreBench {
 public:
  explicit StoreBench(const StoreFormat& format) : store_(format) {
    page = {};
    page.store.assign(std::size_t{format.slot_count} * format.slot_bytes, 0x5A);
  }

  emax::web::PageStore& store() { return store_; }
  void cut_power_after(std::uint64_t) {}
  void restore_power() {}
  bool powered() const { return true; }

 private:
  emax::web::PageStore store_;
};

TEST(WebPorts, PassTheSuiteOfStores) {
  for (const StoreFormat& format : {StoreFormat{2, 8, 8}, StoreFormat{10, 1392, 8}}) {
    StoreBench bench(format);
    EXPECT_TRUE(emax::test::violated_by_store(bench).none()) << format.slot_count;
  }
}

}  // namespace
