// One program message unit, cut into header and parameters.
#pragma once

#include <cstddef>

#include "emax/app/scpi/error_code.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// The parts of "CALCulate:FILTer:ORDer? MAX"; views of the message.
struct ProgramUnit {
  Span<const char> header;                ///< As sent.
  Span<const char> name;                  ///< The header without leading colon and question mark.
  Span<const char> parameters;            ///< From the first one on; empty if there are none.
  std::size_t count = 0;                  ///< Parameters.
  ErrorCode error = ErrorCode::kNoError;  ///< What is wrong with the header.
  bool is_query = false;
  bool is_common = false;    ///< Begins with '*'.
  bool is_absolute = false;  ///< Begins with ':'.
  bool is_empty = false;     ///< Only white space.
};

/// @returns Whether this parameter is a block of either length (IEEE 488.2, 7.7.6).
bool begins_block(Span<const char> parameter) noexcept;

/// Cuts the next unit off a message and checks the form of its header (IEEE 488.2, 7.6.1).
///
/// @param[in]     message  Complete, without its end.
/// @param[in,out] position Where the unit begins; moved behind its semicolon, or to the end of the
///                         message.
/// @returns The unit, with one of -101, -110, -111, -112 if the header is not well formed. Takes
/// one pass over the unit.
ProgramUnit cut_unit(Span<const char> message, std::size_t& position) noexcept;

}  // namespace emax::app::scpi
