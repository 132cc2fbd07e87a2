// What the page's worker must offer to the instrument's module, under the module name "emax".
#pragma once

#include <cstddef>
#include <cstdint>

// In a test of the PC they are functions like any other.
#if defined(__wasm__)
#define EMAX_IMPORT(name) [[clang::import_module("emax"), clang::import_name(name)]]
#else
#define EMAX_IMPORT(name)
#endif

extern "C" {

/// Takes bytes that came in, up to `size`. @returns How many; 0 if nothing has come in.
EMAX_IMPORT("read") std::size_t emax_read(char* bytes, std::size_t size) noexcept;
/// Takes all of these bytes, the instrument's answers.
EMAX_IMPORT("write") void emax_write(const char* bytes, std::size_t size) noexcept;
/// @returns 1 if a device clear was asked for since the last call.
EMAX_IMPORT("take_break") std::int32_t emax_take_break() noexcept;
/// @returns Microseconds since a fixed moment.
EMAX_IMPORT("now_us") double emax_now_us() noexcept;
/// Reads and replaces bytes of the store, which is as large as `emax_store_bytes()` says.
EMAX_IMPORT("store_read")
void emax_store_read(std::size_t offset, std::uint8_t* bytes, std::size_t size) noexcept;
EMAX_IMPORT("store_write")
void emax_store_write(std::size_t offset, const std::uint8_t* bytes, std::size_t size) noexcept;

}  // extern "C"

#undef EMAX_IMPORT
