// Drives for the simulated bench, and what its tests take from the response.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::test {

/// One volt at the default full scale of 10 V.
constexpr hal::Word kVolt = 214748365;
/// No limit but the words' own.
constexpr hal::DriveLimits kFree = {2147483647, 2147483647};

/// Nothing drawn, no noise, nothing rounded to converters' steps.
inline sim::BenchSettings ideal_bench() {
  sim::BenchSettings settings;
  settings.second_harmonic = 0.0;
  settings.third_harmonic = 0.0;
  settings.reference_expanded_percent = 0.0;
  settings.drift_expanded_percent = 0.0;
  settings.gain_expanded_percent = 0.0;
  settings.mounting_expanded_percent = 0.0;
  settings.noise_v = 0.0;
  settings.offset_v = 0.0;
  settings.hum_v = 0.0;
  settings.ideal_converters = true;
  return settings;
}

/// Cosine whose phase is exact however long it lasts, `frames` rounded down to whole blocks of 64.
inline std::vector<hal::Word> cosine(int frequency_hz, double amplitude_v, int frames) {
  std::vector<hal::Word> drive(static_cast<std::size_t>(frames - frames % 64));
  long long phase = 0;
  for (hal::Word& word : drive) {
    const double turns = static_cast<double>(phase) / 100000.0;
    word = static_cast<hal::Word>(
        std::lround(amplitude_v / 10.0 * 2147483648.0 * std::cos(6.283185307179586 * turns)));
    phase = (phase + frequency_hz) % 100000;
  }
  return drive;
}

inline std::vector<hal::Word> silence(int frames) {
  return std::vector<hal::Word>(static_cast<std::size_t>(frames), 0);
}

/// The whole response to a drive, from start to stop.
inline std::vector<hal::Frame> run(sim::SimBench& bench, const std::vector<hal::Word>& drive) {
  std::vector<hal::Frame> response(drive.size());
  const std::size_t block = bench.format().block_frames;
  EXPECT_EQ(bench.start(kFree), Status::kOk);
  EXPECT_EQ(drive.size() % block, 0U);
  for (std::size_t i = 0; i + block <= drive.size(); i += block) {
    const hal::Exchange exchange = bench.exchange({&drive[i], block}, {&response[i], block});
    EXPECT_EQ(exchange.status, Status::kOk);
    EXPECT_EQ(exchange.first_frame, i);
  }
  bench.stop();
  return response;
}

enum class Channel { kReference, kDevice };

inline double volts(const hal::Frame& frame, Channel channel) {
  return 10.0 / 2147483648.0 * (channel == Channel::kDevice ? frame.device : frame.reference);
}

/// Complex amplitude over whole periods, as of a cosine that starts with frame 0.
inline std::complex<double> component(const std::vector<hal::Frame>& response, Channel channel,
                                      int first, int frames, double frequency_hz,
                                      const hal::StreamFormat& format) {
  std::complex<double> sum = 0.0;
  for (int i = 0; i < frames; ++i) {
    const double turns = frequency_hz / format.sample_rate_hz * (first + i);
    sum += volts(response[static_cast<std::size_t>(first + i)], channel) *
           std::polar(1.0, -6.283185307179586 * (turns - std::floor(turns)));
  }
  return sum * (2.0 / frames);
}

}  // namespace emax::test
