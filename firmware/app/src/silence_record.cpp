// Offset, noise and hum from the sine fits of a record without drive.
#include "emax/app/silence_record.hpp"

#include "emax/elementary.hpp"
#include "emax/units.hpp"

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

void SilenceRecord::start(double sample_rate_hz) noexcept {
  half_ = static_cast<std::uint32_t>(floor(0.5 * kDuration_s * sample_rate_hz)) + 1u;
  frames_ = 0;
  Channel* const channels[] = {&reference_, &device_};
  for (Channel* channel : channels) {
    channel->first_sum_v = 0.0;
    channel->second_sum_v = 0.0;
    for (std::size_t i = 0; i < kHumLines; ++i) {
      // A line beyond half the sample rate is refused, and its fit stays without a result.
      channel->fits[i] = SineFit();
      (void)channel->fits[i].start(kHum_hz[i], sample_rate_hz);
    }
  }
}

void SilenceRecord::add(Span<const double> reference_v, Span<const double> device_v) noexcept {
  add(reference_, reference_v);
  add(device_, device_v);
  frames_ += static_cast<std::uint32_t>(reference_v.size());
}

void SilenceRecord::add(Channel& channel, Span<const double> samples_v) const noexcept {
  for (std::size_t i = 0; i < samples_v.size(); ++i) {
    (frames_ + i < half_ ? channel.first_sum_v : channel.second_sum_v) += samples_v[i];
  }
  for (SineFit& fit : channel.fits) {
    fit.add(samples_v);
  }
}

SilentChannel SilenceRecord::evaluate(const Channel& record) const noexcept {
  SilentChannel channel;
  const Fits& fits = record.fits;
  const SineFitResult first = fits[0].result();
  if (first.samples == 0) {
    return channel;
  }
  channel.offset_v = first.offset_v;
  channel.drift_v = (record.second_sum_v - record.first_sum_v) / static_cast<double>(half_);
  // Without the first line; the other lines are taken out below.
  double variance = first.residual_std_v * first.residual_std_v;
  for (std::size_t i = 1; i < kHumLines; ++i) {
    const double amplitude = fits[i].result().amplitude_v;
    variance -= 0.5 * amplitude * amplitude;
  }
  variance = variance > 0.0 ? variance : 0.0;
  channel.noise_v = sqrt(variance);
  // Noise alone looks like a line: its part of the square of an amplitude.
  const double by_noise = 4.0 * variance / static_cast<double>(first.samples);
  for (std::size_t i = 0; i < kHumLines; ++i) {
    const double amplitude = fits[i].result().amplitude_v;
    const double square = amplitude * amplitude - by_noise;
    channel.hum_v[i] = square > 0.0 ? sqrt(square) : 0.0;
  }
  return channel;
}

}  // namespace emax::app
