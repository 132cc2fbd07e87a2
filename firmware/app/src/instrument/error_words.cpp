// The errors of the console: faults of a sweep, failures of an evaluation, and what is missing.
#include "emax/app/instrument/error_words.hpp"

#include "emax/app/scpi/status_model.hpp"
#include "emax/base/capacity.hpp"

namespace emax::app {
namespace {

using scpi::ErrorCode;

/// A fault of a sweep in the words of an error, and what it puts in question.
struct FaultWords {
  Status status;
  const char* words;
  std::uint16_t questionable;
};

constexpr FaultWords kFaults[] = {
    {Status::kLostBlock, "lost block: INIT again", scpi::kQuestionableTime},
    {Status::kLateBlock, "late block: check converter and clock", scpi::kQuestionableTime},
    {Status::kHardwareFault, "converter fault: check its supply", scpi::kQuestionableVoltage},
    {Status::kSaturated, "saturated channel: lower its gain, or divide",
     scpi::kQuestionableVoltage},
    {Status::kStuckChannel, "stuck channel: check its converter", scpi::kQuestionableVoltage},
    {Status::kNoReference, "no reference: check its cable", scpi::kQuestionableVoltage},
    {Status::kNoDevice, "no device: check its cable", scpi::kQuestionableVoltage},
    {Status::kWeakSignal, "weak signal: raise SOUR:LEV, check cables", scpi::kQuestionableVoltage},
    {Status::kLevelNotReached, "level not reached: lower SOUR:LEV", scpi::kQuestionableVoltage},
    {Status::kSwappedChannels, "swapped channels: check cables, gains, DEV:SENS, SWE:CHEC",
     scpi::kQuestionableCalibration},
    {Status::kInvertedPolarity, "inverted polarity: swap its leads; SWE:CHEC below f0?",
     scpi::kQuestionablePhase},
    {Status::kDistorted, "distorted: lower SOUR:LEV, check mount; harmonic at f0?",
     scpi::kQuestionableCalibration},
    {Status::kHum, "mains hum: change SWE:FREQ, CHEC, CYCL", scpi::kQuestionableCalibration},
    {Status::kFewSteps, "few steps: attenuate drive, SOUR:FULL; SOUR:LIM",
     scpi::kQuestionableVoltage},
    {Status::kDcDrift, "DC drift: warm up, check its cable", scpi::kQuestionableVoltage},
};

FaultWords fault_words(Status status) noexcept {
  for (const FaultWords& fault : kFaults) {
    if (fault.status == status) {
      return fault;
    }
  }
  return {status, explain(status), scpi::kQuestionableCalibration};
}

/// Why an evaluation ends early, in the words of an error.
struct FailureWords {
  Status status;
  ErrorCode code;
  const char* words;
};

constexpr FailureWords kFailures[] = {
    {Status::kTooManyCells, ErrorCode::kSettingsConflict,
     "T needs over " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells: shorten it"},
    {Status::kTooManySwitches, ErrorCode::kSettingsConflict,
     "over " EMAX_TEXT_OF(EMAX_MAX_SWITCHES) " switches: shorten T"},
    {Status::kTooFewPoints, ErrorCode::kDataCorruptOrStale, "a fit needs 3 points or more"},
    {Status::kNotIdentifiable, ErrorCode::kExecutionError, "points tell no device: more around f0"},
    {Status::kNotPhysical, ErrorCode::kExecutionError, "fit is no device: check units, phases"},
    {Status::kOverdamped, ErrorCode::kExecutionError, "fit has a damping of 1 or more"},
    {Status::kInvertedPolarity, ErrorCode::kExecutionError, "inverted polarity: add 180 degrees"},
};
constexpr FailureWords kTooWide = {Status::kInvalidArgument, ErrorCode::kSettingsConflict,
                                   "uncertainties too large for the trials"};
constexpr FailureWords kOnlySensitivity = {Status::kNotIdentifiable, ErrorCode::kExecutionError,
                                           "points give S alone: more, nearer to f0"};
constexpr FailureWords kTrendTooLong = {
    Status::kTooManyCells, ErrorCode::kSettingsConflict,
    "a trend time needs over " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells"};

FailureWords failure_words(const Failure& failure) noexcept {
  if (failure.stage == Stage::kMonteCarlo && failure.status == Status::kInvalidArgument) {
    return kTooWide;
  }
  if (failure.stage == Stage::kTrend && failure.status == Status::kTooManyCells) {
    return kTrendTooLong;
  }
  if (failure.stage == Stage::kMonteCarlo && failure.status == Status::kTooManyCells) {
    return {failure.status, ErrorCode::kSettingsConflict, failure.reason};
  }
  for (const FailureWords& words : kFailures) {
    if (words.status == failure.status) {
      return words;
    }
  }
  return {failure.status, ErrorCode::kExecutionError, failure.reason};
}

/// What was asked for at the wrong time, or lacks something.
struct ObstacleWords {
  Obstacle obstacle;
  ErrorCode code;
  const char* words;
};

constexpr ObstacleWords kObstacles[] = {
    {Obstacle::kSweepRuns, ErrorCode::kSettingsConflict, "a sweep runs: ABOR or *WAI"},
    {Obstacle::kComputes, ErrorCode::kSettingsConflict, "computing: ABOR or *WAI first"},
    {Obstacle::kNoWire, ErrorCode::kHardwareError, "no drive at inputs: wire, FULLscale, LIM:VOLT"},
    {Obstacle::kTurnedWire, ErrorCode::kHardwareError, "inverted channel: swap its leads"},
    {Obstacle::kUnsteadyWire, ErrorCode::kHardwareError, "unsteady gains: check wire, again"},
    {Obstacle::kNoDevice, ErrorCode::kDataCorruptOrStale, "no device: CALC:MOD, or INIT:SWE"},
    {Obstacle::kNoPoints, ErrorCode::kDataCorruptOrStale, "no points: INIT:SWE or TRAC:FRES:DATA"},
    {Obstacle::kNoFit, ErrorCode::kDataCorruptOrStale,
     "BIRG needs the points of the fit: INIT:SWE"},
    {Obstacle::kGrid, ErrorCode::kSettingsConflict,
     "T/step > " EMAX_TEXT_OF(EMAX_MAX_CELLS) ": shorten T or longer STEP"},
    {Obstacle::kNoUncertainty, ErrorCode::kDataCorruptOrStale,
     "no uncertainties: CALC:MOD with uS,.."},
    {Obstacle::kOpenDamping, ErrorCode::kDataCorruptOrStale,
     "beta left open: nearer f0, or CALC:MOD"},
    {Obstacle::kNoTimes, ErrorCode::kDataCorruptOrStale, "no times: CALC:TREN? T1,T2,..."},
};

}  // namespace

ErrorWords words_of(const Refusal& refusal, const Sequencer& sequencer) noexcept {
  if (refusal.obstacle == Obstacle::kSweepSetting) {
    return {ErrorCode::kSettingsConflict, sequencer.sweep().refused.expectation};
  }
  if (refusal.obstacle == Obstacle::kSweep) {
    return {ErrorCode::kHardwareError, fault_words(refusal.status).words};
  }
  if (refusal.obstacle == Obstacle::kEvaluation) {
    const EvaluationResults& results = sequencer.evaluation();
    const FailureWords failure =
        results.is_sensitivity_alone() ? kOnlySensitivity : failure_words(results.failure);
    return {failure.code, failure.words};
  }
  for (const ObstacleWords& words : kObstacles) {
    if (words.obstacle == refusal.obstacle) {
      return {words.code, words.words};
    }
  }
  return {};
}

ErrorWords words_of(const SettingsError& error) noexcept {
  if (error.setting == nullptr) {
    return {};
  }
  return {ErrorCode::kSettingsConflict, error.expectation, error.setting};
}

const char* words_of(Warning warning) noexcept {
  if (warning == Warning::kDataSheet) {
    return "S is 20 % off DEV:SENS: check gains, REF:SENS; f0 near SWE:CHEC?";
  }
  if (warning == Warning::kChange) {
    return "check's ratio changed: gain switched, cable or mount loose, hum";
  }
  return warning == Warning::kFit ? "chi2 is high: another resonance, or U too small"
                                  : "fit of a sweep that ended early";
}

std::uint16_t questionable_of(Status fault) noexcept { return fault_words(fault).questionable; }

}  // namespace emax::app
