#include "chip/register_block.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace emax::chip {

void Wires::set(unsigned exception, const void* source, bool high) {
  auto& sources = high_[exception];
  sources[source] = high;
  nvic_.set_line(exception, std::any_of(sources.begin(), sources.end(),
                                        [](const auto& entry) { return entry.second; }));
}

void Wires::clear() {
  for (const auto& entry : high_) {
    nvic_.set_line(entry.first, false);
  }
  high_.clear();
}

RegisterBlock::RegisterBlock(Context context, std::string name, Registers registers)
    : context_(context), name_(std::move(name)), registers_(std::move(registers)) {
  index_.fill(-1);
  for (std::size_t i = 0; i < registers_.size(); ++i) {
    index_.at(registers_[i].offset / 4) = static_cast<std::int16_t>(i);
    values_.push_back(registers_[i].reset);
  }
}

void RegisterBlock::reset() {
  for (std::size_t i = 0; i < registers_.size(); ++i) {
    values_[i] = registers_[i].reset;
  }
  on_reset();
}

const Register* RegisterBlock::row(std::uint32_t offset) const {
  const std::int16_t at = offset / 4 < index_.size() ? index_[offset / 4] : std::int16_t{-1};
  return at < 0 ? nullptr : &registers_[static_cast<std::size_t>(at)];
}

std::string RegisterBlock::where(std::uint32_t offset) const {
  const Register* found = row(offset);
  return name_ + "." + (found != nullptr ? found->name : std::to_string(offset));
}

void RegisterBlock::report(const std::string& what, std::uint32_t offset,
                           std::uint32_t value) const {
  context_.findings.report(what, where(offset), value);
}

unsigned RegisterBlock::widths(std::uint32_t) const { return 4; }

bool RegisterBlock::reachable(std::uint32_t offset, unsigned bytes) {
  if (!gate_.on) {
    report("clock_off", offset);
    return false;
  }
  if (gate_.in_reset) {
    report("held_in_reset", offset);
    return false;
  }
  if (row(offset) == nullptr) {
    report("no_such_register", offset);
    return false;
  }
  if (offset % bytes != 0) {
    report("misaligned", offset);
    return false;
  }
  if ((widths(offset) & bytes) == 0) {
    report("wrong_width", offset, bytes);
    return false;
  }
  return true;
}

std::uint32_t RegisterBlock::bus_read(std::uint32_t offset, unsigned bytes) {
  gate_.fresh = false;
  if (!reachable(offset, bytes)) {
    return 0;
  }
  const std::uint32_t word = offset & ~3U;
  const std::uint32_t value = on_read(word, get(word)) >> (8 * (offset & 3));
  return bytes == 4 ? value : value & ((1U << (8 * bytes)) - 1);
}

void RegisterBlock::bus_write(std::uint32_t offset, unsigned bytes, std::uint32_t value) {
  if (gate_.on && std::exchange(gate_.fresh, false)) {
    report("clock_enable_not_read_back", offset, value);
  }
  if (!reachable(offset, bytes)) {
    return;
  }
  const std::uint32_t word = offset & ~3U;
  const Register& found = *row(word);
  if (found.writable == 0) {
    report("read_only_register_written", word, value);
    return;
  }
  if (bytes < 4) {  // The other bytes keep what they are.
    const unsigned shift = 8 * (offset & 3);
    const std::uint32_t mask = ((1U << (8 * bytes)) - 1) << shift;
    value = (stored(word) & ~mask) | (value << shift & mask);
  }
  if (((value ^ found.reset) & ~found.exists) != 0) {
    report("reserved_bit_written", word, value);
  }
  on_write(word, value);
}

void RegisterBlock::hold(const std::string& register_name, std::uint32_t bits,
                         std::uint32_t value) {
  const auto found =
      std::find_if(registers_.begin(), registers_.end(),
                   [&](const Register& candidate) { return register_name == candidate.name; });
  if (found == registers_.end()) {
    throw std::invalid_argument("no register " + name_ + "." + register_name);
  }
  held_[found->offset] = {bits, value & bits};
}

std::uint32_t RegisterBlock::stored(std::uint32_t offset) const {
  return values_[static_cast<std::size_t>(row(offset) - registers_.data())];
}

std::uint32_t RegisterBlock::get(std::uint32_t offset) const {
  const std::uint32_t value = stored(offset);
  if (held_.empty()) {
    return value;
  }
  const auto held = held_.find(offset);
  return held == held_.end() ? value : (value & ~held->second.bits) | held->second.value;
}

void RegisterBlock::put(std::uint32_t offset, std::uint32_t value) {
  values_[static_cast<std::size_t>(row(offset) - registers_.data())] = value;
}

std::uint32_t RegisterBlock::masked(std::uint32_t offset, std::uint32_t value) const {
  const std::uint32_t writable = row(offset)->writable;
  return (stored(offset) & ~writable) | (value & writable);
}

std::uint32_t RegisterBlock::on_read(std::uint32_t, std::uint32_t value) { return value; }

void RegisterBlock::on_write(std::uint32_t offset, std::uint32_t value) {
  put(offset, masked(offset, value));
}

}  // namespace emax::chip
