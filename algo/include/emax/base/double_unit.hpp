// Whether the core computes with doubles in hardware.
#pragma once

namespace emax {

/// True where the core has doubles in hardware, as the compiler says. For choosing between ways
/// that give the same bits at different costs.
#if defined(__arm__)
#if defined(__ARM_FP) && (__ARM_FP & 8) != 0
inline constexpr bool kHasDoubleUnit = true;
#else
inline constexpr bool kHasDoubleUnit = false;
#endif
#elif defined(__riscv)
#if defined(__riscv_flen) && __riscv_flen >= 64
inline constexpr bool kHasDoubleUnit = true;
#else
inline constexpr bool kHasDoubleUnit = false;
#endif
#else
inline constexpr bool kHasDoubleUnit = true;
#endif

}  // namespace emax
