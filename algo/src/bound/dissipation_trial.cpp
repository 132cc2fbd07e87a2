// One step of the Riccati recursion in single precision.
#include "emax/bound/dissipation_trial.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/float_root.hpp"
#include "emax/bound/energy_bound.hpp"

namespace emax {

void DissipationTrial::set(const DissipationCheck& check, double mean_d) noexcept {
  count_ = check.count_;
  step_s_ = static_cast<float>(check.step_s_);
  const double inverse = 1.0 / mean_d;
  const double inverse_root = sqrt(inverse);
  for (std::size_t m = 0; m < count_; ++m) {
    decay_[m] = single(check.decay_[m]);
    for (std::size_t q = 0; q < 2; ++q) {
      input_[q][m] = single(inverse_root * check.input_[q][m]);
      cross_[q][m] = single(inverse_root * check.cross_[q][m]);
    }
  }
  input_energy_[0] = static_cast<float>(inverse * check.input_energy_[0][0]);
  input_energy_[1] = static_cast<float>(inverse * check.input_energy_[0][1]);
  input_energy_[2] = static_cast<float>(inverse * check.input_energy_[1][1]);
  for (std::size_t pair = 0; pair < count_ * (count_ + 1) / 2; ++pair) {
    step_energy_[pair] = single(check.step_energy_[pair]);
    conj_step_energy_[pair] = single(check.conj_step_energy_[pair]);
  }
  restart();
}

void DissipationTrial::restart() noexcept {
  for (std::size_t pair = 0; pair < kPairs; ++pair) {
    form_[pair] = {};
    conj_form_[pair] = {};
  }
}

/// 1/2 sum_j [G_ij b_j + H_ij conj b_j].
void DissipationTrial::fill_row(const FloatComplex* b, FloatComplex* row) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    row[i] = {};
  }
  std::size_t pair = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    FloatComplex sum = row[i] + form_[pair] * b[i] + conj_form_[pair] * conj(b[i]);
    ++pair;
    for (std::size_t j = i + 1; j < count_; ++j, ++pair) {
      const FloatComplex g = form_[pair];
      const FloatComplex h = conj_form_[pair];
      sum = sum + g * b[j] + h * conj(b[j]);
      row[j] = row[j] + g * b[i] + conj(h * b[i]);
    }
    row[i] = 0.5F * sum;
  }
}

bool DissipationTrial::step_back(float d) noexcept {
  FloatComplex row[2][kMaxModes];
  fill_row(input_[0], row[0]);
  fill_row(input_[1], row[1]);
  const float supply = d * step_s_;
  float form[3] = {supply - input_energy_[0], -input_energy_[1], supply - input_energy_[2]};
  for (std::size_t m = 0; m < count_; ++m) {
    form[0] -= real_of_product(input_[0][m], row[0][m]);
    form[1] -= real_of_product(input_[1][m], row[0][m]);
    form[2] -= real_of_product(input_[1][m], row[1][m]);
  }
  if (!(form[0] > 0.0F)) {
    return false;
  }
  const float ratio = form[1] / form[0];
  const float rest = form[2] - ratio * form[1];
  if (!(rest > 0.0F)) {
    return false;
  }
  const float scale0 = inverse_root(form[0]);
  const float scale1 = inverse_root(rest);
  FloatComplex first[kMaxModes];
  FloatComplex second[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    const FloatComplex c0 = decay_[m] * row[0][m] + cross_[0][m];
    const FloatComplex c1 = decay_[m] * row[1][m] + cross_[1][m];
    first[m] = scale0 * c0;
    second[m] = scale1 * (c1 - ratio * c0);
  }
  return advance(first, second);
}

/// @returns False if the form is no number any more.
bool DissipationTrial::advance(const FloatComplex* first, const FloatComplex* second) noexcept {
  std::size_t pair = 0;
  float trace = 0.0F;
  for (std::size_t i = 0; i < count_; ++i) {
    const FloatComplex decay = decay_[i];
    for (std::size_t j = i; j < count_; ++j, ++pair) {
      form_[pair] = decay * (decay_[j] * form_[pair]) + step_energy_[pair] + first[i] * first[j] +
                    second[i] * second[j];
      conj_form_[pair] = decay * (conj(decay_[j]) * conj_form_[pair]) + conj_step_energy_[pair] +
                         first[i] * conj(first[j]) + second[i] * conj(second[j]);
      trace += i == j ? conj_form_[pair].re : 0.0F;
    }
  }
  return trace - trace == 0.0F;
}

}  // namespace emax
