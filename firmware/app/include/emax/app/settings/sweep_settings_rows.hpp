// One row for each setting of a sweep. Checks, saved bytes, help and commands come from here.
#pragma once

#include <limits>

#include "emax/app/settings/setting_row.hpp"
#include "emax/app/settings/sweep_settings.hpp"

namespace emax::app {

/// Ends of ranges that are the same for several settings.
namespace ranges {

/// Of levels, gains and sensitivities.
inline constexpr double kSmallest = 1e-9;
inline constexpr double kLargest = 1e9;
inline constexpr double kMaxRepeat_s = 10.0;
inline constexpr double kMaxPercent = 50.0;

}  // namespace ranges

inline constexpr SettingRow kReferenceTableRow =
    setting("reference table", EMAX_SETTING(SweepSettings, reference.frequency_hz),
            offsetof(SweepSettings, reference.count), SettingGroup::kChain, Concern::kSweep);

/// In the order of the members. A setting whose check looks at more than its range has it in
/// sweep_settings.cpp.
inline constexpr SettingRow kSweepSettingRows[] = {
    setting("sweep frequencies", EMAX_SETTING(SweepSettings, frequency_hz),
            offsetof(SweepSettings, frequency_count), SettingGroup::kDrive, Concern::kSweep),
    setting("level", EMAX_SETTING(SweepSettings, level_mps2), SettingGroup::kDrive, Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest, "above 0, in m/s^2")
        .as_option(
            {nullptr, "MPS2", "a number of m/s^2 above 0", "peak acceleration to reach, in m/s^2"})
        .as_command("SOURce:LEVel", "<m/s2>", "Peak acceleration to reach", "M/S2"),
    setting("acceleration limit", EMAX_SETTING(SweepSettings, acceleration_limit_mps2),
            SettingGroup::kDrive, Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest, "at least the level, in m/s^2")
        .as_option({"acceleration-limit", "MPS2", "a number of m/s^2 above 0",
                    "peak acceleration never to exceed, in m/s^2"})
        .as_command("SOURce:LIMit", "<m/s2>", "Peak acceleration never to exceed", "M/S2"),
    setting("drive limit", EMAX_SETTING(SweepSettings, drive_limit_v), SettingGroup::kDrive,
            Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest,
                "above 0 and at most the converter's full scale, in V")
        .as_option({"drive-limit", "VOLTS", "a number of V above 0",
                    "peak drive never to exceed, in V, at most 10"}),
    // The stream's rate decides.
    setting("slew", EMAX_SETTING(SweepSettings, slew_v_per_s), SettingGroup::kDrive,
            Concern::kSweep)
        .within(0.0, std::numeric_limits<double>::infinity(),
                "enough to lead the drive limit to zero within 256 frames, in V/s")
        .as_option({nullptr, "V/S", "a number of V/s above 0",
                    "slope of the drive never to exceed, in V/s"})
        .as_command("SOURce:SLEW", "<V/s>", "Slope of the drive never to exceed", "V/S")
        .on_console_within(ranges::kSmallest, ranges::kLargest),
    setting("settling time", EMAX_SETTING(SweepSettings, settle_s), SettingGroup::kRest,
            Concern::kSweep)
        .within(0.0, 10.0, "0 to 10 s")
        .as_option({"settle", "SECONDS", "a number of seconds from 0 to 10",
                    "rest after each ramp, in s; three periods at least"})
        .as_command("[SENSe:]SWEep:SETTle", "<s>", "Rest after each ramp; three periods at least",
                    "S"),
    setting("cycles", EMAX_SETTING(SweepSettings, cycles), SettingGroup::kRepeats, Concern::kSweep)
        .within(1, 1000, "1 to 1000 periods")
        .as_option({nullptr, "N", "a whole number from 1 to 1000",
                    "least number of periods in each of five repeats"})
        .as_command("[SENSe:]SWEep:CYCLes", "<n>", "Periods per repeat, at least"),
    setting("repeat duration", EMAX_SETTING(SweepSettings, repeat_s), SettingGroup::kRepeats,
            Concern::kSweep)
        .within(0.0, ranges::kMaxRepeat_s, "0 to 10 s"),
    setting("repeats", EMAX_SETTING(SweepSettings, repeats), SettingGroup::kRepeats,
            Concern::kSweep)
        .within(2, kMaxRepeats, "2 to 16"),
    kReferenceTableRow,
    more_of("reference sensitivity", EMAX_SETTING(SweepSettings, reference.sensitivity),
            kReferenceTableRow),
    setting("reference uncertainty", EMAX_SETTING(SweepSettings, reference.expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("reference gain", EMAX_SETTING(SweepSettings, reference_gain), SettingGroup::kChain,
            Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest, "above 0"),
    setting("device gain", EMAX_SETTING(SweepSettings, device_gain), SettingGroup::kChain,
            Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest, "above 0"),
    setting("gain uncertainty", EMAX_SETTING(SweepSettings, gain_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("mounting uncertainty", EMAX_SETTING(SweepSettings, mounting_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("skew", EMAX_SETTING(SweepSettings, skew_s), SettingGroup::kChain, Concern::kSweep)
        .within(-1e-3, 1e-3, "within 1 ms of either sign"),
    setting("check frequency", EMAX_SETTING(SweepSettings, check_hz), SettingGroup::kChain,
            Concern::kSweep)
        .within(0.0, ranges::kLargest, "0.1 Hz or more and below the sample rate over 2.5"),
    setting("expected sensitivity", EMAX_SETTING(SweepSettings, expected_sensitivity),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kLargest, "above 0 in V/(m/s^2), or 0 if it is not known"),
};

static_assert(members_in(kSweepSettingRows) ==
                  member_count<SweepSettings>() - 1 + member_count<ReferenceCalibration>(),
              "a member without a row");

}  // namespace emax::app
