// Newton's method on switching times, with curvature applied by recursions.
#include "emax/energy/refinement.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"
#include "emax/energy/known_energy.hpp"

namespace emax {
namespace {

constexpr std::size_t kMaxSteps = 200;
constexpr std::size_t kMaxHalvings = 30;
/// Of the conjugate gradients in one step: iterations times switches.
constexpr std::size_t kSolvePerStep = 1024;
/// A step that promises less than this part of the energy is the last one: it takes the switches to
/// where their gradient is rounding, and changes the energy by less than its last digits.
constexpr double kLastGain = 1e-14;
/// Of the square of the gradient, what a step may leave of it: so little that Newton's method takes
/// no more steps, and rounding of the last one.
constexpr double kEnough = 1e-8;
/// Switches later than this part of T are looked at for whether they are of any use.
constexpr double kIdleEnd = 0.99;
/// The longest move of a switch, as part of T, in a step that follows the gradient.
constexpr double kGradientStep = 0.02;
/// Switches closer than this part of T have met.
constexpr double kMeetingGap = 1e-12;

double dot(Span<const double> a, Span<const double> b) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += a[i] * b[i];
  }
  return sum;
}

}  // namespace

/// The energy of a signal with its first and second derivatives with respect to switching times.
///
/// (Phi x)(t) = Re sum C z(t) + Re sum b(t): z is the state that x before t has left, b what x
/// after t and the end of the record add, going back from T; C is the model's correlation. Both are
/// carried from switch to switch by e^(p (t_(j+1) - t_j)), which is kept.
class EnergyShape {
 public:
  EnergyShape(const ModalModel& model, Span<double> scratch) noexcept
      : model_(model), modes_(model.modes()) {
    Span<double> rest = scratch;
    for (Span<double>* vector : {&gradient, &slope, &step, &residual_, &direction_, &image_}) {
      *vector = rest.first(kMaxSwitches);
      rest = rest.from(kMaxSwitches);
    }
    decays_ = rest;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      correlation_[m] = model.correlation(m);
      self_ += correlation_[m].re;
    }
  }

  /// Goes on with a signal that has been taken.
  void resume(const SwitchingSignal& signal, bool is_scaled) noexcept {
    count_ = signal.count();
    duration_s_ = signal.duration_s();
    is_scaled_ = is_scaled;
  }
  /// Of what has been taken: whether a step can be scaled by the diagonal.
  bool can_be_scaled() const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!(diagonal(i) > 0.0)) {
        return false;
      }
    }
    return true;
  }

  /// Takes a signal: fills `gradient` and `slope`. @returns Its energy.
  double take(const SwitchingSignal& signal) noexcept;

  /// Begins to solve (minus the second derivatives) step = gradient by conjugate gradients, scaled
  /// by the diagonal: what is left is of the rank of the modes or little more, so few iterations
  /// do. Where the energy is not concave, the step is better without.
  /// @returns The square of what is left of the gradient, so scaled.
  double begin_step(bool is_scaled) noexcept;
  /// One iteration: `norm2` is what is left. @returns False where the energy is not concave: the
  /// step stays as it is.
  bool improve_step(double& norm2) noexcept;
  /// A step that promises nothing becomes one along the gradient.
  void end_step() noexcept;

  /// Memory for other switching times, when the step is known.
  Span<double> times_s() const noexcept { return image_; }

  /// What the step promises to add to the energy.
  double promise() const noexcept { return 0.5 * dot(gradient.first(count_), step.first(count_)); }

  Span<double> gradient;  ///< dE/dt_j.
  Span<double> slope;     ///< 4 c_j (Phi x)'(t_j).
  Span<double> step;      ///< In s.

 private:
  void apply_between_switches(Span<const double> vector, Span<double> result) const noexcept;
  void add_end(const Complex* output, Complex* back) const noexcept;
  double scaled(std::size_t i) const noexcept {
    return is_scaled_ ? residual_[i] / diagonal(i) : residual_[i];
  }
  double scaled_square() const noexcept;
  /// Minus the second derivative with respect to a switch.
  double diagonal(std::size_t i) const noexcept { return -8.0 * self_ - slope[i]; }

  void set_decay(std::size_t k, std::size_t m, Complex value) noexcept {
    const std::size_t place = 2 * (k * modes_.size() + m);
    decays_[place] = value.re;
    decays_[place + 1] = value.im;
  }
  Complex decay(std::size_t k, std::size_t m) const noexcept {
    const std::size_t place = 2 * (k * modes_.size() + m);
    return {decays_[place], decays_[place + 1]};
  }

  const ModalModel& model_;
  Span<const Mode> modes_;
  Span<double> decays_;
  Span<double> residual_;
  Span<double> direction_;
  Span<double> image_;
  Complex correlation_[kMaxModes];
  double self_ = 0.0;  // The autocorrelation of k at distance 0.
  double duration_s_ = 0.0;
  std::size_t count_ = 0;
  bool is_scaled_ = false;
};

/// back = r times what the outputs at T still hold, seen from each mode.
void EnergyShape::add_end(const Complex* output, Complex* back) const noexcept {
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    back[m] = modes_[m].residue * model_.gramian_row(m, output);
  }
}

double EnergyShape::take(const SwitchingSignal& signal) noexcept {
  count_ = signal.count();
  duration_s_ = signal.duration_s();
  Complex state[kMaxModes];
  double sign = 1.0;
  double last_s = 0.0;
  double energy = model_.static_power() * signal.duration_s();
  for (std::size_t k = 0; k <= count_; ++k) {
    const bool at_end = k == count_;
    const double time_s = at_end ? signal.duration_s() : signal.times_s()[k];
    double value = 0.0;
    double derivative = 0.0;
    double weighted = 0.0;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      const Complex factor = exp((time_s - last_s) * modes_[m].pole);
      set_decay(k, m, factor);
      const Complex shift = sign * model_.inverse_pole(m);
      state[m] = factor * (state[m] + shift) - shift;
      const Complex term = correlation_[m] * state[m];
      value += term.re;
      derivative += real_of_product(modes_[m].pole, term);
      weighted += real_of_product(state[m], model_.switch_weight(m));
    }
    energy += (at_end ? 2.0 : 4.0) * sign * weighted;
    if (!at_end) {
      gradient[k] = value;
      slope[k] = derivative;
    }
    sign = -sign;
    last_s = time_s;
  }
  Complex output[kMaxModes];
  Complex back[kMaxModes];
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    output[m] = modes_[m].residue * state[m];
  }
  add_end(output, back);
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    energy += real_of_product(state[m], back[m]);
  }
  sign = -sign;
  for (std::size_t k = count_; k-- > 0;) {
    double value = gradient[k];
    double derivative = slope[k];
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      // b(t_k) = e^(p dt) b(t_(k+1)) + C c (e^(p dt) - 1)/p, c being the sign in between.
      const Complex shift = sign * (correlation_[m] * model_.inverse_pole(m));
      back[m] = decay(k + 1, m) * (back[m] + shift) - shift;
      value += back[m].re;
      derivative -= real_of_product(modes_[m].pole, back[m]);
    }
    sign = -sign;
    gradient[k] = 4.0 * sign * value;
    slope[k] = 4.0 * sign * derivative;
  }
  return energy;
}

/// result_i = sum_j c_i c_j Phi(t_i, t_j) vector_j, c_i being the sign before switch i.
void EnergyShape::apply_between_switches(Span<const double> vector,
                                         Span<double> result) const noexcept {
  Complex state[kMaxModes];
  double sign = 1.0;
  for (std::size_t k = 0; k <= count_; ++k) {
    double sum = 0.0;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      state[m] = decay(k, m) * state[m];
      sum += real_of_product(correlation_[m], state[m]);
    }
    if (k < count_) {
      result[k] = sign * sum + self_ * vector[k];
      for (std::size_t m = 0; m < modes_.size(); ++m) {
        state[m].re += sign * vector[k];
      }
      sign = -sign;
    }
  }
  Complex back[kMaxModes];
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    state[m] = modes_[m].residue * state[m];
  }
  add_end(state, back);
  for (std::size_t k = count_; k-- > 0;) {
    sign = -sign;
    double sum = 0.0;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      back[m] = decay(k + 1, m) * back[m];
      sum += back[m].re;
      back[m] = back[m] + (sign * vector[k]) * correlation_[m];
    }
    result[k] += sign * sum;
  }
}

double EnergyShape::scaled_square() const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += residual_[i] * scaled(i);
  }
  return sum;
}

double EnergyShape::begin_step(bool is_scaled) noexcept {
  is_scaled_ = is_scaled;
  for (std::size_t i = 0; i < count_; ++i) {
    step[i] = 0.0;
    residual_[i] = gradient[i];
    direction_[i] = scaled(i);
  }
  return scaled_square();
}

bool EnergyShape::improve_step(double& norm2) noexcept {
  const Span<double> residual = residual_.first(count_);
  apply_between_switches(direction_, image_);
  for (std::size_t i = 0; i < count_; ++i) {
    image_[i] = -8.0 * image_[i] - slope[i] * direction_[i];
  }
  const double bend = dot(direction_.first(count_), image_.first(count_));
  if (!(bend > 0.0)) {
    return false;
  }
  const double length = norm2 / bend;
  for (std::size_t i = 0; i < count_; ++i) {
    step[i] += length * direction_[i];
    residual[i] -= length * image_[i];
  }
  const double next = scaled_square();
  for (std::size_t i = 0; i < count_; ++i) {
    direction_[i] = scaled(i) + (next / norm2) * direction_[i];
  }
  norm2 = next;
  return true;
}

void EnergyShape::end_step() noexcept {
  if (promise() > 0.0) {
    return;
  }
  double largest = 0.0;
  for (const double element : gradient.first(count_)) {
    largest = abs(element) > largest ? abs(element) : largest;
  }
  for (std::size_t i = 0; i < count_ && largest > 0.0; ++i) {
    step[i] = gradient[i] / largest * (kGradientStep * duration_s_);
  }
}

namespace {

/// The largest multiple of the step before two switches meet or one leaves [0, T].
double room(const SwitchingSignal& signal, Span<const double> step) noexcept {
  double limit = 1e300;
  const auto consider = [&limit](double gap, double closing) {
    if (closing > 0.0 && gap < limit * closing) {
      limit = gap / closing;
    }
  };
  const std::size_t last = signal.count() - 1;
  consider(signal.times_s()[0], -step[0]);
  consider(signal.duration_s() - signal.times_s()[last], step[last]);
  for (std::size_t i = 1; i <= last; ++i) {
    consider(signal.times_s()[i] - signal.times_s()[i - 1], step[i - 1] - step[i]);
  }
  return limit;
}

/// The switches moved by a multiple of the step; those that meet or leave are gone.
///
/// @param[out] times_s The times. @returns How many there are.
std::size_t move(const SwitchingSignal& signal, Span<const double> step, double multiple,
                 Span<double> times_s) noexcept {
  const double gap_s = kMeetingGap * signal.duration_s();
  std::size_t count = 0;
  for (std::size_t i = 0; i < signal.count(); ++i) {
    const double time_s = signal.times_s()[i] + multiple * step[i];
    if (time_s <= gap_s || time_s >= signal.duration_s() - gap_s) {
      continue;
    }
    if (count > 0 && time_s - times_s[count - 1] <= gap_s) {
      --count;
      continue;
    }
    times_s[count++] = time_s;
  }
  return count;
}

/// Drops the last switch if nothing but rounding is lost: towards T the energy becomes flat in it,
/// so that Newton's steps shorten before it leaves.
void drop_idle_end(const ModalModel& model, SwitchingSignal& signal, double& best) noexcept {
  const std::size_t count = signal.count();
  if (count == 0 || signal.times_s()[count - 1] < kIdleEnd * signal.duration_s()) {
    return;
  }
  const Span<const double> shorter_s = signal.times_s().first(count - 1);
  const double found = energy(model, shorter_s, signal.duration_s());
  if (found >= best - kLastGain * abs(best)) {
    best = found;
    // Cannot fail: fewer of the same times.
    (void)signal.set(shorter_s, signal.duration_s());
  }
}

}  // namespace

double energy_gradient(const ModalModel& model, const SwitchingSignal& signal,
                       Span<double> gradient, Span<double> scratch) noexcept {
  EnergyShape shape(model, scratch);
  const double energy = shape.take(signal);
  for (std::size_t i = 0; i < signal.count(); ++i) {
    gradient[i] = shape.gradient[i];
  }
  return energy;
}

void Refiner::start(const SwitchingSignal& signal) noexcept {
  *this = Refiner();
  first_count_ = signal.count();
  phase_ = Phase::kGradient;
}

void Refiner::end(const ModalModel& model, SwitchingSignal& signal) noexcept {
  drop_idle_end(model, signal, result_.energy);
  const double rounding =
      energy_rounding(model, signal.duration_s(), signal.count(), result_.energy);
  if (model.moved_by() > 0.0 || !(rounding <= kPermittedRounding * abs(result_.energy))) {
    result_.energy = known_energy(model, signal).known.energy;
  }
  result_.dropped = first_count_ - signal.count();
  phase_ = Phase::kDone;
}

void Refiner::step(const ModalModel& model, SwitchingSignal& signal,
                   Span<double> scratch) noexcept {
  EnergyShape shape(model, scratch);
  shape.resume(signal, is_scaled_);
  switch (phase_) {
    case Phase::kGradient:
      take_gradient(model, signal, shape);
      return;
    case Phase::kSolve:
      solve(signal, shape);
      return;
    case Phase::kTry:
      try_step(model, signal, shape);
      return;
    case Phase::kDone:
      return;
  }
}

void Refiner::take_gradient(const ModalModel& model, SwitchingSignal& signal,
                            EnergyShape& shape) noexcept {
  const double found = shape.take(signal);
  if (!begun_) {
    result_.energy = found;
    begun_ = true;
  }
  if (signal.count() == 0 || result_.steps == kMaxSteps) {
    end(model, signal);
    return;
  }
  begin_step(shape, shape.can_be_scaled());
  phase_ = Phase::kSolve;
}

void Refiner::begin_step(EnergyShape& shape, bool is_scaled) noexcept {
  is_scaled_ = is_scaled;
  norm2_ = shape.begin_step(is_scaled);
  enough_ = kEnough * norm2_;
  iterations_ = 0;
}

void Refiner::solve(const SwitchingSignal& signal, EnergyShape& shape) noexcept {
  bool going = true;
  for (std::size_t work = 0; going && work < kSolvePerStep; work += signal.count()) {
    if (iterations_ == 2 * signal.count() || !(norm2_ > enough_)) {
      going = false;
    } else {
      going = shape.improve_step(norm2_);
      ++iterations_;
      if (!going && is_scaled_) {
        begin_step(shape, false);
        going = true;
      }
    }
  }
  if (going) {
    return;
  }
  shape.end_step();
  last_ = !(shape.promise() > kLastGain * abs(result_.energy));
  tries_left_ = last_ ? 1 : kMaxHalvings;
  const double most = room(signal, shape.step);
  multiple_ = most < 1.0 ? most : 1.0;
  phase_ = Phase::kTry;
}

void Refiner::try_step(const ModalModel& model, SwitchingSignal& signal,
                       EnergyShape& shape) noexcept {
  const std::size_t count = move(signal, shape.step, multiple_, shape.times_s());
  const Span<const double> times_s = shape.times_s().first(count);
  const double found = energy(model, times_s, signal.duration_s());
  if (!(found >= result_.energy)) {
    multiple_ *= 0.5;
    if (--tries_left_ == 0) {
      end(model, signal);
    }
    return;
  }
  const bool moving = !last_ && found > result_.energy && count > 0;
  // Cannot fail: the times ascend inside (0, T) and are no more than before.
  (void)signal.set(times_s, signal.duration_s());
  result_.energy = found;
  ++result_.steps;
  if (!moving) {
    end(model, signal);
    return;
  }
  phase_ = Phase::kGradient;
}

Refinement refine(const ModalModel& model, SwitchingSignal& signal, Span<double> scratch) noexcept {
  Refiner refiner;
  refiner.start(signal);
  while (!refiner.done()) {
    refiner.step(model, signal, scratch);
  }
  return refiner.result();
}

}  // namespace emax
