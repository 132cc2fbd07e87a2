// Upper limits of an impulse response and its derivatives over [0, T], by closed forms.
#pragma once

#include "emax/model/modal_model.hpp"

namespace emax {

/// Sizes of k on [0, T]; none is below the true one.
struct ResponseSizes {
  double start = 0.0;      ///< |k(0)|.
  double slope = 0.0;      ///< |k'(0)|.
  double curvature = 0.0;  ///< The integral of |k''|, at most sqrt(T) times its norm.
  double terms = 0.0;      ///< The integral of sum |r e^(p t)|: what its rounding is relative to.
};

/// @param[in] model Without feedthrough.
/// @param[in] duration_s T, above 0.
/// @returns The sizes. Two products for each two modes.
ResponseSizes response_sizes(const ModalModel& model, double duration_s) noexcept;

}  // namespace emax
