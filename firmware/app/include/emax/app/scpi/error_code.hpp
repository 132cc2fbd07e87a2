// The error numbers of SCPI-99, volume 2, chapter 21, and their texts.
#pragma once

#include <cstdint>

namespace emax::app::scpi {

/// Those that a serial instrument can have. Positive numbers are the instrument's own; they are
/// reported with `text_of()` answering "Device-specific error".
enum class ErrorCode : std::int16_t {
  kNoError = 0,
  kCommandError = -100,
  kInvalidCharacter = -101,
  kSyntaxError = -102,
  kInvalidSeparator = -103,
  kDataTypeError = -104,
  kParameterNotAllowed = -108,
  kMissingParameter = -109,
  kCommandHeaderError = -110,
  kHeaderSeparatorError = -111,
  kProgramMnemonicTooLong = -112,
  kUndefinedHeader = -113,
  kHeaderSuffixOutOfRange = -114,
  kNumericDataError = -120,
  kInvalidCharacterInNumber = -121,
  kExponentTooLarge = -123,
  kTooManyDigits = -124,
  kNumericDataNotAllowed = -128,
  kInvalidSuffix = -131,
  kSuffixTooLong = -134,
  kSuffixNotAllowed = -138,
  kInvalidCharacterData = -141,
  kCharacterDataTooLong = -144,
  kCharacterDataNotAllowed = -148,
  kStringDataError = -150,
  kInvalidStringData = -151,
  kStringDataNotAllowed = -158,
  kInvalidBlockData = -161,
  kBlockDataNotAllowed = -168,
  kExpressionDataNotAllowed = -178,
  kExecutionError = -200,
  kInitIgnored = -213,
  kSettingsConflict = -221,
  kDataOutOfRange = -222,
  kTooMuchData = -223,
  kIllegalParameterValue = -224,
  kOutOfMemory = -225,
  kDataCorruptOrStale = -230,
  kHardwareError = -240,
  kDeviceSpecificError = -300,
  kSystemError = -310,
  kMemoryError = -311,
  kSaveRecallMemoryLost = -314,
  kSelfTestFailed = -330,
  kQueueOverflow = -350,
  kInputBufferOverrun = -363,
  kQueryError = -400,
  kQueryInterrupted = -410,
  kQueryUnterminated = -420,
  kQueryDeadlocked = -430,
};

/// @returns The standard's text, such as "Undefined header"; for any other number that of its
/// class. Never null.
const char* text_of(ErrorCode code) noexcept;

/// @returns The bit of the standard event status register that an error of this number sets: of
/// CME, EXE, DDE, QYE; 0 for kNoError and other numbers of no class.
std::uint8_t event_of(ErrorCode code) noexcept;

/// @returns True for -100 to -199: the rest of the program message is not executed.
constexpr bool is_command_error(ErrorCode code) noexcept {
  const auto number = static_cast<std::int16_t>(code);
  return number <= -100 && number > -200;
}

}  // namespace emax::app::scpi
