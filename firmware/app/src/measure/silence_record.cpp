// Offset, noise and hum from the sine fits of a record without drive.
#include "emax/app/measure/silence_record.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::app {

double SilentChannel::hum_in_fit_v(double frequency_hz, double duration_s) const noexcept {
  double squares = 0.0;
  for (std::size_t i = 0; i < kHumLines; ++i) {
    const double x = kPi * abs(frequency_hz - kHum_hz[i]) * duration_s;
    const double part = x > 1.0 ? hum_v[i] / x : hum_v[i];
    // The phase is not known: half of the square falls on each component.
    squares += 0.5 * part * part;
  }
  return sqrt(squares);
}

void SilenceRecord::start(const hal::StreamFormat& format, const FullScales& scales) noexcept {
  half_ = static_cast<std::uint32_t>(floor(0.5 * kDuration_s * format.sample_rate_hz)) + 1u;
  frames_ = 0;
  rise_ = Rise();
  volts_per_word_ = hal::volts_per_word(scales.reference_v);
  device_scale_ = scales.device_v / scales.reference_v;
  for (std::size_t i = 0; i < kHumLines; ++i) {
    // A line beyond half the sample rate is refused, and its fit stays without a result.
    fits_[i] = FrameSineFit();
    (void)fits_[i].start(kHum_hz[i], format.sample_rate_hz, volts_per_word_);
  }
}

void SilenceRecord::add(Span<const hal::Frame> frames) noexcept {
  for (const hal::Frame& frame : frames) {
    const std::int32_t sign = frames_ < half_ ? -1 : 1;
    rise_.reference += std::int64_t{sign} * frame.reference;
    rise_.device += std::int64_t{sign} * frame.device;
    ++frames_;
  }
  for (FrameSineFit& fit : fits_) {
    fit.add(frames);
  }
}

SilentChannel SilenceRecord::reference() const noexcept {
  Lines lines;
  for (std::size_t i = 0; i < kHumLines; ++i) {
    lines[i] = fits_[i].reference();
  }
  return evaluate(lines, rise_.reference, volts_per_word_);
}

SilentChannel SilenceRecord::device() const noexcept {
  Lines lines;
  for (std::size_t i = 0; i < kHumLines; ++i) {
    lines[i] = in_volts(fits_[i].device(), device_scale_);
  }
  return evaluate(lines, rise_.device, device_scale_ * volts_per_word_);
}

SilentChannel SilenceRecord::evaluate(const Lines& lines, std::int64_t rise,
                                      double volts_per_word) const noexcept {
  SilentChannel channel;
  const SineFitResult& first = lines[0];
  if (first.samples == 0) {
    return channel;
  }
  channel.offset_v = first.offset_v;
  channel.drift_v = volts_per_word * static_cast<double>(rise) / static_cast<double>(half_);
  // Without the first line; the other lines are taken out below.
  double variance = first.residual_std_v * first.residual_std_v;
  for (std::size_t i = 1; i < kHumLines; ++i) {
    const double amplitude = lines[i].amplitude_v;
    variance -= 0.5 * amplitude * amplitude;
  }
  variance = variance > 0.0 ? variance : 0.0;
  channel.noise_v = sqrt(variance);
  // Noise alone looks like a line: its part of the square of an amplitude.
  const double by_noise = 4.0 * variance / static_cast<double>(first.samples);
  for (std::size_t i = 0; i < kHumLines; ++i) {
    const double amplitude = lines[i].amplitude_v;
    const double square = amplitude * amplitude - by_noise;
    channel.hum_v[i] = square > 0.0 ? sqrt(square) : 0.0;
  }
  return channel;
}

}  // namespace emax::app
