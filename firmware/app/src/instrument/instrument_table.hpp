// The command table of the instrument, one line for each command.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/measure/loopback.hpp"
#include "emax/app/scpi/command.hpp"
#include "emax/app/scpi/standard_commands.hpp"

#include "instrument_commands.hpp"
#include "setting_commands.hpp"

namespace emax::app {

namespace instrument_table {

using C = InstrumentCommands;
using I = Instrument;
using scpi::Forms;
using scpi::standard;

inline constexpr auto kSet = Forms::kSet;
inline constexpr auto kQuery = Forms::kQuery;
inline constexpr auto kBoth = Forms::kSetAndQuery;
inline constexpr std::uint8_t kPlain = scpi::kPlain;
inline constexpr std::uint8_t kImmediate = scpi::kImmediate;

// Only what answers nothing, or is asked for in order to see how far a query is, overtakes: all
// other answers come in the order of their queries.
// clang-format off
inline constexpr scpi::Command<Instrument> kCommon[] = {
    {"*CLS", kSet, "", "Clears errors and events", kPlain, C::clear},
    {"*ESE", kBoth, "<mask>", "Events that count in bit 5 of *STB?", kPlain, standard<scpi::event_enable, I>},
    {"*ESR", kQuery, "", "Events since the last look; clears them", kPlain, standard<scpi::event_status, I>},
    {"*IDN", kQuery, "", "emax,board,serial,version", kPlain, C::identify_instrument},
    {"*LRN", kQuery, "", "All settings, as a message that sets them again", kPlain, C::learn},
    {"*OPC", kBoth, "", "Sets event bit 0, or answers 1, once nothing runs", kPlain, C::operation_complete},
    {"*OPT", kQuery, "", "SIM where the bench is simulated, else 0", kPlain, C::options},
    {"*RCL", kSet, "<0..3>", "Takes the settings of a slot", kPlain, C::recall},
    {"*RST", kSet, "", "Ends what runs; default settings; forgets points and device", kPlain, C::reset},
    {"*SAV", kSet, "<0..3>", "Keeps the settings in a slot, over power off", kPlain, C::save},
    {"*SRE", kBoth, "<mask>", "Bits of *STB? that count in its bit 6", kPlain, standard<scpi::service_enable, I>},
    {"*STB", kQuery, "", "Status byte", kPlain, standard<scpi::status_byte, I>},
    {"*TRG", kSet, "", "Starts the sweep", kPlain, C::initiate_sweep},
    {"*TST", kQuery, "", "Numeric self test: 0, or the number of the check that failed", kPlain, C::self_test},
    {"*WAI", kSet, "", "The next command begins once nothing runs", kPlain, C::wait},

    {"SYSTem:ERRor[:NEXT]", kQuery, "", "The oldest error; 0,\"No error\" if none", kPlain, standard<scpi::next_error, I>},
    {"SYSTem:ERRor:COUNt", kQuery, "", "Errors in the queue", kPlain, standard<scpi::error_count, I>},
    {"SYSTem:ERRor:ALL", kQuery, "", "All errors, the oldest first; 0,\"No error\" if none", kPlain, standard<scpi::all_errors, I>},
    {"SYSTem:ERRor:CODE[:NEXT]", kQuery, "", "Number of the oldest error", kPlain, standard<scpi::next_code, I>},
    {"SYSTem:ERRor:CODE:ALL", kQuery, "", "Their numbers; 0 if none", kPlain, standard<scpi::all_codes, I>},
    {"SYSTem:CAPability", kQuery, "", "The subsystems that make up the instrument", kPlain, C::capability},
    {"SYSTem:HELP:HEADers", kQuery, "", "All headers, as a block of lines", kPlain, C::headers},
    {"SYSTem:VERSion", kQuery, "", "1999.0", kPlain, standard<scpi::version, I>},
    {"SYSTem:PROGress", kQuery, "", "Percent and name of the stage that runs; overtakes queries that wait", kImmediate, C::progress},

    {"STATus:OPERation[:EVENt]", kQuery, "", "Bit 3 sweeping, 4 measuring, 8 computing; clears", kPlain, standard<scpi::operation_event, I>},
    {"STATus:OPERation:CONDition", kQuery, "", "The same, now", kPlain, standard<scpi::operation_condition, I>},
    {"STATus:OPERation:ENABle", kBoth, "<mask>", "Bits that count in bit 7 of *STB?", kPlain, standard<scpi::operation_enable, I>},
    {"STATus:OPERation:PTRansition", kBoth, "<mask>", "Bits whose rise is an event", kPlain, standard<scpi::operation_positive, I>},
    {"STATus:OPERation:NTRansition", kBoth, "<mask>", "Bits whose fall is an event", kPlain, standard<scpi::operation_negative, I>},
    {"STATus:QUEStionable[:EVENt]", kQuery, "", "Bit 0 signal, 2 time, 6 polarity, 8 calibration or fit; clears", kPlain, standard<scpi::questionable_event, I>},
    {"STATus:QUEStionable:CONDition", kQuery, "", "The same, of the last sweep or fit", kPlain, standard<scpi::questionable_condition, I>},
    {"STATus:QUEStionable:ENABle", kBoth, "<mask>", "Bits that count in bit 3 of *STB?", kPlain, standard<scpi::questionable_enable, I>},
    {"STATus:QUEStionable:PTRansition", kBoth, "<mask>", "Bits whose rise is an event", kPlain, standard<scpi::questionable_positive, I>},
    {"STATus:QUEStionable:NTRansition", kBoth, "<mask>", "Bits whose fall is an event", kPlain, standard<scpi::questionable_negative, I>},
    {"STATus:PRESet", kSet, "", "Nothing enabled, rises are events", kPlain, standard<scpi::status_preset, I>},

    {"[SENSe:]REFerence:SENSitivity", kBoth, "<V/(m/s2)>[,<percent>]", "Of the reference sensor, and its expanded uncertainty", kLearned, C::reference},
    {"[SENSe:]REFerence:TABLe", kBoth, "<f1>,<S1>,...", "Of the reference over frequency, 2 to 32 pairs, on a PC 64; 0,S where it is one value", kPlain, C::reference_table},
    {"[SENSe:]REFerence:TABLe:CLEar", kSet, "", "One value again: the first of the table", kPlain, C::clear_reference_table},
    {"[SENSe:]SWEep:FREQuency", kBoth, "<f1>,...", "3 to 64 frequencies, on a PC 1024, ascending", kPlain, C::sweep_frequencies},
    {"[SENSe:]SWEep:FREQuency:DEFault", kSet, "", "The 42 frequencies of the default sweep", kPlain, C::default_frequencies},
};

inline constexpr scpi::Command<Instrument> kWork[] = {
    {"INITiate[:IMMediate][:SWEep]", kSet, "", "Starts the sweep", kPlain, C::initiate_sweep},
    {"INITiate[:IMMediate]:ALL", kSet, "", "The same", kPlain, C::initiate_sweep},
    {"INITiate:ENERgy", kSet, "", "Starts the search for the maximum energy", kPlain, C::initiate<Goal::kEnergy>},
    {"INITiate:MCARlo", kSet, "", "Starts the Monte Carlo trials, after the energy", kPlain, C::initiate<Goal::kMonteCarlo>},
    {"INITiate:TRENd", kSet, "", "Starts the trend, after the energy", kPlain, C::initiate<Goal::kTrend>},
    {"INITiate:REPort", kSet, "", "Starts everything that the report shows", kPlain, C::initiate<Goal::kReport>},
    {"ABORt", kSet, "", "Ends what runs, drive at zero; overtakes commands that wait", kImmediate, C::abort},

    {"FETCh:FRESponse", kQuery, "", "n, then f,A,phi,uA,uphi of each point: Hz, V/(m/s2), degrees, standard u with the common part", kPlain, C::fetch},
    {"FETCh:FRESponse:POINt", kQuery, "<i>", "The point i of TRAC:FRES:POIN?: f,A,phi,uA,uphi; while the sweep runs, too, then without u", kPlain, C::fetch_point},
    {"FETCh:TRACe", kQuery, "", "The points as TRACe takes them: expanded U (k = 2), in U(A) the common part of CALC:REF:UNC?", kPlain, C::fetch_trace},
    {"FETCh:JSON", kQuery, "", "What was measured and computed, as results.json, as a block", kPlain, C::fetch_json},
    {"READ:FRESponse", kQuery, "", "ABORt, INITiate and FETCh:FRESponse? in one", kPlain, C::read},
    {"TRACe:FRESponse:DATA", kSet, "<f>,<A>,<phi>,<uA>,<uphi>,...", "Adds points; expanded u (k = 2), degrees", kPlain, C::add_points},
    {"TRACe:FRESponse:CLEar", kSet, "", "Forgets the points", kPlain, C::clear_points},
    {"TRACe:FRESponse:POINts", kQuery, "", "Number of points", kPlain, C::count_points},

    {"CALCulate:REFerence:UNCertainty", kBoth, "<percent>", "Expanded, common to all points of TRACe and within their U(A); of a sweep, what it has found", kPlain, C::common_part},

    {"CALCulate:IDENtify", kQuery, "", "Fits the points: S,f0,beta,uS,uf0,ubeta,chi2,dof", kPlain, C::identify},
    {"CALCulate:IDENtify:COVariance", kQuery, "", "Covariance of S, f0, beta, row by row", kPlain, C::covariance},
    {"CALCulate:MODel", kBoth, "<S>,<f0>,<beta>[,<uS>,<uf0>,<ubeta>]", "The device by its parameters, standard u", kPlain, C::model},
};

inline constexpr scpi::Command<Instrument> kEnergy[] = {
    {"CALCulate:ENERgy", kQuery, "", "The maximum energy: E,xi,bound,n,t1,...,tn", kPlain, C::energy},
    {"CALCulate:ENERgy:BAND", kQuery, "", "The in-band error with that delay taken out: E,rms_percent,bound,n,t1,...", kPlain, C::band},
    {"CALCulate:ENERgy:EVALuate", kQuery, "[<t1>,...]", "Energy of the signal that starts at +a and changes sign at these times", kPlain, C::evaluate},
    {"CALCulate:ENERgy:FPA", kQuery, "", "The fixed point of the paper: iterations,E_0,E_1,...", kPlain, C::fixed_point},
    {"CALCulate:AERRor", kQuery, "", "The largest absolute error, V", kPlain, C::absolute_error},
    {"CALCulate:IMPulse", kQuery, "<t1>,...", "k(t)", kPlain, C::impulse_response},
    {"CALCulate:SETTle", kQuery, "", "The 5 % settling time", kPlain, C::settling_time},
};

inline constexpr scpi::Command<Instrument> kUncertainty[] = {
    {"CALCulate:MCARlo", kQuery, "", "trials,E_max,S,f0,beta,trial,mean,u,low,high,shortest_low,shortest_high,disagreements", kPlain, C::monte_carlo},
    {"CALCulate:MCARlo:HISTogram", kQuery, "", "low,high,n1,...,n64: how many trials in equal bins of E", kPlain, C::histogram},
    {"CALCulate:UNCertainty", kQuery, "", "Of E, by JCGM 101 with normal parameters: u,U,low,high,shortest_low,shortest_high,redrawn", kPlain, C::uncertainty},
    {"CALCulate:TRENd", kQuery, "[<T1>,...]", "slope,intercept,E1,E2,... over these times; without them those of before", kPlain, C::trend},
    {"CALCulate:REPort", kQuery, "[<device>,<serial>,<operator>,<date>,<note>]", "The text of emax report, as a block; labels are strings, in ASCII", kPlain, C::report_text},

    {"DIAGnostic:RANDom", kQuery, "<n>", "The next n random numbers, from the seed set", kPlain, C::random},
    {"DIAGnostic:MEMory", kQuery, "", "static_bytes,stack_limit,stack_used", kPlain, C::memory},
    {"DIAGnostic:CONVersion", kQuery, "", "What one result of the converters takes, s, measured now; 9.91E37 where the board does not", kPlain, C::conversion},
};

inline constexpr scpi::Command<Instrument> kLoopback[] = {
    {"DIAGnostic:LOOPback", kQuery, "", "With a wire from drive to both inputs: latency,offset_r,offset_d,gain_r,gain_d,ratio,skew,noise_r,noise_d,thd,lost", kPlain, C::loopback},
    {"[SENSe:]CORRection:ACQuire", kBoth, "", "Measures by the same loopback, and keeps RATio and SKEW; the query only answers what is set: ratio,percent,skew,s", kPlain, C::acquire_corrections},
};
// clang-format on

template <std::size_t kSize>
constexpr std::size_t size_of(const scpi::Command<Instrument> (&/*part*/)[kSize]) noexcept {
  return kSize;
}

// In the order of the list in the README. The settings come from their rows, group by group.
constexpr auto all_commands() noexcept {
  constexpr std::size_t kRoom = size_of(kCommon) + size_of(kWork) + size_of(kEnergy) +
                                size_of(kUncertainty) + size_of(kLoopback) +
                                count_commands(kSettingRows) + count_commands(kSweepSettingRows);
  CommandTable<kRoom> table;
  table.add(kCommon);
  for (const SettingGroup group :
       {SettingGroup::kRepeats, SettingGroup::kRest, SettingGroup::kDrive, SettingGroup::kChain}) {
    table.add_settings<SettingsOf::kSweep>(kSweepSettingRows, group);
  }
  table.add(kWork);
  for (const SettingGroup group : {SettingGroup::kFilter, SettingGroup::kSignal}) {
    table.add_settings<SettingsOf::kEvaluation>(kSettingRows, group);
  }
  table.add(kEnergy);
  for (const SettingGroup group : {SettingGroup::kTrials, SettingGroup::kRandom,
                                   SettingGroup::kCoverage, SettingGroup::kTrend}) {
    table.add_settings<SettingsOf::kEvaluation>(kSettingRows, group);
  }
  table.add(kUncertainty);
  table.add(kLoopback);
  return table;
}

}  // namespace instrument_table

/// Every command of the instrument.
inline constexpr auto kCommands = instrument_table::all_commands();
static_assert(kCommands.count == instrument_table::size_of(kCommands.rows),
              "a setting of a group that is not listed");
static_assert(scpi::first_bad_row(kCommands.rows) == kCommands.count);

}  // namespace emax::app
