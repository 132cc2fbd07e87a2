// The error queue and its overflow rule.
#include "emax/app/scpi/error_queue.hpp"

#include "characters.hpp"

namespace emax::app::scpi {
namespace {

bool is_text(const char* characters, std::size_t length) noexcept {
  for (std::size_t i = 0; i < length; ++i) {
    if (!is_printable(characters[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace

/// @returns An empty entry at the end; null if the queue is full, and then says so.
ErrorEntry* ErrorQueue::take_place() noexcept {
  const bool is_full = size_ == kCapacity;
  size_ = static_cast<std::uint8_t>(size_ + (is_full ? 0 : 1));
  ErrorEntry& last = entries_[(first_ + std::size_t{size_} - 1) % kCapacity];
  last = {};
  last.code = ErrorCode::kQueueOverflow;
  return is_full ? nullptr : &last;
}

bool ErrorQueue::push(ErrorCode code, Span<const char> context) noexcept {
  ErrorEntry* const entry = take_place();
  if (entry == nullptr) {
    return false;
  }
  const std::size_t length =
      context.size() < ErrorEntry::kContextCapacity ? context.size() : ErrorEntry::kContextCapacity;
  entry->code = code;
  entry->context_length = static_cast<std::uint8_t>(length);
  for (std::size_t i = 0; i < length; ++i) {
    entry->context[i] = is_printable(context[i]) ? context[i] : '.';
  }
  return true;
}

bool ErrorQueue::push(ErrorCode code, const char* subject, const char* words) noexcept {
  ErrorEntry* const entry = take_place();
  if (entry == nullptr) {
    return false;
  }
  entry->code = code;
  entry->subject = subject;
  entry->words = words;
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
    const bool has_more = entry.context_length != 0 || entry.words != nullptr;
    if (entry.code == ErrorCode::kNoError || entry.context_length > ErrorEntry::kContextCapacity ||
        (is_overflow && has_more) || !is_text(entry.context, entry.context_length)) {
      return false;
    }
  }
  return true;
}

}  // namespace emax::app::scpi
