// What the cost image prints: a name and a number of instructions in each line.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/status.hpp"
#include "emax/model/modal_model.hpp"

namespace emax::cost {

/// Lines for the console. Nothing is counted while one is on its way: the UART's interrupts would
/// be counted too.
class Rows {
 public:
  explicit Rows(app::TextWriter& out) noexcept : out_(out) {}

  void add(const char* name, std::uint64_t instructions) noexcept;
  /// The same, of which "name.2ms" is the name for 2.
  void add(const char* name, std::uint32_t duration_ms, std::uint64_t instructions) noexcept;

 private:
  app::TextWriter& out_;
};

/// The device of the paper's Table 2 with its filter.
inline constexpr Accelerometer kDevice = {1.037, 4073.0, 0.3182};
inline constexpr Butterworth kFilter = {10, 1000.0, 1.037};

/// Sine fit, frame of the simulated bench, Phi, one iteration, decimal conversions.
Status count_kernels(Rows& rows) noexcept;

/// Search, bound and one trial.
Status count_energies(std::uint32_t duration_ms, Rows& rows) noexcept;

/// The longest step of each stage of an evaluation, and the whole evaluation.
Status count_steps(std::uint32_t duration_ms, Rows& rows) noexcept;

/// The default evaluation of measured points, without its trials.
Status count_report(Rows& rows) noexcept;

/// The sweep's own work for each frame, without that of the stream.
Status count_sweep(Rows& rows) noexcept;

}  // namespace emax::cost
