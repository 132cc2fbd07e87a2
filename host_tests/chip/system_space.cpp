#include "chip/system_space.hpp"

#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kSysTickEnable = 1, kSysTickInterrupt = 2, kSysTickCore = 4;
constexpr std::uint32_t kTraceEnable = 1U << 24, kCycleCounter = 1;
constexpr std::uint32_t kMpuEnable = 1, kMpuDefaultMap = 4;

// r0p1 with up to 112 interrupts; r1p1 with up to 240 and caches of 16 KB each.
constexpr CoreFeatures kCortexM4 = {0x410FC241, 8, 0x200, false, false};
constexpr CoreFeatures kCortexM7 = {0x411FC271, 16, 0x400, true, true};

constexpr std::uint32_t kDataCache = 1U << 16, kInstructionCache = 1U << 17;
constexpr unsigned kDataCacheLines = 16 * 1024 / 32;
constexpr std::uint32_t kTraceKey = 0xC5ACCE55;

std::uint64_t region_bytes(std::uint32_t attributes) {
  return std::uint64_t{2} << ((attributes >> 1) & 31);
}

}  // namespace

SystemSpace::SystemSpace(Core core, Events& events, Findings& findings, Nvic& nvic)
    : core_(core == Core::kCortexM7 ? kCortexM7 : kCortexM4),
      events_(events),
      findings_(findings),
      nvic_(nvic) {}

void SystemSpace::set_clock(std::function<Time()> cycle, std::function<std::uint64_t()> cycles) {
  cycle_ = std::move(cycle);
  cycles_ = std::move(cycles);
}

void SystemSpace::reset(std::uint32_t vectors, bool power_lost) {
  vtor_ = vectors;
  aircr_ = scr_ = cfsr_ = hfsr_ = mmfar_ = bfar_ = cpacr_ = 0;
  ccr_ = core_.caches ? 0x40200 : 0x200;
  cleared_lines_ = 0;
  code_cleared_ = false;
  fpccr_ = 0xC0000000;
  mpu_control_ = mpu_number_ = 0;
  mpu_ = {};
  mpu_changed_ = true;
  systick_control_ = systick_reload_ = systick_stopped_at_ = 0;
  systick_counted_ = false;
  events_.cancel(std::exchange(systick_event_, 0));
  if (power_lost) {  // Other resets leave the debug parts alone.
    demcr_ = 0;
    trace_unlocked_ = false;
    dwt_control_ = 0x40000000;
    cycle_count_ = 0;
  }
  active_exception = 0;
}

std::uint32_t SystemSpace::read(std::uint32_t address, unsigned bytes) {
  const unsigned shift = 8 * (address & 3);
  const std::uint32_t value = read_word(address & ~3U) >> shift;
  return bytes == 4 ? value : value & ((1U << (8 * bytes)) - 1);
}

void SystemSpace::write(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (bytes == 4) {
    write_word(address, value);
    return;
  }
  // Only priorities and faults may be written in part (B3.1.1).
  const bool priorities = (address >= 0xE000E400 && address < 0xE000E500) ||
                          (address >= 0xE000ED18 && address < 0xE000ED24);
  if (!priorities && address >> 2 != 0xE000ED28 >> 2) {
    findings_.report("wrong_width", "system control", address);
    return;
  }
  const unsigned shift = 8 * (address & 3);
  const std::uint32_t mask = ((1U << (8 * bytes)) - 1) << shift;
  const std::uint32_t old = priorities ? read_word(address & ~3U) : 0;
  write_word(address & ~3U, (old & ~mask) | ((value << shift) & mask));
}

std::uint32_t SystemSpace::read_word(std::uint32_t address) {
  if (address >= 0xE000E010 && address <= 0xE000E01C) {
    return read_systick(address);
  }
  if (address >= 0xE000E100 && address < 0xE000E500) {
    return read_nvic(address - 0xE000E000);
  }
  if (address >= 0xE000ED90 && address <= 0xE000EDA0) {
    const MpuRegion& region = mpu_[mpu_number_];
    const std::uint32_t values[] = {core_.mpu_regions << 8, mpu_control_, mpu_number_,
                                    region.base | mpu_number_, region.attributes};
    return values[(address - 0xE000ED90) / 4];
  }
  if (address >= 0xE000ED00 && address < 0xE000EDF0) {
    return read_control(address);
  }
  return read_debug(address);
}

void SystemSpace::write_word(std::uint32_t address, std::uint32_t value) {
  if (address >= 0xE000E010 && address <= 0xE000E01C) {
    write_systick(address, value);
  } else if (address >= 0xE000E100 && address < 0xE000E500) {
    write_nvic(address - 0xE000E000, value);
  } else if (address >= 0xE000ED94 && address <= 0xE000EDB8) {
    write_mpu(address, value);
  } else if (write_cache(address, value)) {
    // Done.
  } else if (address == 0xE000EF00) {
    nvic_.pend(kFirstInterrupt + (value & 0x1FF), true);
  } else if (address >= 0xE000ED00 && address < 0xE000EDF0) {
    write_control(address, value);
  } else {
    write_debug(address, value);
  }
}

// --- NVIC

std::uint32_t SystemSpace::priorities(unsigned first) const {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) {
    value |= std::uint32_t{nvic_.priority(first + i)} << (8 * i);
  }
  return value;
}

void SystemSpace::write_priorities(unsigned first, std::uint32_t value) {
  for (unsigned i = 0; i < 4; ++i) {
    nvic_.set_priority(first + i, static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

std::uint32_t SystemSpace::read_nvic(std::uint32_t offset) const {
  if (offset >= 0x400) {
    const unsigned first = offset - 0x400;
    return first + 4 <= kInterruptLines ? priorities(kFirstInterrupt + first) : 0;
  }
  const unsigned first = (offset & 0x7F) / 4 * 32;
  const std::uint32_t kind = offset & ~0x7FU;
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 32 && first + i < kInterruptLines; ++i) {
    const unsigned exception = kFirstInterrupt + first + i;
    const bool set = kind <= 0x180   ? nvic_.enabled(exception)
                     : kind <= 0x280 ? nvic_.pending(exception)
                                     : nvic_.active(exception);
    value |= std::uint32_t{set} << i;
  }
  return value;
}

void SystemSpace::write_nvic(std::uint32_t offset, std::uint32_t value) {
  if (offset >= 0x400) {
    const unsigned first = offset - 0x400;
    if (first + 4 <= kInterruptLines) {
      write_priorities(kFirstInterrupt + first, value);
    }
    return;
  }
  const unsigned first = (offset & 0x7F) / 4 * 32;
  for (unsigned i = 0; i < 32 && first + i < kInterruptLines; ++i) {
    if ((value >> i & 1) == 0) {
      continue;
    }
    const unsigned exception = kFirstInterrupt + first + i;
    switch (offset & ~0x7FU) {
      case 0x100:
      case 0x180:
        nvic_.enable(exception, (offset & 0x80) == 0);
        break;
      case 0x200:
      case 0x280:
        // A wire that is high makes it pending again at once.
        nvic_.pend(exception, (offset & 0x80) == 0 || nvic_.line(exception));
        break;
      default:
        break;
    }
  }
}

// --- System control

std::uint32_t SystemSpace::read_control(std::uint32_t address) const {
  const auto bit = [](bool set, unsigned position) { return std::uint32_t{set} << position; };
  switch (address) {
    case 0xE000ED00:
      return core_.cpuid;
    case 0xE000ED04:
      return active_exception | bit(nvic_.pending(kSysTick), 26) | bit(nvic_.pending(kPendSv), 28) |
             bit(nvic_.pending(kNmi), 31);
    case 0xE000ED08:
      return vtor_;
    case 0xE000ED0C:
      return 0xFA050000 | (aircr_ & 0x700);
    case 0xE000ED10:
      return scr_;
    case 0xE000ED14:
      return ccr_;
    case 0xE000ED18:
    case 0xE000ED1C:
    case 0xE000ED20:
      return priorities(address - 0xE000ED18 + 4);
    case 0xE000ED24:
      return bit(nvic_.active(kMemManage), 0) | bit(nvic_.active(kBusFault), 1) |
             bit(nvic_.active(kUsageFault), 3) | bit(nvic_.active(kSvCall), 7) |
             bit(nvic_.active(kPendSv), 10) | bit(nvic_.active(kSysTick), 11) |
             bit(nvic_.enabled(kMemManage), 16) | bit(nvic_.enabled(kBusFault), 17) |
             bit(nvic_.enabled(kUsageFault), 18);
    case 0xE000ED28:
      return cfsr_;
    case 0xE000ED2C:
      return hfsr_;
    case 0xE000ED34:
      return mmfar_;
    case 0xE000ED38:
      return bfar_;
    case 0xE000ED78:
      return core_.caches ? 0x09000003 : 0;
    case 0xE000ED7C:
      return core_.caches ? 0x8303C003 : 0;
    case 0xE000ED80:
      return core_.caches ? 0xF00FE019 : 0;  // 128 sets of 4 lines of 32 bytes.
    case 0xE000ED88:
      return cpacr_;
    default:
      return 0;
  }
}

void SystemSpace::pend_from_icsr(std::uint32_t value) {
  if ((value >> 31 & 1) != 0) {
    nvic_.pend(kNmi, true);
  }
  for (const unsigned exception : {kPendSv, kSysTick}) {
    const unsigned set = exception == kPendSv ? 28 : 26;
    if ((value >> set & 3) != 0 || (value >> (set - 1) & 1) != 0) {
      nvic_.pend(exception, (value >> set & 1) != 0);
    }
  }
}

void SystemSpace::write_control(std::uint32_t address, std::uint32_t value) {
  switch (address) {
    case 0xE000ED04:
      pend_from_icsr(value);
      break;
    case 0xE000ED08:
      if (value % core_.vectors_alignment != 0) {
        findings_.report("vectors_misaligned", "SCB.VTOR", value);
      }
      vtor_ = value & ~(core_.vectors_alignment - 1);
      break;
    case 0xE000ED0C:
      if (value >> 16 != 0x05FA) {
        findings_.report("wrong_key", "SCB.AIRCR", value);
        break;
      }
      aircr_ = value & 0x700;
      nvic_.set_group(aircr_ >> 8);
      if ((value & 4) != 0 && reset_request_) {
        reset_request_();
      }
      break;
    case 0xE000ED10:
      scr_ = value & 0x16;
      break;
    case 0xE000ED14:
      write_configuration(value);
      break;
    case 0xE000ED18:
    case 0xE000ED1C:
    case 0xE000ED20:
      write_priorities(address - 0xE000ED18 + 4, value);
      break;
    case 0xE000ED24:
      nvic_.enable(kMemManage, (value >> 16 & 1) != 0);
      nvic_.enable(kBusFault, (value >> 17 & 1) != 0);
      nvic_.enable(kUsageFault, (value >> 18 & 1) != 0);
      break;
    case 0xE000ED28:
      cfsr_ &= ~value;
      break;
    case 0xE000ED2C:
      hfsr_ &= ~value;
      break;
    case 0xE000ED34:
    case 0xE000ED38:
      break;
    case 0xE000ED88:
      cpacr_ = value & 0xF00000;
      break;
    default:
      findings_.report("no_such_register", "system control", address);
      break;
  }
}

void SystemSpace::note_fault(std::uint32_t cfsr, std::uint32_t address) {
  cfsr_ |= cfsr;
  if ((cfsr & 0x80) != 0) {
    mmfar_ = address;
  }
  if ((cfsr & 0x8000) != 0) {
    bfar_ = address;
  }
}

// --- SysTick

Time SystemSpace::systick_period() const {
  return cycle_() * ((systick_control_ & kSysTickCore) != 0 ? 1 : 8);
}

void SystemSpace::start_systick() {
  events_.cancel(std::exchange(systick_event_, 0));
  if ((systick_control_ & kSysTickEnable) == 0 || systick_reload_ == 0) {
    return;
  }
  systick_due_ = events_.now() + systick_period() * (Time{systick_reload_} + 1);
  systick_event_ = events_.at(systick_due_, [this] {
    systick_counted_ = true;
    if ((systick_control_ & kSysTickInterrupt) != 0) {
      nvic_.pend(kSysTick, true);
    }
    start_systick();
  });
}

std::uint32_t SystemSpace::read_systick(std::uint32_t address) {
  switch (address) {
    case 0xE000E010:
      return systick_control_ | std::uint32_t{std::exchange(systick_counted_, false)} << 16;
    case 0xE000E014:
      return systick_reload_;
    case 0xE000E018:
      if ((systick_control_ & kSysTickEnable) == 0 || systick_event_ == 0) {
        return systick_stopped_at_;
      }
      return static_cast<std::uint32_t>((systick_due_ - events_.now()) / systick_period()) %
             (systick_reload_ + 1);
    default:
      return 0;
  }
}

void SystemSpace::write_systick(std::uint32_t address, std::uint32_t value) {
  if (address == 0xE000E014) {
    systick_reload_ = value & 0xFFFFFF;
    return;
  }
  if (address == 0xE000E018) {  // Any write clears the counter and the flag.
    systick_stopped_at_ = 0;
    systick_counted_ = false;
    start_systick();
    return;
  }
  if (address != 0xE000E010) {
    findings_.report("read_only_register_written", "SysTick.CALIB", value);
    return;
  }
  const std::uint32_t old = systick_control_;
  systick_control_ = value & 7;
  if (((old ^ systick_control_) & (kSysTickEnable | kSysTickCore)) != 0) {
    start_systick();
  }
}

// --- MPU

void SystemSpace::write_mpu(std::uint32_t address, std::uint32_t value) {
  mpu_changed_ = true;
  if (address >= 0xE000EDA4) {  // Aliases of base and attributes.
    address = 0xE000ED9C + (address - 0xE000EDA4) % 8;
  }
  switch (address) {
    case 0xE000ED94:
      mpu_control_ = value & 7;
      break;
    case 0xE000ED98:
      mpu_number_ = value % core_.mpu_regions;
      break;
    case 0xE000ED9C:
      if ((value & 0x10) != 0) {
        mpu_number_ = (value & 0xF) % core_.mpu_regions;
      }
      mpu_[mpu_number_].base = value & ~0x1FU;
      break;
    case 0xE000EDA0:
      mpu_[mpu_number_].attributes = value;
      if ((value & 1) != 0 && mpu_[mpu_number_].base % region_bytes(value) != 0) {
        findings_.report("mpu_region_misaligned", "MPU.RBAR", mpu_[mpu_number_].base);
      }
      break;
    default:
      break;
  }
}

const MpuRegion* SystemSpace::region_at(std::uint32_t address) const {
  for (std::size_t i = mpu_.size(); i-- > 0;) {  // The higher number wins.
    const MpuRegion& region = mpu_[i];
    const std::uint64_t size = region_bytes(region.attributes);
    if ((region.attributes & 1) == 0 || address < region.base || address >= region.base + size) {
      continue;
    }
    const auto part = static_cast<unsigned>((address - region.base) / (size / 8));
    if (size >= 256 && (region.attributes >> (8 + part) & 1) != 0) {
      continue;
    }
    return &region;
  }
  return nullptr;
}

std::uint32_t SystemSpace::permissions_at(std::uint32_t address, std::uint32_t otherwise) const {
  if ((mpu_control_ & kMpuEnable) == 0) {
    return otherwise;
  }
  const MpuRegion* const region = region_at(address);
  if (region == nullptr) {
    return (mpu_control_ & kMpuDefaultMap) != 0 ? otherwise : 0U;
  }
  const std::uint32_t access = region->attributes >> 24 & 7;
  const bool write = access == 1 || access == 2 || access == 3;
  const bool read = write || access == 5 || access == 6 || access == 7;
  const bool execute = read && (region->attributes >> 28 & 1) == 0;
  return std::uint32_t{read} * UC_PROT_READ | std::uint32_t{write} * UC_PROT_WRITE |
         std::uint32_t{execute} * UC_PROT_EXEC;
}

void SystemSpace::apply_mpu(Engine& engine) {
  mpu_changed_ = false;
  engine.protect_all([this](std::uint32_t address, std::uint32_t otherwise) {
    return permissions_at(address, otherwise) & otherwise;
  });
}

// Armv7-M B3.5.2, B3.1; memory that is shared is not kept in the cache of a Cortex-M7 (CACR.SIWT is
// not modelled). Tightly coupled memories are never cached: who asks knows where they are.
bool SystemSpace::is_cached(std::uint32_t address) const {
  if (!core_.caches || (ccr_ & kDataCache) == 0) {
    return false;
  }
  const MpuRegion* const region = (mpu_control_ & kMpuEnable) != 0 ? region_at(address) : nullptr;
  if (region == nullptr) {
    return address < 0x40000000 || (address >= 0x60000000 && address < 0xA0000000);
  }
  const std::uint32_t attributes = region->attributes;
  const bool shared = (attributes >> 18 & 1) != 0;
  const bool outer = (attributes >> 21 & 1) != 0;  // TEX 1BB: the inner policy is in C and B.
  const std::uint32_t c_and_b = attributes >> 16 & 3;
  return !shared && (outer ? c_and_b != 0 : (attributes >> 17 & 1) != 0);
}

void SystemSpace::write_configuration(std::uint32_t value) {
  const std::uint32_t switched_on = value & ~ccr_;
  if (!core_.caches && (switched_on & (kDataCache | kInstructionCache)) != 0) {
    findings_.report("reserved_bit_written", "SCB.CCR", value);
  }
  if (core_.caches && (switched_on & kDataCache) != 0 && cleared_lines_ < kDataCacheLines) {
    findings_.report("cache_not_invalidated", "SCB.CCR", value);
  }
  if (core_.caches && (switched_on & kInstructionCache) != 0 && !code_cleared_) {
    findings_.report("cache_not_invalidated", "SCB.CCR", value);
  }
  ccr_ = value;
}

// Maintenance of the caches: they are not modelled, but that they are cleared before they are on.
bool SystemSpace::write_cache(std::uint32_t address, std::uint32_t) {
  if (!core_.caches) {
    return false;
  }
  if (address == 0xE000EF50) {
    code_cleared_ = true;
  } else if (address == 0xE000EF60 || address == 0xE000EF74) {
    ++cleared_lines_;
  }
  return address == 0xE000ED84 || (address >= 0xE000EF50 && address <= 0xE000EF78) ||
         (address >= 0xE000EF90 && address <= 0xE000EFA8);
}

bool SystemSpace::mpu_forbids(std::uint32_t address, bool write) const {
  const std::uint32_t wanted = write ? UC_PROT_WRITE : UC_PROT_READ;
  return (permissions_at(address, UC_PROT_ALL) & wanted) == 0;
}

// --- DWT and debug

std::uint32_t SystemSpace::read_debug(std::uint32_t address) const {
  switch (address) {
    case 0xE000EDFC:
      return demcr_;
    case 0xE000EF34:
      return fpccr_;
    case 0xE0001000:
      return dwt_control_;
    case 0xE0001004: {
      const bool counts = (demcr_ & kTraceEnable) != 0 && (dwt_control_ & kCycleCounter) != 0;
      return cycle_count_ + (counts ? static_cast<std::uint32_t>(cycles_() - cycle_origin_) : 0);
    }
    default:
      return 0;
  }
}

void SystemSpace::write_debug(std::uint32_t address, std::uint32_t value) {
  const std::uint32_t count = read_debug(0xE0001004);
  switch (address) {
    case 0xE000EDFC:
      demcr_ = value;
      break;
    case 0xE000EF34:
      fpccr_ = value;
      break;
    case 0xE0001000:
    case 0xE0001004:
      if ((demcr_ & kTraceEnable) == 0) {
        findings_.report("trace_off", "DWT", value);
        return;
      }
      if (core_.trace_lock && !trace_unlocked_) {
        findings_.report("trace_locked", "DWT", value);
        return;
      }
      if (address == 0xE0001000) {
        dwt_control_ = (dwt_control_ & 0xF0000000) | (value & 0x0FFFFFFF);
      }
      break;
    case 0xE0001FB0:
      trace_unlocked_ = value == kTraceKey;  // The lock, which only some parts have.
      return;
    default:
      findings_.report("no_such_register", "debug", address);
      return;
  }
  cycle_count_ = address == 0xE0001004 ? value : count;
  cycle_origin_ = cycles_();
}

}  // namespace emax::chip
