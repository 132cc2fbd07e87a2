// Which parameters of a device the points determine.
#pragma once

#include <cstdint>

#include "emax/identify/wlsp.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax {

enum class Determined : std::uint8_t {
  kNothing,        ///< No device: what `Wlsp::fit()` answered says why.
  kSensitivity,    ///< S alone; f0 may be anywhere far above the points.
  kAllButDamping,  ///< S and f0; beta - 2 u(beta) is below the least damping.
  kAll,
};

/// A fit by what it determines.
struct FitJudgement {
  Determined determined = Determined::kNothing;
  /// The estimate, with kAllButDamping the constrained one at the nearest damping that a device may
  /// have: beta as permitted, S and f0 as they follow from their correlation with it. With
  /// kSensitivity only S is not zero.
  Accelerometer device;
  double u_sensitivity = 0.0;           ///< Standard; with kAllButDamping for that given damping.
  double u_natural_frequency_hz = 0.0;  ///< The same; 0 with kSensitivity.
  double u_damping = 0.0;               ///< 0 but with kAll.
  double damping_low = 0.0;   ///< With kAllButDamping: the dampings within 2 u that a device may
  double damping_high = 0.0;  ///< have, from the least one on.
  double sensitivity_slope = 0.0;  ///< With kAllButDamping: how S and f0 move with the damping.
  double frequency_slope_hz = 0.0;
  /// With kSensitivity: f0 is above, by mu3 + 2 u(mu3) or by 2 u(mu3) if mu3 is negative; 0 where
  /// nobody knows.
  double frequency_low_hz = 0.0;
};

/// The largest damping that stands for "below 1" where a range is cut.
inline constexpr double kMaxCutDamping = 0.999;

/// Judges by two standard uncertainties: f0 is undetermined where mu3 - 2 u(mu3) <= 0 <= mu3 + 4
/// u(mu3), whatever the damping is then, and the damping where beta - 2 u(beta) < kMinDamping <=
/// beta + 4 u(beta); where only magnitudes are known, by beta^2 in place of beta. Its range ends at
/// beta + 2 u(beta), and at kMinDamping + u(beta)/2 at least.
///
/// @param[in] fit The result of `Wlsp::fit()`, whatever its status.
FitJudgement judge(const WlspFit& fit) noexcept;

}  // namespace emax
