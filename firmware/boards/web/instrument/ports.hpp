// The instrument's hardware in a browser: each part hands on what the page's worker offers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/byte_stream.hpp"
#include "emax/hal/clock.hpp"
#include "emax/hal/store.hpp"

#include "imports.hpp"

namespace emax::web {

/// Messages between the page and its worker: they never fail, and as much goes out as is said.
class PageStream final : public hal::ByteStream {
 private:
  std::size_t do_read(Span<char> bytes) noexcept override {
    return emax_read(bytes.data(), bytes.size());
  }
  std::size_t do_write(Span<const char> bytes) noexcept override {
    emax_write(bytes.data(), bytes.size());
    return bytes.size();
  }
  bool do_connected() const noexcept override { return true; }
  std::uint32_t do_take_lost_count() noexcept override { return 0; }
  bool do_take_break() noexcept override { return emax_take_break() != 0; }
  bool do_waits_for_reader() const noexcept override { return true; }
};

/// The browser's clock, which steps by a tenth of a millisecond to make it hard to spy with.
class PageClock final : public hal::Clock {
 public:
  constexpr PageClock() noexcept : Clock(kResolution_us) {}

 private:
  static constexpr std::uint32_t kResolution_us = 100;

  std::uint64_t do_now_us() noexcept override { return static_cast<std::uint64_t>(emax_now_us()); }
};

/// Slots in bytes that the page keeps.
class PageStore final : public hal::Store {
 public:
  constexpr explicit PageStore(const hal::StoreFormat& format) noexcept : Store(format) {}

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override {
    emax_store_read(at(slot, offset), bytes.data(), bytes.size());
    return Status::kOk;
  }
  Status do_erase(std::uint32_t slot) noexcept override;
  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override {
    emax_store_write(at(slot, offset), unit.data(), unit.size());
    return Status::kOk;
  }

  std::size_t at(std::uint32_t slot, std::uint32_t offset) const noexcept {
    return std::size_t{slot} * format().slot_bytes + offset;
  }
};

}  // namespace emax::web
