// One climb on the grid: the fixed point and turned pulses, in single precision.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/energy/float_phi.hpp"

namespace emax {

/// Climbs from a pattern of signs in short steps.
///
///     climb.start(shift);
///     while (!climb.done()) {
///       climb.step(phi, table, pulses, signs, applied, product);
///     }
///
/// The fixed point runs until it rests; then the stretch of up to FloatPhi::kMaxPulse cells of
/// equal sign that gains most is turned, and the fixed point runs again, until no stretch gains.
/// The product with Phi is kept up to date by the stretches that have turned; it is computed anew
/// where they are many, and before the climb ends, so that it does not end by rounding. What gains
/// less than 1e-6 of the energy is left to those who refine the end. Where modes cancel, rounding
/// can promise gains without end: a climb that rests 8 times without having gained is done.
class GridClimb {
 public:
  /// @param[in] shift As that of `FixedPoint`, divided by the scale of the FloatPhi.
  void start(float shift) noexcept;

  /// All the same in each step.
  ///
  /// @param[in]     table   As `FloatPhi::fill_table()` fills it.
  /// @param[in]     pulses  As `FloatPhi::fill_pulses()` fills it; or empty, and the energies of
  ///   pulses are computed where they may count.
  /// @param[in,out] signs   The starting pattern, then that of the climb; at the end the best one.
  /// @param[out]    applied Memory for the pattern that belongs to the product.
  /// @param[out]    product Memory for Phi x.
  /// @returns What it has cost, in cells of a product in single precision: at most some thousand or
  ///   four products.
  std::size_t step(const FloatPhi& phi, Span<const float> table, Span<const float> pulses,
                   Signs signs, Signs applied, Span<float> product) noexcept;

  bool done() const noexcept { return phase_ == Phase::kDone; }
  /// @returns With `done()`, the energy of the pattern, divided by the scale of the FloatPhi.
  double energy() const noexcept { return energy_; }
  /// Iterates of the fixed point until it first rested, and whether it did.
  std::size_t iterations() const noexcept { return first_iterations_; }
  bool at_rest() const noexcept { return at_rest_; }

 private:
  enum class Phase : std::uint8_t { kDone, kProduct, kStretches, kSigns, kPulses };

  /// A stretch of cells, and a quarter of what turning it adds to the energy.
  struct Pulse {
    std::size_t cell = 0;
    std::size_t width = 0;
    float gain = 0.0F;
  };

  std::size_t add_next_stretch(const FloatPhi& phi, Span<const float> table, Signs signs,
                               Signs applied, Span<float> product) noexcept;
  std::size_t take_signs(Signs signs, Signs applied, Span<const float> product) noexcept;
  void rest(Signs signs, Span<const float> product) noexcept;
  std::size_t look_for_pulses(const FloatPhi& phi, Span<const float> pulses, Signs signs,
                              Signs applied, Span<const float> product) noexcept;
  std::size_t look_at_word(std::size_t word, std::uint32_t starts, const FloatPhi& phi,
                           Span<const float> pulses, Signs signs,
                           Span<const float> product) noexcept;
  std::size_t look_at(std::size_t cell, std::size_t longest, bool positive, const FloatPhi& phi,
                      Span<const float> product) noexcept;
  std::size_t look_up(std::size_t cell, std::size_t longest, bool positive,
                      Span<const float> pulses, Span<const float> product) noexcept;
  void turn_best(Signs signs, Signs applied) noexcept;
  void begin_update(Signs signs, Signs applied) noexcept;

  FloatPhi::End at_end_ = {};  // Of the stretches of this update
  Pulse best_ = {};
  double energy_ = 0.0;
  double highest_ = 0.0;  // Of the energies at rest.
  float shift_ = 0.0F;
  std::size_t next_ = 0;  // The cell that comes next.
  std::size_t iterations_ = 0;
  std::size_t first_iterations_ = 0;
  std::size_t turns_ = 0;
  std::size_t updates_ = 0;  // Since the product was computed.
  std::size_t products_ = 0;
  std::size_t fruitless_ = 0;  // Rests since the highest one.
  Phase phase_ = Phase::kDone;
  bool has_rested_ = false;
  bool at_rest_ = false;
};

static_assert(std::is_trivially_copyable_v<GridClimb>);

}  // namespace emax
