// What strings and vectors need where there is no C library: memory, a few of its functions, and no
// way on after an error.
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <string>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"

#include "arena.hpp"

namespace emax::web {
namespace {

constexpr std::size_t kAlignment = 16;
alignas(kAlignment) unsigned char arena[kArenaBytes];
std::size_t used = 0;

}  // namespace

void clear_arena() noexcept { used = 0; }

// Who asks for more than there is ends the module; the page tells so.
void* take_from_arena(std::size_t size) noexcept {
  const std::size_t rounded = (size + kAlignment - 1) / kAlignment * kAlignment;
  if (rounded < size || rounded > kArenaBytes - used) {
    __builtin_trap();
  }
  unsigned char* const place = arena + used;
  used += rounded;
  return place;
}

}  // namespace emax::web

// What else would come from the C++ library.
template class std::basic_string<char>;

// Nothing is given back before the next call begins.
void* operator new(std::size_t size) { return emax::web::take_from_arena(size); }
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return emax::web::take_from_arena(size);
}
void* operator new[](std::size_t size) { return emax::web::take_from_arena(size); }
void operator delete(void* /*place*/) noexcept {}
void operator delete[](void* /*place*/) noexcept {}
void operator delete(void* /*place*/, const std::nothrow_t& /*tag*/) noexcept {}
void operator delete(void* /*place*/, std::size_t /*size*/) noexcept {}
void operator delete[](void* /*place*/, std::size_t /*size*/) noexcept {}

namespace std {

const nothrow_t nothrow;

void __throw_length_error(const char* /*what*/) { __builtin_trap(); }
void __throw_logic_error(const char* /*what*/) { __builtin_trap(); }
void __throw_out_of_range_fmt(const char* /*what*/, ...) { __builtin_trap(); }
void __throw_bad_alloc() { __builtin_trap(); }
void __throw_bad_array_new_length() { __builtin_trap(); }

}  // namespace std

extern "C" {

int* __errno() {
  static int number = 0;
  return &number;
}

void abort() { __builtin_trap(); }

// Nothing is ever destroyed at the end, for there is none.
int atexit(void (* /*function*/)()) { return 0; }

std::size_t strlen(const char* text) {
  std::size_t size = 0;
  while (text[size] != '\0') {
    ++size;
  }
  return size;
}

void* memchr(const void* bytes, int wanted, std::size_t size) {
  const auto* at = static_cast<const unsigned char*>(bytes);
  for (; size > 0; ++at, --size) {
    if (*at == static_cast<unsigned char>(wanted)) {
      return const_cast<unsigned char*>(at);
    }
  }
  return nullptr;
}

int strcmp(const char* left, const char* right) {
  while (*left != '\0' && *left == *right) {
    ++left;
    ++right;
  }
  return static_cast<unsigned char>(*left) - static_cast<unsigned char>(*right);
}

// The only powers that are asked for: of ten, with whole exponents. Correctly rounded.
double pow(double /*base*/, double exponent) {
  char text[8] = {'1', 'e'};
  const int whole = static_cast<int>(exponent);
  const unsigned size = static_cast<unsigned>(whole < 0 ? -whole : whole) % 1000;
  text[2] = whole < 0 ? '-' : '+';
  text[3] = static_cast<char>('0' + size / 100);
  text[4] = static_cast<char>('0' + size / 10 % 10);
  text[5] = static_cast<char>('0' + size % 10);
  return emax::parse_decimal(emax::Span<const char>(text, 6)).value;
}

// Exact for powers of ten, so that its floor is the decimal exponent.
double log10(double x) {
  constexpr double kPerNatural = 0.43429448190325182765;
  const double estimate = emax::log(x) * kPerNatural;
  const double whole = __builtin_floor(estimate + 0.5);
  return x == pow(10.0, whole) ? whole : estimate;
}

}  // extern "C"
