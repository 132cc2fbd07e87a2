// The devices of a box, and what proves a bound for all of them: the corners, and what may lie
// between.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/bound/box_curvature.hpp"
#include "emax/bound/energy_certificate.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/uncertainty/device_draws.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// What `--box` says.
struct BoxOption {
  bool is_wanted = false;
  bool is_given = false;    ///< False for the uncertainties of the model or of the fit.
  ParameterBox half_width;  ///< If given.
};

/// @returns Whether `text` is "auto" or three numbers uS,uf0,ubeta, 0 or more; sets `box` if it is.
bool take_box(std::string_view text, BoxOption& box);

/// A box of devices, cut into cells along f0 and beta by knots, and its proof. Its corners are the
/// devices with each S, f0 and beta of the knots, in this order, beta running fastest.
class BoxProof final {
 public:
  /// Lays out the box about the estimate, with so many cells that what lies between the corners
  /// costs about 1e-4 of the energy, as far as `most_corners` allow; and finds the signal with the
  /// largest energy at each corner.
  ///
  /// @returns What is wrong with the box, or a corner that has no energy.
  Problem start(const app::EvaluationResults& estimate, const BoxOption& option,
                std::size_t most_corners);

  /// The models of all corners; the first one is that with the largest energy.
  Span<const ModalModel> models() const { return {models_.data(), models_.size()}; }
  /// The largest energy known, for a = 1; its signal and its device.
  const MaximumEnergy& maximum() const { return maximum_; }
  const Accelerometer& device() const { return models_[0].device(); }

  /// Takes the bound and the y of a model from a certificate that has just proven it.
  void take(std::size_t model, const EnergyCertificate& certificate);

  /// @returns The bound of all devices and signals for a = 1, from one for all corners.
  double bound(double of_corners) const;
  /// @returns That of the certificate, with all corners taken.
  double bound() const { return bound(corner_bound_); }
  double corner_bound() const { return corner_bound_; }

  Span<const double> sensitivities() const { return view(sensitivities_); }
  Span<const double> frequencies_hz() const { return view(frequencies_hz_); }
  Span<const double> dampings() const { return view(dampings_); }
  const ParameterBox& half_width() const { return half_width_; }
  bool gain_follows() const { return gain_follows_; }
  const CurvatureTerms& terms() const { return terms_; }
  /// y of a corner, in units.
  Span<const std::int32_t> duals(std::size_t corner) const {
    const std::vector<std::int32_t>& own = duals_[place_of(corner)];
    return {own.data(), own.size()};
  }

 private:
  static Span<const double> view(const std::vector<double>& values) {
    return {values.data(), values.size()};
  }
  /// The best corner's model has changed places with that of the first corner.
  std::size_t place_of(std::size_t corner) const {
    if (corner == 0 || corner == best_corner_) {
      return best_corner_ - corner;
    }
    return corner;
  }
  Problem set_ranges(const app::EvaluationResults& estimate, const BoxOption& option);
  CurvatureTerms terms_of(std::size_t frequency_cells, std::size_t damping_cells) const;
  void choose_cells(double energy, std::size_t most_corners);
  Problem make_models(const ModalModel& estimate);
  Problem search_all(double duration_s);

  std::vector<double> sensitivities_;
  std::vector<double> frequencies_hz_;
  std::vector<double> dampings_;
  std::vector<ModalModel> models_;
  std::vector<std::vector<std::int32_t>> duals_;
  ParameterBox half_width_;
  Accelerometer middle_;
  MaximumEnergy maximum_;
  CurvatureTerms terms_;
  std::size_t best_corner_ = 0;
  double duration_s_ = 0.0;
  double filter_integral_ = 1.0;
  double more_ = 0.0;
  double corner_bound_ = 0.0;
  bool gain_follows_ = false;
};

}  // namespace emax::desk
