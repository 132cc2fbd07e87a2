// In the place of the header of this name: registers that a test answers for, so that drivers run
// on the PC as they are.
#pragma once

#include <cstdint>

namespace emax::test {

/// A chip as its registers show it. Each access takes a moment of its time.
class FakeChip {
 public:
  FakeChip(const FakeChip&) = delete;
  FakeChip& operator=(const FakeChip&) = delete;

  /// The one that was made last and still is there.
  static FakeChip& current() { return *current_; }

  virtual std::uint32_t read(std::uintptr_t address, unsigned bytes) = 0;
  virtual void write(std::uintptr_t address, std::uint32_t value) = 0;

 protected:
  FakeChip() : before_(current_) { current_ = this; }
  ~FakeChip() { current_ = before_; }

 private:
  static inline FakeChip* current_ = nullptr;
  FakeChip* const before_;
};

}  // namespace emax::test

namespace emax::board {

template <typename T>
class FakeRegister {
 public:
  explicit FakeRegister(std::uintptr_t address) : address_(address) {}
  FakeRegister(const FakeRegister&) = delete;

  operator T() const { return static_cast<T>(test::FakeChip::current().read(address_, sizeof(T))); }
  void operator=(std::uint32_t value) { test::FakeChip::current().write(address_, value); }
  void operator|=(std::uint32_t bits) { *this = *this | bits; }
  void operator&=(std::uint32_t bits) { *this = *this & bits; }

 private:
  const std::uintptr_t address_;
};

template <typename T = std::uint32_t>
FakeRegister<T> reg(std::uintptr_t address) noexcept {
  return FakeRegister<T>(address);
}

}  // namespace emax::board
