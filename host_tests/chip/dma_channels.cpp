#include "chip/dma_channels.hpp"

#include <cstring>

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kIsr = 0x00, kIfcr = 0x04, kFirstControl = 0x08;
constexpr std::uint32_t kEnable = 1, kFromMemory = 1U << 4, kCircular = 1U << 5;
constexpr std::uint32_t kPeripheralSteps = 1U << 6, kMemorySteps = 1U << 7;
constexpr std::uint32_t kMemoryToMemory = 1U << 14;
constexpr std::uint32_t kInterruptEnables = 0xE;
constexpr std::uint32_t kAny = 1, kWhole = 2, kHalf = 4, kError = 8;

unsigned peripheral_bytes(std::uint32_t control) { return 1U << field(control, 8, 2); }
unsigned memory_bytes(std::uint32_t control) { return 1U << field(control, 10, 2); }

}  // namespace

DmaChannels::DmaChannels(Context context, const std::string& name, DmaBus& bus, Dmamux& mux,
                         unsigned first_mux, const std::array<unsigned, kChannels>& interrupts)
    : Dma(context, name, g474::dma_registers(), bus, mux, first_mux, interrupts) {}

void DmaChannels::on_reset() {
  channels_ = {};
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    refresh(channel);
  }
}

void DmaChannels::on_write(std::uint32_t offset, std::uint32_t value) {
  if (offset == kIfcr) {
    for (unsigned channel = 0; channel < kChannels; ++channel) {
      std::uint32_t flags = value >> (4 * channel) & 0xF;
      flags |= (flags & kAny) != 0 ? 0xFU : 0U;
      clear_bits(kIsr, flags << (4 * channel));
      refresh(channel);
    }
    return;
  }
  const unsigned channel = (offset - kFirstControl) / 20;
  const bool is_control = offset == control(channel);
  const std::uint32_t free = is_control ? kEnable | kInterruptEnables : 0;
  if (on(channel) && (value & kEnable || !is_control) && ((stored(offset) ^ value) & ~free) != 0) {
    report("dma_setting_while_enabled", offset, value);
    value = (stored(offset) & ~free) | (value & free);
  }
  const bool was_on = on(channel);
  put(offset, masked(offset, value));
  if (is_control && !was_on && on(channel)) {
    enable(channel);
  }
  refresh(channel);
}

bool DmaChannels::usable(unsigned channel) const {
  const std::uint32_t settings = stored(control(channel));
  const std::uint32_t items = stored(count(channel));
  const std::uint32_t target = stored(memory(channel));
  const std::uint32_t source = stored(peripheral(channel));
  if (target % memory_bytes(settings) != 0 || source % peripheral_bytes(settings) != 0) {
    report("dma_misaligned", memory(channel), target);
  }
  const std::uint32_t steps = (settings & kMemorySteps) != 0 ? items : 1;
  if (!bus_.is_register(source)) {
    report("dma_unreachable", peripheral(channel), source);
    return false;
  }
  return reach(memory(channel), target, steps * memory_bytes(settings)) != nullptr;
}

void DmaChannels::enable(unsigned channel) {
  channels_[channel].over = false;
  channels_[channel].total = stored(count(channel));
  const std::uint32_t settings = stored(control(channel));
  if ((settings & (kMemoryToMemory | kPeripheralSteps)) != 0) {
    report("not_modelled", control(channel), settings);
  }
  if (stored(count(channel)) == 0) {
    report("dma_nothing_to_transfer", count(channel));
    return;
  }
  if (chosen(channel) == 0) {
    report("dma_no_request_chosen", control(channel), settings);
  }
  if (!usable(channel)) {
    fail(channel);
  }
}

void DmaChannels::fail(unsigned channel) {
  clear_bits(control(channel), kEnable);
  set_flags(channel, kError);
}

void DmaChannels::ask_in_vain(unsigned channel) {
  if (on(channel) && channels_[channel].over) {
    report("dma_not_circular", control(channel), stored(control(channel)));
  }
}

void DmaChannels::lose(unsigned channel) {
  const std::uint32_t settings = stored(control(channel));
  if ((settings & kFromMemory) == 0) {
    bus_.read(stored(peripheral(channel)), peripheral_bytes(settings));
  }
}

DmaAnswer DmaChannels::serve(unsigned channel) {
  transfer(channel);
  const std::uint32_t left = stored(count(channel)) - 1;
  put(count(channel), left);
  if (left == channels_[channel].total / 2) {
    set_flags(channel, kHalf);
  }
  if (left != 0) {
    return DmaAnswer::kDone;
  }
  const bool circular = (stored(control(channel)) & kCircular) != 0;
  channels_[channel].over = !circular;
  if (circular) {
    put(count(channel), channels_[channel].total);
  }
  set_flags(channel, kWhole);
  return DmaAnswer::kLast;
}

void DmaChannels::transfer(unsigned channel) {
  const std::uint32_t settings = stored(control(channel));
  const std::uint32_t done = channels_[channel].total - stored(count(channel));
  const unsigned bytes = memory_bytes(settings);
  const std::uint32_t step = (settings & kMemorySteps) != 0 ? done * bytes : 0;
  std::uint8_t* const at = bus_.dma_memory(stored(memory(channel)) + step, bytes);
  const std::uint32_t target = stored(peripheral(channel));
  std::uint32_t value = 0;
  if ((settings & kFromMemory) != 0) {
    std::memcpy(&value, at, bytes);
    bus_.write(target, peripheral_bytes(settings), value);
    return;
  }
  value = bus_.read(target, peripheral_bytes(settings));
  std::memcpy(at, &value, bytes);
}

void DmaChannels::set_flags(unsigned channel, std::uint32_t flags) {
  set_bits(kIsr, (flags | kAny) << (4 * channel));
  refresh(channel);
}

void DmaChannels::refresh(unsigned channel) {
  const std::uint32_t flags = get(kIsr) >> (4 * channel) & kInterruptEnables;
  const bool high = (flags & get(control(channel)) & kInterruptEnables) != 0;
  set_line(channel, high);
}

}  // namespace emax::chip
