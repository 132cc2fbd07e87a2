#include "chip/rcc_h7.hpp"

#include "chip/stm32h743_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCfgr = 0x10, kD1cfgr = 0x18, kD2cfgr = 0x1C;
constexpr std::uint32_t kD3cfgr = 0x20, kPllckselr = 0x28, kPllcfgr = 0x2C, kPll1divr = 0x30;
constexpr std::uint32_t kPll1fracr = 0x34, kD1ccipr = 0x4C, kD2ccip2r = 0x54, kD3ccipr = 0x58;
constexpr std::uint32_t kCifr = 0x64, kCicr = 0x68, kBdcr = 0x70, kCsr = 0x74, kRsr = 0xD0;
constexpr std::uint32_t kFirstEnable = 0xD4, kLastEnable = 0xF4, kResetBelow = 0x58;

constexpr std::uint32_t kHsiOn = 1, kHsiReady = 4, kCsiOn = 1U << 7, kCsiReady = 1U << 8;
constexpr std::uint32_t kHseBypass = 1U << 18;
constexpr std::uint32_t kOtherPlls = 0x14000000;
constexpr std::uint32_t kSecurityFlag = 1U << 10;
constexpr std::uint32_t kForget = 1U << 16;
constexpr std::uint32_t kHsi_hz = 64'000'000, kCsi_hz = 4'000'000, kLse_hz = 32'768;
constexpr std::uint32_t kHse_hz = 8'000'000;  // From the debug probe.

const Time kHsiStart = ticks(4e-6);
const Time kHseStart = ticks(0.1e-3);
const Time kPllLock = ticks(50e-6);
const Time kSwitch = ticks(0.5e-6);
const Time kLseStart = ticks(0.3);

/// Power on and pin; pin; software; IWDG1. All reset the processor and both domains.
constexpr std::uint32_t kAll = 0x001A0000;
constexpr ResetCauses kCauses = {kAll | 0x00E00000, kAll | 0x00400000, kAll | 0x01400000,
                                 kAll | 0x04400000};

constexpr std::uint32_t kMega = 1'000'000;

}  // namespace

// RM0433, FLASH recommended wait states and programming delay, and the limits of each scale.
void check_speed_h7(const Clocks& clocks, Findings& findings) {
  const unsigned scale = clocks.boost ? 0 : clocks.voltage_range;
  // At scale 3 the peripherals' buses are said to reach 50 MHz, and run at 64 after reset.
  constexpr std::uint32_t kCpu[] = {480, 400, 300, 200}, kBus[] = {240, 200, 150, 100};
  constexpr std::uint32_t kPeripheral[] = {120, 100, 75, 64};
  constexpr std::uint32_t kPerState[] = {70, 70, 55, 45};
  if (clocks.cpu_hz > kCpu[scale] * kMega || clocks.hclk_hz > kBus[scale] * kMega ||
      clocks.pclk1_hz > kPeripheral[scale] * kMega ||
      clocks.pclk2_hz > kPeripheral[scale] * kMega) {
    findings.report("too_fast_for_voltage", "PWR.D3CR", clocks.cpu_hz);
  }
  // Scale 1 reaches 210 MHz with two, and 225 with three; each state adds as much in the others.
  const std::uint32_t most_hz = kPerState[scale] * (clocks.wait_states + 1) * kMega;
  if (clocks.hclk_hz > most_hz) {
    findings.report("too_few_wait_states", "FLASH.ACR", clocks.hclk_hz);
  }
  constexpr std::uint32_t kDelay1[] = {70, 70, 55, 45}, kDelay2[] = {185, 185, 165, 135};
  const unsigned delay = clocks.hclk_hz > kDelay2[scale] * kMega   ? 2
                         : clocks.hclk_hz > kDelay1[scale] * kMega ? 1
                                                                   : 0;
  if (clocks.write_delay < delay) {
    findings.report("flash_write_delay", "FLASH.ACR", clocks.hclk_hz);
  }
}

RccH7::RccH7(Context context, Clocks& clocks)
    : Rcc(context, clocks, h743::rcc_registers(),
          {kHsiOn | kHsiReady, kCifr, kSecurityFlag, kFirstEnable, kLastEnable, kResetBelow, kCsr,
           kRsr, 0x55FA0000, kForget, kCauses}) {}

bool RccH7::pll_takes_hse() const { return field(stored(kPllckselr), 0, 2) == 2; }

unsigned RccH7::used_clock() const { return field(get(kCfgr), 3, 3); }

void RccH7::use_hsi() { clear_bits(kCfgr, 0x3F); }

void RccH7::write_own(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kCr:
      write_control(value);
      break;
    case kCfgr:
      write_configuration(value);
      break;
    case kPllckselr:
    case kPllcfgr:
    case kPll1divr:
    case kPll1fracr:
      write_pll(offset, value);
      break;
    case kCicr:
      put(kCifr, stored(kCifr) & ~value);
      context_.wires.set(kNmi, this, has(kCifr, kSecurityFlag));
      break;
    case kBdcr:
      write_backup(value);
      break;
    case kD1cfgr:
    case kD2cfgr:
    case kD3cfgr:
    case kD1ccipr:
    case kD2ccip2r:
    case kD3ccipr:
      put(offset, masked(offset, value));
      update();
      break;
    default:
      put(offset, masked(offset, value));
      break;
  }
}

void RccH7::write_backup(std::uint32_t value) {
  if (!backup_open_) {
    report("backup_domain_locked", kBdcr, value);
    return;
  }
  put(kBdcr, masked(kBdcr, value));
  if ((value & 1) != 0) {
    context_.events.after(kLseStart, [this] {
      if (has(kBdcr, 1)) {
        set_bits(kBdcr, 2);
        update();
      }
    });
  } else {
    clear_bits(kBdcr, 2);
  }
}

// Bits of PLL2 and PLL3 may change while PLL1 runs.
void RccH7::write_pll(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t own = offset == kPllckselr ? 0x3F3 : offset == kPllcfgr ? 0x0007000F : ~0U;
  const bool on = has(kCr, kPllOn);
  if (on && ((stored(offset) ^ value) & own) != 0 && offset != kPll1fracr) {
    report("pll_changed_while_on", offset, value);
    return;
  }
  put(offset, masked(offset, value));
}

void RccH7::start(std::uint32_t on, std::uint32_t ready, Time delay) {
  context_.events.after(delay, [this, on, ready] {
    if ((stored(kCr) & on) != 0) {
      set_bits(kCr, ready);
      update();
    }
  });
}

std::uint32_t RccH7::keep_what_is_used(std::uint32_t old, std::uint32_t next) {
  const unsigned used = field(get(kCfgr), 3, 3);
  const unsigned source = field(stored(kPllckselr), 0, 2);
  const bool pll = (old & kPllOn) != 0;
  const auto in_use = [&](unsigned number) {
    return used == number || (number < 3 && pll && source == number);
  };
  constexpr std::uint32_t kOn[] = {kHsiOn, kCsiOn, kHseOn, kPllOn};
  constexpr std::uint32_t kReady[] = {kHsiReady, kCsiReady, kHseReady, kPllReady};
  for (unsigned number = 0; number < 4; ++number) {
    if ((old & kOn[number]) != 0 && (next & kOn[number]) == 0 && in_use(number)) {
      report("clock_source_switched_off", kCr, kOn[number]);
      next |= kOn[number];
    }
    if ((next & kOn[number]) == 0) {
      next &= ~kReady[number];
    }
  }
  return next;
}

void RccH7::write_control(std::uint32_t value) {
  const std::uint32_t old = stored(kCr);
  const std::uint32_t next = keep_what_is_used(old, masked(kCr, value) | (old & kSecurity));
  put(kCr, next);
  const std::uint32_t started = next & ~old;
  if ((started & kOtherPlls) != 0) {
    report("not_modelled", kCr, value);
  }
  if ((started & kHsiOn) != 0) {
    start(kHsiOn, kHsiReady, kHsiStart);
  }
  if ((started & kCsiOn) != 0) {
    start(kCsiOn, kCsiReady, kHsiStart);
  }
  if ((started & kHseOn) != 0) {
    if ((next & kHseBypass) == 0) {
      report("hse_not_bypassed", kCr, value);  // The board has no crystal for this oscillator.
    } else {
      context_.events.after(kHseStart, [this] {
        if (!hse_dead_) {
          start(kHseOn, kHseReady, 0);
        }
      });
    }
  }
  if ((started & kPllOn) != 0) {
    check_pll();
    if (pll_input_hz() != 0) {
      start(kPllOn, kPllReady, kPllLock);
    }
  }
  update();
}

std::uint32_t RccH7::pll_input_hz() const {
  const unsigned source = field(stored(kPllckselr), 0, 2);
  const unsigned divider = field(stored(kPllckselr), 4, 6);
  return source == 3 || divider == 0 ? 0 : source_hz(source) / divider;
}

void RccH7::check_pll() const {
  const std::uint32_t input_hz = pll_input_hz();
  if (input_hz == 0) {
    report("pll_without_source", kPllckselr, stored(kPllckselr));
    return;
  }
  const std::uint32_t settings = stored(kPllcfgr);
  const bool narrow = (settings & 2) != 0;
  if (input_hz < kMega || input_hz > (narrow ? 2 : 16) * kMega) {
    report("pll_input_out_of_range", kPllckselr, input_hz);
  }
  // PLL1RGE: 1 to 2, 2 to 4, 4 to 8, 8 to 16 MHz.
  const std::uint32_t low_hz = kMega << field(settings, 2, 2);
  if (input_hz < low_hz || input_hz > 2 * low_hz) {
    report("pll_range_wrong", kPllcfgr, settings);
  }
  const std::uint64_t vco_hz = std::uint64_t{input_hz} * (field(stored(kPll1divr), 0, 9) + 1);
  const std::uint64_t most_hz = (narrow ? 420U : revision_ == Revision::kV ? 960U : 836U) * kMega;
  if (vco_hz < (narrow ? 150U : 192U) * kMega || vco_hz > most_hz) {
    report("vco_out_of_range", kPll1divr, static_cast<std::uint32_t>(vco_hz));
  }
  const unsigned divider = field(stored(kPll1divr), 9, 7) + 1;
  if (divider % 2 != 0 && divider != 1) {
    report("pll_output_divider", kPll1divr, divider);
  }
}

std::uint32_t RccH7::source_hz(unsigned choice) const {
  switch (choice) {
    case 0:
      return has(kCr, kHsiReady) ? kHsi_hz >> field(stored(kCr), 3, 2) : 0;
    case 1:
      return has(kCr, kCsiReady) ? kCsi_hz : 0;
    case 2:
      return has(kCr, kHseReady) ? kHse_hz : 0;
    case 3: {
      if (!has(kCr, kPllReady) || !has(kPllcfgr, 1U << 16)) {
        return 0;
      }
      const std::uint32_t factors = stored(kPll1divr);
      const std::uint64_t eighths =  // Of 1/8192, with the fraction if that is let through.
          std::uint64_t{field(factors, 0, 9) + 1} * 8192 +
          (has(kPllcfgr, 1) ? field(stored(kPll1fracr), 3, 13) : 0);
      return static_cast<std::uint32_t>(pll_input_hz() * eighths / 8192 /
                                        (field(factors, 9, 7) + 1));
    }
    default:
      return 0;
  }
}

void RccH7::write_configuration(std::uint32_t value) {
  const std::uint32_t old = stored(kCfgr);
  const std::uint32_t next = masked(kCfgr, value);
  const unsigned wanted = field(next, 0, 3);
  put(kCfgr, next);
  if (wanted == field(old, 0, 3)) {
    update();
    return;
  }
  if (source_hz(wanted) == 0) {
    const bool output_off = wanted == 3 && has(kCr, kPllReady);
    report(output_off ? "pll_output_off" : "switch_to_dead_clock", kCfgr, value);
    put(kCfgr, (next & ~7U) | (old & 7));
    return;
  }
  context_.events.after(kSwitch, [this] {
    put(kCfgr, (stored(kCfgr) & ~0x38U) | field(stored(kCfgr), 0, 3) << 3);
    update();
  });
}

void RccH7::update() {
  // What the status says it runs from, also while a test holds that.
  const std::uint32_t running_hz = source_hz(field(get(kCfgr), 3, 3));
  const std::uint32_t d1 = stored(kD1cfgr), d2 = stored(kD2cfgr);
  clocks_.sysclk_hz = running_hz != 0 ? running_hz : kHsi_hz;
  clocks_.cpu_hz = clocks_.sysclk_hz / ahb_divider(field(d1, 8, 4));
  clocks_.hclk_hz = clocks_.cpu_hz / ahb_divider(field(d1, 0, 4));
  const unsigned divider1 = apb_divider(field(d2, 4, 3));
  clocks_.pclk1_hz = clocks_.hclk_hz / divider1;
  clocks_.pclk2_hz = clocks_.hclk_hz / apb_divider(field(d2, 8, 3));
  const bool fast_timers = has(kCfgr, 1U << 15);  // TIMPRE
  const unsigned factor = divider1 == 1 ? 1 : fast_timers && divider1 > 2 ? 4 : 2;
  clocks_.timer1_hz = clocks_.pclk1_hz * factor;
  const std::uint32_t lse_hz = has(kBdcr, 2) ? kLse_hz : 0;
  const std::uint32_t uart_hz[] = {clocks_.pclk1_hz, 0,      0, source_hz(0),
                                   source_hz(1),     lse_hz, 0, 0};
  clocks_.uart_hz = uart_hz[field(stored(kD2ccip2r), 0, 3)];
  // Of the converters' choices PLL2 and PLL3 are not modelled; PER_CK is HSI, CSI or HSE.
  const unsigned peripheral = field(stored(kD1ccipr), 28, 2);
  const std::uint32_t per_hz = peripheral < 3 ? source_hz(peripheral) : 0;
  clocks_.adc_async_hz = field(stored(kD3ccipr), 16, 2) == 2 ? per_hz : 0;
  clocks_.changed();
}

}  // namespace emax::chip
