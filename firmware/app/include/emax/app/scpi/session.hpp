// A conversation in SCPI: bytes in, commands executed, bytes out, nothing ever waited for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/scpi/call.hpp"
#include "emax/app/scpi/command.hpp"
#include "emax/app/scpi/input_buffer.hpp"
#include "emax/app/scpi/pattern.hpp"
#include "emax/app/scpi/program_unit.hpp"
#include "emax/app/scpi/response.hpp"
#include "emax/app/scpi/status_model.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// Executes program messages in the order in which they came, one unit for each `step()`.
///
/// While a unit waits (see `Call::wait()`) or an answer is not read, later messages stay where they
/// are, except those of at most 256 characters all of whose units are immediate: they overtake. One
/// that has queries overtakes only the message with a unit that waits, never another one with
/// queries, and only if it has at most three of them and no answer is under way: answers are never
/// mixed, and come in the order of their queries but for the one that is waited for. Of "ABOR;*RST"
/// the immediate front overtakes, and the rest stays.
///
/// After a command error (-1xx) the rest of its message is dropped; after any other error it goes
/// on with the next unit. A message with a byte that belongs into none is -101, one that is longer
/// than `InputBuffer::kCapacity` -363; neither executes anything.
///
///     stream -> room(), receive() -> step() until false -> output(), consume() -> stream
///
/// 1.4 KiB beside the input. A step costs at most one handler, one pass over one message and one
/// over the table.
class Session {
 public:
  /// Call once: registers as after switching on.
  void power_on() noexcept;

  /// @returns How many bytes `receive()` takes now: 0 while the memory is full of messages that
  /// wait. Read no more than that from the stream, which holds the sender back.
  std::size_t room() const noexcept { return input_.room(); }
  /// @param[in] bytes At most `room()`.
  void receive(Span<const char> bytes) noexcept { input_.add(bytes); }

  /// Executes the next unit, asks one that waits again, or makes the next item of an answer.
  ///
  /// @param[in] table The same at each call.
  /// @returns False if nothing can be done before new bytes come, an answer is read, or whatever a
  /// unit waits for has happened.
  template <typename Context>
  bool step(Context& context, Table<std::decay_t<Context>> table) noexcept;

  /// @returns Characters to be sent; empty if there are none.
  Span<const char> output() const noexcept { return response_.pending(); }
  /// @param[in] count Characters of `output()` that were sent.
  void consume(std::size_t count) noexcept { response_.consume(count); }

  StatusModel& status() noexcept { return status_; }
  const StatusModel& status() const noexcept { return status_; }
  /// @returns True while a unit waits.
  bool is_waiting() const noexcept { return main_.stage == Stage::kWaiting; }
  /// @returns True if no complete message is left and all answers were read.
  bool is_idle() const noexcept;
  /// @returns True while items or a block of an answer are still to be sent: what they are made of
  /// must stay as it is.
  bool is_answering() const noexcept {
    return main_.stage == Stage::kItems || main_.stage == Stage::kBlock;
  }
  bool holds_block() const noexcept { return response_.holds_block(); }

  /// @returns True if input and output are both full: a peer that does not read and goes on
  /// sending. If it lasts while nothing of `output()` is taken, `break_deadlock()` helps.
  bool is_deadlocked() const noexcept;
  /// -430: drops the answers and what is left of the message that made them, as IEEE 488.2 has it.
  void break_deadlock() noexcept;

  /// Device clear: forgets input, output and what waits. Status and errors stay. A line that was
  /// sent in part is ended.
  void clear() noexcept;
  /// The same for a new peer, who has seen nothing of that line.
  void forget_peer() noexcept;

  /// @returns False only if memory was overwritten: for tests.
  bool consistent() const noexcept;

 private:
  static constexpr std::size_t kMaxOvertaking = 256;
  static constexpr std::size_t kMaxOvertakingQueries = 3;
  static constexpr std::uint16_t kNoRow = 0xFFFF;

  enum class Stage : std::uint8_t {
    kNone,     ///< No message.
    kReady,    ///< Before the next unit.
    kCall,     ///< The unit is known but was not called.
    kWaiting,  ///< The unit asked to be called again.
    kItems,    ///< The unit answers item by item.
    kBlock,    ///< The unit's block is being sent.
  };

  /// A message under execution, and its unit.
  struct Message {
    std::size_t item = 0;
    std::size_t items = 0;
    std::uint16_t begin = 0;  ///< In the input.
    std::uint16_t length = 0;
    std::uint16_t position = 0;    ///< Of the next unit, from `begin`.
    std::uint16_t parameters = 0;  ///< Of this unit, from `begin`.
    std::uint16_t parameters_length = 0;
    std::uint16_t count = 0;  ///< Of its parameters.
    std::uint16_t row = 0;
    HeaderPath path;
    Stage stage = Stage::kNone;
    bool is_query = false;
    bool has_queries = false;
  };

  /// What a header leads to.
  struct Found {
    std::uint16_t row = kNoRow;
    HeaderPath path;
    bool has_wrong_suffix = false;
  };

  template <typename Context>
  static Found find(Table<Context> table, const ProgramUnit& unit, HeaderPath path) noexcept;
  template <typename Context>
  bool advance(Context& context, Table<Context> table, Message& message) noexcept;
  template <typename Context>
  void start_unit(Table<Context> table, Message& message) noexcept;
  template <typename Context>
  bool look_ahead(Table<Context> table) noexcept;
  template <typename Context>
  std::size_t overtaking_length(Table<Context> table, Span<const char> text) const noexcept;

  /// @returns Whether the message may answer; a question mark inside of a string counts, too.
  static bool has_query(Span<const char> text) noexcept;
  bool start_message() noexcept;
  void start_overtaking(Span<const char> text) noexcept;
  bool is_overtaking(const Message& message) const noexcept { return &message == &overtaking_; }
  std::size_t room_needed(const Message& message) const noexcept;
  bool can_call(const Message& message) const noexcept;
  bool may_answer(std::size_t overtaking_queries) const noexcept;
  void accept(Message& message, const ProgramUnit& unit, const Found& found) noexcept;
  void reject(Message& message, ErrorCode error, Span<const char> offender) noexcept;
  Call begin_call(const Message& message) noexcept;
  bool end_call(Message& message, Call& call) noexcept;
  void end_message(Message& message) noexcept;

  StatusModel status_;
  Response response_;
  InputBuffer input_;
  Message main_;
  Message overtaking_;
  std::uint16_t looked_at_ = 0;    ///< Messages before this offset stay in order.
  bool has_passed_query_ = false;  ///< One of them has a query.
};

static_assert(std::is_trivially_copyable_v<Session>);
static_assert(sizeof(Session) <= InputBuffer::kCapacity + std::size_t{2} * 1024);

template <typename Context>
bool Session::step(Context& context, Table<std::decay_t<Context>> table) noexcept {
  if (overtaking_.stage != Stage::kNone) {
    return advance(context, table, overtaking_);
  }
  if (main_.stage == Stage::kNone) {
    return start_message();
  }
  return advance(context, table, main_) || look_ahead(table);
}

template <typename Context>
Session::Found Session::find(Table<Context> table, const ProgramUnit& unit,
                             HeaderPath path) noexcept {
  Found found;
  const bool is_at_root = unit.is_common || unit.is_absolute || path.nodes == 0;
  const char* from = is_at_root ? "" : table[path.row].pattern;
  const std::uint16_t nodes = is_at_root ? std::uint16_t{0} : path.nodes;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const HeaderMatchResult result = match_header(table[row].pattern, unit.name, from, nodes);
    const bool has_form = unit.is_query ? table[row].has_query() : table[row].has_set();
    if (result.match == HeaderMatch::kNo || !has_form) {
      continue;
    }
    found.has_wrong_suffix = result.match == HeaderMatch::kSuffixOutOfRange;
    if (!found.has_wrong_suffix) {
      found.row = static_cast<std::uint16_t>(row);
      found.path = unit.is_common ? path : HeaderPath{found.row, result.nodes};
      return found;
    }
  }
  return found;
}

template <typename Context>
void Session::start_unit(Table<Context> table, Message& message) noexcept {
  std::size_t position = message.position;
  const ProgramUnit unit = cut_unit(input_.text(message.begin, message.length), position);
  message.position = static_cast<std::uint16_t>(position);
  if (unit.is_empty) {
    return;
  }
  if (unit.error != ErrorCode::kNoError) {
    reject(message, unit.error, unit.header);
    return;
  }
  const Found found = find(table, unit, message.path);
  if (found.row == kNoRow) {
    reject(
        message,
        found.has_wrong_suffix ? ErrorCode::kHeaderSuffixOutOfRange : ErrorCode::kUndefinedHeader,
        unit.header);
    return;
  }
  const Arity arity = table[found.row].arity(unit.is_query);
  if (unit.count < arity.min) {
    const bool is_block = begins_block(unit.parameters);
    reject(message, is_block ? ErrorCode::kBlockDataNotAllowed : ErrorCode::kMissingParameter,
           is_block ? unit.parameters : unit.header);
    return;
  }
  if (unit.count > arity.max) {
    reject(message, ErrorCode::kParameterNotAllowed, unit.parameters);
    return;
  }
  accept(message, unit, found);
}

template <typename Context>
bool Session::advance(Context& context, Table<Context> table, Message& message) noexcept {
  if (message.stage == Stage::kReady) {
    if (message.position == message.length) {
      end_message(message);
      return true;
    }
    start_unit(table, message);
    if (message.stage == Stage::kReady) {
      return true;
    }
  }
  if (!can_call(message)) {
    return false;
  }
  if (message.stage == Stage::kBlock) {
    message.stage = Stage::kReady;
    return true;
  }
  Call call = begin_call(message);
  table[message.row].handler(context, call);
  return end_call(message, call);
}

template <typename Context>
bool Session::look_ahead(Table<Context> table) noexcept {
  const MessageText message = input_.message_at(looked_at_);
  if (!message.is_complete) {
    return false;
  }
  const std::size_t length = message.is_valid ? overtaking_length(table, message.text) : 0;
  if (length > 0) {
    start_overtaking(message.text.first(length));
  } else {
    has_passed_query_ = has_passed_query_ || has_query(message.text);
    looked_at_ = static_cast<std::uint16_t>(looked_at_ + message.text.size() + 1);
  }
  return true;
}

/// @returns The characters of the message that overtake: all of it, the units in front of a
/// semicolon if they answer nothing and leave the path at the root, or none.
template <typename Context>
std::size_t Session::overtaking_length(Table<Context> table, Span<const char> text) const noexcept {
  if (text.size() > kMaxOvertaking) {
    return 0;
  }
  HeaderPath path;
  std::size_t queries = 0;
  for (std::size_t position = 0; position < text.size();) {
    const std::size_t begin = position;
    const ProgramUnit unit = cut_unit(text, position);
    if (unit.is_empty) {
      continue;
    }
    const Found found = unit.error == ErrorCode::kNoError ? find(table, unit, path) : Found{};
    if (found.row == kNoRow || !table[found.row].is_immediate()) {
      return begin > 0 && queries == 0 && path.nodes == 0 ? begin - 1 : 0;
    }
    path = found.path;
    queries += unit.is_query ? 1U : 0U;
  }
  return may_answer(queries) ? text.size() : 0;
}

}  // namespace emax::app::scpi
