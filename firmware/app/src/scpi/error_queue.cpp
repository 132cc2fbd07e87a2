// The error queue and its overflow rule.
#include "emax/app/scpi/error_queue.hpp"

#include "characters.hpp"

namespace emax::app::scpi {
namespace {

void assign(ErrorEntry& entry, ErrorCode code, Span<const char> context) noexcept {
  const std::size_t length =
      context.size() < ErrorEntry::kContextCapacity ? context.size() : ErrorEntry::kContextCapacity;
  entry.code = code;
  entry.context_length = static_cast<std::uint8_t>(length);
  for (std::size_t i = 0; i < length; ++i) {
    entry.context[i] = is_printable(context[i]) ? context[i] : '.';
  }
}

}  // namespace

bool ErrorQueue::push(ErrorCode code, Span<const char> context) noexcept {
  if (size_ == kCapacity) {
    const std::size_t last = (first_ + std::size_t{size_} - 1) % kCapacity;
    assign(entries_[last], ErrorCode::kQueueOverflow, {});
    return false;
  }
  assign(entries_[(first_ + std::size_t{size_}) % kCapacity], code, context);
  ++size_;
  return true;
}

ErrorEntry ErrorQueue::pop() noexcept {
  if (size_ == 0) {
    return {};
  }
  const ErrorEntry entry = entries_[first_];
  first_ = static_cast<std::uint8_t>((first_ + 1U) % kCapacity);
  --size_;
  return entry;
}

void ErrorQueue::clear() noexcept {
  first_ = 0;
  size_ = 0;
}

bool ErrorQueue::consistent() const noexcept {
  if (first_ >= kCapacity || size_ > kCapacity) {
    return false;
  }
  for (std::size_t i = 0; i < size_; ++i) {
    const ErrorEntry& entry = entries_[(first_ + i) % kCapacity];
    const bool is_overflow = entry.code == ErrorCode::kQueueOverflow;
    if (entry.code == ErrorCode::kNoError || entry.context_length > ErrorEntry::kContextCapacity ||
        (is_overflow && entry.context_length != 0)) {
      return false;
    }
    for (const char character : entry.context_text()) {
      if (!is_printable(character)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace emax::app::scpi
