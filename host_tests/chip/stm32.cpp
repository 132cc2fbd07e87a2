#include "chip/stm32.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace emax::chip {

Stm32::Stm32(Core core, std::uint32_t start_hz, Clocks::Rule rule, std::uint32_t bank_bytes,
             const Constants& constants)
    : processor_(core, bank_bytes, *this, events, findings),
      wires_(processor_.nvic()),
      context_{events, findings, wires_},
      clocks(findings, start_hz, std::move(rule)),
      constants_(constants) {}

void Stm32::place(std::uint32_t base, std::uint32_t bytes, RegisterBlock& block) {
  places_.push_back({base, bytes, &block});
  by_name_[block.name()] = &block;
}

void Stm32::map_flash() {
  const std::uint32_t bank = program_memory().layout().bank_bytes;
  place_memory({"flash", kFlashBase, 2 * bank, program_memory().bytes(), true, nullptr});
  processor_.engine().map_memory(kFlashBase, bank, UC_PROT_READ | UC_PROT_EXEC,
                                 program_memory().bytes());
  processor_.engine().map_registers(kFlashBase + bank, bank);
}

void Stm32::restart_for(std::uint32_t cause) {
  restart_asked_ = true;
  restart_cause_ = cause;
  processor_.halt();
}

void Stm32::fail_power() {
  power_failed_ = true;
  processor_.halt();
}

void Stm32::load(const Elf& elf) {
  for (const ElfSegment& segment : elf.segments) {
    const std::uint32_t offset = segment.address - kFlashBase;
    if (segment.address < kFlashBase ||
        offset + segment.bytes.size() > 2 * program_memory().layout().bank_bytes) {
      throw std::runtime_error("the program does not lie in flash");
    }
    std::copy(segment.bytes.begin(), segment.bytes.end(), program_memory().bytes() + offset);
  }
  symbols_ = elf.symbols;
}

void Stm32::power_on() {
  // Memory of no meaning, but the same in each run.
  std::uint32_t noise = 0x12345678;
  for (const Memory& memory : memories_) {
    if (memory.data == program_memory().bytes()) {
      continue;
    }
    for (std::uint32_t i = 0; i < memory.bytes; ++i) {
      noise = noise * 1664525 + 1013904223;
      memory.data[i] = static_cast<std::uint8_t>(noise >> 24);
    }
  }
  reset_control().forget_causes();
  power_lost();
  restart(reset_control().cause_bits().power_on, true);
}

void Stm32::restart(std::uint32_t cause, bool power_lost) {
  ++resets_;
  power_failed_ = restart_asked_ = false;
  events.clear();
  wires_.clear();
  reset_control().note_reset(cause);
  // The clock first, as what follows looks at it. The debug unit's registers only know power.
  reset_control().reset();
  for (const Place& place : places_) {
    const bool lasts = std::find(lasting_.begin(), lasting_.end(), place.block) != lasting_.end();
    if (place.block != &reset_control() && (!lasts || power_lost)) {
      place.block->reset();
    }
  }
  processor_.system().reset(kFlashBase, power_lost);
  processor_.reset(kFlashBase);
}

Halt Stm32::run_for(double time_s) {
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

bool Stm32::run_until(const std::function<bool()>& condition, double most_s, double look_every_s) {
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

bool Stm32::run_until_text(const std::string& text, double most_s) {
  return run_until([&] { return line().sent().find(text) != std::string::npos; }, most_s);
}

std::uint32_t Stm32::ram_word(std::uint32_t address) {
  std::uint32_t word = 0;
  const std::uint8_t* at = memory(address, 4);
  if (at == nullptr) {
    throw std::out_of_range("no memory at this address");
  }
  std::memcpy(&word, at, 4);
  return word;
}

const Stm32::Memory* Stm32::memory_at(std::uint32_t address, std::size_t bytes) const {
  for (const Memory& memory : memories_) {
    if (address >= memory.base && address - memory.base + bytes <= memory.bytes) {
      return &memory;
    }
  }
  return nullptr;
}

std::uint8_t* Stm32::memory(std::uint32_t address, std::size_t bytes) {
  const Memory* const found = memory_at(address, bytes);
  return found == nullptr ? nullptr : found->data + (address - found->base);
}

std::uint8_t* Stm32::dma_memory(std::uint32_t address, std::uint32_t bytes) {
  const Memory* const found = memory_at(address, bytes);
  return found == nullptr || !found->by_dma ? nullptr : found->data + (address - found->base);
}

RegisterBlock* Stm32::block_at(std::uint32_t address, std::uint32_t* offset) {
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

bool Stm32::read_constant(std::uint32_t address, unsigned bytes, std::uint32_t& value) {
  std::uint32_t word = 0;
  const std::uint32_t at = address & ~3U;
  if (at >= constants_.unique_id && at < constants_.unique_id + 12) {
    word = unique_id_[(at - constants_.unique_id) / 4];
  } else if (at == constants_.flash_size) {
    word = 2 * program_memory().layout().bank_bytes / 1024 | 0xFFFF0000;
  } else {
    return false;
  }
  value = word >> (8 * (address & 3));
  value = bytes == 4 ? value : value & ((1U << (8 * bytes)) - 1);
  return true;
}

bool Stm32::is_second_bank(std::uint32_t address) {
  const std::uint32_t bank = program_memory().layout().bank_bytes;
  return address >= kFlashBase + bank && address < kFlashBase + 2 * bank;
}

std::uint32_t Stm32::read(std::uint32_t address, unsigned bytes) {
  if (is_second_bank(address)) {
    return program_memory().read_array(address, bytes);
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

void Stm32::write(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (is_second_bank(address)) {
    program_memory().write_array(address, bytes, value);
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
