// Assembles the state space of the shaker and the device and discretises it.
#include "emax/sim/plant.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::sim {
namespace {

// A pair of states (x, v) of w^2/(s^2 + 2 d w s + w^2) driven by u: x' = w v,
// v' = w (u - x - 2 d v). Its low-pass output is x, its high-pass output v'/w.
constexpr std::size_t kReconstruction1 = 0;
constexpr std::size_t kReconstruction2 = 2;
constexpr std::size_t kArmature = 4;
constexpr std::size_t kSuspension = 6;
constexpr std::size_t kDevice = 8;
/// The held voltage: one more state, whose derivative is zero.
constexpr std::size_t kDrive = 10;
static_assert(kDrive + 1 == kMatrixOrder);

/// Butterworth, fourth order: sin(pi/8) and cos(pi/8).
constexpr double kReconstructionDamping1 = 0.38268343236508977;
constexpr double kReconstructionDamping2 = 0.9238795325112867;

constexpr double kMinDamping = 0.001;
constexpr double kMaxDamping = 10.0;
constexpr double kMaxCyclesPerInterval = 20.0;
/// Smaller states are taken for zero: subnormal numbers are slow, and nobody sees them.
constexpr double kSmallestState = 1e-150;

bool frequency_ok(double frequency_hz, double interval_s) noexcept {
  return frequency_hz > 0.0 && frequency_hz * interval_s <= kMaxCyclesPerInterval;
}

bool damping_ok(double damping) noexcept {
  return damping >= kMinDamping && damping <= kMaxDamping;
}

/// Rows of one pair that nothing drives.
void add_pair(Matrix& matrix, std::size_t at, double frequency_hz, double damping) noexcept {
  const double omega = kTwoPi * frequency_hz;
  matrix[at][at + 1] = omega;
  matrix[at + 1][at] = -omega;
  matrix[at + 1][at + 1] = -2.0 * damping * omega;
}

/// Drives the pair at `to` by this state, times `weight`.
void connect(Matrix& matrix, std::size_t from, std::size_t to, double weight) noexcept {
  matrix[to + 1][from] = matrix[to][to + 1] * weight;
}

/// Of a state in the acceleration for a gain of 1: the suspension's high-pass output. The gain is
/// left to the outputs, so that it does not matter to the exponential.
double acceleration_weight(std::size_t state, const Shaker& shaker) noexcept {
  switch (state) {
    case kArmature:
      return 1.0;
    case kSuspension:
      return -1.0;
    case kSuspension + 1:
      return -2.0 * shaker.suspension_damping;
    default:
      return 0.0;
  }
}

/// The rates of change of all states.
void assemble(const Device& device, const Shaker& shaker, Matrix& matrix) noexcept {
  matrix = {};
  add_pair(matrix, kReconstruction1, shaker.reconstruction_hz, kReconstructionDamping1);
  add_pair(matrix, kReconstruction2, shaker.reconstruction_hz, kReconstructionDamping2);
  add_pair(matrix, kArmature, shaker.armature_hz, shaker.armature_damping);
  add_pair(matrix, kSuspension, shaker.suspension_hz, shaker.suspension_damping);
  add_pair(matrix, kDevice, device.natural_frequency_hz, device.damping);
  connect(matrix, kDrive, kReconstruction1, 1.0);
  connect(matrix, kReconstruction1, kReconstruction2, 1.0);
  connect(matrix, kReconstruction2, kArmature, 1.0);
  connect(matrix, kArmature, kSuspension, 1.0);
  for (std::size_t from = kArmature; from < kDevice; ++from) {
    connect(matrix, from, kDevice, acceleration_weight(from, shaker));
  }
}

void scale(double factor, Matrix& matrix) noexcept {
  for (auto& row : matrix) {
    for (double& element : row) {
      element *= factor;
    }
  }
}

}  // namespace

Status Plant::configure(const Device& device, const Shaker& shaker, double interval_s,
                        double skew_s) noexcept {
  if (!(interval_s > 0.0) || !is_finite(interval_s) || !(abs(skew_s) <= 0.5 * interval_s)) {
    return Status::kInvalidArgument;
  }
  if (!frequency_ok(device.natural_frequency_hz, interval_s) ||
      !frequency_ok(shaker.reconstruction_hz, interval_s) ||
      !frequency_ok(shaker.armature_hz, interval_s) ||
      !frequency_ok(shaker.suspension_hz, interval_s)) {
    return Status::kInvalidArgument;
  }
  if (!damping_ok(device.damping) || !damping_ok(shaker.armature_damping) ||
      !damping_ok(shaker.suspension_damping)) {
    return Status::kInvalidArgument;
  }
  if (!is_finite(device.sensitivity) || !is_finite(shaker.gain)) {
    return Status::kInvalidArgument;
  }
  // One matrix on the stack, the other is the one that comes last.
  Matrix matrix;
  const auto pass = [&](double time_s) {
    assemble(device, shaker, matrix);
    scale(time_s, matrix);
    exponentiate(matrix, transition_);
  };
  pass(0.5 * interval_s);
  acceleration_ = {};
  for (std::size_t state = kArmature; state < kDevice; ++state) {
    const double weight = shaker.gain * acceleration_weight(state, shaker);
    for (std::size_t j = 0; j < kMatrixOrder; ++j) {
      acceleration_[j] += weight * matrix[state][j];
    }
  }
  pass(0.5 * interval_s + skew_s);
  for (std::size_t j = 0; j < kMatrixOrder; ++j) {
    device_[j] = shaker.gain * device.sensitivity * matrix[kDevice][j];
  }
  pass(interval_s);
  for (std::size_t i = 0; i < kMatrixOrder; ++i) {
    for (std::size_t j = 0; j < kMatrixOrder; ++j) {
      transition_[j][i] = matrix[i][j];
    }
  }
  state_ = {};
  return Status::kOk;
}

PlantOutput Plant::step(double drive_v) noexcept {
  PlantOutput output{acceleration_[kDrive] * drive_v, device_[kDrive] * drive_v};
  std::array<double, kStates> next = {};
  for (std::size_t i = 0; i < kStates; ++i) {
    next[i] = transition_[kDrive][i] * drive_v;
  }
  for (std::size_t j = 0; j < kStates; ++j) {
    output.acceleration_mps2 += acceleration_[j] * state_[j];
    output.device_v += device_[j] * state_[j];
    for (std::size_t i = j - j % 2; i < kStates; ++i) {
      next[i] += transition_[j][i] * state_[j];
    }
  }
  state_ = next;
  return output;
}

void Plant::flush() noexcept {
  for (double& state : state_) {
    state = abs(state) < kSmallestState ? 0.0 : state;
  }
}

}  // namespace emax::sim
