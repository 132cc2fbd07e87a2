// Status registers: transitions, summaries and what clears what.
#include "emax/app/scpi/status_model.hpp"

#include <cstddef>

namespace emax::app::scpi {

void StatusRegister::set_condition(std::uint16_t bits) noexcept {
  const auto wanted = static_cast<std::uint16_t>(bits & kAllBits);
  const int rising = wanted & ~condition_ & positive_;
  const int falling = condition_ & ~wanted & negative_;
  event_ = static_cast<std::uint16_t>(event_ | rising | falling);
  condition_ = wanted;
}

std::uint16_t StatusRegister::take_event() noexcept {
  const std::uint16_t event = event_;
  event_ = 0;
  return event;
}

void StatusRegister::preset() noexcept {
  enable_ = 0;
  positive_ = kAllBits;
  negative_ = 0;
}

bool StatusRegister::consistent() const noexcept {
  return ((condition_ | event_ | enable_ | positive_ | negative_) & ~kAllBits) == 0;
}

void StatusModel::power_on() noexcept {
  *this = {};
  operation_.preset();
  questionable_.preset();
  events_ = kPowerOn;
}

void StatusModel::clear() noexcept {
  errors_.clear();
  operation_.clear_event();
  questionable_.clear_event();
  events_ = 0;
}

void StatusModel::preset() noexcept {
  operation_.preset();
  questionable_.preset();
}

void StatusModel::report(ErrorCode code, Span<const char> context) noexcept {
  if (code == ErrorCode::kNoError) {
    return;
  }
  add_events(event_of(code));
  if (!errors_.push(code, context)) {
    add_events(event_of(ErrorCode::kQueueOverflow));
  }
}

void StatusModel::report(ErrorCode code, const char* words, const char* subject) noexcept {
  if (code == ErrorCode::kNoError) {
    return;
  }
  add_events(event_of(code));
  if (!errors_.push(code, subject, words)) {
    add_events(event_of(ErrorCode::kQueueOverflow));
  }
}

void StatusModel::add_events(std::uint8_t events) noexcept {
  events_ = static_cast<std::uint8_t>(events_ | events);
}

std::uint8_t StatusModel::take_events() noexcept {
  const std::uint8_t events = events_;
  events_ = 0;
  return events;
}

void StatusModel::set_service_enable(std::uint8_t bits) noexcept {
  service_enable_ = static_cast<std::uint8_t>(bits & ~kMasterSummary);
}

std::uint8_t StatusModel::status_byte(bool message_available) const noexcept {
  int byte = 0;
  byte |= errors_.empty() ? 0 : kErrorQueueSummary;
  byte |= questionable_.summary() ? kQuestionableSummary : 0;
  byte |= message_available ? kMessageAvailable : 0;
  byte |= (events_ & event_enable_) != 0 ? kStandardEventSummary : 0;
  byte |= operation_.summary() ? kOperationSummary : 0;
  byte |= (byte & service_enable_) != 0 ? kMasterSummary : 0;
  return static_cast<std::uint8_t>(byte);
}

bool StatusModel::consistent() const noexcept {
  constexpr int kUsedEvents = kOperationComplete | kQueryErrorEvent | kDeviceErrorEvent |
                              kExecutionErrorEvent | kCommandErrorEvent | kPowerOn;
  return errors_.consistent() && operation_.consistent() && questionable_.consistent() &&
         (events_ & ~kUsedEvents) == 0 && (service_enable_ & kMasterSummary) == 0;
}

}  // namespace emax::app::scpi
