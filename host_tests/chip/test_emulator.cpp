// What the model believes of libunicorn, point by point: another version may differ.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <initializer_list>
#include <vector>

#include "chip/engine.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCode = 0x08000000;
constexpr std::uint32_t kRam = 0x20000000;
constexpr std::uint32_t kRegisters = 0x40000000;

struct Access {
  bool write;
  std::uint32_t address;
  unsigned bytes;
  std::uint32_t value;
};

/// A few instructions in flash, with RAM and a page of registers.
class Emulator final : private EngineClient {
 public:
  explicit Emulator(std::initializer_list<std::uint16_t> code, Core core = Core::kCortexM4)
      : engine(core, *this) {
    std::memcpy(flash_.data(), code.begin(), code.size() * 2);
    engine.map_memory(kCode, flash_.size(), UC_PROT_READ | UC_PROT_EXEC, flash_.data());
    engine.map_memory(kRam, ram_.size(), UC_PROT_ALL, ram_.data());
    engine.map_registers(kRegisters, 4096);
  }

  /// Runs so many blocks at most.
  EngineStop run(unsigned most, std::uint32_t from = kCode) {
    blocks_left_ = most;
    return engine.run(from);
  }

  void change(std::size_t index, std::uint16_t code) {
    std::memcpy(flash_.data() + 2 * index, &code, 2);
  }

  std::vector<std::uint32_t> blocks;
  std::vector<std::uint32_t> bytes_of_blocks;
  std::vector<Access> accesses;
  Engine engine;

 private:
  bool on_block(std::uint32_t address, std::uint32_t bytes) override {
    if (blocks_left_ == 0) {
      return false;
    }
    --blocks_left_;
    blocks.push_back(address);
    bytes_of_blocks.push_back(bytes);
    return true;
  }
  std::uint32_t read_register(std::uint32_t address, unsigned bytes) override {
    accesses.push_back({false, address, bytes, 0});
    return 0x1234;
  }
  void write_register(std::uint32_t address, unsigned bytes, std::uint32_t value) override {
    accesses.push_back({true, address, bytes, value});
  }

  std::array<std::uint8_t, 4096> flash_ = {};
  std::array<std::uint8_t, 4096> ram_ = {};
  unsigned blocks_left_ = 0;
};

// vadd.f64 d0, d0, d1; b .
constexpr std::initializer_list<std::uint16_t> kDoubleAddition = {0xEE30, 0x0B01, 0xE7FE};

TEST(Emulator, TheM7AddsInDoublePrecision) {
  Emulator emulator(kDoubleAddition, Core::kCortexM7);
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  EXPECT_EQ(emulator.engine.pc(), kCode + 4);
}

TEST(Emulator, TheM4RefusesDoublePrecision) {
  Emulator emulator(kDoubleAddition, Core::kCortexM4);
  EXPECT_NE(emulator.run(2), EngineStop::kBlock);
}

TEST(Emulator, TheFirstFloatingPointInstructionShowsInControl) {
  // vadd.f32 s0, s0, s1; b next; next: b .
  Emulator emulator({0xEE30, 0x0A20, 0xE7FF, 0xE7FE});
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_CONTROL) & 4U, 0U);
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_CONTROL) & 4U, 4U);
  emulator.engine.set(UC_ARM_REG_CONTROL, 0);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_CONTROL) & 4U, 0U);
}

TEST(Emulator, AStopInTheBlockHookIsInFrontOfTheBlockAndCanGoOn) {
  // loop: adds r0, #1; cmp r0, #100; bne loop; b .
  Emulator emulator({0x3001, 0x2864, 0xD1FC, 0xE7FE});
  emulator.engine.set(UC_ARM_REG_R0, 0);
  for (std::uint32_t turn = 1; turn <= 99; ++turn) {
    ASSERT_EQ(emulator.run(1, kCode), EngineStop::kBlock);
    ASSERT_EQ(emulator.engine.get(UC_ARM_REG_R0), turn);
    ASSERT_EQ(emulator.engine.pc(), kCode);
  }
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  EXPECT_EQ(emulator.engine.pc(), kCode + 6);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_R0), 100U);
}

TEST(Emulator, ABlockIsToldWithItsBytes) {
  Emulator emulator({0x3001, 0x2864, 0xD1FC, 0xE7FE});
  emulator.engine.set(UC_ARM_REG_R0, 98);
  EXPECT_EQ(emulator.run(3), EngineStop::kBlock);
  EXPECT_EQ(emulator.blocks, (std::vector<std::uint32_t>{kCode, kCode, kCode + 6}));
  EXPECT_EQ(emulator.bytes_of_blocks, (std::vector<std::uint32_t>{6, 6, 2}));
}

TEST(Emulator, WfiEndsTheRunBehindIt) {
  // movs r0, #1; wfi; movs r0, #2; b .
  Emulator emulator({0x2001, 0xBF30, 0x2002, 0xE7FE});
  EXPECT_EQ(emulator.run(9), EngineStop::kSleep);
  EXPECT_EQ(emulator.engine.pc(), kCode + 4);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_R0), 1U);
}

TEST(Emulator, WfeIsNotDone) {
  Emulator emulator({0x2001, 0xBF20, 0x2002, 0xE7FE});
  EXPECT_EQ(emulator.run(9), EngineStop::kUndefined);
}

TEST(Emulator, ASupervisorCallIsNumberTwoAndABreakpointSeven) {
  // movs r1, #5; svc 0; bkpt 3
  Emulator emulator({0x2105, 0xDF00, 0xBE03});
  EXPECT_EQ(emulator.run(9), EngineStop::kException);
  EXPECT_EQ(emulator.engine.exception(), 2U);
  EXPECT_EQ(emulator.engine.pc(), kCode + 4);
  EXPECT_EQ(emulator.run(9, kCode + 4), EngineStop::kException);
  EXPECT_EQ(emulator.engine.exception(), 7U);
  EXPECT_EQ(emulator.engine.pc(), kCode + 4);
}

TEST(Emulator, AReturnFromAnExceptionEndsWithItsValueInThePc) {
  Emulator emulator({0x4770});  // bx lr
  for (const std::uint32_t value : {0xFFFFFFF9U, 0xFFFFFFE9U, 0xFFFFFFF1U, 0xFFFFFFE1U}) {
    emulator.engine.set(UC_ARM_REG_XPSR, 0x01000000 | 20);
    emulator.engine.set(UC_ARM_REG_LR, value);
    EXPECT_EQ(emulator.run(9), EngineStop::kException);
    EXPECT_EQ(emulator.engine.pc() | 1U, value);
    EXPECT_EQ(emulator.engine.get(UC_ARM_REG_IPSR), 20U);
  }
}

TEST(Emulator, WritingTheStatusRestoresFlagsAndExceptionNumber) {
  Emulator emulator({0xE7FE});
  emulator.engine.set(UC_ARM_REG_XPSR, 0x61000025);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_XPSR), 0x61000025U);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_IPSR), 0x25U);
}

TEST(Emulator, AnItBlockIsRestoredWithTheStatus) {
  // cmp r0, #1; itt eq; moveq r1, #7; beq on; movs r1, #9; on: b .
  Emulator emulator({0x2801, 0xBF04, 0x2107, 0xE000, 0x2109, 0xE7FE});
  emulator.engine.set(UC_ARM_REG_R1, 0);
  // Inside of it, in front of the moveq: two conditional instructions to go, condition "eq".
  const std::uint32_t it = 0x04;
  const std::uint32_t bits = (it >> 2) << 10 | (it & 3) << 25;
  emulator.engine.set(UC_ARM_REG_XPSR, 0x01000000 | bits);  // Z is clear: neither is done.
  EXPECT_EQ(emulator.run(1, kCode + 4), EngineStop::kBlock);
  emulator.run(1, emulator.engine.pc());
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_R1), 9U);
}

TEST(Emulator, MasksReadAsTheProgramSetThem) {
  // cpsid i; movs r0, #0x40; msr basepri, r0; wfi
  Emulator emulator({0xB672, 0x2040, 0xF380, 0x8811, 0xBF30});
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_PRIMASK), 0U);
  EXPECT_EQ(emulator.run(9), EngineStop::kSleep);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_PRIMASK) & 1U, 1U);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_BASEPRI), 0x40U);
}

TEST(Emulator, RegistersAreAskedWithAddressAndWidth) {
  // ldrh r1, [r0, #2]; strb r1, [r0, #5]; str r1, [r0, #8]; b .
  Emulator emulator({0x8841, 0x7141, 0x6081, 0xE7FE});
  emulator.engine.set(UC_ARM_REG_R0, kRegisters);
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  ASSERT_EQ(emulator.accesses.size(), 3U);
  EXPECT_FALSE(emulator.accesses[0].write);
  EXPECT_EQ(emulator.accesses[0].address, kRegisters + 2);
  EXPECT_EQ(emulator.accesses[0].bytes, 2U);
  EXPECT_TRUE(emulator.accesses[1].write);
  EXPECT_EQ(emulator.accesses[1].address, kRegisters + 5);
  EXPECT_EQ(emulator.accesses[1].bytes, 1U);
  EXPECT_EQ(emulator.accesses[1].value, 0x34U);
  EXPECT_EQ(emulator.accesses[2].address, kRegisters + 8);
  EXPECT_EQ(emulator.accesses[2].bytes, 4U);
  EXPECT_EQ(emulator.accesses[2].value, 0x1234U);
}

TEST(Emulator, AfterAFaultThePcIsTheBlocksStart) {
  // movs r2, #1; ldr r1, [r0]; movs r2, #2; b .
  Emulator emulator({0x2201, 0x6801, 0x2202, 0xE7FE});
  emulator.engine.set(UC_ARM_REG_R0, 0x60000000);
  EXPECT_EQ(emulator.run(9), EngineStop::kRead);
  EXPECT_EQ(emulator.engine.fault_address(), 0x60000000U);
  EXPECT_EQ(emulator.engine.pc(), kCode);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_R2), 1U);
}

TEST(Emulator, ProtectedMemoryFaults) {
  // str r1, [r0, #8] with what is before it.
  Emulator emulator({0x8841, 0x7141, 0x6081, 0xE7FE});
  emulator.engine.set(UC_ARM_REG_R0, kRam);
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  ASSERT_TRUE(emulator.engine.protect(kRam, UC_PROT_READ));
  EXPECT_EQ(emulator.run(1), EngineStop::kWrite);
  ASSERT_TRUE(emulator.engine.protect(kRam, UC_PROT_NONE));
  EXPECT_EQ(emulator.run(1), EngineStop::kRead);
  ASSERT_TRUE(emulator.engine.protect(kRam, UC_PROT_ALL));
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  EXPECT_FALSE(emulator.engine.protect(0x60000000, UC_PROT_NONE));
}

TEST(Emulator, CodeThatIsChangedFromOutsideIsReadAnewWhenAsked) {
  Emulator emulator({0x2001, 0xE7FE});  // movs r0, #1; b .
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  emulator.change(0, 0x2002);
  emulator.engine.forget_code();
  EXPECT_EQ(emulator.run(1), EngineStop::kBlock);
  EXPECT_EQ(emulator.engine.get(UC_ARM_REG_R0), 2U);
}

TEST(Emulator, AnUndefinedInstructionIsTold) {
  Emulator emulator({0x2203, 0xDE00});  // movs r2, #3; udf 0
  const EngineStop why = emulator.run(9);
  EXPECT_TRUE(why == EngineStop::kUndefined ||
              (why == EngineStop::kException && emulator.engine.exception() == 1));
}

}  // namespace
}  // namespace emax::chip
