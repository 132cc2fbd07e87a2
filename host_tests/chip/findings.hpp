// What a program did wrong with its chip, as far as the model can tell.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "chip/events.hpp"

namespace emax::chip {

struct Finding {
  std::string what;         ///< Stable short name, such as "clock_off"; the README lists them.
  std::string where;        ///< Register or part, such as "ADC1.CFGR".
  std::uint32_t value = 0;  ///< What was written, or what the name's row in the README says.
  std::uint32_t block = 0;  ///< Address of the block of code that ran.
  Time at = 0;
  unsigned times = 1;  ///< How often the same was found from the same block.
};

/// The list of findings; one that repeats itself from the same block of code is counted only.
class Findings {
 public:
  /// Who knows where the program is.
  void locate_with(const Events* events, std::function<std::uint32_t()> block);

  void report(const std::string& what, const std::string& where, std::uint32_t value = 0);

  const std::vector<Finding>& all() const { return all_; }
  bool has(const std::string& what) const;
  void clear() { all_.clear(); }

  /// One line for each finding, empty if there is none.
  std::string text() const;

 private:
  std::vector<Finding> all_;
  const Events* events_ = nullptr;
  std::function<std::uint32_t()> block_;
};

}  // namespace emax::chip
