// Texts and classes of the standard's error numbers.
#include "emax/app/scpi/error_code.hpp"

#include "emax/app/scpi/status_model.hpp"

namespace emax::app::scpi {
namespace {

struct ErrorText {
  ErrorCode code;
  const char* text;
};

constexpr ErrorText kTexts[] = {
    {ErrorCode::kNoError, "No error"},
    {ErrorCode::kCommandError, "Command error"},
    {ErrorCode::kInvalidCharacter, "Invalid character"},
    {ErrorCode::kSyntaxError, "Syntax error"},
    {ErrorCode::kInvalidSeparator, "Invalid separator"},
    {ErrorCode::kDataTypeError, "Data type error"},
    {ErrorCode::kParameterNotAllowed, "Parameter not allowed"},
    {ErrorCode::kMissingParameter, "Missing parameter"},
    {ErrorCode::kCommandHeaderError, "Command header error"},
    {ErrorCode::kHeaderSeparatorError, "Header separator error"},
    {ErrorCode::kProgramMnemonicTooLong, "Program mnemonic too long"},
    {ErrorCode::kUndefinedHeader, "Undefined header"},
    {ErrorCode::kHeaderSuffixOutOfRange, "Header suffix out of range"},
    {ErrorCode::kNumericDataError, "Numeric data error"},
    {ErrorCode::kInvalidCharacterInNumber, "Invalid character in number"},
    {ErrorCode::kExponentTooLarge, "Exponent too large"},
    {ErrorCode::kTooManyDigits, "Too many digits"},
    {ErrorCode::kNumericDataNotAllowed, "Numeric data not allowed"},
    {ErrorCode::kInvalidSuffix, "Invalid suffix"},
    {ErrorCode::kSuffixTooLong, "Suffix too long"},
    {ErrorCode::kSuffixNotAllowed, "Suffix not allowed"},
    {ErrorCode::kInvalidCharacterData, "Invalid character data"},
    {ErrorCode::kCharacterDataTooLong, "Character data too long"},
    {ErrorCode::kCharacterDataNotAllowed, "Character data not allowed"},
    {ErrorCode::kStringDataError, "String data error"},
    {ErrorCode::kInvalidStringData, "Invalid string data"},
    {ErrorCode::kStringDataNotAllowed, "String data not allowed"},
    {ErrorCode::kInvalidBlockData, "Invalid block data"},
    {ErrorCode::kBlockDataNotAllowed, "Block data not allowed"},
    {ErrorCode::kExpressionDataNotAllowed, "Expression data not allowed"},
    {ErrorCode::kExecutionError, "Execution error"},
    {ErrorCode::kInitIgnored, "Init ignored"},
    {ErrorCode::kSettingsConflict, "Settings conflict"},
    {ErrorCode::kDataOutOfRange, "Data out of range"},
    {ErrorCode::kTooMuchData, "Too much data"},
    {ErrorCode::kIllegalParameterValue, "Illegal parameter value"},
    {ErrorCode::kOutOfMemory, "Out of memory"},
    {ErrorCode::kDataCorruptOrStale, "Data corrupt or stale"},
    {ErrorCode::kHardwareError, "Hardware error"},
    {ErrorCode::kDeviceSpecificError, "Device-specific error"},
    {ErrorCode::kSystemError, "System error"},
    {ErrorCode::kMemoryError, "Memory error"},
    {ErrorCode::kSaveRecallMemoryLost, "Save/recall memory lost"},
    {ErrorCode::kSelfTestFailed, "Self-test failed"},
    {ErrorCode::kQueueOverflow, "Queue overflow"},
    {ErrorCode::kInputBufferOverrun, "Input buffer overrun"},
    {ErrorCode::kQueryError, "Query error"},
    {ErrorCode::kQueryInterrupted, "Query INTERRUPTED"},
    {ErrorCode::kQueryUnterminated, "Query UNTERMINATED"},
    {ErrorCode::kQueryDeadlocked, "Query DEADLOCKED"},
};

const char* class_text(std::uint8_t event) noexcept {
  switch (event) {
    case kCommandErrorEvent:
      return "Command error";
    case kExecutionErrorEvent:
      return "Execution error";
    case kQueryErrorEvent:
      return "Query error";
    default:
      return "Device-specific error";
  }
}

}  // namespace

const char* text_of(ErrorCode code) noexcept {
  for (const ErrorText& entry : kTexts) {
    if (entry.code == code) {
      return entry.text;
    }
  }
  return class_text(event_of(code));
}

std::uint8_t event_of(ErrorCode code) noexcept {
  const auto number = static_cast<std::int16_t>(code);
  if (number > 0) {
    return kDeviceErrorEvent;
  }
  switch (number / -100) {
    case 1:
      return kCommandErrorEvent;
    case 2:
      return kExecutionErrorEvent;
    case 3:
      return kDeviceErrorEvent;
    case 4:
      return kQueryErrorEvent;
    default:
      return 0;
  }
}

}  // namespace emax::app::scpi
