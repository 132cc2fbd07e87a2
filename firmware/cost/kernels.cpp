// The innermost pieces of work.
#include <array>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/board/board.hpp"
#include "emax/board/instruction_counter.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/hal/analog_stream.hpp"

#include "memory.hpp"
#include "rows.hpp"

namespace emax::cost {
namespace {

constexpr double kDuration_s = 2e-3;
constexpr std::size_t kBlock = hal::kMaxBlockFrames;
constexpr std::size_t kBlocks = 100;
constexpr double kFrequency_hz = 1000.0;
constexpr double kRate_hz = 100000.0;
/// A hundredth of full scale, about what a sweep needs.
constexpr double kDrive = 2e7;

/// What a report prints: energies, frequencies, times and ratios.
constexpr double kNumbers[] = {0.005115251359876, 4073.0, 0.3182,  1.0474909417558e-3,
                               -86.749999999999,  1.037,  17462.4, 5.83761994e-03};
constexpr int kDigits = 17;
constexpr std::size_t kTextRoom = 24;

volatile double number_sink;

std::uint64_t mean(Ticks ticks, std::size_t count) noexcept {
  return instructions_of((ticks + count / 2) / count);
}

double sine_at(std::size_t sample) noexcept {
  return sincos(kTwoPi * kFrequency_hz / kRate_hz * static_cast<double>(sample)).sin;
}

/// As a sweep does it, of both channels.
Status count_frame_sine_fit(FrameSineFit& fit, Rows& rows) noexcept {
  const hal::StreamFormat format = board::ports().analog.format();
  const Status status = fit.start(kFrequency_hz, format.sample_rate_hz,
                                  hal::volts_per_word(format.input_full_scale_v));
  Ticks ticks = 0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    std::array<hal::Frame, kBlock> frames = {};
    for (std::size_t i = 0; i < kBlock; ++i) {
      const auto word = static_cast<hal::Word>(kDrive * sine_at(block * kBlock + i));
      frames[i] = {word, word};
    }
    ticks += ticks_of([&] { fit.add(Span<const hal::Frame>(frames)); });
  }
  rows.add("frame_sine_fit_sample", mean(ticks, 2 * kBlocks * kBlock));
  rows.add("frame_sine_fit_result",
           instructions_in([&] { number_sink = fit.reference().amplitude_v; }));
  return status;
}

Status count_bench_frame(Rows& rows) noexcept {
  hal::AnalogStream& stream = board::ports().analog;
  Status status = stream.start({1'000'000'000, 100'000'000});
  std::array<hal::Word, kBlock> drive = {};
  std::array<hal::Frame, kBlock> response = {};
  Ticks ticks = 0;
  for (std::size_t block = 0; block < kBlocks && status == Status::kOk; ++block) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      drive[i] = static_cast<hal::Word>(kDrive * sine_at(block * kBlock + i));
    }
    ticks += ticks_of([&] { status = stream.exchange(drive, response).status; });
  }
  stream.stop();
  rows.add("bench_frame", mean(ticks, kBlocks * kBlock));
  return status;
}

Status count_phi(Kernels& kernels, Rows& rows) noexcept {
  Status status = Status::kOk;
  rows.add("phi_fill", instructions_in([&] {
             status = kernels.stored_phi.fill(kernels.model, kDuration_s, kStoredCells);
           }));
  return status;
}

/// Two products with Phi against one more: the difference is one iteration.
Ticks ticks_of_run(Kernels& kernels, std::size_t iterations) noexcept {
  const std::size_t cells = kernels.phi.cells();
  const Signs signs(kernels.signs, cells);
  const Signs best(kernels.best_signs, cells);
  const Span<double> product = Span<double>(kernels.product).first(cells);
  signs_of_column(kernels.phi, 0, signs, product);
  return ticks_of([&] {
    number_sink =
        run_fixed_point(kernels.phi, iterations, 0.0, signs, best, product, Span<double>()).energy;
  });
}

Status count_iteration(std::size_t cells, const char* apply_name, const char* iteration_name,
                       Kernels& kernels, Rows& rows) noexcept {
  const Status status = kernels.phi.set(kernels.model, kDuration_s, cells);
  const Signs signs(kernels.signs, cells);
  const Span<double> product = Span<double>(kernels.product).first(cells);
  signs_of_column(kernels.phi, 0, signs, product);
  rows.add(apply_name, instructions_in([&] { kernels.phi.multiply(signs, product); }));
  const Ticks one = ticks_of_run(kernels, 1);
  rows.add(iteration_name, instructions_of(ticks_of_run(kernels, 2) - one));
  return status;
}

Status count_decimal(Rows& rows) noexcept {
  Ticks format_ticks = 0;
  Ticks parse_ticks = 0;
  bool is_same = true;
  for (const double number : kNumbers) {
    std::array<char, kTextRoom> text = {};
    std::size_t length = 0;
    format_ticks += ticks_of([&] { length = format_general(number, kDigits, text); });
    ParsedNumber parsed;
    const Span<const char> written(text.data(), length);
    parse_ticks += ticks_of([&] { parsed = parse_decimal(written); });
    is_same = is_same && parsed.status == Status::kOk && parsed.value == number;
  }
  rows.add("decimal_format", mean(format_ticks, std::size(kNumbers)));
  rows.add("decimal_parse", mean(parse_ticks, std::size(kNumbers)));
  return is_same ? Status::kOk : Status::kSyntax;
}

}  // namespace

Status count_kernels(Rows& rows) noexcept {
  Kernels& kernels = memory().kernels.make();
  Status status = kernels.model.set(kDevice, kFilter, Criterion::kIntegralSquareError);
  const auto then = [&status](Status next) { status = status == Status::kOk ? next : status; };
  then(count_frame_sine_fit(kernels.frame_fit, rows));
  then(count_bench_frame(rows));
  then(count_decimal(rows));
  then(count_phi(kernels, rows));
  const std::size_t cells = grid_cells(kernels.model, kDuration_s);
  then(count_iteration(cells, "phi_apply", "iteration", kernels, rows));
  then(count_iteration(kPaperCells, "phi_apply_paper", "iteration_paper", kernels, rows));
  return status;
}

}  // namespace emax::cost
