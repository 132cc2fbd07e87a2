// Which message is executed next, and what becomes of it after each call.
#include "emax/app/scpi/session.hpp"

namespace emax::app::scpi {
namespace {

constexpr char kTooLong[] = "a line has 4096 characters at most";
constexpr char kTooLongOnPc[] = "a line has 32768 characters at most";
static_assert(InputBuffer::kCapacity == 4096 || InputBuffer::kCapacity == 32768,
              "as these words say");

constexpr std::size_t kMaxOffender = 40;

/// The end of a text is where its invalid byte is.
Span<const char> last_characters(Span<const char> text) noexcept {
  return text.size() > kMaxOffender ? text.from(text.size() - kMaxOffender) : text;
}

}  // namespace

void Session::power_on() noexcept {
  forget_peer();
  status_.power_on();
}

bool Session::is_idle() const noexcept {
  return main_.stage == Stage::kNone && input_.complete() == 0 && response_.empty();
}

bool Session::is_deadlocked() const noexcept {
  const bool has_unit = main_.stage != Stage::kNone && main_.stage != Stage::kReady;
  const bool needs_reader = is_answering() || (has_unit && !can_call(main_));
  return needs_reader && !response_.empty() && input_.room() == 0;
}

void Session::break_deadlock() noexcept {
  response_.drop_unsent();
  if (overtaking_.stage != Stage::kNone) {
    overtaking_.has_queries = false;
    end_message(overtaking_);
  }
  main_.position = main_.length;
  main_.stage = main_.stage == Stage::kNone ? Stage::kNone : Stage::kReady;
  status_.report(ErrorCode::kQueryDeadlocked);
}

void Session::clear() noexcept {
  response_.drop_unsent();
  input_.clear();
  main_ = {};
  overtaking_ = {};
  looked_at_ = 0;
  has_passed_query_ = false;
}

void Session::forget_peer() noexcept {
  clear();
  response_.clear();
}

bool Session::start_message() noexcept {
  const MessageText message = input_.message_at(0);
  if (!message.is_complete) {
    return false;
  }
  if (message.text.empty()) {
    status_.report(ErrorCode::kInputBufferOverrun,
                   InputBuffer::kCapacity == 4096 ? kTooLong : kTooLongOnPc);
    input_.remove(0, 0);
    return true;
  }
  if (!message.is_valid) {
    status_.report(ErrorCode::kInvalidCharacter, last_characters(message.text));
    input_.remove(0, message.text.size());
    return true;
  }
  main_ = {};
  main_.length = static_cast<std::uint16_t>(message.text.size());
  main_.stage = Stage::kReady;
  looked_at_ = static_cast<std::uint16_t>(main_.length + 1);
  has_passed_query_ = false;
  return true;
}

void Session::start_overtaking(Span<const char> text) noexcept {
  overtaking_ = {};
  overtaking_.begin = looked_at_;
  overtaking_.length = static_cast<std::uint16_t>(text.size());
  overtaking_.stage = Stage::kReady;
}

bool Session::has_query(Span<const char> text) noexcept {
  for (const char c : text) {
    if (c == '?') {
      return true;
    }
  }
  return false;
}

/// What the answer may take, with the separator before it.
std::size_t Session::room_needed(const Message& message) const noexcept {
  return 1 + (is_overtaking(message) ? Response::kImmediateRoom : Response::kAnswerRoom);
}

bool Session::can_call(const Message& message) const noexcept {
  if (!message.is_query) {
    return true;
  }
  // The line feed has its place, too.
  return !response_.holds_block() && response_.room() > room_needed(message);
}

bool Session::may_answer(std::size_t overtaking_queries) const noexcept {
  if (overtaking_queries == 0) {
    return true;
  }
  if (main_.stage != Stage::kWaiting || has_passed_query_) {
    return false;
  }
  const std::size_t needed = overtaking_queries * (Response::kImmediateRoom + 1) + 1;
  return overtaking_queries <= kMaxOvertakingQueries && !response_.is_open() &&
         response_.room() >= needed;
}

void Session::accept(Message& message, const ProgramUnit& unit, const Found& found) noexcept {
  const char* begin = input_.text(message.begin, 0).data();
  const bool has_parameters = !unit.parameters.empty();
  message.parameters = has_parameters ? static_cast<std::uint16_t>(unit.parameters.data() - begin)
                                      : std::uint16_t{0};
  message.parameters_length = static_cast<std::uint16_t>(unit.parameters.size());
  message.count = static_cast<std::uint16_t>(unit.count);
  message.row = found.row;
  message.path = found.path;
  message.is_query = unit.is_query;
  message.has_queries = message.has_queries || unit.is_query;
  message.stage = Stage::kCall;
}

void Session::reject(Message& message, ErrorCode error, Span<const char> offender) noexcept {
  status_.report(error, offender);
  message.position = message.length;
}

Call Session::begin_call(const Message& message) noexcept {
  using CallStage = Call::Stage;
  const bool is_item = message.stage == Stage::kItems;
  // An answer of this message may have gone out already, all but its line feed.
  const bool message_available = !response_.empty() || response_.is_open();
  if (!message.is_query) {
    response_.begin_item(0);
  } else if (is_item) {
    response_.begin_item(room_needed(message));
  } else {
    response_.begin_answer(room_needed(message));
  }
  const CallStage again = message.stage == Stage::kWaiting ? CallStage::kAgain : CallStage::kStart;
  Call::Origin origin;
  origin.stage = is_item ? CallStage::kItem : again;
  origin.item = message.item;
  origin.count = message.count;
  origin.is_query = message.is_query;
  origin.is_overtaking = is_overtaking(message);
  origin.message_available = message_available;
  const auto begin = static_cast<std::size_t>(message.begin + message.parameters);
  return Call(status_, response_, input_.text(begin, message.parameters_length), origin);
}

/// @returns False if the unit still waits.
bool Session::end_call(Message& message, Call& call) noexcept {
  const bool defers =
      call.waits_ || call.items_ > 0 || (message.is_query && response_.holds_block());
  if (!response_.fits()) {
    call.fail(ErrorCode::kSystemError, "the answer is too long");
  } else if (is_overtaking(message) && defers && !call.failed_) {
    call.fail(ErrorCode::kSystemError, "an immediate command waits");
  }
  if (call.failed_) {
    response_.drop_answer();
    message.stage = Stage::kReady;
    message.position = call.stops_message_ ? message.length : message.position;
    return true;
  }
  if (call.waits_) {
    response_.drop_answer();
    message.stage = message.stage == Stage::kItems ? Stage::kItems : Stage::kWaiting;
    return false;
  }
  if (message.stage == Stage::kItems) {
    ++message.item;
  } else {
    message.item = 0;
    message.items = call.items_;
  }
  if (message.item < message.items) {
    message.stage = Stage::kItems;
  } else {
    message.stage = message.is_query && response_.holds_block() ? Stage::kBlock : Stage::kReady;
  }
  return true;
}

void Session::end_message(Message& message) noexcept {
  // What a message without queries overtakes may be in the middle of its answers.
  if (!is_overtaking(message) || message.has_queries) {
    response_.end_message();
  }
  input_.remove(message.begin, message.length);
  if (!is_overtaking(message)) {
    looked_at_ = 0;
  }
  message = {};
}

bool Session::consistent() const noexcept {
  const auto fits = [](const Message& message, std::size_t from, std::size_t end) noexcept {
    return message.stage == Stage::kNone ||
           (message.begin >= from && std::size_t{message.begin} + message.length < end &&
            message.position <= message.length &&
            message.parameters + message.parameters_length <= message.length);
  };
  const std::size_t end = input_.complete();
  const bool is_alone = main_.stage != Stage::kNone || overtaking_.stage == Stage::kNone;
  return status_.consistent() && response_.consistent() && input_.consistent() && is_alone &&
         fits(main_, 0, end) && fits(overtaking_, std::size_t{main_.length} + 1, end) &&
         looked_at_ <= end;
}

}  // namespace emax::app::scpi
