// What lines around a table say of it: the coverage factor, and units that its header leaves out.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "desk/import/import_error.hpp"
#include "desk/import/table_header.hpp"

namespace emax::desk {

/// A unit that a line states for columns of one kind.
struct StatedUnit {
  std::string spelling;  ///< Empty if none does.
  std::size_t line = 0;  ///< From 1.
};

/// What is read of lines that are no rows. All else in them is passed over.
struct Statements {
  double coverage = 0.0;  ///< k of all uncertainties; 0 if no line states it.
  std::size_t coverage_line = 0;
  /// A k other than the usual one in a line that speaks of a reference sensor: perhaps only that
  /// sensor's. 0 if there is none.
  double doubtful_coverage = 0.0;
  std::size_t doubtful_line = 0;
  StatedUnit frequency;
  StatedUnit amplitude;
  StatedUnit phase;
};

/// @returns The number in up to six digits.
std::string text_of_number(double value);
/// @returns "k = 2".
std::string text_of_coverage(double coverage);

/// @returns Whether a line states a coverage factor or units.
bool is_statement(std::string_view text);

/// Reads lines one by one.
///
///     reader.take(line_number, line);
///     error = reader.finish(statements);
///
/// A coverage factor is "k = 2", "coverage factor: 2" or its like, "standard uncertainties" where
/// nothing speaks of expanded ones. Units are those behind the word "units", or a name with its
/// unit, such as "sensitivity in mV/g".
class StatementReader final {
 public:
  /// @returns Two lines that state different values are an error.
  ImportError take(std::size_t line, std::string_view text);
  const Statements& finish();

 private:
  ImportError take_coverage(std::size_t line, std::string_view text);
  void take_doubtful(std::size_t line, std::string_view text);
  ImportError take_units(std::size_t line, std::string_view text);
  ImportError take_unit(std::size_t line, Role role, const std::string& spelling);

  Statements statements_;
  std::size_t standard_line_ = 0;
  bool speaks_of_expanded_ = false;
};

}  // namespace emax::desk
