// The uniform generators of Wichmann and Hill, 2006 and 1982, with jump-ahead.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {

enum class Generator : std::uint8_t {
  k2006,  ///< Four components, period 2^121; JCGM 101:2008 C.3. Passes BigCrush.
  k1982,  ///< Three components, period 6.95e12; algorithm AS 183. Fails Crush: for comparison with
          ///< older work.
};

/// Pseudo-random numbers in [0, 1): the fraction of the sum of i_j / m_j, where i_j <- a_j i_j mod
/// m_j.
///
/// Integers only but for the last sum, so the sequence is the same on every target. 20 bytes.
/// Before `seed()` the state is zero and every number is 0. A copy continues on its own.
class WichmannHill {
 public:
  static constexpr std::size_t kMaxComponents = 4;

  /// Starts the sequence after the given seeds.
  ///
  /// The 2006 generator takes four seeds, each from 1 to m_j - 1 with m = (2147483579, 2147483543,
  /// 2147483423, 2147483123). The 1982 generator takes the first three of three or four seeds and
  /// reduces each to 1 + (seed - 1) mod (m_j - 1) with m = (30269, 30307, 30323), so that seeds in
  /// its own range stay what they are and the four of the 2006 generator serve both.
  ///
  /// @returns
  /// * kOk: The next number is the first of the sequence.
  /// * kInvalidArgument: Too few or too many seeds, a seed of zero, or for k2006 a seed of m_j or
  /// more. Nothing has
  ///   changed.
  Status seed(Generator generator, Span<const std::uint32_t> seeds) noexcept;

  /// @returns The next number, in [0, 1). One multiplication and one division per component; where
  /// doubles are divided in software, three multiplications (`share_of_modulus`).
  double next() noexcept;

  /// Goes forward as `steps` calls of `next()` would, by a_j^steps mod m_j; at most 512 modular
  /// products.
  void jump(std::uint64_t steps) noexcept;

  Generator generator() const noexcept { return generator_; }
  std::size_t components() const noexcept { return generator_ == Generator::k2006 ? 4 : 3; }

  /// @returns The components i_j; the fourth is 0 for the 1982 generator. Given to `seed()` (the
  /// first `components()` of them), they continue the sequence from here.
  std::array<std::uint32_t, kMaxComponents> state() const noexcept { return state_; }

 private:
  std::array<std::uint32_t, kMaxComponents> state_ = {};
  Generator generator_ = Generator::k2006;
};

static_assert(std::is_trivially_copyable_v<WichmannHill>);
static_assert(sizeof(WichmannHill) == 20);

}  // namespace emax
