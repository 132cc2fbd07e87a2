// The version that reports and files carry.
#pragma once

namespace emax::app {

inline constexpr char kVersion[] = "0.1.0";

}  // namespace emax::app
