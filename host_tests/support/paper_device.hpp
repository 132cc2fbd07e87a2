// The device of the paper's Table 2 with its filter, and the numbers that are known of it from
// outside this code.
#pragma once

#include "emax/model/modal_model.hpp"

namespace emax::test {

inline constexpr double kS = 1.037;
inline constexpr Accelerometer kPaperDevice = {1.037, 4073.0, 0.3182};
inline constexpr Butterworth kPaperFilter = {10, 1000.0, 1.037};
/// E is printed for a = 1.037; the code works with a = 1.
inline constexpr double kPaperA2 = 1.037 * 1.037;

/// Best known signals, found by continuous refinement outside this code.
inline constexpr double kBestTimes2ms[] = {1.0474909417558e-3};
inline constexpr double kBestTimes10ms[] = {
    .84866315101641e-3, 1.9058315037729e-3, 2.9367350905267e-3,
    3.976378908253e-3,  5.0135209735015e-3, 6.049938135172e-3,
    7.0918057372703e-3, 8.1148875436357e-3, 9.1942917643007e-3};
inline constexpr double kBestEnergy2ms = 0.005115251359876;
inline constexpr double kBestEnergy10ms = 0.03809122131476;

inline ModalModel paper_model(Criterion criterion = Criterion::kIntegralSquareError) {
  ModalModel model{};
  (void)model.set(kPaperDevice, kPaperFilter, criterion);
  return model;
}

}  // namespace emax::test
