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
            offsetof(SweepSettings, frequency_count), SettingGroup::kDrive, Concern::kSweep)
        .as_option({"frequencies", "F1,F2,...", "3 or more frequencies in Hz, ascending",
                    "frequencies of the sweep, in Hz", "the 42 of the paper's Table 1"}),
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
                    "peak drive never to exceed, in V, at most 10"})
        .as_command("SOURce:LIMit:VOLTage", "<V>", "Peak drive never to exceed", "V"),
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
                    "least number of periods in each repeat"})
        .as_command("[SENSe:]SWEep:CYCLes", "<n>", "Periods per repeat, at least"),
    setting("repeat duration", EMAX_SETTING(SweepSettings, repeat_s), SettingGroup::kRepeats,
            Concern::kSweep)
        .within(0.0, ranges::kMaxRepeat_s, "0 to 10 s"),
    setting("repeats", EMAX_SETTING(SweepSettings, repeats), SettingGroup::kRepeats,
            Concern::kSweep)
        .within(2, kMaxRepeats, "2 to 16")
        .as_option({nullptr, "N", "a whole number from 2 to 16", "repeats at each frequency"})
        .as_command("[SENSe:]SWEep:REPeat", "<n>", "Repeats at each frequency, 2 to 16"),
    kReferenceTableRow,
    more_of("reference sensitivity", EMAX_SETTING(SweepSettings, reference.sensitivity),
            kReferenceTableRow),
    setting("reference uncertainty", EMAX_SETTING(SweepSettings, reference.expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("reference gain", EMAX_SETTING(SweepSettings, reference_gain), SettingGroup::kChain,
            Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest, "above 0")
        .as_option({"reference-gain", "X[,PERCENT]", "a gain above 0, and perhaps its percent",
                    "gain of the reference's conditioner, and its expanded\n"
                    "uncertainty (k = 2) in percent"})
        .as_command("[SENSe:]REFerence:GAIN", "<x>[,<percent>]",
                    "Gain of the reference's conditioner, expanded u")
        .with_uncertainty("PCT"),
    setting("reference gain uncertainty",
            EMAX_SETTING(SweepSettings, reference_gain_expanded_percent), SettingGroup::kChain,
            Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("device gain", EMAX_SETTING(SweepSettings, device_gain), SettingGroup::kChain,
            Concern::kSweep)
        .within(ranges::kSmallest, ranges::kLargest, "above 0")
        .as_option({"device-gain", "X[,PERCENT]", "a gain above 0, and perhaps its percent",
                    "gain of the device's conditioner, and its expanded\n"
                    "uncertainty (k = 2) in percent"})
        .as_command("[SENSe:]DEVice:GAIN", "<x>[,<percent>]",
                    "Gain of the device's conditioner, expanded u")
        .with_uncertainty("PCT"),
    setting("device gain uncertainty", EMAX_SETTING(SweepSettings, device_gain_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("ratio correction", EMAX_SETTING(SweepSettings, ratio_correction), SettingGroup::kChain,
            Concern::kSweep)
        .within(0.1, 10.0, "0.1 to 10")
        .as_option({"correction-ratio", "X[,PERCENT]", "0.1 to 10, and perhaps its percent",
                    "ratio of the channels' gains, device over reference,\n"
                    "relative to the nominal ratio, and its expanded\n"
                    "uncertainty (k = 2) in percent"})
        .as_command("[SENSe:]CORRection:RATio", "<x>[,<percent>]",
                    "Device's channel over reference's, over nominal; expanded u")
        .with_uncertainty("PCT"),
    setting("ratio uncertainty", EMAX_SETTING(SweepSettings, ratio_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent"),
    setting("mounting uncertainty", EMAX_SETTING(SweepSettings, mounting_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent")
        .as_option({"mounting-uncertainty", "PERCENT", "a number of percent from 0 to 50",
                    "expanded uncertainty (k = 2) by mounting, transverse\n"
                    "motion and temperature"})
        .as_command("[SENSe:]MOUNting:UNCertainty", "<percent>",
                    "Mounting, transverse motion, temperature; expanded u", "PCT"),
    setting("skew", EMAX_SETTING(SweepSettings, skew_s), SettingGroup::kChain, Concern::kSweep)
        .within(-1e-3, 1e-3, "within 1 ms of either sign")
        .as_option({"correction-skew", "S[,S]",
                    "seconds within 1 ms, and perhaps their uncertainty",
                    "time by which the device's channel samples later than\n"
                    "the reference's, and its expanded uncertainty, in s"})
        .as_command("[SENSe:]CORRection:SKEW", "<s>[,<s>]",
                    "The device's channel is sampled later by this; expanded u", "S")
        .with_uncertainty("S"),
    setting("skew uncertainty", EMAX_SETTING(SweepSettings, skew_expanded_s), SettingGroup::kChain,
            Concern::kSweep)
        .within(0.0, 1e-3, "0 to 1 ms"),
    setting("clock uncertainty", EMAX_SETTING(SweepSettings, clock_expanded_ppm),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, 1e4, "0 to 10000 ppm")
        .as_option({"clock-uncertainty", "PPM", "a number of ppm from 0 to 10000",
                    "expanded uncertainty (k = 2) of the sampling rate, in\n"
                    "ppm"})
        .as_command("[SENSe:]CLOCk:UNCertainty", "<ppm>", "Of the sampling rate; expanded u"),
    setting("crosstalk", EMAX_SETTING(SweepSettings, crosstalk_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent")
        .as_option({"crosstalk-uncertainty", "PERCENT", "a number of percent from 0 to 50",
                    "part of one channel's voltage that appears in the\n"
                    "other, expanded (k = 2)"})
        .as_command("[SENSe:]CROSstalk:UNCertainty", "<percent>",
                    "Of a channel's voltage seen in the other; expanded u", "PCT"),
    setting("linearity", EMAX_SETTING(SweepSettings, linearity_expanded_percent),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kMaxPercent, "0 to 50 percent")
        .as_option({"linearity-uncertainty", "PERCENT", "a number of percent from 0 to 50",
                    "change of a channel's gain from small signals to full\n"
                    "scale, expanded (k = 2)"})
        .as_command("[SENSe:]LINearity:UNCertainty", "<percent>",
                    "Change of a channel's gain up to full scale; expanded u", "PCT"),
    setting("check frequency", EMAX_SETTING(SweepSettings, check_hz), SettingGroup::kChain,
            Concern::kSweep)
        .within(0.0, ranges::kLargest, "0.1 Hz or more and below the sample rate over 2.5")
        .as_option({"check-frequency", "HZ", "a frequency from 0.1 Hz",
                    "frequency that is measured before and after the sweep,\n"
                    "to see the drift"})
        .as_command("[SENSe:]SWEep:CHECk", "<Hz>", "Measured before and after the sweep", "HZ")
        .on_console_within(0.1, ranges::kLargest),
    setting("expected sensitivity", EMAX_SETTING(SweepSettings, expected_sensitivity),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kLargest, "above 0 in V/(m/s^2), or 0 if it is not known")
        .as_option({"device-sensitivity", "V/(M/S2)", "a sensitivity, or 0",
                    "sensitivity of the device by its data sheet, right\n"
                    "within a factor of 3, in V/(m/s^2); 0 if not known"})
        .as_command("[SENSe:]DEVice:SENSitivity", "<V/(m/s2)>",
                    "Of the device by its data sheet; 0 if not known"),
    setting("drive full scale", EMAX_SETTING(SweepSettings, drive_full_scale_v),
            SettingGroup::kDrive, Concern::kSweep)
        .within(0.0, ranges::kLargest, "1 mV or more, or 0")
        .as_option({"drive-full-scale", "VOLTS", "1 mV or more, or 0",
                    "full scale of the drive outside the front end; 0: that\n"
                    "of the converter"})
        .as_command("SOURce:FULLscale", "<V>", "Of the drive, outside the front end; 0: at the pin",
                    "V"),
    setting("reference full scale", EMAX_SETTING(SweepSettings, reference_full_scale_v),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kLargest, "1 mV or more, or 0")
        .as_option({"reference-full-scale", "VOLTS", "1 mV or more, or 0",
                    "full scale of the reference's channel, as above"})
        .as_command("[SENSe:]REFerence:FULLscale", "<V>",
                    "Of its channel, outside the front end; 0: at the pin", "V"),
    setting("device full scale", EMAX_SETTING(SweepSettings, device_full_scale_v),
            SettingGroup::kChain, Concern::kSweep)
        .within(0.0, ranges::kLargest, "1 mV or more, or 0")
        .as_option({"device-full-scale", "VOLTS", "1 mV or more, or 0",
                    "full scale of the device's channel, as above"})
        .as_command("[SENSe:]DEVice:FULLscale", "<V>",
                    "Of its channel, outside the front end; 0: at the pin", "V"),
};

static_assert(members_in(kSweepSettingRows) ==
                  member_count<SweepSettings>() - 1 + member_count<ReferenceCalibration>(),
              "a member without a row");

}  // namespace emax::app
