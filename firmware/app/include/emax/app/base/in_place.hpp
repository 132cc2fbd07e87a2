// Room for an object that is made at run time, from what is known only then.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace emax::app {

/// Memory for one `T` whose constructor takes arguments, or that shares its memory with others. As
/// a static object it is all zero, so it sits in .bss and needs no initialiser.
///
///     static InPlace<Instrument> memory;
///     Instrument& instrument = memory.make(...);
template <typename T>
class InPlace {
 public:
  /// Makes the object, in place: nothing passes over the stack. Once; what was made before is gone.
  template <typename... Arguments>
  T& make(Arguments&&... arguments) noexcept {
    return (new (bytes_) Made(std::forward<Arguments>(arguments)...))->object;
  }

 private:
  // Its own placement form of new: <new> is no header of a freestanding program.
  struct Made {
    template <typename... Arguments>
    explicit Made(Arguments&&... arguments) noexcept
        : object(std::forward<Arguments>(arguments)...) {}
    static void* operator new(std::size_t /*size*/, void* place) noexcept { return place; }

    T object;
  };
  static_assert(std::is_trivially_destructible_v<T>);

  alignas(Made) unsigned char bytes_[sizeof(Made)] = {};
};

}  // namespace emax::app
