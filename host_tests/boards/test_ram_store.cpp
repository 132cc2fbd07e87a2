// Slots in RAM pass the suite that every store must pass, and a new object finds what the last one
// has written.
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "emax/base/status.hpp"
#include "emax/board/ram_store.hpp"

#include "hal/board_conformance.hpp"

namespace {

using emax::Span;
using emax::Status;
using emax::board::RamStore;
using emax::hal::StoreFormat;

/// Power that never fails: RAM has nothing to say about half a write.
class RamBench {
 public:
  explicit RamBench(const StoreFormat& format)
      : memory_(std::size_t{format.slot_count} * format.slot_bytes, 0x5A),
        store_(format, {memory_.data(), memory_.size()}) {}

  RamStore& store() { return store_; }
  void cut_power_after(std::uint64_t) {}
  void restore_power() {}
  bool powered() const { return true; }

 private:
  std::vector<std::uint8_t> memory_;
  RamStore store_;
};

TEST(RamStore, PassesTheSuiteOfStores) {
  for (const StoreFormat& format : {StoreFormat{2, 8, 8}, StoreFormat{10, 1392, 8}}) {
    RamBench bench(format);
    EXPECT_TRUE(emax::test::violated_by_store(bench).none()) << format.slot_count;
  }
}

TEST(RamStore, SurvivesItsObject) {
  constexpr StoreFormat kFormat = {3, 16, 8};
  std::array<std::uint8_t, 48> memory = {};
  const std::array<std::uint8_t, 3> record = {1, 2, 3};
  {
    RamStore store(kFormat, memory);
    ASSERT_EQ(store.write(2, record), Status::kOk);
  }
  RamStore store(kFormat, memory);
  std::array<std::uint8_t, 4> found = {};
  EXPECT_EQ(store.read(2, found), Status::kOk);
  EXPECT_EQ(found, (std::array<std::uint8_t, 4>{1, 2, 3, emax::hal::kErasedByte}));
  EXPECT_EQ(memory[31], 0) << "another slot";
}

}  // namespace
