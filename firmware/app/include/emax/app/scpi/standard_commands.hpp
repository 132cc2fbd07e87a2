// Handlers of the commands that are the same for every instrument: IEEE 488.2 status, SYSTem,
// STATus.
#pragma once

#include "emax/app/scpi/call.hpp"

namespace emax::app::scpi {

/// Makes one of the functions below a handler for any table:
/// {"*CLS", Forms::kSet, "", "Clears ...", kImmediate, standard<clear_status, Instrument>}.
template <void (*kFunction)(Call&), typename Context>
void standard(Context& /*context*/, Call& call) noexcept {
  kFunction(call);
}

// All of them are immediate commands. The forms are given with each.

void clear_status(Call& call) noexcept;    ///< *CLS
void event_enable(Call& call) noexcept;    ///< *ESE and *ESE?, 0 to 255.
void event_status(Call& call) noexcept;    ///< *ESR?
void service_enable(Call& call) noexcept;  ///< *SRE and *SRE?, 0 to 255.
void status_byte(Call& call) noexcept;     ///< *STB?

void next_error(Call& call) noexcept;   ///< SYSTem:ERRor[:NEXT]?
void error_count(Call& call) noexcept;  ///< SYSTem:ERRor:COUNt?
void all_errors(Call& call) noexcept;   ///< SYSTem:ERRor:ALL?, not immediate.
void next_code(Call& call) noexcept;    ///< SYSTem:ERRor:CODE[:NEXT]?
void all_codes(Call& call) noexcept;    ///< SYSTem:ERRor:CODE:ALL?
void version(Call& call) noexcept;      ///< SYSTem:VERSion?, 1999.0

void status_preset(Call& call) noexcept;           ///< STATus:PRESet
void operation_event(Call& call) noexcept;         ///< STATus:OPERation[:EVENt]?
void operation_condition(Call& call) noexcept;     ///< STATus:OPERation:CONDition?
void operation_enable(Call& call) noexcept;        ///< STATus:OPERation:ENABle and ?
void operation_positive(Call& call) noexcept;      ///< STATus:OPERation:PTRansition and ?
void operation_negative(Call& call) noexcept;      ///< STATus:OPERation:NTRansition and ?
void questionable_event(Call& call) noexcept;      ///< STATus:QUEStionable[:EVENt]?
void questionable_condition(Call& call) noexcept;  ///< STATus:QUEStionable:CONDition?
void questionable_enable(Call& call) noexcept;     ///< STATus:QUEStionable:ENABle and ?
void questionable_positive(Call& call) noexcept;   ///< STATus:QUEStionable:PTRansition and ?
void questionable_negative(Call& call) noexcept;   ///< STATus:QUEStionable:NTRansition and ?

}  // namespace emax::app::scpi
