// What a call that takes data from outside can answer.
#pragma once

#include <cstdint>

namespace emax {

/// The answer of every call that checks what it is given. Unless its docstring says otherwise, a
/// call that does not answer kOk has changed nothing.
enum class [[nodiscard]] Status : std::uint8_t{
    kOk = 0,
    kInvalidArgument,         ///< A number outside its stated range, or not a number.
    kOverdamped,              ///< A damping of 1 or more: the model has no resonance to resolve.
    kInvalidOrder,            ///< A filter order outside 1 to 15.
    kTooFewPoints,            ///< Fewer points than parameters can be found from.
    kTooManyPoints,           ///< More points than the fixed table holds.
    kNotAscending,            ///< Frequencies (or times) that repeat or go down.
    kUncertaintyNotPositive,  ///< An uncertainty of zero or less, which would give a point infinite
                              ///< weight.
    kNotIdentifiable,         ///< The points do not determine the parameters.
    kNotPhysical,  ///< The fit ends in a device that cannot exist (a mu of zero or less, damping of
                   ///< zero or less).
    kInvertedPolarity,  ///< The sensitivity comes out negative.
    kTooManySwitches,   ///< The signal needs more switching times than the fixed table holds.
    kTooManyCells,      ///< The grid needs more cells than the fixed memory holds.
    kTooFewTrials,      ///< Fewer Monte Carlo trials than a coverage interval needs.
    kBufferTooSmall,    ///< The caller's memory is too small for the result.
    kSyntax,            ///< Text that is not what was expected there.
    kNotRunning,        ///< The stream has not been started, or has stopped.
    kAlreadyRunning,    ///< The stream runs already.
    kDriveLimit,        ///< A drive beyond the permitted amplitude or slope was asked for.
    kLostBlock,         ///< Frames are missing between two blocks.
    kLateBlock,         ///< No block came in time.
    kHardwareFault,     ///< A converter or its board reports a fault.
    kWeakSignal,        ///< A channel stays too small at the largest permitted drive.
    kLevelNotReached,   ///< The wanted acceleration needs more drive than is permitted.
    kSaturated,         ///< A channel reaches its full scale even at a reduced drive.
    kStuckChannel,      ///< A channel does not change.
    kNoReference,       ///< The reference channel carries no signal.
    kNoDevice,          ///< The channel of the device under test carries no signal.
    kSwappedChannels,   ///< The ratio of the channels is that of exchanged cables.
    kDistorted,         ///< The response is not a sine at the drive's frequency.
    kStopped,           ///< Ended on request.
    kDcDrift,           ///< The offset of a channel does not stay where it was.
    kNotProven,         ///< No bound passed its check.
    kNothingStored,     ///< No whole record is stored there.
    kUnknownRecord,     ///< What is stored is of another version, or no such thing.
    kDelayTooLong,      ///< A delay below 0 or above 1/(2 pi band) of the reference filter.
    kDelayNotResolved,  ///< What a delay leaves open is too large beside the error it is taken
                        ///< from.
    kLostDigits,        ///< Rounding is more than 1e-9 of the energy, in every form there is.
    kHum,               ///< Mains at the frequency that is measured.
    kFewSteps,          ///< The limit of acceleration leaves the drive's converter too few steps.
};

/// @returns One sentence, in plain words, that says what is wrong and what to do next. Never null.
const char* explain(Status status) noexcept;

}  // namespace emax
