// Constants of circles and angles. Every physical double elsewhere carries its unit in its name.
#pragma once

namespace emax {

inline constexpr double kPi = 3.141592653589793;
inline constexpr double kTwoPi = 6.283185307179586;
inline constexpr double kDegreesPerRadian = 57.29577951308232;
inline constexpr double kRadiansPerDegree = 0.017453292519943295;

}  // namespace emax
