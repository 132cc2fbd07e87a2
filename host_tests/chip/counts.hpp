// Instructions of the image that is tested, and the tables that have them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chip/tested_board.hpp"

namespace emax::chip {

/// Counts the instructions of a sweep without those that wait for a block.
class WorkCounter {
 public:
  WorkCounter(Tested::Chip& chip, std::uint32_t wait, std::uint32_t exchange)
      : chip_(chip), wait_(wait), exchange_(exchange) {}

  void on_block(std::uint32_t address, std::uint32_t instructions) {
    const Engine& engine = chip_.processor().engine();
    if (address == exchange_) {
      if (exchanges_++ > 0) {
        total_ += block_;
        largest_ = std::max(largest_, block_);
      }
      block_ = 0;
    } else if (address == wait_) {
      back_ = engine.get(UC_ARM_REG_LR) & ~1U;
      sp_ = engine.get(UC_ARM_REG_SP);
    } else if (address == back_ && engine.get(UC_ARM_REG_SP) == sp_) {
      back_ = 0;
    }
    block_ += back_ == 0 ? instructions : 0;
  }
  /// Of the blocks that are over.
  std::uint64_t total() const { return total_; }
  double per_frame() const { return static_cast<double>(total_) / (64.0 * (exchanges_ - 1)); }
  double per_frame_at_most() const { return static_cast<double>(largest_) / 64.0; }

 private:
  Tested::Chip& chip_;
  const std::uint32_t wait_, exchange_;
  std::uint32_t back_ = 0, sp_ = 0;  // Of the wait under way.
  std::uint64_t block_ = 0, total_ = 0, largest_ = 0;
  unsigned exchanges_ = 0;
};

/// 1 234 567
inline std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) {
    at -= 3;
    text.insert(at, " ");
  }
  return text;
}

inline std::string time_of(double time_us) {
  std::ostringstream text;
  text.precision(3);
  if (time_us < 1e3) {
    text << time_us << " µs";
  } else if (time_us < 1e6) {
    text << time_us / 1e3 << " ms";
  } else {
    text << time_us / 1e6 << " s";
  }
  return text.str();
}

/// Rows of a table in a Markdown file, between its two marks: the first cell, and the second one as
/// a number.
inline std::vector<std::pair<std::string, double>> table_rows(const std::string& name) {
  std::ifstream file(EMAX_CHIP_TABLES);
  std::vector<std::pair<std::string, double>> rows;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    inside = inside ? line != "<!-- end of table " + name + " -->"
                    : line == "<!-- table " + name + " -->";
    const std::size_t middle = line.find(" | "), end = line.find(" | ", middle + 3);
    if (inside && end != std::string::npos && line.find("---") == std::string::npos) {
      std::string number = line.substr(middle + 3, end - middle - 3);
      number.erase(std::remove(number.begin(), number.end(), ' '), number.end());
      rows.emplace_back(line.substr(2, middle - 2), std::strtod(number.c_str(), nullptr));
    }
  }
  return rows;
}

}  // namespace emax::chip
