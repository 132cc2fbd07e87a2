// Sums over modes, raised by more than their rounding.
#include "emax/bound/response_sizes.hpp"

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

/// What a sum over modes may be off by, as part of the sum of its terms' sizes. Residues are
/// products and quotients of up to kMaxModes differences, and two sums follow.
constexpr double kRounding = 0x1p-47;

}  // namespace

ResponseSizes response_sizes(const ModalModel& model, double duration_s) noexcept {
  const Span<const Mode> modes = model.modes();
  ResponseSizes sizes;
  Complex curve[kMaxModes];
  double start = 0.0;
  double slope = 0.0;
  double start_terms = 0.0;
  double slope_terms = 0.0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Complex residue = modes[i].residue;
    const Complex pole = modes[i].pole;
    const double size = sqrt(norm(residue));
    const double life_s = -1.0 / pole.re;
    start += residue.re;
    slope += real_of_product(residue, pole);
    start_terms += size;
    slope_terms += size * sqrt(norm(pole));
    sizes.terms += size * (life_s < duration_s ? life_s : duration_s);
    curve[i] = residue * pole * pole;
  }
  // Terms that are 0 by their relative degree are 0, whatever their sums are: that of the filter,
  // or of the sensor alone, which is 2.
  const bool is_in_band = model.criterion() == Criterion::kInBandError;
  const bool delayed = model.delay_s() > 0.0;
  const int degree = model.filter().relative_degree;
  sizes.start = degree >= 2 && !delayed ? 0.0 : abs(start) + kRounding * start_terms;
  sizes.slope = degree >= 3 && !delayed && is_in_band ? 0.0 : abs(slope) + kRounding * slope_terms;
  double energy = 0.0;
  double energy_terms = 0.0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t j = 0; j < modes.size(); ++j) {
      const Complex pole = modes[i].pole;
      const Complex g = reciprocal(pole + modes[j].pole);
      const Complex h = reciprocal(pole + conj(modes[j].pole));
      energy -= 0.5 * (real_of_product(curve[i] * curve[j], g) +
                       real_of_product(curve[i] * conj(curve[j]), h));
      energy_terms +=
          0.5 * (sqrt(norm(curve[i]) * norm(curve[j])) * (sqrt(norm(g)) + sqrt(norm(h))));
    }
  }
  const double most = energy + kRounding * energy_terms;
  sizes.curvature = most > 0.0 ? sqrt(duration_s * most) : 0.0;
  return sizes;
}

}  // namespace emax
