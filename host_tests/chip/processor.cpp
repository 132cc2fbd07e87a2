#include "chip/processor.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kFlash = 0x08000000;
constexpr std::uint32_t kRam = 0x20000000, kRamBytes = 0x20000;

constexpr std::uint32_t kFloatingPointActive = 4;  // CONTROL.FPCA
constexpr std::uint32_t kProcessStack = 2;         // CONTROL.SPSEL
constexpr std::uint32_t kThumb = 1U << 24;
constexpr std::uint32_t kPadded = 1U << 9;
/// IT bits, stack padding and exception number are not flags.
constexpr std::uint32_t kFlags = 0xF80F0000;
constexpr std::uint32_t kBasicWords = 8, kFloatingWords = 26;
/// A handler that is entered so often at once, with no other code in between, never clears its
/// flag.
constexpr unsigned kStorm = 1000;

constexpr int kBasic[] = {UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                          UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR};

bool is_long(std::uint32_t halfword) { return (halfword >> 11) >= 0x1D; }

}  // namespace

Processor::Processor(Core core, std::uint32_t flash_bytes, Bus& bus, Events& events,
                     Findings& findings)
    : flash_bytes_(flash_bytes),
      bus_(bus),
      events_(events),
      findings_(findings),
      engine_(core, *this),
      system_(core, events, findings, nvic_),
      counts_(flash_bytes / 2) {
  findings.locate_with(&events, [this] { return block_; });
  system_.set_clock([this] { return cycle_; }, [this] { return cycles_; });
}

void Processor::reset(std::uint32_t vectors) {
  nvic_.reset();
  engine_.set(UC_ARM_REG_XPSR, kThumb);
  for (const int name : kBasic) {
    engine_.set(name, 0xDEADBEEF);
  }
  engine_.set(UC_ARM_REG_CONTROL, 0);
  engine_.set(UC_ARM_REG_PRIMASK, 0);
  engine_.set(UC_ARM_REG_BASEPRI, 0);
  engine_.set(UC_ARM_REG_FAULTMASK, 0);
  engine_.set(UC_ARM_REG_FPSCR, 0);
  engine_.set(UC_ARM_REG_LR, 0xFFFFFFFF);
  engine_.set(UC_ARM_REG_SP, load(vectors));
  pc_ = load(vectors + 4) & ~1U;
  halt_ = asleep_ = event_ = locked_up_ = broke_ = access_failed_ = false;
  last_left_ = again_ = 0;
}

Halt Processor::run(Time until) {
  until_ = until;
  while (true) {
    events_.run_due();
    if (std::exchange(halt_, false)) {
      return Halt::kAsked;
    }
    if (locked_up_) {
      return Halt::kLockup;
    }
    if (std::exchange(broke_, false)) {
      return Halt::kBreak;
    }
    if (events_.now() >= until) {
      return Halt::kTime;
    }
    if (asleep_) {
      const Halt slept = sleep(until);
      if (slept != Halt::kTime) {
        return slept;
      }
      continue;
    }
    if (system_.mpu_changed()) {
      system_.apply_mpu(engine_);
    }
    if (between_) {
      std::exchange(between_, nullptr)();
    }
    if (std::exchange(access_failed_, false)) {
      system_.note_fault(0x8200, failed_address_);
      fault(kBusFault);
    }
    take_pending();
    if (!locked_up_) {
      on_stop(engine_.run(pc_));
    }
  }
}

// One step of waiting: kTime if there is more to do.
Halt Processor::sleep(Time until) {
  if (nvic_.wakes(masks())) {
    asleep_ = false;
    return Halt::kTime;
  }
  const Time next = std::min(events_.next(), until);
  if (next == kNever) {
    return Halt::kAsleep;
  }
  if (next > events_.now()) {
    events_.pass(next - events_.now());
  }
  return Halt::kTime;
}

void Processor::fail_access(std::uint32_t address) {
  const bool is_most_urgent = masks().faultmask || nvic_.active(kNmi) || nvic_.active(kHardFault);
  if (is_most_urgent && system_.ignores_bus_faults()) {
    return;
  }
  access_failed_ = true;
  failed_address_ = address;
}

void Processor::stall(Time delay) { events_.pass(delay); }

ExceptionMasks Processor::masks() const {
  return {(engine_.get(UC_ARM_REG_PRIMASK) & 1) != 0, (engine_.get(UC_ARM_REG_FAULTMASK) & 1) != 0,
          static_cast<std::uint8_t>(engine_.get(UC_ARM_REG_BASEPRI))};
}

bool Processor::must_stop() {
  return halt_ || events_.now() >= until_ || events_.next() <= events_.now() ||
         system_.mpu_changed() || access_failed_ || between_ ||
         (nvic_.attention() && nvic_.next(masks()) != 0);
}

bool Processor::on_block(std::uint32_t address, std::uint32_t bytes) {
  if (must_stop()) {
    return false;
  }
  block_ = address;
  const std::uint32_t instructions = count(address, bytes);
  instructions_ += instructions;
  cycles_ += instructions;
  if (watcher_) {
    watcher_(address, instructions);
  }
  events_.pass(cycle_ * instructions);
  if (bytes == 2 && is_endless(address)) {
    spin();
  }
  if (last_left_ != 0 && !nvic_.anything_active()) {
    last_left_ = again_ = 0;
  }
  if (!system_.fpu_enabled()) {
    watch_floating_point();
  }
  return true;
}

bool Processor::is_endless(std::uint32_t address) {
  constexpr std::uint8_t kBranchToItself[] = {0xFE, 0xE7};
  const std::uint8_t* code = bus_.memory(address, 2);
  return code != nullptr && std::equal(code, code + 2, kBranchToItself);
}

// Nothing changes before something is due: all turns until then at once.
void Processor::spin() {
  const Time next = std::min(events_.next(), until_);
  if (next != kNever && next > events_.now()) {
    const Time turns = (next - events_.now() + cycle_ - 1) / cycle_;
    instructions_ += turns;
    cycles_ += turns;
    events_.pass(turns * cycle_);
  }
}

// The emulator's unit is always on: a program that forgot to switch it on would never know.
void Processor::watch_floating_point() {
  if ((engine_.get(UC_ARM_REG_CONTROL) & kFloatingPointActive) != 0) {
    findings_.report("fpu_off", "SCB.CPACR");
  }
}

std::uint32_t Processor::count(std::uint32_t address, std::uint32_t bytes) {
  const bool in_flash = address - kFlash < flash_bytes_;
  if (in_flash && counts_[(address - kFlash) / 2] != 0) {
    return counts_[(address - kFlash) / 2];
  }
  const std::uint8_t* code = bus_.memory(address, bytes);
  if (code == nullptr) {
    return 1;
  }
  std::uint32_t instructions = 0;
  for (std::uint32_t at = 0; at < bytes; ++instructions) {
    at += is_long(code[at] | static_cast<std::uint32_t>(code[at + 1]) << 8) ? 4U : 2U;
  }
  if (in_flash && instructions < 256) {
    counts_[(address - kFlash) / 2] = static_cast<std::uint8_t>(instructions);
  }
  return instructions;
}

std::uint32_t Processor::read_register(std::uint32_t address, unsigned bytes) {
  events_.run_due();
  if (address >= 0xE0000000 && address < 0xE0040000) {
    return system_.read(address, bytes);
  }
  return bus_.read(address, bytes);
}

void Processor::write_register(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  events_.run_due();
  if (address < 0xE0000000 || address >= 0xE0040000) {
    bus_.write(address, bytes, value);
    return;
  }
  system_.write(address, bytes, value);
  // An interrupt that is let through must have somebody who knows it.
  if (address >= 0xE000E100 && address < 0xE000E180) {
    const std::uint32_t table = system_.vectors();
    for (unsigned i = 0; i < 32; ++i) {
      const unsigned exception = kFirstInterrupt + (address - 0xE000E100) / 4 * 32 + i;
      if ((value >> i & 1) != 0 && exception < kFirstInterrupt + kInterruptLines &&
          (load(table + 4 * exception) == load(table + 4 * kHardFault) ||
           load(table + 4 * exception) == 0)) {
        findings_.report("interrupt_without_handler", "NVIC", exception - kFirstInterrupt);
      }
    }
  }
}

void Processor::take_pending() {
  const unsigned exception = nvic_.attention() ? nvic_.next(masks()) : 0;
  if (exception == 0) {
    return;
  }
  if (exception == last_left_) {
    if (++again_ == kStorm) {
      findings_.report("flag_not_cleared", "exception " + std::to_string(exception), exception);
    }
  } else {
    again_ = 0;
  }
  enter(exception);
}

std::uint32_t Processor::load(std::uint32_t address) {
  const std::uint8_t* memory = bus_.memory(address, 4);
  std::uint32_t value = 0;
  if (memory != nullptr) {
    std::memcpy(&value, memory, 4);
  }
  return value;
}

void Processor::store(std::uint32_t address, std::uint32_t value) {
  std::uint8_t* memory = address - kRam < kRamBytes ? bus_.memory(address, 4) : nullptr;
  if (memory != nullptr) {
    std::memcpy(memory, &value, 4);
  }
}

// Entry, Armv7-M B1.5.6: the frame, with the floating point registers if they are in use.
void Processor::enter(unsigned exception) {
  ++exceptions_;
  const std::uint32_t control = engine_.get(UC_ARM_REG_CONTROL);
  const std::uint32_t status = engine_.get(UC_ARM_REG_XPSR);
  if ((control & kProcessStack) != 0) {
    findings_.report("not_modelled", "process stack");
  }
  const bool floating = (control & kFloatingPointActive) != 0;
  const std::uint32_t old_sp = engine_.get(UC_ARM_REG_SP);
  const std::uint32_t sp = (old_sp - 4 * (floating ? kFloatingWords : kBasicWords)) & ~7U;
  if (sp - kRam >= kRamBytes || system_.mpu_forbids(sp, true)) {
    findings_.report("stack_overflow", "exception " + std::to_string(exception), sp);
    locked_up_ = exception == kHardFault || exception == kNmi;
    system_.note_fault(0x10, sp);
  }
  std::uint32_t at = sp;
  for (const int name : kBasic) {
    store(at, engine_.get(name));
    at += 4;
  }
  store(at, pc_);
  store(at + 4, (status & ~kPadded) | ((old_sp & 4) != 0 ? kPadded : 0));
  if (floating) {
    for (int i = 0; i < 16; ++i) {
      store(sp + 32 + 4 * static_cast<std::uint32_t>(i), engine_.get(UC_ARM_REG_S0 + i));
    }
    store(sp + 96, engine_.get(UC_ARM_REG_FPSCR));
  }
  const bool nested = system_.active_exception != 0;
  engine_.set(UC_ARM_REG_LR, (nested ? 0xFFFFFFF1U : 0xFFFFFFF9U) & ~(floating ? 0x10U : 0U));
  engine_.set(UC_ARM_REG_SP, sp);
  engine_.set(UC_ARM_REG_CONTROL, control & ~kFloatingPointActive);
  engine_.set(UC_ARM_REG_XPSR, (status & kFlags) | kThumb | exception);
  nvic_.enter(exception);
  system_.active_exception = exception;
  const std::uint32_t vector = load(system_.vectors() + 4 * exception);
  if ((vector & 1) == 0) {
    findings_.report("vector_not_thumb", "exception " + std::to_string(exception), vector);
  }
  pc_ = vector & ~1U;
}

void Processor::leave(std::uint32_t exception_return) {
  const unsigned exception = engine_.get(UC_ARM_REG_IPSR) & 0x1FF;
  if (exception != kNmi) {
    engine_.set(UC_ARM_REG_FAULTMASK, 0);
  }
  nvic_.leave(exception);
  last_left_ = exception;
  const bool floating = (exception_return & 0x10) == 0;
  const std::uint32_t sp = engine_.get(UC_ARM_REG_SP);
  std::uint32_t at = sp;
  for (const int name : kBasic) {
    engine_.set(name, load(at));
    at += 4;
  }
  pc_ = load(at) & ~1U;
  const std::uint32_t status = load(at + 4);
  if (floating) {
    for (int i = 0; i < 16; ++i) {
      engine_.set(UC_ARM_REG_S0 + i, load(sp + 32 + 4 * static_cast<std::uint32_t>(i)));
    }
    engine_.set(UC_ARM_REG_FPSCR, load(sp + 96));
  }
  const std::uint32_t used = 4 * (floating ? kFloatingWords : kBasicWords);
  engine_.set(UC_ARM_REG_SP, (sp + used) | ((status & kPadded) != 0 ? 4U : 0U));
  const std::uint32_t control = engine_.get(UC_ARM_REG_CONTROL) & ~kFloatingPointActive;
  engine_.set(UC_ARM_REG_XPSR, status & ~kPadded);
  engine_.set(UC_ARM_REG_CONTROL, control | (floating ? kFloatingPointActive : 0));
  system_.active_exception = status & 0x1FF;
  if (system_.sleep_on_exit() && system_.active_exception == 0) {
    asleep_ = true;
  }
}

void Processor::on_stop(EngineStop why) {
  pc_ = engine_.pc();
  switch (why) {
    case EngineStop::kBlock:
      break;
    case EngineStop::kSleep:
      asleep_ = true;
      if (system_.deep_sleep()) {
        findings_.report("not_modelled", "stop and standby modes");
      }
      break;
    case EngineStop::kException:
      on_exception(engine_.exception());
      break;
    case EngineStop::kUndefined:
      system_.note_fault(1U << 16, 0);
      fault(kUsageFault);
      break;
    case EngineStop::kRead:
    case EngineStop::kWrite: {
      const std::uint32_t address = engine_.fault_address();
      const bool write = why == EngineStop::kWrite;
      if (system_.mpu_forbids(address, write)) {
        system_.note_fault(0x82, address);
        fault(kMemManage);
        break;
      }
      findings_.report(write ? "bad_write" : "bad_read", "memory", address);
      system_.note_fault(0x8200, address);
      fault(kBusFault);
      break;
    }
    case EngineStop::kFetch:
      findings_.report("bad_fetch", "memory", engine_.fault_address());
      system_.note_fault(0x100, 0);
      fault(kBusFault);
      break;
  }
}

void Processor::on_exception(std::uint32_t number) {
  constexpr std::uint32_t kExceptionReturn = 0xFFFFFFE0;
  constexpr std::uint32_t kSupervisorCall = 2;
  constexpr std::uint32_t kBreakpoint = 7;
  if (pc_ >= kExceptionReturn) {
    leave(pc_ | 1);
    return;
  }
  if (number == kSupervisorCall) {
    nvic_.pend(kSvCall, true);
    return;
  }
  if (number == kBreakpoint) {
    broke_ = true;
    pc_ += 2;
    return;
  }
  system_.note_fault(1U << 16, 0);
  fault(kUsageFault);
}

void Processor::fault(unsigned exception) {
  const ExceptionMasks now = masks();
  if (!nvic_.can_enter(exception, now)) {
    system_.note_escalation();
    exception = kHardFault;
    if (!nvic_.can_enter(kHardFault, now)) {
      findings_.report("lockup", "processor", block_);
      locked_up_ = true;
      return;
    }
  }
  enter(exception);
}

}  // namespace emax::chip
