// The sentences behind the status codes.
#include "emax/base/status.hpp"

namespace emax {

const char* explain(Status status) noexcept {
  switch (status) {
    case Status::kOk:
      return "No error; nothing needs to be done.";
    case Status::kInvalidArgument:
      return "A number is outside its permitted range or not a number; give a value inside the "
             "stated range.";
    case Status::kOverdamped:
      return "The damping is 1 or more, so the model has no resonance; give a damping ratio below "
             "1.";
    case Status::kInvalidOrder:
      return "The filter order is outside its range; give a whole number from 1 to 15.";
    case Status::kTooFewPoints:
      return "There are fewer points than parameters to find; measure or load more frequencies.";
    case Status::kTooManyPoints:
      return "There are more points than the table holds; leave out some frequencies.";
    case Status::kNotAscending:
      return "The values repeat or go down; sort them in ascending order and give each one once.";
    case Status::kUncertaintyNotPositive:
      return "An uncertainty is zero or negative and would give its point infinite weight; give a "
             "positive one.";
    case Status::kNotIdentifiable:
      return "The points do not determine the parameters; add frequencies around the resonance and "
             "below it.";
    case Status::kNotPhysical:
      return "The fitted model cannot exist as a device; check the units and phases of the points "
             "and measure again.";
    case Status::kInvertedPolarity:
      return "The sensitivity comes out negative; swap the sensor's leads or add 180 degrees to "
             "the phases.";
    case Status::kTooManySwitches:
      return "The signal needs more switching times than the table holds; shorten the time or the "
             "filter's band.";
    case Status::kTooManyCells:
      return "The grid needs more cells than the memory holds; shorten the time or take a longer "
             "step.";
    case Status::kTooFewTrials:
      return "There are too few Monte Carlo trials for a coverage interval; ask for more trials.";
    case Status::kBufferTooSmall:
      return "The memory given is too small for the result; give a larger buffer.";
    case Status::kSyntax:
      return "The text is not what was expected at this place; correct it and send it again.";
    case Status::kNotRunning:
      return "The converters are not running; start them first.";
    case Status::kAlreadyRunning:
      return "The converters are running already; stop them before starting them anew.";
    case Status::kDriveLimit:
      return "The drive would exceed its permitted amplitude or slope; lower the level or raise "
             "the limit.";
    case Status::kLostBlock:
      return "Frames were lost between two blocks; reduce what else the processor does and measure "
             "again.";
    case Status::kLateBlock:
      return "The converters did not deliver a block in time; check their clock and connection.";
    case Status::kHardwareFault:
      return "The converter board reports a fault; check its supply and connections and start "
             "again.";
    case Status::kWeakSignal:
      return "The signal is buried in noise at the level and drive permitted; raise the level, or "
             "check amplifier, both cables, gains and mounting.";
    case Status::kLevelNotReached:
      return "The wanted acceleration needs more drive than is permitted; lower the level, or "
             "check "
             "cables and gains, and only then raise the drive limit.";
    case Status::kSaturated:
      return "A channel is at its full scale even at a reduced drive; lower the conditioner's "
             "gain.";
    case Status::kStuckChannel:
      return "A channel does not change at all; check its converter and its conditioner's supply.";
    case Status::kNoReference:
      return "The reference channel carries no signal; check the reference sensor's cable and "
             "conditioner, and whether the two cables are exchanged.";
    case Status::kNoDevice:
      return "The channel of the device under test carries no signal beyond its noise; check its "
             "cable, its conditioner and the gain.";
    case Status::kSwappedChannels:
      return "The ratio of the channels is implausible, as if they were swapped; check the cables "
             "and the gains set.";
    case Status::kDistorted:
      return "The response is not a sine at the drive's frequency; lower the level, check the "
             "mounting, or leave out what excites a resonance.";
    case Status::kStopped:
      return "The measurement was stopped on request; start it again when ready.";
    case Status::kDcDrift:
      return "The offset of a channel wanders; let the sensor and its conditioner warm up and "
             "check "
             "its cable and supply.";
    case Status::kHum:
      return "Hum of the mains is too strong here; measure at other frequencies or more cycles.";
    case Status::kFewSteps:
      return "The limit of acceleration leaves the drive's converter too few steps; put an "
             "attenuator behind the drive and tell the drive's full scale, or raise the limit.";
    case Status::kNotProven:
      return "No upper bound passed its check for this device and time; shorten T, or use the "
             "energy found without a bound.";
    case Status::kNothingStored:
      return "Nothing is stored there, or a power cut or a damage has left nothing whole; store it "
             "first.";
    case Status::kUnknownRecord:
      return "What is stored there is of another version or does not fit this instrument; set it "
             "anew and store it again.";
    case Status::kDelayTooLong:
      return "The delay is below 0 or longer than 1/(2 pi cutoff); lower the cutoff, or take no "
             "delay out.";
    case Status::kDelayNotResolved:
      return "At this order the delay cannot be taken out exactly enough; take a higher order, or "
             "take no delay out.";
    case Status::kLostDigits:
      return "The error is the difference of two outputs, and so small beside them that rounding "
             "hides it; take a longer time, or another cutoff or order.";
  }
  return "The status code is not known; the data it came from is damaged, so start the work again.";
}

}  // namespace emax
