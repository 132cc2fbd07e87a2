// A box of devices, its corners and its cells.
#include "desk/certify/box_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "emax/energy/grid_workspace.hpp"

#include "desk/cli/console_progress.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/cli/value_text.hpp"

namespace emax::desk {

namespace {

/// Of the energy: what lies between the corners may cost so much for f0 and for beta.
constexpr double kWanted = 1e-4;
/// Where that takes too many corners, this much more is tried.
constexpr double kCoarser = 1.25;

// The next number but one: sums and the numbers in the text are both rounded.
double outwards(double end, double direction) {
  const double far = direction * std::numeric_limits<double>::infinity();
  return std::nextafter(std::nextafter(end, far), far);
}

// The ends are no less far out than those meant, whatever their rounding.
std::vector<double> knots(double middle, double half_width, std::size_t cells) {
  std::vector<double> values;
  if (half_width == 0.0) {
    values.push_back(middle);
    return values;
  }
  for (std::size_t i = 0; i <= cells; ++i) {
    const double part = 2.0 * static_cast<double>(i) / static_cast<double>(cells) - 1.0;
    values.push_back(middle + part * half_width);
  }
  values.front() = outwards(values.front(), -1.0);
  values.back() = outwards(values.back(), 1.0);
  return values;
}

std::size_t cells_for(double term, double permitted) {
  return static_cast<std::size_t>(std::max(std::ceil(std::sqrt(term / permitted)), 1.0));
}

}  // namespace

bool take_box(std::string_view text, BoxOption& box) {
  if (text == "auto") {
    box = {};
    box.is_wanted = true;
    return true;
  }
  const Numbers numbers = take_list(text);
  if (!numbers.valid || numbers.count != 3 ||
      std::any_of(numbers.values, numbers.values + 3, [](double value) { return value < 0.0; })) {
    return false;
  }
  box = {true, true, {numbers.values[0], numbers.values[1], numbers.values[2]}};
  return true;
}

Problem BoxProof::start(const app::EvaluationResults& estimate, const BoxOption& option,
                        std::size_t most_corners) {
  if (Problem problem = set_ranges(estimate, option)) {
    return problem;
  }
  const ModalModel& model = estimate.model;
  duration_s_ = estimate.maximum.signal.duration_s();
  const ReferenceFilter& filter = model.filter();
  filter_integral_ =
      model.criterion() == Criterion::kInBandError ? filter_integral(filter, duration_s_) : 1.0;
  if (model.criterion() == Criterion::kEnergyDifference) {
    const double ratio = gain_follows_ ? 1.0 + half_width_.sensitivity / middle_.sensitivity : 1.0;
    more_ = filter.gain * filter.gain * ratio * ratio * duration_s_;
  }
  choose_cells(estimate.maximum.energy, most_corners);
  Problem problem = make_models(model);
  return problem ? problem : search_all(duration_s_);
}

Problem BoxProof::set_ranges(const app::EvaluationResults& estimate, const BoxOption& option) {
  const double scale = estimate.trial_scale();
  const ParameterBox& u = estimate.device.u;
  half_width_ = option.is_given ? option.half_width
                                : ParameterBox{scale * u.sensitivity,
                                               scale * u.natural_frequency_hz, scale * u.damping};
  middle_ = estimate.device.estimate;
  gain_follows_ = estimate.settings.gain_mode == app::GainMode::kTrack;
  const bool is_point = half_width_.sensitivity == 0.0 && half_width_.natural_frequency_hz == 0.0 &&
                        half_width_.damping == 0.0;
  if (is_point) {
    return bad_input(
        "--box: a box without width; expected --box uS,uf0,ubeta, or uncertainties of the device");
  }
  const bool is_inside = half_width_.sensitivity < middle_.sensitivity &&
                         half_width_.natural_frequency_hz < middle_.natural_frequency_hz &&
                         half_width_.damping < middle_.damping &&
                         middle_.damping + half_width_.damping < 1.0;
  return is_inside ? Problem{}
                   : bad_input(
                         "--box: some devices of the box cannot exist; expected S and f0 above 0 "
                         "and beta between 0 and 1 in all of it");
}

// The largest of all cells, each for itself.
CurvatureTerms BoxProof::terms_of(std::size_t frequency_cells, std::size_t damping_cells) const {
  const std::vector<double> f =
      knots(middle_.natural_frequency_hz, half_width_.natural_frequency_hz, frequency_cells);
  const std::vector<double> b = knots(middle_.damping, half_width_.damping, damping_cells);
  const double sensitivity = knots(middle_.sensitivity, half_width_.sensitivity, 1).back();
  CurvatureTerms largest;
  for (std::size_t i = 0; i + 1 < f.size() || i == 0; ++i) {
    for (std::size_t j = 0; j + 1 < b.size() || j == 0; ++j) {
      const DeviceRange range = {f[i], f[std::min(i + 1, f.size() - 1)], b[j],
                                 b[std::min(j + 1, b.size() - 1)]};
      const CurvatureTerms own = curvature_terms(range, sensitivity, duration_s_, filter_integral_);
      largest.frequency = std::max(largest.frequency, own.frequency);
      largest.damping = std::max(largest.damping, own.damping);
    }
  }
  return largest;
}

void BoxProof::choose_cells(double energy, std::size_t most_corners) {
  const double root = std::sqrt(energy + more_);
  const bool has_two_ends = half_width_.sensitivity > 0.0 && !gain_follows_;
  const CurvatureTerms whole = terms_of(1, 1);
  std::size_t frequency_cells = 1;
  std::size_t damping_cells = 1;
  for (double permitted = kWanted * energy / root;; permitted *= kCoarser) {
    frequency_cells = cells_for(whole.frequency, permitted);
    damping_cells = cells_for(whole.damping, permitted);
    const std::size_t corners =
        (has_two_ends ? 2 : 1) * (frequency_cells + 1) * (damping_cells + 1);
    if (corners <= most_corners || frequency_cells + damping_cells == 2) {
      break;
    }
  }
  // E in S is convex, and grows as S^2 if the gain follows.
  sensitivities_ = knots(middle_.sensitivity, half_width_.sensitivity, 1);
  if (!has_two_ends) {
    sensitivities_.erase(sensitivities_.begin(), sensitivities_.end() - 1);
  }
  frequencies_hz_ =
      knots(middle_.natural_frequency_hz, half_width_.natural_frequency_hz, frequency_cells);
  dampings_ = knots(middle_.damping, half_width_.damping, damping_cells);
  terms_ = terms_of(frequency_cells, damping_cells);
}

Problem BoxProof::make_models(const ModalModel& estimate) {
  ErrorMeasure measure;
  measure.criterion = estimate.criterion();
  if (estimate.delay_s() > 0.0) {  // That of the estimate, all over the box.
    measure.delay = {DelayMode::kGiven, estimate.delay_s()};
  }
  for (const double sensitivity : sensitivities_) {
    for (const double f0_hz : frequencies_hz_) {
      for (const double damping : dampings_) {
        ModalModel model = {};
        Status status = model.set({sensitivity, f0_hz, damping}, estimate.filter(), measure);
        if (status == Status::kOk && gain_follows_) {
          status = model.set_gain(sensitivity);
        }
        if (status != Status::kOk) {
          return bad_input(std::string("--box: a corner: ") + explain(status));
        }
        models_.push_back(model);
      }
    }
  }
  duals_.resize(models_.size());
  return {};
}

Problem BoxProof::search_all(double duration_s) {
  static GridWorkspace workspace;
  static EnergySearch search;
  SearchSettings settings;
  settings.duration_s = duration_s;
  ConsoleProgress progress;
  clear(maximum_);
  for (std::size_t corner = 0; corner < models_.size(); ++corner) {
    progress.show("signals at the corners",
                  static_cast<double>(corner) / static_cast<double>(models_.size()));
    Status status = search.start(models_[corner], settings);
    while (status == Status::kOk && !search.done()) {
      if (stop_requested()) {
        return stopped();
      }
      status = search.step(models_[corner], workspace);
    }
    if (status != Status::kOk) {
      return bad_input(std::string("--box: a corner: ") + explain(status));
    }
    if (search.result().energy > maximum_.energy) {
      maximum_ = search.result();
      best_corner_ = corner;
    }
  }
  std::swap(models_[0], models_[best_corner_]);
  return {};
}

void BoxProof::take(std::size_t model, const EnergyCertificate& certificate) {
  corner_bound_ = std::max(corner_bound_, certificate.bound());
  duals_[model].assign(certificate.duals().begin(), certificate.duals().end());
}

double BoxProof::bound(double of_corners) const {
  constexpr double kRounding = 1.0 + 1e-12;
  return box_bound(of_corners, terms_.frequency + terms_.damping, more_) * kRounding;
}

}  // namespace emax::desk
