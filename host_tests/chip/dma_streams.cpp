#include "chip/dma_streams.hpp"

#include "chip/stm32h743_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kLowFlags = 0x00, kHighFlags = 0x04, kLowClear = 0x08, kHighClear = 0x0C;
constexpr std::uint32_t kFirstStream = 0x10, kStreamStep = 0x18;
constexpr std::uint32_t kEnable = 1, kInterruptEnables = 0x1E, kFromMemory = 1U << 6;
constexpr std::uint32_t kCircular = 1U << 8, kMemorySteps = 1U << 10, kBuffered = 1U << 20;
/// Flow control, memory to memory, steps of the peripheral, two buffers.
constexpr std::uint32_t kOtherModes = 1U << 5 | 1U << 7 | 1U << 9 | 1U << 15 | 1U << 18;
constexpr std::uint32_t kFifoError = 1, kError = 8, kHalf = 16, kWhole = 32;
constexpr std::uint32_t kAllFlags = 0x3D;
constexpr std::size_t kFifoBytes = 16;
constexpr std::uint32_t kFifoInterrupt = 1U << 7;

constexpr unsigned shift_of(unsigned stream) {
  constexpr unsigned kShifts[] = {0, 6, 16, 22};
  return kShifts[stream % 4];
}

/// Requests of UARTs, which lock up without TRBUFF when other streams run.
bool is_uart(unsigned request) {
  return (request >= 41 && request <= 46) || (request >= 63 && request <= 66) || request == 71 ||
         request == 72 || (request >= 79 && request <= 82);
}

}  // namespace

DmaStreams::DmaStreams(Context context, const std::string& name, DmaBus& bus, Dmamux& mux,
                       unsigned first_mux, const std::array<unsigned, kChannels>& interrupts)
    : Dma(context, name, h743::dma_registers(), bus, mux, first_mux, interrupts) {}

void DmaStreams::on_reset() {
  streams_ = {};
  for (unsigned stream = 0; stream < kChannels; ++stream) {
    refresh(stream);
  }
}

unsigned DmaStreams::peripheral_bytes(unsigned stream) const {
  return 1U << field(stored(control(stream)), 11, 2);
}
unsigned DmaStreams::memory_bytes(unsigned stream) const {
  return is_direct(stream) ? peripheral_bytes(stream) : 1U << field(stored(control(stream)), 13, 2);
}
unsigned DmaStreams::burst_bytes(unsigned stream) const {
  constexpr unsigned kBeats[] = {1, 4, 8, 16};
  return memory_bytes(stream) * kBeats[field(stored(control(stream)), 23, 2)];
}
std::uint32_t DmaStreams::turn_bytes(unsigned stream) const {
  return streams_[stream].total * peripheral_bytes(stream);
}

void DmaStreams::on_write(std::uint32_t offset, std::uint32_t value) {
  if (offset >= kFirstStream) {
    write_stream((offset - kFirstStream) / kStreamStep, offset, value);
    return;
  }
  clear_bits(offset == kLowClear ? kLowFlags : kHighFlags, value);
  for (unsigned stream = 0; stream < kChannels; ++stream) {
    refresh(stream);
  }
}

void DmaStreams::write_stream(unsigned stream, std::uint32_t offset, std::uint32_t value) {
  const bool is_control = offset == control(stream);
  const std::uint32_t free = is_control                       ? kEnable | kInterruptEnables
                             : offset == fifo_control(stream) ? kFifoInterrupt
                                                              : 0;
  const bool was_on = on(stream);
  const bool stays_on = was_on && (!is_control || (value & kEnable) != 0);
  if (stays_on && ((stored(offset) ^ masked(offset, value)) & ~free) != 0) {
    report("dma_setting_while_enabled", offset, value);
    value = (stored(offset) & ~free) | (value & free);
  }
  put(offset, masked(offset, value));
  if (is_control && !was_on && (value & kEnable) != 0) {
    enable(stream);
  }
  if (is_control && (value & kEnable) == 0) {
    streams_[stream].over = false;
    if (was_on) {  // What is in the FIFO goes to memory, and the end is told.
      drain(stream, true);
      set_flags(stream, kWhole);
    }
  }
  refresh(stream);
}

bool DmaStreams::fifo_is_right(unsigned stream) {
  const std::uint32_t settings = stored(control(stream));
  const std::uint32_t bursts = field(settings, 21, 2) | field(settings, 23, 2);
  if (is_direct(stream)) {
    if (field(settings, 13, 2) != field(settings, 11, 2)) {
      report("dma_memory_size_ignored", control(stream), settings);
    }
    if (bursts != 0) {
      report("dma_burst_in_direct_mode", control(stream), settings);
    }
    return true;
  }
  const unsigned threshold = 4 * (field(stored(fifo_control(stream)), 0, 2) + 1);
  if (threshold % burst_bytes(stream) != 0) {
    report("dma_burst_and_threshold", fifo_control(stream), stored(fifo_control(stream)));
    set_flags(stream, kFifoError);
    return false;
  }
  if (stored(memory(stream)) % burst_bytes(stream) != 0) {  // Else one may cross 1 KB.
    report("dma_burst_misaligned", memory(stream), stored(memory(stream)));
  }
  if (turn_bytes(stream) % burst_bytes(stream) != 0) {
    report("dma_count_not_multiple", count(stream), stored(count(stream)));
  }
  if ((settings & kFromMemory) != 0 && memory_bytes(stream) < peripheral_bytes(stream)) {
    report("dma_packs", control(stream), settings);  // Two items go into one register.
  }
  return true;
}

bool DmaStreams::usable(unsigned stream) const {
  const std::uint32_t target = stored(memory(stream)), source = stored(peripheral(stream));
  if (target % memory_bytes(stream) != 0 || source % peripheral_bytes(stream) != 0) {
    report("dma_misaligned", memory(stream), target);
  }
  if (!bus_.is_register(source)) {
    report("dma_unreachable", peripheral(stream), source);
    return false;
  }
  const bool steps = has(control(stream), kMemorySteps);
  return reach(memory(stream), target, steps ? turn_bytes(stream) : memory_bytes(stream)) !=
         nullptr;
}

void DmaStreams::enable(unsigned stream) {
  Stream& state = streams_[stream];
  state = {};
  state.total = stored(count(stream));
  const std::uint32_t settings = stored(control(stream));
  if ((settings & kOtherModes) != 0) {
    report("not_modelled", control(stream), settings);
  }
  if (flags(stream) != 0) {
    report("dma_old_flags", control(stream), flags(stream));
  }
  if (state.total == 0) {
    report("dma_nothing_to_transfer", count(stream));
    clear_bits(control(stream), kEnable);
    return;
  }
  const unsigned request = chosen(stream);
  if (request == 0) {
    report("dma_no_request_chosen", control(stream), settings);
  }
  if (is_uart(request) && (settings & kBuffered) == 0) {
    report("dma_without_trbuff", control(stream), settings);
  }
  if (!fifo_is_right(stream)) {
    clear_bits(control(stream), kEnable);
    return;
  }
  if (!usable(stream)) {
    fail(stream);
    return;
  }
  if ((settings & kFromMemory) != 0) {
    fill(stream);
  }
}

void DmaStreams::fail(unsigned stream) {
  clear_bits(control(stream), kEnable);
  set_flags(stream, kError);
}

// A stream that has come to its end is off.
void DmaStreams::ask_in_vain(unsigned stream) {
  if (streams_[stream].over) {
    report("dma_not_circular", control(stream), stored(control(stream)));
  }
}

void DmaStreams::lose(unsigned stream) {
  if (!has(control(stream), kFromMemory)) {
    bus_.read(stored(peripheral(stream)), peripheral_bytes(stream));
  }
}

std::uint8_t* DmaStreams::memory_now(unsigned stream) {
  const bool steps = has(control(stream), kMemorySteps);
  const std::uint32_t done = steps ? streams_[stream].memory_done : 0;
  return bus_.dma_memory(stored(memory(stream)) + done, memory_bytes(stream));
}

// From memory, ahead of the requests: in direct mode by one item, else as far as the FIFO takes.
void DmaStreams::fill(unsigned stream) {
  Stream& state = streams_[stream];
  const bool direct = is_direct(stream);
  const std::size_t room = direct ? peripheral_bytes(stream) : kFifoBytes;
  const unsigned burst = direct ? peripheral_bytes(stream) : burst_bytes(stream);
  const unsigned bytes = memory_bytes(stream);
  while (state.fifo.size() + burst <= room && state.memory_done < turn_bytes(stream)) {
    for (unsigned part = 0; part < burst && state.memory_done < turn_bytes(stream); part += bytes) {
      const std::uint8_t* const at = memory_now(stream);
      if (at == nullptr) {
        fail(stream);
        return;
      }
      state.fifo.insert(state.fifo.end(), at, at + bytes);
      state.memory_done += bytes;
    }
    if (state.memory_done >= turn_bytes(stream) && has(control(stream), kCircular)) {
      state.memory_done = 0;
    }
  }
}

// To memory: at the threshold in whole bursts, at the end what there is.
void DmaStreams::drain(unsigned stream, bool all) {
  Stream& state = streams_[stream];
  if (has(control(stream), kFromMemory)) {
    return;
  }
  const unsigned bytes = memory_bytes(stream);
  const std::size_t threshold =
      is_direct(stream) ? bytes : 4 * (field(stored(fifo_control(stream)), 0, 2) + 1);
  if (!all && state.fifo.size() < threshold) {
    return;
  }
  while (state.fifo.size() >= bytes && state.memory_done < turn_bytes(stream)) {
    std::uint8_t* const at = memory_now(stream);
    if (at == nullptr) {
      fail(stream);
      return;
    }
    for (unsigned i = 0; i < bytes; ++i) {
      at[i] = state.fifo.front();
      state.fifo.pop_front();
    }
    state.memory_done += bytes;
  }
}

DmaAnswer DmaStreams::serve(unsigned stream) {
  Stream& state = streams_[stream];
  const unsigned bytes = peripheral_bytes(stream);
  const std::uint32_t target = stored(peripheral(stream));
  if (has(control(stream), kFromMemory)) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < bytes && !state.fifo.empty(); ++i) {
      value |= std::uint32_t{state.fifo.front()} << (8 * i);
      state.fifo.pop_front();
    }
    bus_.write(target, bytes, value);
  } else {
    const std::uint32_t value = bus_.read(target, bytes);
    for (unsigned i = 0; i < bytes; ++i) {
      state.fifo.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  put(count(stream), stored(count(stream)) - 1);
  if (has(control(stream), kFromMemory)) {
    fill(stream);
  } else {
    drain(stream, stored(count(stream)) == 0);
  }
  return move_on(stream) ? DmaAnswer::kLast : DmaAnswer::kDone;
}

bool DmaStreams::move_on(unsigned stream) {
  Stream& state = streams_[stream];
  const std::uint32_t now = stored(count(stream));
  if (now == state.total / 2) {
    set_flags(stream, kHalf);
  }
  if (now != 0) {
    return false;
  }
  const bool circular = has(control(stream), kCircular);
  state.over = !circular;
  if (circular) {
    put(count(stream), state.total);
    if (!has(control(stream), kFromMemory)) {
      state.memory_done = 0;
    }
    reach(memory(stream), stored(memory(stream)), memory_bytes(stream));
  } else {
    clear_bits(control(stream), kEnable);
  }
  set_flags(stream, kWhole);
  return true;
}

std::uint32_t DmaStreams::flags(unsigned stream) const {
  return get(stream < 4 ? kLowFlags : kHighFlags) >> shift_of(stream) & kAllFlags;
}

void DmaStreams::set_flags(unsigned stream, std::uint32_t flags) {
  set_bits(stream < 4 ? kLowFlags : kHighFlags, flags << shift_of(stream));
  refresh(stream);
}

// DMEIE, TEIE, HTIE, TCIE stand one below their flags.
void DmaStreams::refresh(unsigned stream) {
  const std::uint32_t now = flags(stream);
  const std::uint32_t enables = get(control(stream)) & kInterruptEnables;
  const bool fifo = (now & kFifoError) != 0 && has(fifo_control(stream), kFifoInterrupt);
  set_line(stream, (now & enables << 1 & 0x3C) != 0 || fifo);
}

}  // namespace emax::chip
