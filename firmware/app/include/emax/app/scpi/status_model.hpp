// The status registers of IEEE 488.2 and SCPI-99, and the error queue they summarise.
#pragma once

#include <cstdint>
#include <type_traits>

#include "emax/app/scpi/error_code.hpp"
#include "emax/app/scpi/error_queue.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// Bits of the standard event status register, `*ESR?`.
enum StandardEvent : std::uint8_t {
  kOperationComplete = 1 << 0,
  kQueryErrorEvent = 1 << 2,
  kDeviceErrorEvent = 1 << 3,
  kExecutionErrorEvent = 1 << 4,
  kCommandErrorEvent = 1 << 5,
  kPowerOn = 1 << 7,
};

/// Bits of the status byte, `*STB?`.
enum StatusByte : std::uint8_t {
  kErrorQueueSummary = 1 << 2,
  kQuestionableSummary = 1 << 3,
  kMessageAvailable = 1 << 4,
  kStandardEventSummary = 1 << 5,
  kMasterSummary = 1 << 6,
  kOperationSummary = 1 << 7,
};

/// Bits of STATus:OPERation that SCPI-99 defines.
enum OperationBit : std::uint16_t {
  kCalibrating = 1 << 0,
  kSettling = 1 << 1,
  kRanging = 1 << 2,
  kSweeping = 1 << 3,
  kMeasuring = 1 << 4,
  kWaitingForTrigger = 1 << 5,
  kWaitingForArm = 1 << 6,
  kCorrecting = 1 << 7,
};

/// Bits of STATus:QUEStionable that SCPI-99 defines.
enum QuestionableBit : std::uint16_t {
  kQuestionableVoltage = 1 << 0,
  kQuestionableCurrent = 1 << 1,
  kQuestionableTime = 1 << 2,
  kQuestionablePower = 1 << 3,
  kQuestionableTemperature = 1 << 4,
  kQuestionableFrequency = 1 << 5,
  kQuestionablePhase = 1 << 6,
  kQuestionableModulation = 1 << 7,
  kQuestionableCalibration = 1 << 8,
};

/// One SCPI status structure: condition, two transition filters, event, enable. Bit 15 is never
/// used (SCPI-99), so all values are below 32768.
class StatusRegister {
 public:
  static constexpr std::uint16_t kAllBits = 0x7FFF;

  /// Sets the condition; each bit that changes in a direction its filter lets through sets its
  /// event.
  void set_condition(std::uint16_t bits) noexcept;
  std::uint16_t condition() const noexcept { return condition_; }
  /// Reading clears.
  std::uint16_t take_event() noexcept;
  std::uint16_t event() const noexcept { return event_; }
  void clear_event() noexcept { event_ = 0; }
  void set_enable(std::uint16_t bits) noexcept { enable_ = bits & kAllBits; }
  std::uint16_t enable() const noexcept { return enable_; }
  void set_positive_filter(std::uint16_t bits) noexcept { positive_ = bits & kAllBits; }
  /// @returns Rising bits that become events; all of them after `preset()`.
  std::uint16_t positive_filter() const noexcept { return positive_; }
  void set_negative_filter(std::uint16_t bits) noexcept { negative_ = bits & kAllBits; }
  std::uint16_t negative_filter() const noexcept { return negative_; }
  /// As STATus:PRESet: nothing enabled, rising bits become events. Condition and event are kept.
  void preset() noexcept;
  bool summary() const noexcept { return (event_ & enable_) != 0; }
  bool consistent() const noexcept;

 private:
  std::uint16_t condition_ = 0;
  std::uint16_t event_ = 0;
  std::uint16_t enable_ = 0;
  std::uint16_t positive_ = 0;
  std::uint16_t negative_ = 0;
};

/// All registers. 0.8 KiB with the queue.
class StatusModel {
 public:
  /// As after switching on: nothing enabled, filters preset, the queue empty, ESR = power on.
  void power_on() noexcept;
  /// `*CLS`: clears all events and the error queue. Enables, filters and conditions are kept.
  void clear() noexcept;
  /// `STATus:PRESet`.
  void preset() noexcept;

  /// Queues an error and sets the bit of its class. kNoError does nothing.
  void report(ErrorCode code, Span<const char> context) noexcept;
  /// @param[in] words   Kept by their address; may be null.
  /// @param[in] subject What they are about; may be null.
  void report(ErrorCode code, const char* words = nullptr, const char* subject = nullptr) noexcept;

  /// Takes the oldest error off the queue.
  ErrorEntry take_error() noexcept { return errors_.pop(); }
  const ErrorQueue& errors() const noexcept { return errors_; }

  /// Sets bits of `StandardEvent`, such as kOperationComplete.
  void add_events(std::uint8_t events) noexcept;
  /// `*ESR?`: reading clears.
  std::uint8_t take_events() noexcept;
  std::uint8_t events() const noexcept { return events_; }
  void set_event_enable(std::uint8_t bits) noexcept { event_enable_ = bits; }
  std::uint8_t event_enable() const noexcept { return event_enable_; }
  /// `*SRE`; bit 6 cannot be enabled and reads 0.
  void set_service_enable(std::uint8_t bits) noexcept;
  std::uint8_t service_enable() const noexcept { return service_enable_; }

  StatusRegister& operation() noexcept { return operation_; }
  const StatusRegister& operation() const noexcept { return operation_; }
  StatusRegister& questionable() noexcept { return questionable_; }
  const StatusRegister& questionable() const noexcept { return questionable_; }

  /// `*STB?`: bit 6 is the master summary; RQS exists in a serial poll only.
  ///
  /// @param[in] message_available Whether an answer waits to be read.
  std::uint8_t status_byte(bool message_available) const noexcept;

  /// @returns False only if a register holds what no sequence of calls can leave there: for tests.
  bool consistent() const noexcept;

 private:
  ErrorQueue errors_;
  StatusRegister operation_;
  StatusRegister questionable_;
  std::uint8_t events_ = 0;
  std::uint8_t event_enable_ = 0;
  std::uint8_t service_enable_ = 0;
};

static_assert(std::is_trivially_copyable_v<StatusModel>);

}  // namespace emax::app::scpi
