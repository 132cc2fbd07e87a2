// The dual of the semidefinite relaxation as a proposal, and a Riccati recursion as its proof.
#include "emax/bound/energy_bound.hpp"

#include <limits>
#include <new>

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/float_root.hpp"
#include "emax/base/units.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/bound/response_sizes.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/model/in_band.hpp"

namespace emax {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Rounding that each number of a step is charged with, relative to the largest: 64 half units in
/// the last place. Its longest sums have 2 kMaxModes products, and two sums of products follow.
constexpr double kRounding = 0x1p-47;
/// By how much d is lowered so that the rounding of a vector counts only by its square.
constexpr double kSlack = 1e-9;
/// More than the rounding of a few operations.
constexpr double kRoundedUp = 1.0 + 0x1p-48;

/// What the rounding of poles, residues and the integral of d may add to the bound, as part of T
/// (max |Ka| + max |Kf|)^2.
constexpr double kModelRounding = 1e-10;
/// The same for the in-band error, as part of T (integral of sum |r e^(p t)|)^2: k is off by less
/// than 4e-14 of its terms, and E by twice that.
constexpr double kTermRounding = 1e-13;

/// Gauss-Legendre with 8 nodes: exact to 1e-18 for products of exponentials with |p| tau below 1.
struct Node {
  double place;
  double weight;
};
constexpr Node kNodes[] = {
    {-0.9602898564975363, 0.1012285362903763}, {-0.7966664774136267, 0.2223810344533745},
    {-0.5255324099163290, 0.3137066458778873}, {-0.1834346424956498, 0.3626837833783620},
    {0.1834346424956498, 0.3626837833783620},  {0.5255324099163290, 0.3137066458778873},
    {0.7966664774136267, 0.2223810344533745},  {0.9602898564975363, 0.1012285362903763}};

constexpr double kRoot3 = 1.7320508075688772;
/// The lowest frequency of a clamped beam, 4.730040744862704, squared (rounded down).
constexpr double kClampedBeam = 22.373285;

constexpr std::size_t smaller_of(std::size_t a, std::size_t b) noexcept { return b < a ? b : a; }

constexpr std::size_t kRank = 8;
constexpr std::size_t kSweeps = 64;
/// The same for all capacities that have the room: vectors and their products with Phi share the
/// workspace.
constexpr std::size_t kMaxProposalCells = smaller_of(1024, packed_size(kPhiCells) / kRank);
/// For each cell of the search, as long as they are not too many.
constexpr std::size_t kProposalCellsPerCell = 4;
/// And at least one, or half a one for a sensor that rings longer than this part of the record that
/// so many resolve: what happens at one end of it still matters at the other.
constexpr double kLongRinging = 0.125;
constexpr std::size_t kStepsPerCell = 4;
constexpr std::size_t kLongGrid = 512;
constexpr std::size_t kStepsPerCellOfLongGrid = 2;
/// Order 1 has the larger remainder, and the fewest modes.
constexpr std::size_t kMoreStepsForOrder1 = 4;
/// Least d, as part of its mean: d falls to 0 towards T, but its least value divides the remainder.
constexpr double kFloor = 0.02;
constexpr std::size_t kMaxTrials = 20;
constexpr std::size_t kMaxChecks = 20;
constexpr std::size_t kStepsAtOnce = 16;
constexpr std::size_t kTrialStepsAtOnce = 64;
/// The first lift on trial. It triples until one passes, or below 0 until one fails.
constexpr double kFirstLift = 0.002;
constexpr double kLiftResolution = 2e-5;
/// What the check begins with on top of a lift that has passed the trial; it triples until one
/// passes.
constexpr double kFirstRaise = 2e-5;
/// With as many modes the trial is off by more than 1e-4, and the check bisects itself.
constexpr std::size_t kManyModes = 7;
/// With the sensor's pole so near to one of the filter's, modes may cancel beyond single precision:
/// the check bisects from the start. In-band the proposal is that of a sensor so far away.
constexpr double kApart = 0.01;
/// A cell whose vectors have no more length than this is left without a direction.
constexpr float kNoLength2 = 1e-30F;
constexpr std::uint32_t kSeed[] = {1, 2, 3, 4};

constexpr double larger(double a, double b) noexcept { return b > a ? b : a; }
template <typename Number>
constexpr Number smaller(Number a, Number b) noexcept {
  return b < a ? b : a;
}
double size(Complex z) noexcept { return abs(z.re) + abs(z.im); }

}  // namespace

Status DissipationCheck::start(const ModalModel& model, double duration_s,
                               std::size_t steps) noexcept {
  if (!(duration_s > 0.0) || !is_finite(duration_s) || steps == 0) {
    return Status::kInvalidArgument;
  }
  duration_s_ = duration_s;
  step_s_ = duration_s / static_cast<double>(steps);
  count_ = model.modes().size();
  criterion_ = model.criterion();
  fill_inputs(model);
  fill_limits(model);
  std::size_t pair = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t j = i; j < count_; ++j, ++pair) {
      const Complex z = step_s_ * (model.modes()[i].pole + model.modes()[j].pole);
      const Complex z_conj = step_s_ * (model.modes()[i].pole + conj(model.modes()[j].pole));
      step_energy_[pair] = model.gramian(i, j) * (z * phi1(z));
      conj_step_energy_[pair] = model.conjugate_gramian(i, j) * (z_conj * phi1(z_conj));
    }
  }
  restart();
  return Status::kOk;
}

void DissipationCheck::fill_inputs(const ModalModel& model) noexcept {
  const Span<const Mode> modes = model.modes();
  const bool difference = criterion_ == Criterion::kEnergyDifference;
  double input_size = 0.0;
  for (std::size_t m = 0; m < count_; ++m) {
    const Complex z = step_s_ * modes[m].pole;
    decay_[m] = exp(z);
    input_[0][m] = (step_s_ * modes[m].residue) * phi1(z);
    input_[1][m] = (kRoot3 * step_s_ * modes[m].residue) * (2.0 * phi2(z) - phi1(z));
    cross_[0][m] = {};
    cross_[1][m] = {};
    input_size += size(input_[0][m]) + size(input_[1][m]);
  }
  input_size_ = input_size;
  for (double(&row)[2] : input_energy_) {
    row[0] = 0.0;
    row[1] = 0.0;
  }
  for (const Node& node : kNodes) {
    const double time_s = 0.5 * step_s_ * (1.0 + node.place);
    const double weight = 0.5 * step_s_ * node.weight;
    Complex decay[kMaxModes];
    double sensor[2] = {};  // outputs for the two inputs
    double filter[2] = {};
    for (std::size_t m = 0; m < count_; ++m) {
      const Complex z = time_s * modes[m].pole;
      decay[m] = exp(z);
      const Complex constant = time_s * phi1(z);
      const Complex ramp = kRoot3 * ((2.0 * time_s * time_s / step_s_) * phi2(z) - constant);
      double(&output)[2] = m == 0 ? sensor : filter;
      output[0] += real_of_product(modes[m].residue, constant);
      output[1] += real_of_product(modes[m].residue, ramp);
    }
    for (std::size_t q = 0; q < 2; ++q) {
      const double of_sensor = difference ? sensor[q] : sensor[q] + filter[q];
      const double of_filter = difference ? -filter[q] : sensor[q] + filter[q];
      for (std::size_t m = 0; m < count_; ++m) {
        cross_[q][m] = cross_[q][m] + (weight * (m == 0 ? of_sensor : of_filter)) * decay[m];
      }
      for (std::size_t r = 0; r < 2; ++r) {
        input_energy_[q][r] += weight * (of_sensor * sensor[r] + of_filter * filter[r]);
      }
    }
  }
}

void DissipationCheck::fill_limits(const ModalModel& model) noexcept {
  // K v = k(0) Q' + k'(0) Q + the convolution of k'' and Q; v = (Q')' with Q' of mean zero.
  const ResponseSizes sizes = response_sizes(model, duration_s_);
  remainder_ = sizes.start * step_s_ / kTwoPi +
               step_s_ * step_s_ / kClampedBeam * (sizes.slope + sizes.curvature);
  mixed_remainder_ = 0.0;
  model_rounding_ = kTermRounding * duration_s_ * sizes.terms * sizes.terms;
  if (criterion_ == Criterion::kInBandError) {
    return;
  }
  const Accelerometer& device = model.device();
  const ReferenceFilter& filter = model.filter();
  const double w0 = kTwoPi * device.natural_frequency_hz;
  const double wc = kTwoPi * filter.band_hz;
  const double b = device.damping;
  // |Ka| and |s^2 Ka|/w0^2 have the same maximum over frequency; within T neither can amplify by
  // more than 1 plus the integral of the envelope of its impulse response.
  const double root = sqrt((1.0 - b) * (1.0 + b));
  const double resonance = 2.0 * b * b < 1.0 ? 1.0 / (2.0 * b * root) : 1.0;
  const double within_time = 1.0 + smaller(w0 * duration_s_, 1.0 / b) / root;
  const double device_gain = device.sensitivity * smaller(resonance, within_time);
  const double gains = device_gain + filter.gain;
  model_rounding_ = kModelRounding * duration_s_ * gains * gains;
  const double beam = step_s_ * step_s_ / kClampedBeam;
  const double device_remainder = beam * w0 * w0 * device_gain;
  // Of order 1 the filter passes s^2 K no more, but s K: w = W' with W of mean zero, |W| <= (tau/(2
  // pi)) |w|. From order 2 on |s^2 Kf| <= gain wc^2.
  const double filter_remainder =
      filter.gain * (filter.relative_degree == 1 ? wc * step_s_ / kTwoPi : beam * wc * wc);
  if (criterion_ == Criterion::kIntegralSquareError) {
    // Sensor and filter apart: worse than their difference where they are alike.
    remainder_ = smaller(remainder_, device_remainder + filter_remainder);
    return;
  }
  remainder_ = device_remainder;
  mixed_remainder_ = device_gain * device_remainder + filter.gain * filter_remainder;
}

void DissipationCheck::restart() noexcept {
  for (std::size_t pair = 0; pair < kPairs; ++pair) {
    form_[pair] = {};
    conj_form_[pair] = {};
  }
  largest_ = 0.0;
}

/// 1/2 sum_j [G_ij b_j + H_ij conj b_j] for both inputs b.
void DissipationCheck::fill_rows(Complex (&row)[2][kMaxModes]) noexcept {
  for (std::size_t q = 0; q < 2; ++q) {
    const Complex* const b = input_[q];
    std::size_t pair = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      row[q][i] = row[q][i] + form_[pair] * b[i] + conj_form_[pair] * conj(b[i]);
      ++pair;
      for (std::size_t j = i + 1; j < count_; ++j, ++pair) {
        const Complex g = form_[pair];
        const Complex h = conj_form_[pair];
        row[q][i] = row[q][i] + g * b[j] + h * conj(b[j]);
        row[q][j] = row[q][j] + g * b[i] + conj(h * b[i]);
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      row[q][i] = 0.5 * row[q][i];
    }
  }
}

bool DissipationCheck::step_back(double d) noexcept {
  Complex row[2][kMaxModes];
  fill_rows(row);
  // Minus the form of the two inputs; its diagonal is lowered by more than what was rounded.
  double form[3] = {-input_energy_[0][0], -input_energy_[0][1], -input_energy_[1][1]};
  for (std::size_t m = 0; m < count_; ++m) {
    form[0] -= real_of_product(input_[0][m], row[0][m]);
    form[1] -= real_of_product(input_[1][m], row[0][m]);
    form[2] -= real_of_product(input_[1][m], row[1][m]);
  }
  const double supply = d * step_s_;
  const double rounded = (largest_ + step_s_) * input_size_;  // the terms of a vector are below it
  const double modes = static_cast<double>(count_);
  const double rounding = 2.0 * kRounding * (supply + rounded * input_size_);
  form[0] += supply - rounding;
  form[2] += supply - rounding;
  if (!(form[0] > 0.0)) {
    return false;
  }
  const double ratio = form[1] / form[0];
  const double rest = form[2] - ratio * form[1];
  if (!(rest > 0.0) || !is_finite(rest)) {
    return false;
  }
  const double scale0 = sqrt((1.0 + kSlack) / form[0]);
  const double scale1 = sqrt((1.0 + kSlack) / rest);
  Complex first[kMaxModes];
  Complex second[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    const Complex c0 = decay_[m] * row[0][m] + cross_[0][m];
    const Complex c1 = decay_[m] * row[1][m] + cross_[1][m];
    first[m] = scale0 * c0;
    second[m] = scale1 * (c1 - ratio * c0);
  }
  double largest = largest_;
  for (std::size_t m = 0; m < count_; ++m) {
    largest = larger(largest, larger(norm(first[m]), norm(second[m])));
  }
  std::size_t pair = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t j = i; j < count_; ++j, ++pair) {
      const Complex g = decay_[i] * (decay_[j] * form_[pair]) + step_energy_[pair] +
                        first[i] * first[j] + second[i] * second[j];
      const Complex h = decay_[i] * (conj(decay_[j]) * conj_form_[pair]) + conj_step_energy_[pair] +
                        first[i] * conj(first[j]) + second[i] * conj(second[j]);
      form_[pair] = g;
      conj_form_[pair] = h;
      largest = larger(largest, larger(size(g), size(h)));
    }
  }
  // V is raised by more than what was rounded. Errors of e in G and H are at most m e |w|^2. Errors
  // of e in the two vectors c of x'c, which add c' M^-1 c to V, are at most 2 m e^2 |w|^2 over the
  // least eigenvalue of M, if c' M^-1 c is multiplied by 1 + slack and e^2 divided by it.
  const double vector_error = kRounding * rounded;
  const double least_eigenvalue = form[0] * rest / (form[0] + form[2]);
  const double raise = modes * (2.0 * kRounding * largest +
                                4.0 / kSlack * (vector_error * vector_error / least_eigenvalue));
  pair = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    conj_form_[pair].re += raise;
    pair += count_ - i;
  }
  largest_ = largest;
  return is_finite(largest);
}

double DissipationCheck::completed(double integral, double least) const noexcept {
  const double proven = integral + model_rounding_;
  const double remainder2 = remainder_ * remainder_;
  if (criterion_ != Criterion::kEnergyDifference) {
    return least > 0.0 ? proven + integral * remainder2 / least : kInfinity;
  }
  const double room = least - remainder2;
  return room > 0.0 ? proven + duration_s_ * mixed_remainder_ * mixed_remainder_ / room : kInfinity;
}

Status EnergyBound::start(const ModalModel& model, double duration_s,
                          GridWorkspace& workspace) noexcept {
  if (!(duration_s > 0.0) || !is_finite(duration_s) || model.feedthrough() != 0.0) {
    return Status::kInvalidArgument;
  }
  const std::size_t grid = grid_cells(model, duration_s);
  if (grid > kMaxCells) {
    return Status::kTooManyCells;
  }
  const OneSidedResponse constant = one_sided_response(model, duration_s);
  if (constant.holds) {
    const double energy = (constant.energy.energy + constant.energy.rounding) * kRoundedUp;
    // Of the sensor itself; only a delay is still to come.
    const double root = sqrt(energy) + delay_tolerance(model) * sqrt(duration_s);
    bound_ = delay_tolerance(model) > 0.0 ? root * root : energy;
    steps_ = 0;
    phase_ = Phase::kDone;
    return Status::kOk;
  }
  steps_ = grid * (grid > kLongGrid ? kStepsPerCellOfLongGrid : kStepsPerCell) *
           (model.filter().relative_degree == 1 ? kMoreStepsForOrder1 : 1);
  cells_ = smaller(kProposalCellsPerCell * grid, kMaxProposalCells);
  count_of_modes_ = model.modes().size();
  duration_s_ = duration_s;
  proposal_s_ = resolved_time(model, duration_s, grid);
  bound_ = kInfinity;
  const Status status = check_.start(model, duration_s, steps_);
  if (status != Status::kOk) {
    return status;
  }
  begin_proposal(model, workspace);
  workspace.share_nothing();
  vector_ = 0;
  sweeps_ = 0;
  trials_ = 0;
  checks_ = 0;
  phase_ = Phase::kFirstVectors;
  return Status::kOk;
}

/// T, or as much of it as the cells of the proposal resolve.
double EnergyBound::resolved_time(const ModalModel& model, double duration_s,
                                  std::size_t grid) const noexcept {
  if (grid <= cells_) {
    return duration_s;
  }
  const Accelerometer& device = model.device();
  const double ringing_s = 1.0 / (device.damping * kTwoPi * device.natural_frequency_hz);
  const double resolved_s = duration_s * static_cast<double>(cells_) / static_cast<double>(grid);
  return ringing_s > kLongRinging * resolved_s ? smaller(duration_s, 2.0 * resolved_s) : resolved_s;
}

void EnergyBound::begin_proposal(const ModalModel& model, GridWorkspace& workspace) noexcept {
  const Accelerometer apart = with_simple_poles(model.device(), model.filter(), kApart);
  cancels_ = apart.natural_frequency_hz != model.device().natural_frequency_hz;
  const ModalModel* source = &model;
  if (cancels_ && model.criterion() == Criterion::kInBandError) {
    auto* const place = new (workspace.numbers().data()) ModalModel;  // Free until the vectors.
    (void)place->set(apart, model.filter(),
                     {model.criterion(), {DelayMode::kGiven, model.delay_s()}});
    source = place;
  }
  PhiOperator phi;
  (void)phi.set(*source, proposal_s_, cells_);
  phi_.set(*source, phi);
  const double cell_s = proposal_s_ / static_cast<double>(cells_);
  shift_ = static_cast<float>(ascent_shift(*source, cell_s) / phi_.scale());
}

/// One vector; all of them together are one sequence of random numbers.
void EnergyBound::fill_vector(GridWorkspace& workspace) noexcept {
  const std::size_t begin = vector_ * cells_;
  WichmannHill random;
  (void)random.seed(Generator::k2006, Span<const std::uint32_t>(kSeed));
  random.jump(begin);
  for (float& number : workspace.singles().from(begin).first(cells_)) {
    number = static_cast<float>(random.next() - 0.5);
  }
  if (++vector_ == kRank) {
    vector_ = 0;
    phase_ = Phase::kProposal;
  }
}

double EnergyBound::progress() const noexcept {
  if (done()) {
    return 1.0;
  }
  // A check takes the time of several trials, and few are needed.
  const std::size_t made =
      sweeps_ + trials_ + kMaxTrials * (checks_ != 0 || phase_ == Phase::kCheck ? 1 : 0) + checks_;
  return static_cast<double>(made) / static_cast<double>(kSweeps + 2 * kMaxTrials + kMaxChecks);
}

/// One product; with the last vector's, all vectors take the direction of their products.
void EnergyBound::sweep(GridWorkspace& workspace) noexcept {
  const Span<float> vectors = workspace.singles().first(kRank * cells_);
  const Span<float> products = workspace.singles().from(kRank * cells_);
  const Span<const float> vector = vectors.from(vector_ * cells_).first(cells_);
  phi_.multiply(vector, products.from(vector_ * cells_).first(cells_));
  if (++vector_ < kRank) {
    return;
  }
  vector_ = 0;
  ++sweeps_;
  take_directions(vectors, products);
}

/// The length of each cell's products, less the shift, takes the place of the first product.
void EnergyBound::take_directions(Span<float> vectors, Span<float> products) const noexcept {
  for (std::size_t i = 0; i < cells_; ++i) {
    float norm2 = 0.0F;
    for (std::size_t r = 0; r < kRank; ++r) {
      float& vector = vectors[r * cells_ + i];
      vector = products[r * cells_ + i] + shift_ * vector;
      norm2 += vector * vector;
    }
    const float scale = norm2 > kNoLength2 ? inverse_root(norm2) : 0.0F;
    for (std::size_t r = 0; r < kRank; ++r) {
      vectors[r * cells_ + i] *= scale;
    }
    products[i] = norm2 * scale - shift_;
  }
}

void EnergyBound::take_proposal(GridWorkspace& workspace) noexcept {
  const Span<float> d = workspace.singles().first(cells_);
  const Span<float> lengths = workspace.singles().from(kRank * cells_);
  const auto per_second =
      static_cast<float>(phi_.scale() * static_cast<double>(cells_) / proposal_s_);
  double sum = 0.0;
  for (std::size_t i = 0; i < cells_; ++i) {
    d[i] = per_second * lengths[i];
    sum += abs(static_cast<double>(d[i]));
  }
  const auto floor = static_cast<float>(kFloor * sum / static_cast<double>(cells_));
  for (float& value : d) {
    value = value > floor ? value : floor;
  }
  sum = 0.0;
  least_ = kInfinity;
  for (std::size_t step = 0; step < steps_; ++step) {
    const double value = shape(step, d);
    sum += value;
    least_ = smaller(least_, value);
  }
  mean_ = sum / static_cast<double>(steps_);
  trial_.set(check_, mean_);
}

double EnergyBound::shape(std::size_t step, Span<const float> d) const noexcept {
  const double cell_s = proposal_s_ / static_cast<double>(cells_);
  const double time_s =
      duration_s_ * (static_cast<double>(step) + 0.5) / static_cast<double>(steps_);
  // Of a longer T only the two ends were proposed; in between d stays as it is in the middle.
  const double middle_s = 0.5 * proposal_s_;
  const double from_end_s = time_s - (duration_s_ - proposal_s_);
  const double proposal_time_s = smaller(time_s, larger(middle_s, from_end_s));
  const double place = proposal_time_s / cell_s - 0.5;
  if (!(place > 0.0)) {
    return static_cast<double>(d[0]);
  }
  const double whole = floor(place);
  const auto cell = static_cast<std::size_t>(whole);
  if (cell + 1 >= cells_) {
    return static_cast<double>(d[cells_ - 1]);
  }
  const auto before = static_cast<double>(d[cell]);
  return before + (place - whole) * (static_cast<double>(d[cell + 1]) - before);
}

/// A positive lift raises all of d alike, which suits its weak end at T; a negative one shrinks it.
double EnergyBound::lifted(double d, double lift) const noexcept {
  return lift > 0.0 ? d + lift * mean_ : d * (1.0 + lift);
}

double EnergyBound::multiplier(std::size_t step, GridWorkspace& workspace) const noexcept {
  return lifted(shape(step, workspace.singles().first(cells_)), passed_);
}

void EnergyBound::begin_lifts(double first) noexcept {
  lift_ = first;
  passed_ = kInfinity;
  failed_ = -kInfinity;
  steps_left_ = steps_;
}

/// Bisects once a lift has passed and one has failed. @returns False if they are near enough.
bool EnergyBound::next_lift() noexcept {
  steps_left_ = steps_;
  if (!(passed_ < kInfinity)) {
    lift_ *= 3.0;
  } else if (failed_ > -kInfinity) {
    lift_ = 0.5 * (passed_ + failed_);
  } else {
    lift_ *= lift_ > 0.0 ? -3.0 : 3.0;
  }
  return passed_ - failed_ >= kLiftResolution;
}

/// The next lift on trial; at the end the least one that has passed, raised, to be checked.
void EnergyBound::next_trial(bool passed) noexcept {
  (passed ? passed_ : failed_) = lift_;
  ++trials_;
  trial_.restart();
  if (next_lift() && trials_ < kMaxTrials) {
    return;
  }
  phase_ = passed_ < kInfinity ? Phase::kCheck : Phase::kDone;
  guess_ = passed_;
  raise_ = kFirstRaise;
  begin_lifts(guess_ + raise_);
}

/// The next lift to check: more raised than the one that has failed. The first one that passes is
/// the result; with many modes the check then looks for a lower one, below the guess too.
void EnergyBound::next_check(bool passed) noexcept {
  (passed ? passed_ : failed_) = lift_;
  ++checks_;
  check_.restart();
  const bool is_bisecting = (cancels_ || count_of_modes_ >= kManyModes) && checks_ < kMaxChecks;
  const bool has_passed = passed_ < kInfinity;
  if (has_passed && !(is_bisecting && passed_ - failed_ >= kLiftResolution)) {
    phase_ = Phase::kDone;
    bound_ = check_.completed(duration_s_ * lifted(mean_, passed_), lifted(least_, passed_));
    return;
  }
  steps_left_ = steps_;
  if (has_passed && failed_ > -kInfinity) {
    lift_ = 0.5 * (passed_ + failed_);
    return;
  }
  raise_ *= 3.0;
  lift_ = has_passed ? guess_ - raise_ : guess_ + raise_;
  phase_ = checks_ < kMaxChecks ? Phase::kCheck : Phase::kDone;
}

void EnergyBound::try_steps(Span<const float> d) noexcept {
  const std::size_t trials_before = trials_;
  const double inverse = 1.0 / mean_;
  for (std::size_t i = 0; i < kTrialStepsAtOnce && trials_ == trials_before; ++i) {
    --steps_left_;
    const double value = lifted(shape(steps_left_, d), lift_);
    const bool passed = trial_.step_back(static_cast<float>(inverse * value));
    if (!passed || steps_left_ == 0) {
      next_trial(passed);
    }
  }
}

void EnergyBound::check_steps(Span<const float> d) noexcept {
  const std::size_t checks_before = checks_;
  for (std::size_t i = 0; i < kStepsAtOnce && checks_ == checks_before; ++i) {
    --steps_left_;
    const bool passed = check_.step_back(lifted(shape(steps_left_, d), lift_));
    if (!passed || steps_left_ == 0) {
      next_check(passed);
    }
    if (done()) {
      return;
    }
  }
}

Status EnergyBound::step(const ModalModel& model, GridWorkspace& workspace) noexcept {
  switch (phase_) {
    case Phase::kFirstVectors:
      fill_vector(workspace);
      return Status::kOk;
    case Phase::kProposal:
      sweep(workspace);
      if (sweeps_ == kSweeps) {
        take_proposal(workspace);
        phase_ = cancels_ ? Phase::kCheck : Phase::kTrial;
        guess_ = 0.0;
        raise_ = kFirstLift;
        begin_lifts(kFirstLift);
      }
      return Status::kOk;
    case Phase::kTrial:
      try_steps(workspace.singles().first(cells_));
      break;
    case Phase::kCheck:
      check_steps(workspace.singles().first(cells_));
      break;
    case Phase::kDone:
      return Status::kOk;
  }
  if (!done()) {
    return Status::kOk;
  }
  if (bound_ < kInfinity) {
    bound_ = true_bound(model, bound_, duration_s_);
  }
  return bound_ < kInfinity ? Status::kOk : Status::kNotProven;
}

}  // namespace emax
