#include "chip/stm32g474.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kSecondBank = kFlashBase + kBankBytes;
constexpr std::uint32_t kCcm = 0x10000000, kCcmBytes = 0x8000, kCcmInRam = 0x18000;
constexpr std::uint32_t kUniqueId = 0x1FFF7590, kFlashSize = 0x1FFF75E0;
constexpr std::uint32_t kIdCode = 0x20036469;  // Device 0x469.
constexpr unsigned kAdcTimer6 = 13, kDacTimer6 = 7;

constexpr std::array<unsigned, 8> kDma1Interrupts = {11, 12, 13, 14, 15, 16, 17, 96};
constexpr std::array<unsigned, 8> kDma2Interrupts = {56, 57, 58, 59, 60, 97, 98, 99};

Registers dbgmcu_with_id() {
  Registers rows = dbgmcu_registers();
  rows.front().reset = kIdCode;
  return rows;
}

}  // namespace

Stm32g474::Stm32g474(Pins& pins)
    : processor_(Core::kCortexM4, *this, events, findings),
      wires_(processor_.nvic()),
      context_{events, findings, wires_},
      clocks(findings),
      rcc(context_, clocks),
      pwr(context_, clocks),
      flash(context_, clocks),
      ports([this] {
        std::vector<std::unique_ptr<Gpio>> made;
        for (char letter = 'A'; letter <= 'G'; ++letter) {
          made.push_back(std::make_unique<Gpio>(context_, letter));
        }
        return made;
      }()),
      tim2(context_, clocks, "TIM2", Timer::Kind::kGeneral, 28),
      tim6(context_, clocks, "TIM6", Timer::Kind::kBasic, 54),
      tim7(context_, clocks, "TIM7", Timer::Kind::kBasic, 55),
      console(context_, clocks, *ports[0]),
      watchdog(context_, rcc),
      dmamux(context_),
      dma1(context_, "DMA1", *this, dmamux, 0, kDma1Interrupts),
      dma2(context_, "DMA2", *this, dmamux, 8, kDma2Interrupts),
      requests(dma1, dma2),
      adc(context_, clocks, requests),
      dac(context_, clocks, requests, *ports[0]),
      pins_(pins),
      syscfg_(context_, "SYSCFG", syscfg_registers()),
      exti_(context_, "EXTI", exti_registers()),
      dbgmcu_(context_, "DBGMCU", dbgmcu_with_id()),
      ram_(kRamBytes) {
  map();
  attach_clocks();
  wire();
}

void Stm32g474::place(std::uint32_t base, std::uint32_t bytes, RegisterBlock& block) {
  places_.push_back({base, bytes, &block});
  by_name_[block.name()] = &block;
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
  engine.map_memory(kFlashBase, kBankBytes, kReadOnly, flash.bytes());
  engine.map_registers(kSecondBank, kBankBytes);
  engine.map_memory(kRamBase, kRamBytes, UC_PROT_ALL, ram_.data());
  engine.map_memory(kCcm, kCcmBytes, UC_PROT_ALL, ram_.data() + kCcmInRam);
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
  clocks.on_change([this] { processor_.set_cycle(cycles_of(1, clocks.hclk_hz)); });
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
  const auto restart_for = [this](std::uint32_t cause) {
    restart_asked_ = true;
    restart_cause_ = cause;
    processor_.halt();
  };
  watchdog.on_bite([restart_for] { restart_for(kWatchdogReset); });
  processor_.system().on_reset_request([restart_for] { restart_for(kSoftwareReset); });
  flash.on_power_cut([this] {
    power_failed_ = true;
    processor_.halt();
  });
}

void Stm32g474::load(const Elf& elf) {
  for (const ElfSegment& segment : elf.segments) {
    const std::uint32_t offset = segment.address - kFlashBase;
    if (segment.address < kFlashBase || offset + segment.bytes.size() > 2 * kBankBytes) {
      throw std::runtime_error("the program does not lie in flash");
    }
    std::copy(segment.bytes.begin(), segment.bytes.end(), flash.bytes() + offset);
  }
  symbols_ = elf.symbols;
}

void Stm32g474::power_on() {
  // Memory of no meaning, but the same in each run.
  std::uint32_t noise = 0x12345678;
  for (std::uint8_t& byte : ram_) {
    noise = noise * 1664525 + 1013904223;
    byte = static_cast<std::uint8_t>(noise >> 24);
  }
  rcc.forget_causes();
  restart(kPowerOnReset, true);
}

void Stm32g474::restart(std::uint32_t cause, bool power_lost) {
  ++resets_;
  power_failed_ = restart_asked_ = false;
  events.clear();
  wires_.clear();
  rcc.note_reset(cause);
  // The clock first, as what follows looks at it. The debug unit's registers only know power.
  rcc.reset();
  for (const Place& place : places_) {
    if (place.block != &rcc && (place.block != &dbgmcu_ || power_lost)) {
      place.block->reset();
    }
  }
  processor_.system().reset(kFlashBase, power_lost);
  processor_.reset(kFlashBase);
}

Halt Stm32g474::run_for(double time_s) {
  const Time until = events.now() + ticks(time_s);
  while (!power_failed_) {
    last_halt_ = processor_.run(until);
    if (last_halt_ != Halt::kAsked || !restart_asked_) {
      return last_halt_;
    }
    if (!power_failed_) {
      restart(restart_cause_, false);
    }
  }
  return Halt::kAsked;
}

bool Stm32g474::run_until(const std::function<bool()>& condition, double most_s,
                          double look_every_s) {
  const Time end = events.now() + ticks(most_s);
  while (!condition()) {
    if (events.now() >= end) {
      return false;
    }
    if (run_for(look_every_s) != Halt::kTime) {
      return condition();
    }
  }
  return true;
}

bool Stm32g474::run_until_text(const std::string& text, double most_s) {
  return run_until([&] { return console.sent().find(text) != std::string::npos; }, most_s);
}

std::uint32_t Stm32g474::ram_word(std::uint32_t address) {
  std::uint32_t word = 0;
  const std::uint8_t* at = memory(address, 4);
  if (at == nullptr) {
    throw std::out_of_range("no memory at this address");
  }
  std::memcpy(&word, at, 4);
  return word;
}

std::uint8_t* Stm32g474::memory(std::uint32_t address, std::size_t bytes) {
  const auto within = [&](std::uint32_t base, std::uint32_t size) {
    return address >= base && address - base + bytes <= size;
  };
  if (within(kFlashBase, 2 * kBankBytes)) {
    return flash.bytes() + (address - kFlashBase);
  }
  if (within(kRamBase, kRamBytes)) {
    return ram_.data() + (address - kRamBase);
  }
  if (within(kCcm, kCcmBytes)) {
    return ram_.data() + kCcmInRam + (address - kCcm);
  }
  if (within(0, kBankBytes)) {
    return flash.bytes() + address;
  }
  return nullptr;
}

// The controllers reach flash and RAM, but not the CCM at its own address.
std::uint8_t* Stm32g474::dma_memory(std::uint32_t address, std::uint32_t bytes) {
  const bool reachable = address >= kFlashBase && (address < kCcm || address >= kRamBase);
  return reachable ? memory(address, bytes) : nullptr;
}

RegisterBlock* Stm32g474::block_at(std::uint32_t address, std::uint32_t* offset) {
  for (const Place& place : places_) {
    if (address >= place.base && address - place.base < place.bytes) {
      if (offset != nullptr) {
        *offset = address - place.base;
      }
      return place.block;
    }
  }
  return nullptr;
}

bool Stm32g474::read_constant(std::uint32_t address, unsigned bytes, std::uint32_t& value) const {
  std::uint32_t word = 0;
  const std::uint32_t at = address & ~3U;
  if (at >= kUniqueId && at < kUniqueId + 12) {
    word = unique_id_[(at - kUniqueId) / 4];
  } else if (at == kFlashSize) {
    word = 2 * kBankBytes / 1024 | 0xFFFF0000;
  } else {
    return false;
  }
  value = word >> (8 * (address & 3));
  value = bytes == 4 ? value : value & ((1U << (8 * bytes)) - 1);
  return true;
}

std::uint32_t Stm32g474::read(std::uint32_t address, unsigned bytes) {
  if (address >= kSecondBank && address < kSecondBank + kBankBytes) {
    return flash.read_array(address, bytes);
  }
  std::uint32_t value = 0;
  if (read_constant(address, bytes, value)) {
    return value;
  }
  std::uint32_t offset = 0;
  if (RegisterBlock* const found = block_at(address, &offset)) {
    return found->bus_read(offset, bytes);
  }
  findings.report("not_modelled", "read", address);
  return 0;
}

void Stm32g474::write(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (address >= kSecondBank && address < kSecondBank + kBankBytes) {
    flash.write_array(address, bytes, value);
    return;
  }
  std::uint32_t offset = 0;
  if (RegisterBlock* const found = block_at(address, &offset)) {
    found->bus_write(offset, bytes, value);
    return;
  }
  findings.report("not_modelled", "write", address);
}

}  // namespace emax::chip
