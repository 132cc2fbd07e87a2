// Uniform and jointly normal draws of S, f0 and damping.
#include "emax/uncertainty/device_draws.hpp"

#include "emax/base/distributions.hpp"
#include "emax/base/elementary.hpp"

namespace emax {
namespace {

/// A variance that the earlier parameters explain to this part is zero.
constexpr double kDependent = 1e-12;
/// Rounding that a covariance of a parameter without a variance of its own may show.
constexpr double kSemidefinite = 1e-6;
/// How near to the end of a range `reach()` goes: a little less, for rounding.
constexpr double kShortOfEnd = 0.999;

bool is_uncertainty(double u) noexcept { return u >= 0.0 && is_finite(u); }

}  // namespace

Status DeviceDraws::start(const Accelerometer& estimate, const DrawSettings& settings) noexcept {
  const Status estimate_status = validate(estimate);
  if (estimate_status != Status::kOk) {
    return estimate_status;
  }
  DeviceDraws next;
  next.estimate_ = estimate;
  next.distribution_ = settings.distribution;
  next.first_generator_ = settings.generator;
  next.generator_ = settings.generator;
  const Status status = settings.distribution == Distribution::kBox
                            ? next.set_box(settings.box)
                            : next.set_covariance(settings.covariance);
  if (status != Status::kOk) {
    return status;
  }
  constexpr double kFarthestDraw = 9.0;  // Of Box and Muller.
  next.safe_ = next.reach(kFarthestDraw);
  *this = next;
  return Status::kOk;
}

Status DeviceDraws::set_box(const ParameterBox& box) noexcept {
  const double half_widths[3] = {box.sensitivity, box.natural_frequency_hz, box.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!is_uncertainty(half_widths[i])) {
      return Status::kInvalidArgument;
    }
    factor_[i][i] = half_widths[i];
  }
  for (const double side : {-1.0, 1.0}) {
    const Status status = validate(device_at({side, side, side}));
    if (status != Status::kOk) {
      return status;
    }
  }
  return Status::kOk;
}

Status DeviceDraws::set_covariance(const double (&c)[3][3]) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double size = sqrt(c[i][i] * c[j][j]);
      if (!is_uncertainty(c[i][i]) || !(abs(c[i][j] - c[j][i]) <= kDependent * size)) {
        return Status::kInvalidArgument;
      }
      double rest = c[i][j];
      for (std::size_t k = 0; k < j; ++k) {
        rest -= factor_[i][k] * factor_[j][k];
      }
      if (i == j) {
        if (!(rest >= -kDependent * c[i][i])) {
          return Status::kInvalidArgument;
        }
        factor_[i][i] = rest > kDependent * c[i][i] ? sqrt(rest) : 0.0;
        continue;
      }
      // A parameter without a share of its own leaves no share to later ones.
      if (factor_[j][j] == 0.0 && abs(rest) > kSemidefinite * size) {
        return Status::kInvalidArgument;
      }
      factor_[i][j] = factor_[j][j] == 0.0 ? 0.0 : rest / factor_[j][j];
    }
  }
  return Status::kOk;
}

double DeviceDraws::row_sum(std::size_t parameter) const noexcept {
  double sum = 0.0;
  for (const double element : factor_[parameter]) {
    sum += abs(element);
  }
  return sum;
}

double DeviceDraws::spread(std::size_t parameter) const noexcept {
  double squares = 0.0;
  for (const double element : factor_[parameter]) {
    squares += element * element;
  }
  return sqrt(squares);
}

double DeviceDraws::reach(double most) const noexcept { return reach_of(3, most); }

double DeviceDraws::reach_without_damping(double most) const noexcept { return reach_of(2, most); }

/// The farthest that the first parameters stay those of devices.
double DeviceDraws::reach_of(std::size_t parameters, double most) const noexcept {
  const double room[3] = {estimate_.sensitivity, estimate_.natural_frequency_hz - kMinFrequency_hz,
                          estimate_.damping - kMinDamping < 1.0 - estimate_.damping
                              ? estimate_.damping - kMinDamping
                              : 1.0 - estimate_.damping};
  if (distribution_ == Distribution::kBox) {
    return most < 1.0 ? most : 1.0;  // `start()` has looked at the ends.
  }
  double reach = most;
  for (std::size_t i = 0; i < parameters; ++i) {
    const double limit = kShortOfEnd * room[i];
    const double sum = row_sum(i);
    reach = limit < reach * sum ? limit / sum : reach;
  }
  return reach;
}

bool DeviceDraws::moves(std::size_t unit, bool without_sensitivity) const noexcept {
  for (std::size_t i = without_sensitivity ? 1 : 0; i < 3; ++i) {
    if (factor_[i][unit] != 0.0) {
      return true;
    }
  }
  return false;
}

bool DeviceDraws::draw(std::uint32_t trial) noexcept {
  if (trial != next_trial_) {
    generator_ = first_generator_;
    generator_.jump(numbers_per_trial() * trial);
  }
  next_trial_ = trial + 1;
  const bool is_new = trial == counted_;
  counted_ += is_new ? 1 : 0;
  is_first_time_ = is_new;
  if (distribution_ == Distribution::kBox) {
    draw_box();
    return true;
  }
  draw_normal(generator_);
  const bool is_safe =
      abs(place_[0]) <= safe_ && abs(place_[1]) <= safe_ && abs(place_[2]) <= safe_;
  if (is_safe || validate(device()) == Status::kOk) {
    return true;
  }
  const std::uint32_t before = redraws_;
  const bool found = draw_again(trial);
  redraws_ = is_new ? redraws_ : before;
  return found;
}

void DeviceDraws::start_share(std::uint32_t first) noexcept {
  counts_from_ = first;
  counted_ = first;
  redraws_ = 0;
}

void DeviceDraws::join(const DeviceDraws& share) noexcept {
  if (share.counts_from_ == counted_) {
    counted_ = share.counted_;
    redraws_ += share.redraws_;
  }
}

void DeviceDraws::draw_box() noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    uniform_[i] = generator_.next();
    place_[i] = 2.0 * uniform_[i] - 1.0;
  }
}

void DeviceDraws::draw_normal(WichmannHill& generator) noexcept {
  double u[4];
  for (double& number : u) {
    number = generator.next();
  }
  const NormalPair first = box_muller(u[0], u[1]);
  const NormalPair second = box_muller(u[2], u[3]);
  place_ = {first.first, first.second, second.first};
}

bool DeviceDraws::draw_again(std::uint32_t trial) noexcept {
  constexpr std::uint64_t kHalf = std::uint64_t{1} << 63U;
  WichmannHill generator = first_generator_;
  generator.jump(numbers_per_trial() * trial);
  for (std::uint32_t i = 0; i < kMaxRedraws; ++i) {
    generator.jump(kHalf);  // 2^64 has one bit more than a number of steps.
    generator.jump(kHalf);
    WichmannHill numbers = generator;
    draw_normal(numbers);
    ++redraws_;
    if (validate(device()) == Status::kOk) {
      return true;
    }
  }
  place_ = {};
  return false;
}

Accelerometer DeviceDraws::device() const noexcept {
  return {parameter(0), parameter(1), parameter(2)};
}

/// A parameter of the trial last drawn: S, f0 or damping.
double DeviceDraws::parameter(std::size_t index) const noexcept {
  const double estimates[3] = {estimate_.sensitivity, estimate_.natural_frequency_hz,
                               estimate_.damping};
  const double estimate = estimates[index];
  if (distribution_ == Distribution::kBox) {
    const double half_width = factor_[index][index];
    return uniform_in(estimate - half_width, estimate + half_width, uniform_[index]);
  }
  double deviation = 0.0;
  for (std::size_t j = 0; j <= index; ++j) {
    deviation += factor_[index][j] * place_[j];
  }
  return estimate + deviation;
}

Accelerometer DeviceDraws::device_at(const Place& place) const noexcept {
  double deviation[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      deviation[i] += factor_[i][j] * place[j];
    }
  }
  return {estimate_.sensitivity + deviation[0], estimate_.natural_frequency_hz + deviation[1],
          estimate_.damping + deviation[2]};
}

DeviceDraws::Place DeviceDraws::place_of(const Accelerometer& device) const noexcept {
  const double deviation[3] = {device.sensitivity - estimate_.sensitivity,
                               device.natural_frequency_hz - estimate_.natural_frequency_hz,
                               device.damping - estimate_.damping};
  Place place = {};
  for (std::size_t i = 0; i < 3; ++i) {
    double rest = deviation[i];
    for (std::size_t j = 0; j < i; ++j) {
      rest -= factor_[i][j] * place[j];
    }
    place[i] = factor_[i][i] == 0.0 ? 0.0 : rest / factor_[i][i];
  }
  return place;
}

}  // namespace emax
