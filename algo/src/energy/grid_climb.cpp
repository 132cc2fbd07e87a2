// The fixed point and turned pulses on a product that is kept up to date.
#include "emax/energy/grid_climb.hpp"

namespace emax {
namespace {

/// Iterates until the first rest; they count anew at each rest that has gained.
constexpr std::size_t kMaxIterations = 200;
/// Pulses turned in one climb; no run has been seen to need as many.
constexpr std::size_t kMaxTurns = 1000;
/// Products that may find, at the end of a climb, that it goes on.
constexpr std::size_t kMaxProducts = 64;
/// Rests in a row that gain nothing. A gain that is real but less than the rounding of the energy
/// may not show at once.
constexpr std::size_t kMaxFruitless = 8;
/// A product from scratch costs as much as this many stretches.
constexpr std::size_t kMaxStretches = 12;
/// Updates until their rounding has to go: it adds up, and energies would rise with it.
constexpr std::size_t kMaxUpdates = 256;
/// A quarter of the least gain of a pulse, as part of the energy, and as part of the diagonal.
constexpr double kSmallestGain = 0.25e-7;
constexpr float kSmallestGainOfDiagonal = 2e-5F;
/// Cells with less than this part of the diagonal in the product keep their sign.
constexpr float kZero = 1e-7F;
/// In cells of a product.
constexpr std::size_t kWorkOfPulse = 8;
constexpr std::size_t kWorkOfPulses = 2048;

/// The first cell after the stretch that has turned to one sign and begins at a cell.
std::size_t turned_end(Signs signs, Signs applied, std::size_t begin) noexcept {
  const std::size_t run_end = signs.run_end(begin);
  const std::size_t same = signs.first_agreement(applied, begin);
  return same < run_end ? same : run_end;
}

/// Of the cells of a word: whose product is negative, and whose is beyond +-limit.
struct Compared {
  std::uint32_t negative = 0;
  std::uint32_t beyond = 0;
};

Compared compare(std::size_t word, float limit, Span<const float> product) noexcept {
  constexpr std::uint32_t kHighest = 0x80000000U;
  const auto limit_bits = __builtin_bit_cast(std::uint32_t, limit);
  const std::size_t first = Signs::kBits * word;
  const std::size_t left = product.size() - first;
  const std::size_t count = left < Signs::kBits ? left : Signs::kBits;
  Compared result;
  if (count == 0) {  // A shift by all bits of a word is not defined.
    return result;
  }
  const float* const end = product.data() + first + count;
  for (const float* value = end - count; value != end; ++value) {
    const auto bits = __builtin_bit_cast(std::uint32_t, *value);
    result.negative = result.negative >> 1 | (bits & kHighest);
    result.beyond = result.beyond >> 1 | ((limit_bits - (bits & ~kHighest)) & kHighest);
  }
  result.negative >>= Signs::kBits - count;
  result.beyond >>= Signs::kBits - count;
  return result;
}

/// The cells of a word that hold at most `limit`: sign times product.
std::uint32_t weakly_held(std::size_t word, float limit, Signs signs,
                          Span<const float> product) noexcept {
  const Compared compared = compare(word, limit, product);
  return ~(compared.beyond & (compared.negative ^ signs.word(word)));
}

}  // namespace

void GridClimb::start(float shift) noexcept {
  *this = GridClimb();
  shift_ = shift;
  phase_ = Phase::kProduct;
}

std::size_t GridClimb::step(const FloatPhi& phi, Span<const float> table, Span<const float> pulses,
                            Signs signs, Signs applied, Span<float> product) noexcept {
  switch (phase_) {
    case Phase::kDone:
      return 0;
    case Phase::kProduct:
      phi.multiply(signs, product);
      applied.copy(signs);
      updates_ = 0;
      ++products_;
      phase_ = Phase::kSigns;
      return 2 * signs.size();
    case Phase::kStretches:
      return add_next_stretch(phi, table, signs, applied, product);
    case Phase::kSigns:
      return take_signs(signs, applied, product);
    case Phase::kPulses:
      return look_for_pulses(phi, pulses, signs, applied, product);
  }
  return 0;
}

/// The product follows the signs: by stretches if they are few.
void GridClimb::begin_update(Signs signs, Signs applied) noexcept {
  phase_ = Phase::kStretches;
  next_ = 0;
  at_end_ = {};
  if (updates_ == kMaxUpdates) {
    phase_ = Phase::kProduct;
    return;
  }
  std::size_t cell = 0;
  for (std::size_t stretches = 0; (cell = signs.first_difference(applied, cell)) != signs.size();
       cell = turned_end(signs, applied, cell)) {
    if (++stretches > kMaxStretches) {
      phase_ = Phase::kProduct;
      return;
    }
  }
}

std::size_t GridClimb::add_next_stretch(const FloatPhi& phi, Span<const float> table, Signs signs,
                                        Signs applied, Span<float> product) noexcept {
  const std::size_t begin = signs.first_difference(applied, next_);
  if (begin == signs.size()) {
    phi.add_end(at_end_, product);
    applied.copy(signs);
    ++updates_;
    phase_ = Phase::kSigns;
    return signs.size();
  }
  const std::size_t end = turned_end(signs, applied, begin);
  phi.add_stretch(begin, end, signs.is_positive(begin) ? 1.0F : -1.0F, table, product, at_end_);
  next_ = end;
  return signs.size() / 4 + 1;
}

/// One iteration: x <- sgn(y + c x), 32 cells at a time. A cell near zero keeps its sign; with the
/// shift c that is one whose y is not beyond c on the other side.
std::size_t GridClimb::take_signs(Signs signs, Signs applied, Span<const float> product) noexcept {
  const float limit = shift_ > kZero ? shift_ : kZero;
  const std::size_t size = signs.size();
  bool changed = false;
  for (std::size_t word = 0; word < sign_words(size); ++word) {
    const Compared compared = compare(word, limit, product);
    const std::uint32_t before = signs.word(word);
    const std::uint32_t after =
        (before & ~compared.beyond) | (~compared.negative & compared.beyond);
    changed = changed || after != before;
    signs.set_word(word, after);
  }
  if (changed && iterations_ < kMaxIterations && fruitless_ < kMaxFruitless) {
    ++iterations_;
    begin_update(signs, applied);
    return size / 4 + 1;
  }
  if (changed) {
    signs.copy(applied);
  }
  at_rest_ = has_rested_ ? at_rest_ : !changed;
  rest(signs, product);
  return size / 4 + 1;
}

void GridClimb::rest(Signs signs, Span<const float> product) noexcept {
  if (!has_rested_) {
    has_rested_ = true;
    first_iterations_ = iterations_;
  }
  double energy = 0.0;
  for (std::size_t i = 0; i < signs.size();) {
    const bool positive = signs.is_positive(i);
    float sum = 0.0F;
    for (const std::size_t end = signs.run_end(i); i < end; ++i) {
      sum += product[i];
    }
    energy += static_cast<double>(positive ? sum : -sum);
  }
  energy_ = energy;
  const double size = energy < 0.0 ? -energy : energy;
  const bool is_higher = turns_ == 0 || energy > highest_ + kSmallestGain * size;
  highest_ = is_higher ? energy : highest_;
  fruitless_ = is_higher ? 0 : fruitless_ + 1;
  iterations_ = is_higher ? 0 : iterations_;
  best_ = {};
  const auto least = static_cast<float>(kSmallestGain * size);
  best_.gain = least > kSmallestGainOfDiagonal ? least : kSmallestGainOfDiagonal;
  next_ = 0;
  phase_ = Phase::kPulses;
}

std::size_t GridClimb::look_for_pulses(const FloatPhi& phi, Span<const float> pulses, Signs signs,
                                       Signs applied, Span<const float> product) noexcept {
  const std::size_t words = sign_words(signs.size());
  const float limit = phi.greatest_limit_per_cell();
  std::size_t work = 0;
  std::uint32_t weak = weakly_held(next_, limit, signs, product);
  for (; next_ < words && work < kWorkOfPulses; ++next_) {
    const std::uint32_t weak_after =
        next_ + 1 < words ? weakly_held(next_ + 1, limit, signs, product) : 0;
    // A stretch that gains holds less than its limit, so a cell of it less than the limit per cell.
    std::uint64_t starts = weak | std::uint64_t{weak_after} << Signs::kBits;
    starts |= starts >> 1;
    starts |= starts >> 2;
    starts |= starts >> 4;
    static_assert(FloatPhi::kMaxPulse == 8);
    work += look_at_word(next_, static_cast<std::uint32_t>(starts), phi, pulses, signs, product);
    weak = weak_after;
  }
  if (next_ == words) {
    turn_best(signs, applied);
  }
  return work;
}

/// @param[in] starts The cells of the word at which stretches begin that may gain.
std::size_t GridClimb::look_at_word(std::size_t word, std::uint32_t starts, const FloatPhi& phi,
                                    Span<const float> pulses, Signs signs,
                                    Span<const float> product) noexcept {
  std::size_t work = Signs::kBits / 4;
  std::size_t run_end = 0;
  for (; starts != 0; starts &= starts - 1) {
    const std::size_t cell = Signs::kBits * word + static_cast<std::size_t>(__builtin_ctz(starts));
    if (cell >= signs.size()) {
      break;
    }
    if (cell >= run_end) {
      run_end = signs.run_end(cell);
    }
    const std::size_t left = run_end - cell;
    const std::size_t longest = left < FloatPhi::kMaxPulse ? left : FloatPhi::kMaxPulse;
    const bool positive = signs.is_positive(cell);
    work += pulses.empty() ? look_at(cell, longest, positive, phi, product)
                           : look_up(cell, longest, positive, pulses, product);
  }
  return work;
}

void GridClimb::turn_best(Signs signs, Signs applied) noexcept {
  const bool is_over = turns_ == kMaxTurns || fruitless_ >= kMaxFruitless;
  if (best_.width != 0 && !is_over) {
    ++turns_;
    for (std::size_t i = best_.cell; i < best_.cell + best_.width; ++i) {
      signs.turn(i);
    }
    begin_update(signs, applied);
    return;
  }
  phase_ = updates_ != 0 && products_ < kMaxProducts ? Phase::kProduct : Phase::kDone;
}

/// The stretches that begin at a cell, their energies computed where their limit lets them count.
std::size_t GridClimb::look_at(std::size_t cell, std::size_t longest, bool positive,
                               const FloatPhi& phi, Span<const float> product) noexcept {
  const float* value = product.data() + cell;
  std::size_t work = 1;
  float held = 0.0F;
  for (std::size_t k = 0; k < longest; ++k) {
    held += positive ? value[k] : -value[k];
    if (phi.pulse_limit(k + 1) - held > best_.gain) {
      work += kWorkOfPulse;
      const float gain = phi.pulse(cell, k + 1) - held;
      if (gain > best_.gain) {
        best_ = {cell, k + 1, gain};
      }
    }
  }
  return work;
}

/// The same with their energies from the table.
std::size_t GridClimb::look_up(std::size_t cell, std::size_t longest, bool positive,
                               Span<const float> pulses, Span<const float> product) noexcept {
  const float* value = product.data() + cell;
  const float* energy = pulses.data() + FloatPhi::kMaxPulse * cell;
  float held = 0.0F;
  float best = best_.gain;
  for (std::size_t k = 0; k < longest; ++k) {
    held += positive ? value[k] : -value[k];
    const float gain = energy[k] - held;
    if (gain > best) {
      best = gain;
      best_ = {cell, k + 1, gain};
    }
  }
  return 1;
}

}  // namespace emax
