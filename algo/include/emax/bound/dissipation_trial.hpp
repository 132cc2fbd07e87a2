// The recursion of the bound's check in single precision: a guess of what the check will say.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/float_complex.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

class DissipationCheck;

/// Takes the steps of a `DissipationCheck` in `float`, with no account of rounding: proves nothing,
/// and says within some 1e-4 of d what the check will say. For bisecting. 1.9 KiB.
class DissipationTrial {
 public:
  /// Takes the steps that have been laid out.
  ///
  /// @param[in] mean_d That of the d to be tried, in (V/(m/s^2))^2; they are divided by it, so that
  ///   no sensitivity leaves the range of `float`.
  void set(const DissipationCheck& check, double mean_d) noexcept;

  /// Back to T.
  void restart() noexcept;

  /// As `DissipationCheck::step_back()`, of d divided by their mean.
  bool step_back(float d) noexcept;

 private:
  static constexpr std::size_t kPairs = kMaxModes * (kMaxModes + 1) / 2;

  void fill_row(const FloatComplex* b, FloatComplex* row) const noexcept;
  bool advance(const FloatComplex* first, const FloatComplex* second) noexcept;

  FloatComplex decay_[kMaxModes] = {};
  FloatComplex input_[2][kMaxModes] = {};
  FloatComplex cross_[2][kMaxModes] = {};
  float input_energy_[3] = {};
  FloatComplex step_energy_[kPairs] = {};
  FloatComplex conj_step_energy_[kPairs] = {};
  FloatComplex form_[kPairs] = {};
  FloatComplex conj_form_[kPairs] = {};
  float step_s_ = 0.0F;
  std::size_t count_ = 0;
};

static_assert(std::is_trivially_copyable_v<DissipationTrial>);

}  // namespace emax
