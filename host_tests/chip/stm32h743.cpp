#include "chip/stm32h743.hpp"

#include <array>
#include <cstring>
#include <limits>

#include "chip/stm32h743_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kHsi_hz = 64'000'000;
constexpr Uart::Kind kConsole = {"USART3", 1, 16, 16, 8, 9, 7, 39};
constexpr Dac::Kind kDac = {67, false, false};
constexpr unsigned kAdcTimer6 = 13, kDacTimer6 = 5;
constexpr unsigned kPortA = 0, kPortC = 2, kPortD = 3;
/// The inputs: INP15 is PA3, INP10 is PC0, of both converters; nothing else is connected.
constexpr unsigned kReferenceChannel = 15, kDeviceChannel = 10;
constexpr std::uint32_t kPwrcr = 0x2C;
/// Device 0x450, revisions Y and V.
constexpr std::uint32_t kIdY = 0x10036450, kIdV = 0x20036450;

constexpr std::array<unsigned, 8> kDma1Interrupts = {11, 12, 13, 14, 15, 16, 17, 47};
constexpr std::array<unsigned, 8> kDma2Interrupts = {56, 57, 58, 59, 60, 68, 69, 70};

}  // namespace

Stm32h743::Syscfg::Syscfg(Context context, Stm32h743& chip)
    : RegisterBlock(context, "SYSCFG", h743::syscfg_registers()), chip_(chip) {}

void Stm32h743::Syscfg::on_write(std::uint32_t offset, std::uint32_t value) {
  put(offset, masked(offset, value));
  if (offset == kPwrcr) {
    chip_.pwr.set_overdrive((value & 1) != 0, chip_.revision_);
  }
}

Stm32h743::Dbgmcu::Dbgmcu(Context context)
    : RegisterBlock(context, "DBGMCU", h743::dbgmcu_registers(kIdV)), id_code(kIdV) {}

std::uint32_t Stm32h743::Dbgmcu::on_read(std::uint32_t offset, std::uint32_t value) {
  return offset == 0 ? id_code : value;
}

Stm32h743::Stm32h743(Pins& pins)
    : Stm32(Core::kCortexM7, kHsi_hz, check_speed_h7, FlashH7::kBankBytes,
            {0x1FF1E800, 0x1FF1E880}),
      rcc(context_, clocks),
      pwr(context_, clocks, rcc),
      flash(context_, clocks),
      ports([this] {
        std::vector<std::unique_ptr<Gpio>> made;
        for (char letter = 'A'; letter <= 'K'; ++letter) {
          made.push_back(std::make_unique<Gpio>(context_, letter, h743::gpio_registers(letter)));
        }
        return made;
      }()),
      tim2(context_, clocks, "TIM2", Timer::Kind::kGeneral, h743::general_timer_registers(), 28),
      tim6(context_, clocks, "TIM6", Timer::Kind::kBasic, h743::basic_timer_registers(), 54),
      tim7(context_, clocks, "TIM7", Timer::Kind::kBasic, h743::basic_timer_registers(), 55),
      console(context_, clocks, *ports[kPortD], kConsole, h743::usart_registers()),
      watchdog(context_, rcc, h743::iwdg_registers()),
      dmamux(context_, h743::dmamux_registers()),
      dma1(context_, "DMA1", *this, dmamux, 0, kDma1Interrupts),
      dma2(context_, "DMA2", *this, dmamux, 8, kDma2Interrupts),
      requests(dma1, dma2),
      adc(context_, clocks, requests, family_),
      dac(context_, clocks, requests, *ports[kPortA], kDac, h743::dac_registers()),
      pins_(pins),
      syscfg_(context_, *this),
      exti_(context_, "EXTI", h743::exti_registers()),
      dbgmcu_(context_),
      rams_({{"ITCM", 0x00000000, std::vector<std::uint8_t>(0x10000), false, -1, {}},
             {"DTCM", 0x20000000, std::vector<std::uint8_t>(0x20000), false, -1, {}},
             {"AXI SRAM", 0x24000000, std::vector<std::uint8_t>(0x80000), true, -1, {}},
             {"SRAM1", 0x30000000, std::vector<std::uint8_t>(0x20000), true, 29, {}},
             {"SRAM2", 0x30020000, std::vector<std::uint8_t>(0x20000), true, 30, {}},
             {"SRAM3", 0x30040000, std::vector<std::uint8_t>(0x8000), true, 31, {}},
             {"SRAM4", 0x38000000, std::vector<std::uint8_t>(0x10000), true, -1, {}}}) {
  map();
  attach_clocks();
  wire();
}

void Stm32h743::set_revision(Revision revision) {
  revision_ = revision;
  dbgmcu_.id_code = revision == Revision::kV ? kIdV : kIdY;
  rcc.set_revision(revision);
  family_.set_revision(revision);
}

void Stm32h743::map() {
  place(0x40000000, 0x400, tim2);
  place(0x40001000, 0x400, tim6);
  place(0x40001400, 0x400, tim7);
  place(0x40004800, 0x400, console);
  place(0x40007400, 0x400, dac);
  place(0x40020000, 0x400, dma1);
  place(0x40020400, 0x400, dma2);
  place(0x40020800, 0x400, dmamux);
  place(0x40022000, 0x100, adc.master);
  place(0x40022100, 0x100, adc.slave);
  place(0x40022300, 0x100, adc.common);
  place(0x52002000, 0x400, flash);
  place(0x58000000, 0x400, exti_);
  place(0x58000400, 0x400, syscfg_);
  place(0x58004800, 0x400, watchdog);
  for (std::uint32_t port = 0; port < ports.size(); ++port) {
    place(0x58020000 + 0x400 * port, 0x400, *ports[port]);
  }
  place(0x58024400, 0x400, rcc);
  place(0x58024800, 0x400, pwr);
  place(0x5C001000, 0x400, dbgmcu_);
  lasting_ = {&dbgmcu_};

  Engine& engine = processor_.engine();
  map_flash();
  for (Ram& ram : rams_) {
    const auto bytes = static_cast<std::uint32_t>(ram.bytes.size());
    engine.map_memory(ram.base, bytes, UC_PROT_ALL, ram.bytes.data());
    place_memory({ram.name, ram.base, bytes, ram.bytes.data(), ram.by_dma,
                  ram.clock_bit < 0 ? nullptr : &ram.gate});
  }
  engine.map_registers(0x1FF1E000, 0x1000);
  engine.map_registers(0x40000000, 0x40000);
  engine.map_registers(0x48020000, 0x10000);
  engine.map_registers(0x52000000, 0x10000);
  engine.map_registers(0x58000000, 0x30000);
  engine.map_registers(0x5C001000, 0x1000);
  engine.map_registers(0xE0000000, 0x10000);
}

void Stm32h743::attach_clocks() {
  constexpr std::uint32_t kAhb1 = 0xD8, kAhb2 = 0xDC, kAhb4 = 0xE0, kApb1 = 0xE8, kApb4 = 0xF4;
  rcc.attach(kAhb1, 0, dma1);
  rcc.attach(kAhb1, 1, dma2);
  rcc.attach(kAhb1, 5, adc.master);
  rcc.attach(kAhb1, 5, adc.slave);
  rcc.attach(kAhb1, 5, adc.common);
  for (Ram& ram : rams_) {
    if (ram.clock_bit >= 0) {
      rcc.attach(kAhb2, static_cast<unsigned>(ram.clock_bit), ram.gate);
    }
  }
  for (unsigned port = 0; port < ports.size(); ++port) {
    rcc.attach(kAhb4, port, *ports[port]);
  }
  rcc.attach(kApb1, 0, tim2);
  rcc.attach(kApb1, 4, tim6);
  rcc.attach(kApb1, 5, tim7);
  rcc.attach(kApb1, 18, console);
  rcc.attach(kApb1, 29, dac);
  rcc.attach(kApb4, 1, syscfg_);
  rcc.on_gates([this] { processor_.between_blocks([this] { show_memories(); }); });
}

// A memory without its clock is not there for the processor: its accesses come here, too.
void Stm32h743::show_memories() {
  for (const Ram& ram : rams_) {
    if (ram.clock_bit >= 0) {
      processor_.engine().hide(ram.base, !ram.gate.on);
    }
  }
  processor_.system().renew_mpu();
}

void Stm32h743::wire() {
  clocks.on_change([this] { processor_.set_cycle(cycles_of(1, clocks.cpu_hz)); });
  dmamux.ask_with(
      [this](unsigned channel) { return channel < 8 ? dma1.on(channel) : dma2.on(channel - 8); });
  adc.look_at_pin_with([this](unsigned channel) {
    return channel == kReferenceChannel ? ports[kPortA]->mode(3) == PinMode::kAnalog
                                        : ports[kPortC]->mode(0) == PinMode::kAnalog;
  });
  adc.measure_with([this](unsigned channel) {
    return channel == kReferenceChannel ? pins_.reference_pin_v()
           : channel == kDeviceChannel  ? pins_.device_pin_v()
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
  flash.on_bus_error([this](std::uint32_t address) { processor_.fail_access(address); });
  pwr.on_power_lost([this] { fail_power(); });
}

std::uint8_t* Stm32h743::clocked(const Memory& memory, std::uint32_t address, bool writes) {
  Gate& gate = *memory.gate;
  if (!gate.on) {
    findings.report("memory_clock_off", memory.name, address);
    return nullptr;
  }
  if (std::exchange(gate.fresh, false) && writes) {
    findings.report("clock_enable_not_read_back", memory.name, address);
  }
  return memory.data + (address - memory.base);
}

std::uint32_t Stm32h743::read(std::uint32_t address, unsigned bytes) {
  const Memory* const memory = memory_at(address, bytes);
  if (memory == nullptr || memory->gate == nullptr) {
    return Stm32::read(address, bytes);
  }
  std::uint32_t value = 0;
  if (const std::uint8_t* const at = clocked(*memory, address, false)) {
    std::memcpy(&value, at, bytes);
  }
  return value;
}

void Stm32h743::write(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  const Memory* const memory = memory_at(address, bytes);
  if (memory == nullptr || memory->gate == nullptr) {
    Stm32::write(address, bytes, value);
  } else if (std::uint8_t* const at = clocked(*memory, address, true)) {
    std::memcpy(at, &value, bytes);
  }
}

std::uint8_t* Stm32h743::dma_memory(std::uint32_t address, std::uint32_t bytes) {
  const Memory* const memory = memory_at(address, bytes);
  const bool off = memory != nullptr && memory->gate != nullptr && !memory->gate->on;
  return off ? nullptr : Stm32::dma_memory(address, bytes);
}

// Flash is not written while its constants are in the cache.
const char* Stm32h743::dma_objection(std::uint32_t address, std::uint32_t bytes) {
  const Memory* const memory = memory_at(address, bytes);
  if (memory == nullptr || !memory->by_dma || memory->data == flash.bytes()) {
    return nullptr;
  }
  if (memory->gate != nullptr && !memory->gate->on) {
    return "memory_clock_off";
  }
  constexpr std::uint32_t kLine = 32;
  for (std::uint32_t at = address & ~(kLine - 1); at < address + bytes; at += kLine) {
    if (processor_.system().is_cached(at)) {
      return "dma_cacheable_memory";
    }
  }
  return nullptr;
}

}  // namespace emax::chip
