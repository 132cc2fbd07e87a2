// exp, log, sin, cos, atan2, sqrt and floor from +, -, *, / and integer operations only.
//
// Each function splits its argument so that the leading part of the result is exact and the rest
// small: all rounding but the last then happens far below the last place. Every step marked exact
// is so by the widths of its operands; contraction or excess precision would break it. The
// coefficients are minimax fits made for the intervals named beside them.
#include "emax/base/elementary.hpp"

#include <cstdint>
#include <limits>

#if defined(__FAST_MATH__)
#error "emax needs IEEE arithmetic: do not compile with -ffast-math"
#endif
#if defined(__FLT_EVAL_METHOD__)
#if __FLT_EVAL_METHOD__ != 0
#error "emax needs arithmetic in the precision of double, without excess bits"
#endif
#endif

#if defined(__x86_64__) || defined(__aarch64__)
#define EMAX_HARDWARE_SQRT 1
#elif defined(__ARM_FP)
#if __ARM_FP & 8
#define EMAX_HARDWARE_SQRT 1
#endif
#elif defined(__riscv_flen)
#if __riscv_flen >= 64
#define EMAX_HARDWARE_SQRT 1
#endif
#endif

namespace emax {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kSignBit = std::uint64_t{1} << 63;
constexpr std::uint64_t kHiddenBit = std::uint64_t{1} << 52;
constexpr std::uint64_t kFractionMask = kHiddenBit - 1;

/// Added and subtracted again it rounds a double below 2^51 to an integer, which sits in the low
/// bits meanwhile.
constexpr double kRounder = 0x1.8p52;

constexpr std::uint64_t to_bits(double x) noexcept { return __builtin_bit_cast(std::uint64_t, x); }
constexpr double from_bits(std::uint64_t bits) noexcept { return __builtin_bit_cast(double, bits); }
constexpr std::int32_t biased_exponent(double x) noexcept {
  return static_cast<std::int32_t>((to_bits(x) >> 52) & 0x7FF);
}
constexpr bool is_negative(double x) noexcept { return (to_bits(x) & kSignBit) != 0; }
constexpr double power_of_two(std::int32_t exponent) noexcept {
  return from_bits(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

/// The leading 26 bits of x; the other 27 are x - leading_half(x). Products of two such parts are
/// exact.
constexpr double leading_half(double x) noexcept {
  return from_bits(to_bits(x) & ~((std::uint64_t{1} << 27) - 1));
}

constexpr std::uint64_t multiply_wide(std::uint32_t a, std::uint32_t b) noexcept {
  return std::uint64_t{a} * b;
}

/// The upper 64 bits of the product.
constexpr std::uint64_t multiply_high(std::uint64_t a, std::uint64_t b) noexcept {
  const auto a0 = static_cast<std::uint32_t>(a);
  const auto a1 = static_cast<std::uint32_t>(a >> 32);
  const auto b0 = static_cast<std::uint32_t>(b);
  const auto b1 = static_cast<std::uint32_t>(b >> 32);
  const std::uint64_t low = multiply_wide(a1, b0) + (multiply_wide(a0, b0) >> 32);
  const std::uint64_t middle = multiply_wide(a0, b1) + static_cast<std::uint32_t>(low);
  return multiply_wide(a1, b1) + (low >> 32) + (middle >> 32);
}

// exp: x = (64 e + j) ln2/64 + r, |r| <= ln2/128, and 2^(j/64) = value (1 + tail).

struct ExpEntry {
  double value;
  double tail;
};

constexpr ExpEntry kExpTable[64] = {
    {0x1.0p+0, 0.0},
    {0x1.02c9a3e778061p+0, -0x1.160139cd8dc5dp-56},
    {0x1.059b0d3158574p+0, 0x1.cd2523567f613p-55},
    {0x1.0874518759bc8p+0, 0x1.0f74e61e6c861p-57},
    {0x1.0b5586cf9890fp+0, 0x1.79aa65d837b6dp-54},
    {0x1.0e3ec32d3d1a2p+0, 0x1.ebe3d702f9cd1p-60},
    {0x1.11301d0125b51p+0, -0x1.556522a2fbd0ep-54},
    {0x1.1429aaea92dep+0, -0x1.1c923b9d5f416p-54},
    {0x1.172b83c7d517bp+0, -0x1.01b15eaa59348p-55},
    {0x1.1a35beb6fcb75p+0, 0x1.b898c3f1353bfp-55},
    {0x1.1d4873168b9aap+0, 0x1.aecf73e3a2f6p-54},
    {0x1.2063b88628cd6p+0, 0x1.a6f4144a6c38dp-55},
    {0x1.2387a6e756238p+0, 0x1.68efde3a8a894p-54},
    {0x1.26b4565e27cddp+0, 0x1.0472b981fe7f2p-55},
    {0x1.29e9df51fdee1p+0, 0x1.2f7e16d09ab31p-55},
    {0x1.2d285a6e4030bp+0, 0x1.b3782720c0ab4p-55},
    {0x1.306fe0a31b715p+0, 0x1.34d754db0abb6p-55},
    {0x1.33c08b26416ffp+0, 0x1.fdd395dd3f84ap-55},
    {0x1.371a7373aa9cbp+0, -0x1.24aedcc4b5068p-54},
    {0x1.3a7db34e59ff7p+0, -0x1.1d1e83e9436d2p-56},
    {0x1.3dea64c123422p+0, 0x1.59f48a72a4c6dp-55},
    {0x1.4160a21f72e2ap+0, -0x1.8a78f4817895bp-58},
    {0x1.44e086061892dp+0, 0x1.363ed60c2ac11p-59},
    {0x1.486a2b5c13cdp+0, 0x1.ecce1daa10379p-57},
    {0x1.4bfdad5362a27p+0, 0x1.690cebb7aafbp-56},
    {0x1.4f9b2769d2ca7p+0, -0x1.f94340071a38ep-55},
    {0x1.5342b569d4f82p+0, -0x1.8dec6bd0f385fp-56},
    {0x1.56f4736b527dap+0, 0x1.3350518fdd78ep-54},
    {0x1.5ab07dd485429p+0, 0x1.063e1e21c5409p-54},
    {0x1.5e76f15ad2148p+0, 0x1.432e62b64c035p-54},
    {0x1.6247eb03a5585p+0, -0x1.c33c53bef4da8p-55},
    {0x1.6623882552225p+0, -0x1.3cedd78565858p-54},
    {0x1.6a09e667f3bcdp+0, -0x1.3b3efbf5e2228p-54},
    {0x1.6dfb23c651a2fp+0, -0x1.367efb86da9eep-57},
    {0x1.71f75e8ec5f74p+0, -0x1.81f647e5a3ecfp-56},
    {0x1.75feb564267c9p+0, -0x1.619321e55e68ap-55},
    {0x1.7a11473eb0187p+0, -0x1.b32dcb94da51dp-56},
    {0x1.7e2f336cf4e62p+0, 0x1.5ebe1abd66c55p-57},
    {0x1.82589994cce13p+0, -0x1.369b6f13b3734p-54},
    {0x1.868d99b4492edp+0, -0x1.4d450d872576ep-54},
    {0x1.8ace5422aa0dbp+0, 0x1.db72fc1f0eab4p-55},
    {0x1.8f1ae99157736p+0, 0x1.bf68359f35f44p-56},
    {0x1.93737b0cdc5e5p+0, -0x1.da9b88b6c1e29p-58},
    {0x1.97d829fde4e5p+0, -0x1.2434322f4f9aap-54},
    {0x1.9c49182a3f09p+0, 0x1.1affc2b91ce27p-56},
    {0x1.a0c667b5de565p+0, -0x1.7c50422622263p-55},
    {0x1.a5503b23e255dp+0, -0x1.1bbd1d3bcbb15p-54},
    {0x1.a9e6b5579fdbfp+0, 0x1.469846e735ab3p-55},
    {0x1.ae89f995ad3adp+0, 0x1.c1a7792cb3387p-55},
    {0x1.b33a2b84f15fbp+0, -0x1.5c3d956dcaebap-58},
    {0x1.b7f76f2fb5e47p+0, -0x1.8d6f438ad9334p-57},
    {0x1.bcc1e904bc1d2p+0, 0x1.4ffd70a5fddcdp-56},
    {0x1.c199bdd85529cp+0, 0x1.36eae30af0cb3p-56},
    {0x1.c67f12e57d14bp+0, 0x1.4e08fd10959acp-55},
    {0x1.cb720dcef9069p+0, 0x1.76b2c6c921968p-57},
    {0x1.d072d4a07897cp+0, -0x1.fad5d3ffffa6fp-55},
    {0x1.d5818dcfba487p+0, 0x1.4a385a63d07a7p-56},
    {0x1.da9e603db3285p+0, 0x1.e5a50d5c192acp-55},
    {0x1.dfc97337b9b5fp+0, -0x1.2d52107b43e1fp-55},
    {0x1.e502ee78b3ff6p+0, 0x1.4b604603a88d3p-56},
    {0x1.ea4afa2a490dap+0, -0x1.ff7128fd391fp-55},
    {0x1.efa1bee615a27p+0, 0x1.ec3bc41aa2008p-55},
    {0x1.f50765b6e454p+0, 0x1.a64a931d185eep-55},
    {0x1.fa7c1819e90d8p+0, 0x1.7893b4d91cd9dp-56},
};

constexpr double kExp64OverLn2 = 0x1.71547652b82fep+6;
constexpr double kExpLn2Over64High =
    0x1.62e42fefa0000p-7;  // Multiples of 2^-42: times 17 bits it is exact.
constexpr double kExpLn2Over64Low = 0x1.cf79abc9e3b3ap-46;

// (e^r - 1 - r) / r^2, error 2^-59 in e^r.
constexpr double kExpC2 = 0x1.fffffffffdbc8p-2;
constexpr double kExpC3 = 0x1.55555555548b9p-3;
constexpr double kExpC4 = 0x1.555573c8a103dp-5;
constexpr double kExpC5 = 0x1.111123d8c9af3p-7;

constexpr double kExpOverflow = 0x1.62e42fefa39efp+9;  // ln of the greatest double, rounded down.
constexpr double kExpUnderflow =
    -0x1.74910d52d3052p+9;  // Below: less than half the least subnormal.

/// e^x 2^-shift, for results between 2^-1000 and 2^1023.
double scaled_exp(double x, std::int32_t shift) noexcept {
  const double rounded = x * kExp64OverLn2 + kRounder;
  const auto k = static_cast<std::int32_t>(static_cast<std::uint32_t>(to_bits(rounded)));
  const double n = rounded - kRounder;
  const double r = (x - n * kExpLn2Over64High) - n * kExpLn2Over64Low;
  const double r2 = r * r;
  const std::int32_t j = k & 63;
  const ExpEntry& entry = kExpTable[j];
  const auto exponent = static_cast<std::int64_t>(k - j - 64 * shift);
  const double scale =
      from_bits(to_bits(entry.value) + (static_cast<std::uint64_t>(exponent) << 46));
  const double p = (entry.tail + r) + r2 * ((kExpC2 + r * kExpC3) + r2 * (kExpC4 + r * kExpC5));
  return scale + scale * p;
}

// log: x = 2^k z with z in [0.816, 1.633), z reciprocal = 1 + r with |r| <= 2^-7, and
// high + low = -ln(reciprocal), high in multiples of 2^-42. The middle of one interval is 1, with r
// = z - 1.

struct LogEntry {
  float reciprocal;
  float low;
  double high;
};

constexpr LogEntry kLogTable[64] = {
    {0x1.381p+0F, 0x1.3b6858p-46F, -0x1.958eadae6p-3},
    {0x1.352p+0F, -0x1.98dd68p-46F, -0x1.8230164c1ap-3},
    {0x1.324p+0F, -0x1.69737cp-44F, -0x1.6f0d28ae56p-3},
    {0x1.2f7p+0F, -0x1.6ece38p-44F, -0x1.5c28060c46p-3},
    {0x1.2cap+0F, 0x1.53ceep-44F, -0x1.4915d832fcp-3},
    {0x1.29ep+0F, -0x1.1e18f2p-44F, -0x1.3643cad058p-3},
    {0x1.273p+0F, 0x1.7e6e8p-44F, -0x1.23b412580cp-3},
    {0x1.249p+0F, -0x1.93437p-46F, -0x1.1168e8127ep-3},
    {0x1.22p+0F, 0x1.54555ep-44F, -0x1.fec9131dcp-4},
    {0x1.1f7p+0F, -0x1.a83eacp-46F, -0x1.da6e7637c4p-4},
    {0x1.1cfp+0F, -0x1.b176p-44F, -0x1.b6a688d9b4p-4},
    {0x1.1a8p+0F, -0x1.eddc38p-44F, -0x1.9375e55594p-4},
    {0x1.181p+0F, -0x1.8f199ap-55F, -0x1.6ff7309f8cp-4},
    {0x1.15bp+0F, 0x1.8e7d02p-47F, -0x1.4d1515b988p-4},
    {0x1.136p+0F, 0x1.cea3aep-44F, -0x1.2ad449eff4p-4},
    {0x1.111p+0F, 0x1.93b33cp-46F, -0x1.08498b51e4p-4},
    {0x1.0edp+0F, -0x1.97a98cp-44F, -0x1.cccb3cd798p-5},
    {0x1.0c9p+0F, 0x1.9c8d9p-45F, -0x1.88729e70fp-5},
    {0x1.0a7p+0F, -0x1.6de8fcp-46F, -0x1.475ee9a0bp-5},
    {0x1.084p+0F, -0x1.f77896p-44F, -0x1.03d5d85e7p-5},
    {0x1.062p+0F, -0x1.deb9cap-45F, -0x1.83624fba8p-6},
    {0x1.041p+0F, -0x1.6107d2p-44F, -0x1.01f565873p-6},
    {0x1.02p+0F, -0x1.9e23fp-46F, -0x1.fe02a6b1p-8},
    {0x1.0p+0F, 0.0F, 0.0},
    {0x1.f82p-1F, 0x1.ec927cp-50F, 0x1.fbea8b13cp-7},
    {0x1.f08p-1F, 0x1.42ad92p-45F, 0x1.f7a9b1678p-6},
    {0x1.e92p-1F, 0x1.ff0a82p-46F, 0x1.766d923c2p-5},
    {0x1.e1ep-1F, -0x1.caef36p-45F, 0x1.f0c30c1118p-5},
    {0x1.daep-1F, 0x1.d4203ep-44F, 0x1.345179b63cp-4},
    {0x1.d42p-1F, -0x1.5d462ep-44F, 0x1.6ef528c058p-4},
    {0x1.cd8p-1F, 0x1.e63794p-44F, 0x1.a956d3ecacp-4},
    {0x1.c72p-1F, -0x1.f89798p-45F, 0x1.e2507702bp-4},
    {0x1.c0ep-1F, 0x1.cb4228p-44F, 0x1.0d79e7cd48p-3},
    {0x1.bacp-1F, 0x1.d4d008p-44F, 0x1.299d30c606p-3},
    {0x1.b4ep-1F, 0x1.df6a44p-44F, 0x1.44f8b726f8p-3},
    {0x1.af2p-1F, 0x1.152d7ep-44F, 0x1.601b076e7ap-3},
    {0x1.a98p-1F, -0x1.ae75fcp-44F, 0x1.7b00916516p-3},
    {0x1.a42p-1F, 0x1.f1e676p-44F, 0x1.9509aa0044p-3},
    {0x1.9ecp-1F, -0x1.148288p-45F, 0x1.af6895610ep-3},
    {0x1.99ap-1F, 0x1.eee43p-44F, 0x1.c8df7cb9a8p-3},
    {0x1.948p-1F, 0x1.823818p-44F, 0x1.e2a877a6b2p-3},
    {0x1.8fap-1F, -0x1.1c061cp-45F, 0x1.fb7d86eee4p-3},
    {0x1.8acp-1F, 0x1.03094ep-44F, 0x1.0a504e97bbp-2},
    {0x1.862p-1F, -0x1.172p-44F, 0x1.1661caecbap-2},
    {0x1.818p-1F, -0x1.a14216p-44F, 0x1.22981fbef8p-2},
    {0x1.7dp-1F, 0x1.4300c2p-45F, 0x1.2e9e2bce12p-2},
    {0x1.78ap-1F, -0x1.ce772p-44F, 0x1.3a71c56bb5p-2},
    {0x1.746p-1F, -0x1.e82cap-46F, 0x1.4610bc29c6p-2},
    {0x1.702p-1F, 0x1.5b0faap-44F, 0x1.51d1d93104p-2},
    {0x1.6c2p-1F, 0x1.740ab8p-45F, 0x1.5d01dc49ffp-2},
    {0x1.682p-1F, -0x1.3c6e8p-44F, 0x1.68518244dp-2},
    {0x1.642p-1F, -0x1.9be482p-45F, 0x1.73c1800dc1p-2},
    {0x1.606p-1F, -0x1.401a62p-50F, 0x1.7e9883fa4ap-2},
    {0x1.5cap-1F, 0x1.1f666p-44F, 0x1.898d38a893p-2},
    {0x1.58ep-1F, 0x1.0e7bccp-44F, 0x1.94a0428036p-2},
    {0x1.556p-1F, -0x1.2edbfep-45F, 0x1.9f123f4bf7p-2},
    {0x1.51ep-1F, 0x1.1e89c6p-46F, 0x1.a99fcabdb8p-2},
    {0x1.4e6p-1F, -0x1.cae5ep-47F, 0x1.b44977c149p-2},
    {0x1.4bp-1F, -0x1.4bac8ap-44F, 0x1.beacd9e272p-2},
    {0x1.47ap-1F, -0x1.bc058p-44F, 0x1.c92b7d6bb1p-2},
    {0x1.446p-1F, 0x1.42cdb6p-44F, 0x1.d360e90c38p-2},
    {0x1.414p-1F, 0x1.2d8512p-44F, 0x1.dd4aa04e1cp-2},
    {0x1.3e2p-1F, -0x1.e146bap-44F, 0x1.e74d262789p-2},
    {0x1.3b2p-1F, 0x1.cce77ap-45F, 0x1.f100f6c2ebp-2},
};

constexpr std::uint64_t kLogOffset = 0x3FEA200000000000;
constexpr double kLn2High = 0x1.62e42fefa3800p-1;  // Multiples of 2^-42.
constexpr double kLn2Low = 0x1.ef35793c76730p-45;

// (ln(1 + r) - r + r^2/2) / r^3, error 2^-57 of ln(1 + r).
constexpr double kLogC3 = 0x1.5555555555584p-2;
constexpr double kLogC4 = -0x1.fffffff762e15p-3;
constexpr double kLogC5 = 0x1.9999998d036a2p-3;
constexpr double kLogC6 = -0x1.555b6c395c29ap-3;
constexpr double kLogC7 = 0x1.249898015ae89p-3;

// sin, cos: x = n pi/2 + (high + low), |high| <= pi/4.

struct ReducedAngle {
  double high;
  double low;
  std::uint32_t quadrant;
};

constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
constexpr double kHalfPiHigh = 0x1.921fb54440000p+0;  // 37 bits: times 16 bits it is exact.
constexpr double kHalfPiLow = 0x1.68c234c4c6629p-39;
constexpr double kTwoPartLimit = 65536.0;
constexpr double kTwoPartLeast = 0x1p-15;
constexpr double kTinyAngle = 0x1p-27;
constexpr std::uint64_t kHalfPiTimes2To63 = 0xC90FDAA22168C235;

/// 2/pi in binary behind 64 zero bits: as many digits as the greatest double needs.
constexpr std::uint32_t kTwoOverPiBits[39] = {
    0x00000000, 0x00000000, 0xA2F9836E, 0x4E441529, 0xFC2757D1, 0xF534DDC0, 0xDB629599, 0x3C439041,
    0xFE5163AB, 0xDEBBC561, 0xB7246E3A, 0x424DD2E0, 0x06492EEA, 0x09D1921C, 0xFE1DEB1C, 0xB129A73E,
    0xE88235F5, 0x2EBB4484, 0xE99C7026, 0xB45F7E41, 0x3991D639, 0x835339F4, 0x9C845F8B, 0xBDF9283B,
    0x1FF897FF, 0xDE05980F, 0xEF2F118B, 0x5A0A6D1F, 0x6D367ECF, 0x27CB09B7, 0x4F463F66, 0x9E5FEA2D,
    0x7527BAC7, 0xEBE5F17B, 0x3D0739F7, 0x8A5292EA, 0x6BFB5FB1, 0x1F8D5D08, 0x56033046,
};

/// Payne and Hanek: the 192 bits of 2/pi that decide x 2/pi modulo 4, in integers. |x| >= 1/2 and
/// finite.
///
/// No double is nearer than 2^-62 to a multiple of pi/2 (in units of pi/2); 2^-137 is kept.
ReducedAngle reduce_by_integers(double x) noexcept {
  const std::uint64_t bits = to_bits(x);
  const std::uint64_t mantissa = (bits & kFractionMask) | kHiddenBit;
  const auto m0 = static_cast<std::uint32_t>(mantissa);
  const auto m1 = static_cast<std::uint32_t>(mantissa >> 32);
  // |x| = mantissa 2^(biased - 1075). The bit of 2/pi that makes 2 of it is the first to matter.
  const auto position = static_cast<std::uint32_t>(biased_exponent(x)) - 1013U;
  const std::uint32_t word = position >> 5;
  const std::uint32_t shift = position & 31U;
  std::uint32_t product[6];
  std::uint64_t carry = 0;
  std::uint32_t previous = 0;
  for (std::uint32_t i = 0; i < 6;
       ++i) {  // From the least word; what exceeds 192 bits is a multiple of 4.
    const std::uint32_t at = word + 5U - i;
    const std::uint64_t pair = (std::uint64_t{kTwoOverPiBits[at]} << 32) | kTwoOverPiBits[at + 1U];
    const auto window = static_cast<std::uint32_t>((pair << shift) >> 32);
    const std::uint64_t high = multiply_wide(m1, previous) + carry;
    const std::uint64_t sum = multiply_wide(m0, window) + static_cast<std::uint32_t>(high);
    product[i] = static_cast<std::uint32_t>(sum);
    carry = (sum >> 32) + (high >> 32);
    previous = window;
  }
  const std::uint64_t top = (std::uint64_t{product[5]} << 32) | product[4];
  const std::uint64_t next = (std::uint64_t{product[3]} << 32) | product[2];
  auto quadrant = static_cast<std::uint32_t>(top >> 62);
  std::uint64_t fraction = (top << 2) | (next >> 62);
  std::uint64_t rest = next << 2;
  bool negative = (bits & kSignBit) != 0;
  if ((fraction >> 63) != 0) {  // Nearer to the next multiple.
    ++quadrant;
    fraction = ~fraction;
    rest = ~rest;
    negative = !negative;
  }
  if ((bits & kSignBit) != 0) {
    quadrant = 0U - quadrant;
  }
  const int zeros = __builtin_clzll(fraction | 1U);
  if (zeros != 0) {
    fraction = (fraction << zeros) | (rest >> (64 - zeros));
  }
  const std::uint64_t angle = multiply_high(fraction, kHalfPiTimes2To63);  // Times 2^(-63 - zeros).
  const double unit = negative ? -power_of_two(-63 - zeros) : power_of_two(-63 - zeros);
  const double high = static_cast<double>(static_cast<std::int64_t>(angle >> 11)) * (2048.0 * unit);
  const double low = static_cast<double>(static_cast<std::int32_t>(angle & 2047U)) * unit;
  return {high, low, quadrant};
}

/// x finite.
ReducedAngle reduce_angle(double x) noexcept {
  if (abs(x) < kTwoPartLimit) {
    const double rounded = x * kTwoOverPi + kRounder;
    const double n = rounded - kRounder;
    const double a = x - n * kHalfPiHigh;  // Exact.
    const double b = n * kHalfPiLow;       // Off by 2^-75 at most.
    const double high = a - b;
    if (abs(high) >= kTwoPartLeast || n == 0.0) {
      return {high, (a - high) - b, static_cast<std::uint32_t>(to_bits(rounded))};
    }
  }
  return reduce_by_integers(x);
}

/// sin(y + tail), |y| <= pi/4, error 2^-58. z = y^2.
double sine_kernel(double y, double tail, double z, double z2) noexcept {
  constexpr double kC3 = -0x1.5555555555548p-3;
  constexpr double kC5 = 0x1.111111110f74bp-7;
  constexpr double kC7 = -0x1.a01a019beeea1p-13;
  constexpr double kC9 = 0x1.71de355bc9146p-19;
  constexpr double kC11 = -0x1.ae5e51b481605p-26;
  constexpr double kC13 = 0x1.5d8d5f89f0e7cp-33;
  const double p = (kC3 + z * kC5) + z2 * ((kC7 + z * kC9) + z2 * (kC11 + z * kC13));
  return y + ((z * y) * p + tail * (1.0 - 0.5 * z));
}

/// cos(y + tail), |y| <= pi/4, error 2^-63. z = y^2.
double cosine_kernel(double y, double tail, double z, double z2) noexcept {
  constexpr double kC4 = 0x1.555555555554bp-5;
  constexpr double kC6 = -0x1.6c16c16c1500ep-10;
  constexpr double kC8 = 0x1.a01a019c8df61p-16;
  constexpr double kC10 = -0x1.27e4f7f06df8ep-22;
  constexpr double kC12 = 0x1.1ee9dae0e215cp-29;
  constexpr double kC14 = -0x1.8fa5f7bc8ce26p-37;
  const double p = (kC4 + z * kC6) + z2 * ((kC8 + z * kC10) + z2 * (kC12 + z * kC14));
  const double half = 0.5 * z;
  const double leading = 1.0 - half;
  return leading + (((1.0 - leading) - half) + (z2 * p - y * tail));
}

/// sin(angle + quarter_turns pi/2).
double sine_of(const ReducedAngle& angle, std::uint32_t quarter_turns) noexcept {
  const std::uint32_t quadrant = angle.quadrant + quarter_turns;
  const double z = angle.high * angle.high;
  const double z2 = z * z;
  const double value = (quadrant & 1U) != 0U ? cosine_kernel(angle.high, angle.low, z, z2)
                                             : sine_kernel(angle.high, angle.low, z, z2);
  return (quadrant & 2U) != 0U ? -value : value;
}

// atan2: with c = i/8 next to b/a, atan(b/a) = atan(c) + atan(t), where t = (b - c a) / (a + c b),
// |t| < 0.0675.

struct ArcEntry {
  double ratio;
  double high;
  double low;
};

constexpr ArcEntry kArcTable[9] = {
    {0.0, 0.0, 0.0},
    {0.125, 0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0.25, 0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0.375, 0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0.5, 0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0.625, 0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0.75, 0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0.875, 0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {1.0, 0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};

constexpr double kPiHigh = 0x1.921fb54442d18p+1;
constexpr double kPiLow = 0x1.1a62633145c07p-53;

struct DoubleDouble {
  double high;
  double low;
};

/// t of the comment above to 2^-75 of itself: the quotient's leading bits, then its remainder.
DoubleDouble arc_argument(double a, double b, double c) noexcept {
  const double a_leading = leading_half(a);
  const double ca = c * (a - a_leading);     // Exact.
  const double partial = b - c * a_leading;  // Exact: the two are close, or c is 0.
  const double numerator = partial - ca;
  const double numerator_low = (partial - numerator) - ca;
  const double cb = c * b;
  const double denominator = a + cb;
  const double denominator_low = (a - denominator) + cb;
  const double reciprocal = 1.0 / denominator;
  const double t = leading_half(numerator * reciprocal);
  const double d_leading = leading_half(denominator);
  const double remainder = (numerator - t * d_leading) - t * (denominator - d_leading);
  return {t, (remainder + (numerator_low - t * denominator_low)) * reciprocal};
}

/// c = i/8 next to b/a, for normal numbers 0 < b <= a, from 21 bits of each.
std::uint32_t nearest_eighth(double a, double b) noexcept {
  const std::int32_t distance = biased_exponent(a) - biased_exponent(b);
  if (distance > 4) {
    return 0U;
  }
  constexpr std::uint32_t kMask = 0xFFFFF;
  const std::uint32_t top_a = (static_cast<std::uint32_t>(to_bits(a) >> 32) & kMask) | (kMask + 1U);
  const std::uint32_t top_b = (static_cast<std::uint32_t>(to_bits(b) >> 32) & kMask) | (kMask + 1U);
  return ((top_b << 3) + ((top_a << distance) >> 1)) / (top_a << distance);
}

/// atan2 for y > 0, both finite and not 0.
double upper_half_plane_angle(double y, double x) noexcept {
  const bool left = x < 0.0;
  double a = abs(x);
  double b = y;
  const bool swapped = b > a;
  if (swapped) {
    a = y;
    b = abs(x);
  }
  const std::int32_t exponent = biased_exponent(a);
  if (exponent - biased_exponent(b) > 64) {  // An arc tangent below 2^-63.
    if (swapped) {
      return 0.5 * kPiHigh;
    }
    return left ? kPiHigh : b / a;
  }
  if (exponent < 400) {
    a *= 0x1p600;
    b *= 0x1p600;
  } else if (exponent > 1800) {
    a *= 0x1p-600;
    b *= 0x1p-600;
  }
  const ArcEntry& entry = kArcTable[nearest_eighth(a, b)];
  const DoubleDouble t = arc_argument(a, b, entry.ratio);

  // (atan t - t) / t^3, error 2^-61 of atan t.
  constexpr double kC3 = -0x1.5555555555512p-2;
  constexpr double kC5 = 0x1.9999999933960p-3;
  constexpr double kC7 = -0x1.24924792f5be2p-3;
  constexpr double kC9 = 0x1.c7170d1251f66p-4;
  constexpr double kC11 = -0x1.70265f23b1d4bp-4;
  const double whole = t.high + t.low;
  const double z = whole * whole;
  const double p = kC3 + z * (kC5 + z * (kC7 + z * (kC9 + z * kC11)));
  const double tail = t.low + (z * whole) * p;

  // The angle is base +- (arc of the table + arc of t).
  const double turn = swapped ? 0.5 : (left ? 1.0 : 0.0);
  const double sign = swapped == left ? 1.0 : -1.0;
  const double base = turn * kPiHigh;
  const double arc = sign * entry.high;
  const double sum = base + arc;
  const double sum_low = ((base - sum) + arc) + (turn * kPiLow + sign * entry.low);
  const double leading = sign * t.high;
  const double angle = sum + leading;
  const double angle_low = (sum - angle) + leading;
  return angle + (angle_low + (sum_low + sign * tail));
}

}  // namespace

namespace detail {

double software_sqrt(double x) noexcept {
  std::uint64_t bits = to_bits(x);
  std::int32_t exponent = biased_exponent(x);
  if (x != x || (bits << 1) == 0) {
    return x;
  }
  if (is_negative(x)) {
    return kNan;
  }
  if (exponent == 0x7FF) {
    return x;
  }
  std::uint64_t mantissa = bits & kFractionMask;
  if (exponent == 0) {
    const int shift = __builtin_clzll(mantissa) - 11;
    mantissa <<= shift;
    exponent = 1 - shift;
  }
  mantissa |= kHiddenBit;
  const bool odd = ((exponent + 1) & 1) != 0;                // The bias is odd.
  const std::uint64_t square = mantissa << (odd ? 11 : 10);  // In [1, 4), 62 fraction bits.
  const std::int32_t half_exponent = (exponent + 1023 - (odd ? 1 : 0)) / 2;

  // Reciprocal root in 31 fraction bits: a table of 5 to 6 bits, then three Newton steps.
  constexpr std::uint8_t kSeed[48] = {
      252, 245, 238, 232, 226, 221, 216, 211, 207, 203, 199, 195, 192, 189, 185, 182,
      180, 177, 174, 172, 169, 167, 165, 163, 161, 159, 157, 155, 154, 152, 150, 149,
      147, 146, 144, 143, 141, 140, 139, 137, 136, 135, 134, 133, 132, 131, 130, 129,
  };
  const auto top = static_cast<std::uint32_t>(square >> 32);
  std::uint32_t y = std::uint32_t{kSeed[(top >> 26) - 16U]} << 23;
  for (int i = 0; i < 3; ++i) {
    const auto y_square = static_cast<std::uint32_t>(multiply_wide(y, y) >> 32);
    const auto product = static_cast<std::uint32_t>(multiply_wide(top, y_square) >> 32);
    y = static_cast<std::uint32_t>(multiply_wide(y, 0x30000000U - product) >> 29);
  }

  // The root in 31 bits, then in 53; each correction is remainder / (2 root).
  std::uint64_t root = multiply_wide(top, y) >> 30;
  auto remainder = static_cast<std::int64_t>(square - root * root);
  root += static_cast<std::uint64_t>(((remainder >> 12) * std::int64_t{y}) >> 51);
  remainder = static_cast<std::int64_t>(square - root * root);
  root = (root << 22) + static_cast<std::uint64_t>((remainder * std::int64_t{y >> 4}) >> 37);

  // The largest root whose square is not above: modulo 2^64 the small remainder is exact.
  remainder = static_cast<std::int64_t>((square << 44) - root * root);
  while (remainder < 0) {
    --root;
    remainder += static_cast<std::int64_t>(2 * root + 1);
  }
  while (remainder > static_cast<std::int64_t>(2 * root)) {
    remainder -= static_cast<std::int64_t>(2 * root + 1);
    ++root;
  }
  // 53 bits and one to round by: the root of a double is never halfway between two.
  const std::uint64_t rounded = (root + 1) >> 1;
  return from_bits((static_cast<std::uint64_t>(half_exponent - 1) << 52) + rounded);
}

}  // namespace detail

double exp(double x) noexcept {
  if (abs(x) < 690.0) {  // Beyond, the small part of the result could be subnormal.
    return scaled_exp(x, 0);
  }
  if (x > kExpOverflow) {
    return kInfinity;
  }
  if (x < kExpUnderflow) {
    return 0.0;
  }
  if (x > 0.0) {
    return scaled_exp(x, 1) * 2.0;
  }
  return x < 0.0 ? scaled_exp(x, -64) * 0x1p-64 : x;
}

double log(double x) noexcept {
  std::uint64_t bits = to_bits(x);
  std::int32_t shift = 0;
  if (bits - kHiddenBit >= (std::uint64_t{0x7FE} << 52)) {  // Not a positive normal number.
    if (x != x || x == kInfinity) {
      return x;
    }
    if ((bits << 1) == 0) {
      return -kInfinity;
    }
    if (is_negative(x)) {
      return kNan;
    }
    bits = to_bits(x * 0x1p52);
    shift = 52;
  }
  const std::uint64_t offset = bits - kLogOffset;
  const auto exponent = static_cast<std::int32_t>(static_cast<std::int64_t>(offset) >> 52);
  const LogEntry& entry = kLogTable[(offset >> 46) & 63U];
  const double z =
      from_bits(bits - (static_cast<std::uint64_t>(static_cast<std::int64_t>(exponent)) << 52));
  const double k = static_cast<double>(exponent - shift);

  // r in two exact parts: a reciprocal has at most 13 bits.
  const double reciprocal = static_cast<double>(entry.reciprocal);
  const double z_leading = leading_half(z);
  const double r_leading = z_leading * reciprocal - 1.0;
  const double r_low = (z - z_leading) * reciprocal;
  const double r = r_leading + r_low;
  const double r2 = r * r;

  const double base = k * kLn2High + entry.high;  // Exact: multiples of 2^-42 below 2^10.
  const double sum = base + r;
  const double sum_low = ((base - sum) + r) + ((r_leading - r) + r_low);
  const double low = k * kLn2Low + static_cast<double>(entry.low);
  const double p = (kLogC3 + r * kLogC4) + r2 * ((kLogC5 + r * kLogC6) + r2 * kLogC7);
  return sum + (((low + sum_low) + r * r2 * p) - 0.5 * r2);
}

double sin(double x) noexcept {
  if (abs(x) < kTinyAngle) {
    return x;
  }
  return is_finite(x) ? sine_of(reduce_angle(x), 0U) : kNan;
}

double cos(double x) noexcept { return is_finite(x) ? sine_of(reduce_angle(x), 1U) : kNan; }

SinCos sincos(double x) noexcept {
  if (abs(x) < kTinyAngle) {
    return {x, 1.0};
  }
  if (!is_finite(x)) {
    return {kNan, kNan};
  }
  const ReducedAngle angle = reduce_angle(x);
  const double z = angle.high * angle.high;
  const double z2 = z * z;
  const std::uint64_t sine = to_bits(sine_kernel(angle.high, angle.low, z, z2));
  const std::uint64_t cosine = to_bits(cosine_kernel(angle.high, angle.low, z, z2));
  // Quadrants come at random: exchange and signs without a jump.
  const std::uint64_t quadrant = angle.quadrant;
  const std::uint64_t exchange = (sine ^ cosine) & (0U - (quadrant & 1U));
  return {from_bits(sine ^ exchange ^ ((quadrant & 2U) << 62)),
          from_bits(cosine ^ exchange ^ (((quadrant + 1U) & 2U) << 62))};
}

double atan2(double y, double x) noexcept {
  if (x != x || y != y) {
    return kNan;
  }
  double up = abs(y);
  double across = x;
  if (up == 0.0) {
    return is_negative(x) ? (is_negative(y) ? -kPiHigh : kPiHigh) : y;
  }
  if (abs(x) == kInfinity || up == kInfinity) {
    // Along an axis or a diagonal: the same angle with finite numbers.
    up = up == kInfinity ? 1.0 : 0.0;
    across = abs(x) == kInfinity ? (x < 0.0 ? -1.0 : 1.0) : 0.0;
    if (up == 0.0) {
      up = across < 0.0 ? kPiHigh : 0.0;
      return is_negative(y) ? -up : up;
    }
  }
  const double angle = across == 0.0 ? 0.5 * kPiHigh : upper_half_plane_angle(up, across);
  return is_negative(y) ? -angle : angle;
}

double sqrt(double x) noexcept {
#if defined(EMAX_HARDWARE_SQRT)
  return __builtin_sqrt(x);
#else
  return detail::software_sqrt(x);
#endif
}

double floor(double x) noexcept {
  std::uint64_t bits = to_bits(x);
  const std::int32_t exponent = biased_exponent(x) - 1023;
  if (exponent >= 52 || (bits << 1) == 0) {
    return x;
  }
  if (exponent < 0) {
    return is_negative(x) ? -1.0 : 0.0;
  }
  const std::uint64_t below_one = kFractionMask >> exponent;
  if ((bits & below_one) == 0) {
    return x;
  }
  if (is_negative(x)) {
    bits += below_one;
  }
  return from_bits(bits & ~below_one);
}

}  // namespace emax
