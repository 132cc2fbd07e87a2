#include "chip/stm32g474.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCcm = 0x10000000, kCcmBytes = 0x8000, kCcmInRam = 0x18000;
constexpr std::uint32_t kIdCode = 0x20036469;  // Device 0x469.
constexpr Uart::Kind kConsole = {"LPUART1", 256, 0x300, 8, 2, 3, 12, 91};
constexpr Dac::Kind kDac = {6, true, true};
constexpr unsigned kAdcTimer6 = 13, kDacTimer6 = 7;

constexpr std::array<unsigned, 8> kDma1Interrupts = {11, 12, 13, 14, 15, 16, 17, 96};
constexpr std::array<unsigned, 8> kDma2Interrupts = {56, 57, 58, 59, 60, 97, 98, 99};

Registers dbgmcu_with_id() {
  Registers rows = g474::dbgmcu_registers();
  rows.front().reset = kIdCode;
  return rows;
}

}  // namespace

Stm32g474::Stm32g474(Pins& pins)
    : Stm32(Core::kCortexM4, kHsi_hz, check_speed_g4, kBankBytes, {0x1FFF7590, 0x1FFF75E0}),
      rcc(context_, clocks),
      pwr(context_, clocks),
      flash(context_, clocks),
      ports([this] {
        std::vector<std::unique_ptr<Gpio>> made;
        for (char letter = 'A'; letter <= 'G'; ++letter) {
          made.push_back(std::make_unique<Gpio>(context_, letter, g474::gpio_registers(letter)));
        }
        return made;
      }()),
      tim2(context_, clocks, "TIM2", Timer::Kind::kGeneral, g474::general_timer_registers(), 28),
      tim6(context_, clocks, "TIM6", Timer::Kind::kBasic, g474::basic_timer_registers(), 54),
      tim7(context_, clocks, "TIM7", Timer::Kind::kBasic, g474::basic_timer_registers(), 55),
      console(context_, clocks, *ports[0], kConsole, g474::lpuart_registers()),
      watchdog(context_, rcc, g474::iwdg_registers()),
      dmamux(context_, g474::dmamux_registers()),
      dma1(context_, "DMA1", *this, dmamux, 0, kDma1Interrupts),
      dma2(context_, "DMA2", *this, dmamux, 8, kDma2Interrupts),
      requests(dma1, dma2),
      adc(context_, clocks, requests, family_),
      dac(context_, clocks, requests, *ports[0], kDac, g474::dac_registers()),
      pins_(pins),
      syscfg_(context_, "SYSCFG", g474::syscfg_registers()),
      exti_(context_, "EXTI", g474::exti_registers()),
      dbgmcu_(context_, "DBGMCU", dbgmcu_with_id()),
      ram_(kRamBytes) {
  map();
  attach_clocks();
  wire();
}

void Stm32g474::map() {
  place(0x40000000, 0x400, tim2);
  place(0x40001000, 0x400, tim6);
  place(0x40001400, 0x400, tim7);
  place(0x40003000, 0x400, watchdog);
  place(0x40007000, 0x400, pwr);
  place(0x40008000, 0x400, console);
  place(0x40010000, 0x30, syscfg_);
  place(0x40010400, 0x400, exti_);
  place(0x40020000, 0x400, dma1);
  place(0x40020400, 0x400, dma2);
  place(0x40020800, 0x400, dmamux);
  place(0x40021000, 0x400, rcc);
  place(0x40022000, 0x400, flash);
  for (std::uint32_t port = 0; port < ports.size(); ++port) {
    place(0x48000000 + 0x400 * port, 0x400, *ports[port]);
  }
  place(0x50000000, 0x100, adc.master);
  place(0x50000100, 0x100, adc.slave);
  place(0x50000300, 0x100, adc.common);
  place(0x50000800, 0x400, dac);
  place(0xE0042000, 0x400, dbgmcu_);

  Engine& engine = processor_.engine();
  constexpr std::uint32_t kReadOnly = UC_PROT_READ | UC_PROT_EXEC;
  engine.map_memory(0, kBankBytes, kReadOnly, flash.bytes());
  map_flash();
  engine.map_memory(kRamBase, kRamBytes, UC_PROT_ALL, ram_.data());
  engine.map_memory(kCcm, kCcmBytes, UC_PROT_ALL, ram_.data() + kCcmInRam);
  // The controllers reach flash and RAM, but not the CCM at its own address.
  place_memory({"RAM", kRamBase, kRamBytes, ram_.data(), true, nullptr});
  place_memory({"CCM", kCcm, kCcmBytes, ram_.data() + kCcmInRam, false, nullptr});
  place_memory({"alias", 0, kBankBytes, flash.bytes(), false, nullptr});
  lasting_ = {&dbgmcu_};
  engine.map_registers(0x1FFF7000, 0x1000);
  engine.map_registers(0x40000000, 0x30000);
  engine.map_registers(0x48000000, 0x2000);
  engine.map_registers(0x50000000, 0x2000);
  engine.map_registers(0xE0000000, 0x10000);
  engine.map_registers(0xE0042000, 0x1000);
}

void Stm32g474::attach_clocks() {
  rcc.attach(0x48, 0, dma1);
  rcc.attach(0x48, 1, dma2);
  rcc.attach(0x48, 2, dmamux);
  rcc.attach(0x48, 8, flash);
  for (unsigned port = 0; port < ports.size(); ++port) {
    rcc.attach(0x4C, port, *ports[port]);
  }
  rcc.attach(0x4C, 13, adc.master);
  rcc.attach(0x4C, 13, adc.slave);
  rcc.attach(0x4C, 13, adc.common);
  rcc.attach(0x4C, 16, dac);
  rcc.attach(0x58, 0, tim2);
  rcc.attach(0x58, 4, tim6);
  rcc.attach(0x58, 5, tim7);
  rcc.attach(0x58, 28, pwr);
  rcc.attach(0x5C, 0, console);
  rcc.attach(0x60, 0, syscfg_);
}

void Stm32g474::wire() {
  clocks.on_change([this] { processor_.set_cycle(cycles_of(1, clocks.cpu_hz)); });
  dmamux.ask_with(
      [this](unsigned channel) { return channel < 8 ? dma1.on(channel) : dma2.on(channel - 8); });
  adc.look_at_pin_with(
      [this](unsigned channel) { return ports[0]->mode(channel - 1) == PinMode::kAnalog; });
  // IN1 is PA0, IN2 is PA1, of both converters; nothing else is connected.
  adc.measure_with([this](unsigned channel) {
    return channel == 1   ? pins_.reference_pin_v()
           : channel == 2 ? pins_.device_pin_v()
                          : std::numeric_limits<double>::quiet_NaN();
  });
  dac.on_output([this](double pin_v) { pins_.drive(events.now(), pin_v); });
  tim6.on_trigger([this] {
    dac.trigger(kDacTimer6);
    pins_.trigger(events.now(), tim6.period_s());
    adc.trigger(kAdcTimer6);
  });
  watchdog.on_bite([this] { restart_for(rcc.cause_bits().watchdog); });
  processor_.system().on_reset_request([this] { restart_for(rcc.cause_bits().software); });
  flash.on_power_cut([this] { fail_power(); });
}

}  // namespace emax::chip
