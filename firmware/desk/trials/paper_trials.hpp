// The paper's procedure for many devices on all cores of a PC.
#pragma once

#include <cstddef>

#include "emax/base/span.hpp"
#include "emax/model/modal_model.hpp"

namespace emax::desk {

/// What all trials of the paper's procedure have in common.
struct PaperProcedure {
  double duration_s = 0.0;
  std::size_t cells = 0;
  std::size_t max_iterations = 0;  ///< The paper's J.
};

/// The energies that the fixed point from Phi's first column ends with, one for each device, for
/// a = 1; NaN for a device that is not valid.
///
/// The devices are shared out to `threads` threads, each with the lanes of `PaperLanes` where the
/// processor has them. Each energy depends on its device alone, so all bits are the same for any
/// number of threads and on any processor.
///
/// @param[in] model   Filter and criterion, with any sensor.
/// @param[in] threads At least 1; as many as there are cores is the most that pays.
void find_paper_energies(const ModalModel& model, const PaperProcedure& procedure,
                         std::size_t threads, Span<const Accelerometer> devices,
                         Span<double> energies);

}  // namespace emax::desk
