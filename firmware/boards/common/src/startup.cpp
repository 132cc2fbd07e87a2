// Memory before main().
#include "emax/board/startup.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "emax/board/fault_report.hpp"
#include "emax/board/stack_mark.hpp"

extern "C" {

// From the linker script.
extern std::uint32_t data_begin[];
extern std::uint32_t data_end[];
extern std::uint32_t data_image[];
extern std::uint32_t bss_begin[];
extern std::uint32_t bss_end[];
extern std::uint32_t ram_end[];
extern std::uint32_t stack_limit[];
extern std::uint32_t stack_top[];

int main();
}

namespace emax::board {
namespace {

// What the functions that mark the stack may use of it themselves.
constexpr std::size_t kOwnStackBytes = 256;

std::size_t words_between(const std::uint32_t* begin, const std::uint32_t* end) noexcept {
  return (reinterpret_cast<std::uintptr_t>(end) - reinterpret_cast<std::uintptr_t>(begin)) /
         sizeof(std::uint32_t);
}

}  // namespace

Span<std::uint32_t> stack() noexcept {
  return {stack_limit, words_between(stack_limit, stack_top)};
}

bool is_in_stack_guard(std::uintptr_t address) noexcept {
  const auto limit = reinterpret_cast<std::uintptr_t>(stack_limit);
  return address < limit && address >= limit - kGuardBytes;
}

std::size_t static_bytes() noexcept {
  return words_between(data_begin, ram_end) * sizeof(std::uint32_t);
}

void run_program() noexcept {
  std::copy_n(data_image, words_between(data_begin, data_end), data_begin);
  std::fill_n(bss_begin, words_between(bss_begin, bss_end), 0U);
  const std::size_t words = stack().size() - kOwnStackBytes / sizeof(std::uint32_t);
  mark_stack(stack().first(words));
  stop(main());
}

}  // namespace emax::board
