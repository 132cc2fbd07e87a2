// The errors that SYSTem:ERRor? reads, oldest first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/scpi/error_code.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// One error with the text that caused it, or with words on what to do.
struct ErrorEntry {
  static constexpr std::size_t kContextCapacity = 40;

  ErrorCode code = ErrorCode::kNoError;
  std::uint8_t context_length = 0;
  char context[kContextCapacity] = {};  ///< The text: printable, not terminated.
  const char* subject = nullptr;        ///< What the words are about; may be null.
  const char* words = nullptr;          ///< Null if there is a text.
};

/// A queue of 16 errors. When it is full the last one becomes -350,"Queue overflow" and new ones
/// are dropped until one is read. 0.8 KiB.
class ErrorQueue {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// @param[in] context What was wrong, often the offending text; may be empty. Cut to 40
  ///                    characters; what is not printable becomes a point.
  /// @returns False if the queue was full.
  bool push(ErrorCode code, Span<const char> context) noexcept;
  /// The same with words of any length, which are kept by their address.
  ///
  /// @param[in] subject What they are about, to be named before them; may be null.
  bool push(ErrorCode code, const char* subject, const char* words) noexcept;
  /// Takes the oldest error off the queue.
  ///
  /// @returns kNoError, without context, if there is none.
  ErrorEntry pop() noexcept;
  void clear() noexcept;
  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  /// @returns False only if memory was overwritten.
  bool consistent() const noexcept;

 private:
  ErrorEntry* take_place() noexcept;

  std::array<ErrorEntry, kCapacity> entries_ = {};
  std::uint8_t first_ = 0;
  std::uint8_t size_ = 0;
};

static_assert(std::is_trivially_copyable_v<ErrorQueue>);

}  // namespace emax::app::scpi
