// The status commands of IEEE 488.2 and SCPI-99 on the status model.
#include "emax/app/scpi/standard_commands.hpp"

#include "emax/app/scpi/error_queue.hpp"
#include "emax/app/scpi/status_model.hpp"

namespace emax::app::scpi {
namespace {

constexpr IntegerRule kByte{0, 255, 0};
// Bit 15 may be sent but stays 0. The defaults are what STATus:PRESet leaves.
constexpr IntegerRule kEnable{0, 65535, 0};
constexpr IntegerRule kPositive{0, 65535, StatusRegister::kAllBits};

bool byte_setting(Call& call, std::uint8_t current, std::uint8_t& value) noexcept {
  std::int64_t number = 0;
  if (!call.integer_setting(kByte, current, number)) {
    return false;
  }
  value = static_cast<std::uint8_t>(number);
  return true;
}

bool word_setting(Call& call, const IntegerRule& rule, std::uint16_t current,
                  std::uint16_t& value) noexcept {
  std::int64_t number = 0;
  if (!call.integer_setting(rule, current, number)) {
    return false;
  }
  value = static_cast<std::uint16_t>(number);
  return true;
}

void enable(Call& call, StatusRegister& status) noexcept {
  std::uint16_t bits = 0;
  if (word_setting(call, kEnable, status.enable(), bits)) {
    status.set_enable(bits);
  }
}

void positive(Call& call, StatusRegister& status) noexcept {
  std::uint16_t bits = 0;
  if (word_setting(call, kPositive, status.positive_filter(), bits)) {
    status.set_positive_filter(bits);
  }
}

void negative(Call& call, StatusRegister& status) noexcept {
  std::uint16_t bits = 0;
  if (word_setting(call, kEnable, status.negative_filter(), bits)) {
    status.set_negative_filter(bits);
  }
}

}  // namespace

void clear_status(Call& call) noexcept { call.status().clear(); }

void event_enable(Call& call) noexcept {
  std::uint8_t bits = 0;
  if (byte_setting(call, call.status().event_enable(), bits)) {
    call.status().set_event_enable(bits);
  }
}

void event_status(Call& call) noexcept { call.answer().integer(call.status().take_events()); }

void service_enable(Call& call) noexcept {
  std::uint8_t bits = 0;
  if (byte_setting(call, call.status().service_enable(), bits)) {
    call.status().set_service_enable(bits);
  }
}

void status_byte(Call& call) noexcept {
  call.answer().integer(call.status().status_byte(call.message_available()));
}

void next_error(Call& call) noexcept {
  const ErrorEntry entry = call.status().take_error();
  call.answer().integer(static_cast<std::int16_t>(entry.code));
  call.answer().error(entry);
}

void all_errors(Call& call) noexcept {
  if (call.stage() != Call::Stage::kItem) {
    const std::size_t count = call.status().errors().size();
    call.answer_items(count > 0 ? count : 1);
    return;
  }
  next_error(call);
}

void next_code(Call& call) noexcept {
  call.answer().integer(static_cast<std::int16_t>(call.status().take_error().code));
}

void all_codes(Call& call) noexcept {
  do {
    next_code(call);
  } while (!call.status().errors().empty());
}

void error_count(Call& call) noexcept {
  call.answer().integer(static_cast<std::int64_t>(call.status().errors().size()));
}

void version(Call& call) noexcept { call.answer().word("1999.0"); }

void status_preset(Call& call) noexcept { call.status().preset(); }

void operation_event(Call& call) noexcept {
  call.answer().integer(call.status().operation().take_event());
}

void operation_condition(Call& call) noexcept {
  call.answer().integer(call.status().operation().condition());
}

void operation_enable(Call& call) noexcept { enable(call, call.status().operation()); }

void operation_positive(Call& call) noexcept { positive(call, call.status().operation()); }

void operation_negative(Call& call) noexcept { negative(call, call.status().operation()); }

void questionable_event(Call& call) noexcept {
  call.answer().integer(call.status().questionable().take_event());
}

void questionable_condition(Call& call) noexcept {
  call.answer().integer(call.status().questionable().condition());
}

void questionable_enable(Call& call) noexcept { enable(call, call.status().questionable()); }

void questionable_positive(Call& call) noexcept { positive(call, call.status().questionable()); }

void questionable_negative(Call& call) noexcept { negative(call, call.status().questionable()); }

}  // namespace emax::app::scpi
