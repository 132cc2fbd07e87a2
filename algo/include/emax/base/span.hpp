// A view of consecutive elements: pointer and count, nothing owned.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

namespace emax {

/// A view of `size()` elements that somebody else owns, like C++20's std::span with a dynamic
/// extent.
///
/// Converts from arrays and from a view of non-const elements. Indexing is not checked: an index
/// out of range is the caller's own error.
template <typename T>
class Span {
 public:
  constexpr Span() noexcept = default;
  constexpr Span(T* data, std::size_t size) noexcept : data_(data), size_(size) {}

  template <std::size_t kSize>
  constexpr Span(T (&array)[kSize]) noexcept : data_(array), size_(kSize) {}

  template <typename U, std::size_t kSize,
            typename = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  constexpr Span(std::array<U, kSize>& array) noexcept : data_(array.data()), size_(kSize) {}

  template <typename U, std::size_t kSize,
            typename = std::enable_if_t<std::is_convertible_v<const U (*)[], T (*)[]>>>
  constexpr Span(const std::array<U, kSize>& array) noexcept : data_(array.data()), size_(kSize) {}

  template <typename U, typename = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  constexpr Span(Span<U> other) noexcept : data_(other.data()), size_(other.size()) {}

  constexpr T* data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr T& operator[](std::size_t index) const noexcept { return data_[index]; }
  constexpr T* begin() const noexcept { return data_; }
  constexpr T* end() const noexcept { return data_ + size_; }

  /// The first `count` elements; `count` is at most `size()`.
  constexpr Span first(std::size_t count) const noexcept { return Span(data_, count); }
  /// The elements from `offset` on; `offset` is at most `size()`.
  constexpr Span from(std::size_t offset) const noexcept {
    return Span(data_ + offset, size_ - offset);
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace emax
