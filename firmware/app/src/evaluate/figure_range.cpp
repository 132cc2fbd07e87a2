// The in-band error over the dampings that points leave open.
#include "emax/app/evaluate/figure_range.hpp"

namespace emax::app {
namespace {

constexpr double kCoverage = 2.0;
constexpr double kInwards = 0.01;  // A look from an end of the range, as part of it.
constexpr double kGolden = 0.6180339887498949;
constexpr std::size_t kSections = 12;  // Leave 0.3 % of the range.
constexpr std::size_t kEnds = 2;

double square(double x) noexcept { return x * x; }

double nearest(double value, double low, double high) noexcept {
  return value < low ? low : value > high ? high : value;
}

}  // namespace

void FigureRange::start(const FitJudgement& judgement, const Error& error,
                        const SearchSettings& settings, bool holds_sensitivity) noexcept {
  *this = FigureRange();
  judgement_ = judgement;
  error_ = error;
  settings_ = settings;
  holds_sensitivity_ = holds_sensitivity;
  low_ = error.at_estimate;
  high_ = error.at_estimate;
  damping_ = judgement.damping_low;
  phase_ = Phase::kEnds;
}

std::size_t FigureRange::corners() const noexcept {
  return holds_sensitivity_ ? kSides : kSides * kSensitivities;
}

double FigureRange::progress() const noexcept {
  const std::size_t of_ends = kEnds * corners();
  const std::size_t before = phase_ == Phase::kEnds      ? 0
                             : phase_ == Phase::kInwards ? of_ends
                                                         : of_ends + 1;
  return done()
             ? 1.0
             : static_cast<double>(before + made_) / static_cast<double>(of_ends + 1 + kSections);
}

Accelerometer FigureRange::device_at(double damping, std::size_t corner) const noexcept {
  const Accelerometer& estimate = judgement_.device;
  const double moved = damping - estimate.damping;
  const double by_u_f0 = corner % kSides == 0 ? -kCoverage : kCoverage;
  const double f0_hz = estimate.natural_frequency_hz + judgement_.frequency_slope_hz * moved +
                       by_u_f0 * judgement_.u_natural_frequency_hz;
  if (holds_sensitivity_) {
    return {estimate.sensitivity, f0_hz, damping};
  }
  const double middle = estimate.sensitivity + judgement_.sensitivity_slope * moved;
  const double low = middle - kCoverage * judgement_.u_sensitivity;
  const double high = middle + kCoverage * judgement_.u_sensitivity;
  const double sensitivities[kSensitivities] = {low, nearest(error_.filter.gain, low, high), high};
  return {sensitivities[corner / kSides], f0_hz, damping};
}

void FigureRange::give_up(Status status) noexcept {
  status_ = status;
  phase_ = Phase::kDone;
}

void FigureRange::begin_search(EnergySearch& search) noexcept {
  Status status = model_.set(device_at(damping_, corner_), error_.filter, error_.measure);
  if (status == Status::kOk) {
    status = search.start(model_, settings_);
  }
  if (status != Status::kOk) {
    give_up(status);
  }
  is_searching_ = true;
}

void FigureRange::step(EnergySearch& search, GridWorkspace& grid) noexcept {
  if (done()) {
    return;
  }
  if (!is_searching_) {
    begin_search(search);
    return;
  }
  const Status status = search.step(model_, grid);
  if (status != Status::kOk) {
    give_up(status);
  } else if (search.done()) {
    is_searching_ = false;
    ++made_;
    const double sensitivity = device_at(damping_, corner_).sensitivity;
    take(search.result().energy * square(judgement_.device.sensitivity / sensitivity));
  }
}

void FigureRange::take(double energy) noexcept {
  low_ = energy < low_ ? energy : low_;
  high_ = energy > high_ ? energy : high_;
  switch (phase_) {
    case Phase::kEnds:
      take_end(energy);
      return;
    case Phase::kInwards:
      if (energy < least_end_) {
        begin_sections();
      } else {
        phase_ = Phase::kDone;
      }
      return;
    case Phase::kSections:
      take_section(energy);
      return;
    case Phase::kDone:
      return;
  }
}

void FigureRange::take_end(double energy) noexcept {
  if (made_ == 1 || energy < least_end_) {
    least_end_ = energy;
    least_at_ = damping_;
    least_corner_ = corner_;
  }
  corner_ = made_ % corners();
  if (made_ < kEnds * corners()) {
    damping_ = made_ < corners() ? judgement_.damping_low : judgement_.damping_high;
    return;
  }
  const double width = judgement_.damping_high - judgement_.damping_low;
  const bool is_at_low = least_at_ == judgement_.damping_low;
  damping_ = least_at_ + (is_at_low ? kInwards : -kInwards) * width;
  corner_ = least_corner_;
  made_ = 0;
  phase_ = Phase::kInwards;
}

void FigureRange::begin_sections() noexcept {
  from_ = judgement_.damping_low;
  to_ = judgement_.damping_high;
  const double part = kGolden * (to_ - from_);
  inner_[0] = to_ - part;
  inner_[1] = from_ + part;
  damping_ = inner_[0];
  made_ = 0;
  phase_ = Phase::kSections;
}

void FigureRange::take_section(double energy) noexcept {
  inner_energy_[damping_ == inner_[0] ? 0 : 1] = energy;
  if (made_ == 1) {
    damping_ = inner_[1];
    return;
  }
  if (made_ == kSections) {
    phase_ = Phase::kDone;
    return;
  }
  const bool is_lower_half = inner_energy_[0] < inner_energy_[1];
  const std::size_t kept = is_lower_half ? 0 : 1;
  (is_lower_half ? to_ : from_) = inner_[1 - kept];
  inner_[1 - kept] = inner_[kept];
  inner_energy_[1 - kept] = inner_energy_[kept];
  const double part = kGolden * (to_ - from_);
  inner_[kept] = is_lower_half ? to_ - part : from_ + part;
  damping_ = inner_[kept];
}

}  // namespace emax::app
