// One row for each setting of an evaluation. Checks, saved bytes, help and commands come from here.
#pragma once

#include "emax/app/settings/setting_row.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/model/accelerometer.hpp"
#include "emax/model/butterworth.hpp"
#include "emax/uncertainty/monte_carlo.hpp"

namespace emax::app {

inline constexpr const char* kGainWords[] = {"AUTO", "TRACk"};
inline constexpr const char* kLimitWords[] = {"AUTO"};
inline constexpr const char* kCriterionWords[] = {"ISE", "DIFFerence", "BAND"};
inline constexpr const char* kDelayWords[] = {"AUTO", "NONE"};
inline constexpr const char* kMethodWords[] = {"BEST", "PAPer"};
inline constexpr const char* kDistributionWords[] = {"BOX", "NORMal"};
inline constexpr const char* kGeneratorWords[] = {"WH2006", "WH1982"};
namespace ranges {

/// The shortest time that the console takes.
inline constexpr double kNanoSecond = 1e-9;
inline constexpr double kMaxCommonPercent = 50.0;

}  // namespace ranges

/// In the order of the members. A setting whose check looks at more than its range has it in
/// settings.cpp.
inline constexpr SettingRow kSettingRows[] = {
    setting("order", EMAX_SETTING(Settings, filter_order), SettingGroup::kFilter, Concern::kEnergy)
        .within(1, kMaxFilterOrder, "a whole number from 1 to 15")
        .as_option({nullptr, "L", nullptr, "order, 1 to 15"})
        .as_command("CALCulate:FILTer:ORDer", "<L>", "Order of the reference filter"),
    setting("cutoff", EMAX_SETTING(Settings, cutoff_hz), SettingGroup::kFilter, Concern::kEnergy)
        .within(kMinFrequency_hz, kMaxFrequency_hz, "from 0.001 to 1e9 Hz")
        .as_option({nullptr, "HZ", "a number of Hz above 0", "cutoff frequency (-3 dB) in Hz"})
        .as_command("CALCulate:FILTer:FREQuency", "<Hz>", "Its cutoff frequency", "HZ"),
    setting("gain", EMAX_SETTING(Settings, gain), offsetof(Settings, gain_mode),
            SettingGroup::kFilter, Concern::kEnergy)
        .within(0.0, kMaxGain, "'auto', 'track', or from 0 to 1e9 V/(m/s^2)")
        .or_one_of(kGainWords, static_cast<std::uint8_t>(GainMode::kFixed))
        .as_option({nullptr, "auto|NUMBER|track", "auto, track or a number of V/(m/s^2)",
                    "gain in V/(m/s^2): auto is the estimate of S,\n"
                    "track the S of each Monte Carlo trial"})
        .as_command("CALCulate:FILTer:GAIN", "<g>|AUTO|TRACk",
                    "Its gain; AUTO: the estimate of S, TRACk: the S of each trial"),
    setting("time", EMAX_SETTING(Settings, duration_s), SettingGroup::kSignal, Concern::kEnergy)
        .within(kAboveZero, kMaxDuration_s, "more than 0 and at most 1000 s")
        .as_option(
            {nullptr, "SECONDS", "a number of seconds above 0", "length T of the signal in s"})
        .as_command("CALCulate:ENERgy:TIME", "<T>", "Length of the signal", "S")
        .on_console_within(ranges::kNanoSecond, kMaxDuration_s),
    setting("limit", EMAX_SETTING(Settings, limit_mps2), offsetof(Settings, limit_is_auto),
            SettingGroup::kSignal, Concern::kEnergy)
        .within(kMinLimit_mps2, kMaxLimit_mps2, "from 1e-9 to 1e9 m/s^2")
        .or_one_of(kLimitWords, std::uint8_t{false})
        .as_option({nullptr, "auto|NUMBER", "auto or a number of m/s^2 above 0",
                    "limit a of the signal in m/s^2, which stays within\n"
                    "+-a; auto is the number of S, as in the paper"})
        .as_command("CALCulate:ENERgy:LIMit", "<a>|AUTO",
                    "The signal stays within +-a; AUTO: the number of S", "M/S2"),
    setting("criterion", EMAX_SETTING(Settings, criterion), SettingGroup::kSignal, Concern::kEnergy)
        .one_of(kCriterionWords)
        .as_option({nullptr, "ise|difference|band", "ise, difference or band",
                    "ise: energy of the error, sensor minus filter;\n"
                    "difference: energy of the sensor's output minus that\n"
                    "of the filter's; band: energy of the error within the\n"
                    "filter's band"})
        .as_command("CALCulate:ENERgy:CRITerion", "ISE|DIFFerence|BAND",
                    "Energy of the error, difference of the energies, or error in band"),
    setting("reference delay", EMAX_SETTING(Settings, delay_s), offsetof(Settings, delay_choice),
            SettingGroup::kSignal, Concern::kEnergy)
        .within(0.0, kMaxDuration_s, "'auto', 'none', or a number of seconds, 0 or more")
        .or_one_of(kDelayWords, static_cast<std::uint8_t>(DelayChoice::kGiven))
        .as_option({"reference-delay", "auto|none|NUMBER", "auto, none or a number of seconds",
                    "delay that is taken out of the in-band error; auto is\n"
                    "the sensor's own at low frequency, beta/(pi f0)"})
        .as_command("CALCulate:ENERgy:DELay", "<s>|AUTO|NONE",
                    "Delay taken out of the error in band; AUTO: that of the sensor", "S"),
    setting("method", EMAX_SETTING(Settings, method), SettingGroup::kSignal, Concern::kEnergy)
        .one_of(kMethodWords)
        .as_option({nullptr, "best|paper", "best or paper",
                    "best: many starts; paper: the published procedure, one\n"
                    "start (the first column of the matrix Phi)"})
        .as_command("CALCulate:ENERgy:METHod", "BEST|PAPer",
                    "Many starts, or the fixed point of the paper"),
    setting("step", EMAX_SETTING(Settings, step_s), SettingGroup::kSignal, Concern::kPaper)
        .within(kAboveZero, kMaxDuration_s, "more than 0 and at most 1000 s")
        .as_option({nullptr, "SECONDS", "a number of seconds above 0",
                    "width of a grid cell in s; for --method paper"})
        .as_command("CALCulate:ENERgy:STEP", "<s>", "Grid step of PAPer and FPA?", "S")
        .on_console_within(ranges::kNanoSecond, kMaxDuration_s),
    setting("iterations", EMAX_SETTING(Settings, iterations), SettingGroup::kSignal,
            Concern::kPaper)
        .within(1, kMaxIterations, "a whole number from 1 to 1000")
        .as_option({nullptr, "J", nullptr, "most iterations; for --method paper"})
        .as_command("CALCulate:ENERgy:ITERations", "<J>", "Iterations of PAPer and FPA?, at most"),
    setting("trials", EMAX_SETTING(Settings, trials), SettingGroup::kTrials, Concern::kTrialCount)
        .within(kMinTrials, kMaxTrials, "a whole number from 1000 to 1000000000")
        .as_option({nullptr, "M", nullptr,
                    "number of trials, 1000 to 1e9; below 1e4/(1 - p), with\n"
                    "p of --probability, there is a warning"})
        .as_command("CALCulate:MCARlo:TRIals", "<M>", "Number of trials"),
    setting("adaptive", EMAX_SETTING(Settings, adaptive), SettingGroup::kTrials, Concern::kTrials)
        .as_option({nullptr, nullptr, nullptr,
                    "as many trials as stable results take (JCGM 101, 7.9);\n"
                    "--trials is then unused"})
        .as_command("CALCulate:MCARlo:ADAPtive", "<on>", "The number of trials by JCGM 101 7.9"),
    setting("probability", EMAX_SETTING(Settings, probability), SettingGroup::kCoverage,
            Concern::kTrials)
        .within(kAboveZero, kBelowOne, "more than 0 and less than 1")
        .as_option(
            {nullptr, "P", "a number between 0 and 1", "coverage probability p of the intervals"})
        .as_command("CALCulate:MCARlo:PROBability", "<p>", "Coverage probability of the intervals")
        .on_console_within(1e-6, 0.999999),
    setting("distribution", EMAX_SETTING(Settings, distribution), SettingGroup::kCoverage,
            Concern::kTrials)
        .one_of(kDistributionWords)
        .as_option({nullptr, "box|normal", "box or normal",
                    "box: uniform within +-u of each parameter; normal:\n"
                    "with the covariance of the fit"})
        .as_command("CALCulate:MCARlo:DISTribution", "BOX|NORMal",
                    "Uniform within +-u, or normal with the fit's covariance"),
    setting("birge", EMAX_SETTING(Settings, birge), SettingGroup::kCoverage, Concern::kTrials)
        .as_option({nullptr, nullptr, nullptr,
                    "multiplies the uncertainties in the trials by the\n"
                    "Birge ratio of the fit, where that is above 1"})
        .as_command("CALCulate:MCARlo:BIRGe", "<on>",
                    "Uncertainties times the fit's Birge ratio, if above 1"),
    setting("seed", EMAX_SETTING(Settings, seed), SettingGroup::kRandom, Concern::kRandom)
        .as_option({nullptr, "A,B,C,D",
                    "four whole numbers above 0, or three with --generator 1982",
                    "start of the random numbers; three numbers are enough\n"
                    "with --generator 1982",
                    "123456789,345678901,567890123,789012345"})
        .as_command("CALCulate:MCARlo:SEED", "<a>,<b>,<c>,<d>", "Start of the random numbers"),
    setting("generator", EMAX_SETTING(Settings, generator), SettingGroup::kRandom, Concern::kRandom)
        .one_of(kGeneratorWords)
        .as_option({nullptr, "2006|1982", "2006 or 1982", "random numbers of Wichmann and Hill"})
        .as_command("CALCulate:MCARlo:GENerator", "WH2006|WH1982",
                    "Generator of Wichmann and Hill"),
    setting("trend", EMAX_SETTING(Settings, trend_s), offsetof(Settings, trend_count),
            SettingGroup::kTrend, Concern::kTrend)
        .as_option({nullptr, "T1,T2,...|none", "none or 2 to 16 numbers of seconds",
                    "2 to 16 lengths in s, with the straight line through\n"
                    "their energies",
                    "0.002,0.004,0.006,0.008,0.010"})
        .as_command("CALCulate:TRENd:TIME", "<T1>,...", "2 to 16 lengths for the trend"),
    // Its command looks at the points, too, and its option belongs to their table.
    setting("common part", EMAX_SETTING(Settings, common_percent), SettingGroup::kTrend,
            Concern::kSweep)
        .within(0.0, ranges::kMaxCommonPercent, "0 to 50 percent"),
};

static_assert(members_in(kSettingRows) == member_count<Settings>(), "a member without a row");

}  // namespace emax::app
