#include "chip/rcc_g4.hpp"

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCfgr = 0x08, kPllcfgr = 0x0C, kCifr = 0x1C, kCicr = 0x20;
constexpr std::uint32_t kFirstEnable = 0x48, kLastEnable = 0x60, kResetBelow = 0x20;
constexpr std::uint32_t kCcipr = 0x88, kBdcr = 0x90, kCsr = 0x94, kCrrcr = 0x98;

constexpr std::uint32_t kHsiOn = 1U << 8, kHsiReady = 1U << 10;
constexpr std::uint32_t kHseBypass = 1U << 18;
constexpr std::uint32_t kSecurityFlag = 1U << 8;
constexpr std::uint32_t kForget = 1U << 23;    // CSR.RMVF
constexpr std::uint32_t kHse_hz = 24'000'000;  // The board's crystal.

constexpr std::uint32_t kSlow_hz = 80'000'000;  // Above it, changes are in steps.

const Time kHsiStart = ticks(2e-6);
const Time kHseStart = ticks(2e-3);
const Time kPllLock = ticks(50e-6);
const Time kSwitch = ticks(0.5e-6);
const Time kStep = ticks(1e-6);

constexpr ResetCauses kCauses = {0x0C000000, 0x04000000, 0x14000000, 0x24000000};

}  // namespace

// The most per wait state, and the most at all (RM0440, dynamic voltage scaling).
void check_speed_g4(const Clocks& clocks, Findings& findings) {
  constexpr std::uint32_t kMega = 1'000'000;
  const std::uint32_t per_state_hz = (clocks.voltage_range == 2 ? 12
                                      : clocks.boost            ? 34
                                                                : 30) *
                                     kMega;
  const std::uint32_t most_hz = (clocks.voltage_range == 2 ? 26 : clocks.boost ? 170 : 150) * kMega;
  if (clocks.hclk_hz > per_state_hz * (clocks.wait_states + 1)) {
    findings.report("too_few_wait_states", "FLASH.ACR", clocks.hclk_hz);
  }
  if (clocks.hclk_hz > most_hz || clocks.sysclk_hz > most_hz) {
    findings.report("too_fast_for_voltage", "PWR", clocks.hclk_hz);
  }
}

RccG4::RccG4(Context context, Clocks& clocks)
    : Rcc(context, clocks, g474::rcc_registers(),
          {kHsiOn | kHsiReady, kCifr, kSecurityFlag, kFirstEnable, kLastEnable, kResetBelow, kCsr,
           kCsr, 0xFE000000, kForget, kCauses}) {}

bool RccG4::pll_takes_hse() const { return field(stored(kPllcfgr), 0, 2) == 3; }

unsigned RccG4::used_clock() const { return field(get(kCfgr), 2, 2); }

void RccG4::use_hsi() { put(kCfgr, (stored(kCfgr) & ~0xFU) | 5U); }

void RccG4::write_own(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kCr:
      write_control(value);
      break;
    case kCfgr:
      write_configuration(value);
      break;
    case kPllcfgr:
      if (has(kCr, kPllOn)) {
        report("pll_changed_while_on", offset, value);
        break;
      }
      put(offset, masked(offset, value));
      break;
    case kCicr:
      put(kCifr, stored(kCifr) & ~value);
      context_.wires.set(kNmi, this, has(kCifr, kSecurityFlag));
      break;
    case kBdcr:
    case kCrrcr:
      put(offset, masked(offset, value));
      put(offset, (stored(offset) & ~2U) | (stored(offset) << 1 & 2U));
      break;
    case kCcipr:
      put(offset, masked(offset, value));
      update();
      break;
    default:
      put(offset, masked(offset, value));
      break;
  }
}

void RccG4::start_source(std::uint32_t on, std::uint32_t ready, bool works, Time delay) {
  if (!works) {
    return;
  }
  context_.events.after(delay, [this, on, ready] {
    if ((stored(kCr) & on) != 0) {
      set_bits(kCr, ready);
      update();
    }
  });
}

void RccG4::write_control(std::uint32_t value) {
  const std::uint32_t old = stored(kCr);
  std::uint32_t next = masked(kCr, value) | (old & kSecurity);
  const unsigned used = field(get(kCfgr), 2, 2);
  const unsigned source = field(stored(kPllcfgr), 0, 2);
  const bool pll = (old & kPllOn) != 0;
  const auto in_use = [&](std::uint32_t on) {
    return on == kPllOn   ? used == 3
           : on == kHsiOn ? used == 1 || (pll && source == 2)
                          : used == 2 || (pll && source == 3);
  };
  for (const std::uint32_t on : {kHsiOn, kHseOn, kPllOn}) {
    if ((old & on) != 0 && (next & on) == 0 && in_use(on)) {
      report("clock_source_switched_off", kCr, on);
      next |= on;
    }
    const std::uint32_t ready = on == kHsiOn ? kHsiReady : on << 1;
    if ((next & on) == 0) {
      next &= ~ready;
    }
  }
  put(kCr, next);
  const std::uint32_t started = next & ~old;
  if ((started & kHsiOn) != 0) {
    start_source(kHsiOn, kHsiReady, true, kHsiStart);
  }
  if ((started & kHseOn) != 0) {
    // In bypass mode nothing comes from a crystal.
    context_.events.after(kHseStart, [this] {
      start_source(kHseOn, kHseReady, !hse_dead_ && !has(kCr, kHseBypass), 0);
    });
  }
  if ((started & kPllOn) != 0) {
    check_pll();
    start_source(kPllOn, kPllReady, pll_source_hz() != 0, kPllLock);
  }
  update();
}

std::uint32_t RccG4::pll_source_hz() const {
  switch (field(stored(kPllcfgr), 0, 2)) {
    case 2:
      return has(kCr, kHsiReady) ? kHsi_hz : 0;
    case 3:
      return has(kCr, kHseReady) ? kHse_hz : 0;
    default:
      return 0;
  }
}

void RccG4::check_pll() const {
  const std::uint32_t settings = stored(kPllcfgr);
  if (pll_source_hz() == 0) {
    report("pll_without_source", kPllcfgr, settings);
    return;
  }
  const std::uint32_t input_hz = pll_source_hz() / (field(settings, 4, 4) + 1);
  const std::uint32_t factor = field(settings, 8, 7);
  const std::uint64_t vco_hz = std::uint64_t{input_hz} * factor;
  if (input_hz < 2'660'000 || input_hz > 16'000'000) {
    report("pll_input_out_of_range", kPllcfgr, input_hz);
  }
  if (vco_hz < 96'000'000 || vco_hz > 344'000'000 || factor < 8) {
    report("vco_out_of_range", kPllcfgr, static_cast<std::uint32_t>(vco_hz));
  }
}

std::uint32_t RccG4::source_hz(unsigned choice) const {
  const std::uint32_t settings = stored(kPllcfgr);
  switch (choice) {
    case 1:
      return has(kCr, kHsiReady) ? kHsi_hz : 0;
    case 2:
      return has(kCr, kHseReady) ? kHse_hz : 0;
    case 3:
      if (!has(kCr, kPllReady) || (settings >> 24 & 1) == 0) {
        return 0;
      }
      return static_cast<std::uint32_t>(std::uint64_t{pll_source_hz()} * field(settings, 8, 7) /
                                        (field(settings, 4, 4) + 1) /
                                        (2 * (field(settings, 25, 2) + 1)));
    default:
      return 0;
  }
}

void RccG4::write_configuration(std::uint32_t value) {
  const std::uint32_t old = stored(kCfgr);
  const std::uint32_t next = masked(kCfgr, value);
  const unsigned wanted = field(next, 0, 2);
  put(kCfgr, next);
  if (wanted != field(old, 0, 2)) {
    if (source_hz(wanted) == 0) {
      const bool output_off = wanted == 3 && (stored(kPllcfgr) >> 24 & 1) == 0;
      report(output_off ? "pll_output_off" : "switch_to_dead_clock", kCfgr, value);
      put(kCfgr, (next & ~3U) | field(old, 0, 2));
      return;
    }
    if (source_hz(wanted) > kSlow_hz && ahb_divider(field(next, 4, 4)) == 1) {
      report("clock_step_too_big", kCfgr, source_hz(wanted));
    }
    context_.events.after(kSwitch, [this] { switch_done(); });
    return;
  }
  const bool faster = ahb_divider(field(next, 4, 4)) < ahb_divider(field(old, 4, 4));
  if (faster && clocks_.sysclk_hz > kSlow_hz && context_.events.now() < switched_at_ + kStep) {
    report("clock_step_too_soon", kCfgr, value);
  }
  update();
}

void RccG4::switch_done() {
  put(kCfgr, (stored(kCfgr) & ~0xCU) | field(stored(kCfgr), 0, 2) << 2);
  switched_at_ = context_.events.now();
  update();
}

void RccG4::update() {
  // What the status says it runs from, also while a test holds that.
  const std::uint32_t settings = get(kCfgr);
  const std::uint32_t running_hz = source_hz(field(settings, 2, 2));
  clocks_.sysclk_hz = running_hz != 0 ? running_hz : kHsi_hz;
  clocks_.cpu_hz = clocks_.hclk_hz = clocks_.sysclk_hz / ahb_divider(field(settings, 4, 4));
  const unsigned divider1 = apb_divider(field(settings, 8, 3));
  clocks_.pclk1_hz = clocks_.hclk_hz / divider1;
  clocks_.pclk2_hz = clocks_.hclk_hz / apb_divider(field(settings, 11, 3));
  clocks_.timer1_hz = divider1 == 1 ? clocks_.pclk1_hz : 2 * clocks_.pclk1_hz;
  const std::uint32_t choice = stored(kCcipr);
  const std::uint32_t uart_hz[] = {clocks_.pclk1_hz, clocks_.sysclk_hz, source_hz(1), 0};
  clocks_.uart_hz = uart_hz[field(choice, 10, 2)];
  // ADC12SEL: none, PLL's P output (not modelled, see the README), system clock.
  const std::uint32_t adc_hz[] = {0, 0, clocks_.sysclk_hz, 0};
  clocks_.adc_async_hz = adc_hz[field(choice, 28, 2)];
  clocks_.changed();
}

}  // namespace emax::chip
