// Where messages end, and the memory they wait in.
#include "emax/app/scpi/input_buffer.hpp"

#include "characters.hpp"

namespace emax::app::scpi {

MessageScanner::Event MessageScanner::next(char byte) noexcept {
  if (is_line_end(byte)) {
    *this = {};
    return Event::kEnd;
  }
  if (state_ == State::kHash && is_digit(byte)) {
    state_ = State::kBlock;
  }
  if (state_ == State::kBlock) {
    return Event::kMore;
  }
  if (!is_printable(byte) && !is_blank(byte)) {
    return Event::kInvalid;
  }
  if (state_ == State::kString) {
    state_ = byte == quote_ ? State::kQuote : State::kString;
    return Event::kMore;
  }
  if (state_ == State::kQuote && byte == quote_) {
    state_ = State::kString;
    return Event::kMore;
  }
  return next_of_text(byte);
}

MessageScanner::Event MessageScanner::next_of_text(char byte) noexcept {
  if (byte == ';') {
    *this = {};
    return Event::kUnitEnd;
  }
  if (is_blank(byte)) {
    state_ = state_ == State::kHeader ? State::kElement : state_;
    return Event::kMore;
  }
  if (state_ == State::kBeforeHeader || state_ == State::kHeader) {
    state_ = State::kHeader;
    return Event::kMore;
  }
  return next_of_element(byte);
}

MessageScanner::Event MessageScanner::next_of_element(char byte) noexcept {
  if (byte == '(') {
    ++parentheses_;
  } else if (byte == ')' && parentheses_ > 0) {
    --parentheses_;
  } else if (parentheses_ == 0 && byte == ',') {
    state_ = State::kElement;
    return Event::kSeparator;
  } else if (state_ == State::kElement && (byte == '"' || byte == '\'')) {
    quote_ = byte;
    state_ = State::kString;
    return Event::kMore;
  }
  state_ = state_ == State::kElement && byte == '#' ? State::kHash : State::kInElement;
  return Event::kMore;
}

std::size_t InputBuffer::room() const noexcept {
  if (complete_ == 0) {
    // One byte more than fits shows that a message is too long.
    return kCapacity + 1 - size_;
  }
  return size_ < kCapacity ? kCapacity - size_ : 0;
}

void InputBuffer::add(Span<const char> bytes) noexcept {
  for (const char byte : bytes) {
    if (drops_) {
      drops_ = !is_line_end(byte);
    } else {
      take(byte);
    }
  }
}

void InputBuffer::take(char byte) noexcept {
  const MessageScanner::Event event = scanner_.next(byte);
  const auto length = static_cast<std::size_t>(size_ - complete_);
  if (event == MessageScanner::Event::kEnd) {
    if (length > 0) {
      end_message();
    }
    return;
  }
  if (length + 1 > kCapacity) {
    // An empty message, which is never kept otherwise, stands for it.
    size_ = complete_;
    end_message();
    drop_rest();
    return;
  }
  bytes_[size_] = byte;
  ++size_;
  if (event == MessageScanner::Event::kInvalid) {
    end_message();
    drop_rest();
  }
}

void InputBuffer::end_message() noexcept {
  bytes_[size_] = '\n';
  ++size_;
  complete_ = size_;
}

void InputBuffer::drop_rest() noexcept {
  scanner_ = {};
  drops_ = true;
}

MessageText InputBuffer::message_at(std::size_t offset) const noexcept {
  MessageText message;
  if (offset >= complete_) {
    return message;
  }
  message.is_complete = true;
  message.is_valid = true;
  MessageScanner scanner;
  std::size_t end = offset;
  for (; end < complete_; ++end) {
    const MessageScanner::Event event = scanner.next(bytes_[end]);
    if (event == MessageScanner::Event::kEnd) {
      break;
    }
    if (event == MessageScanner::Event::kInvalid) {
      message.is_valid = false;
      ++end;
      break;
    }
  }
  message.text = text(offset, end - offset);
  return message;
}

void InputBuffer::remove(std::size_t offset, std::size_t length) noexcept {
  const std::size_t count = length + 1;
  for (std::size_t i = offset + count; i < size_; ++i) {
    bytes_[i - count] = bytes_[i];
  }
  size_ = static_cast<std::uint16_t>(size_ - count);
  complete_ = static_cast<std::uint16_t>(complete_ - count);
}

void InputBuffer::clear() noexcept {
  size_ = 0;
  complete_ = 0;
  scanner_ = {};
  drops_ = false;
}

bool InputBuffer::consistent() const noexcept {
  return complete_ <= size_ && size_ <= kMemory &&
         (complete_ == 0 || bytes_[complete_ - 1] == '\n');
}

}  // namespace emax::app::scpi
