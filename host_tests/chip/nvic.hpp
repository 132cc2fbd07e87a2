// Which exception comes next: enabled, pending and active ones, and their priorities (Armv7-M
// Architecture Reference Manual, B1.5.4 and B3.4).
#pragma once

#include <array>
#include <cstdint>

namespace emax::chip {

inline constexpr unsigned kNmi = 2;
inline constexpr unsigned kHardFault = 3;
inline constexpr unsigned kMemManage = 4;
inline constexpr unsigned kBusFault = 5;
inline constexpr unsigned kUsageFault = 6;
inline constexpr unsigned kSvCall = 11;
inline constexpr unsigned kPendSv = 14;
inline constexpr unsigned kSysTick = 15;
/// The first interrupt's exception number.
inline constexpr unsigned kFirstInterrupt = 16;
inline constexpr unsigned kInterruptLines = 160;

/// What in the processor keeps exceptions away.
struct ExceptionMasks {
  bool primask = false;
  bool faultmask = false;
  std::uint8_t basepri = 0;
};

/// The state of all exceptions, four bits of priority as in all chips of this family.
class Nvic {
 public:
  void reset();

  void enable(unsigned exception, bool on);
  bool enabled(unsigned exception) const { return state_.at(exception).enabled; }
  void pend(unsigned exception, bool on);
  bool pending(unsigned exception) const { return state_.at(exception).pending; }
  bool active(unsigned exception) const { return state_.at(exception).active; }
  void set_priority(unsigned exception, std::uint8_t priority);
  std::uint8_t priority(unsigned exception) const { return state_.at(exception).priority; }
  /// Bits of the priority that decide between handlers only where two are pending: AIRCR.PRIGROUP.
  void set_group(unsigned group);

  /// The level of an interrupt's wire; a high one makes it pending as often as its handler ends.
  void set_line(unsigned exception, bool high);
  bool line(unsigned exception) const { return state_.at(exception).line; }

  /// Something is pending and enabled that would interrupt what runs now, were there no masks.
  bool attention() const { return next_ != 0 && rank(next_) < running_rank_; }
  /// @returns The exception to enter now, or zero.
  unsigned next(const ExceptionMasks& masks) const;
  /// Something is pending and enabled that ends a WFI, masked by PRIMASK or not.
  bool wakes(const ExceptionMasks& masks) const;
  /// Whether a fault may be entered now, or becomes a HardFault.
  bool can_enter(unsigned exception, const ExceptionMasks& masks) const;

  void enter(unsigned exception);
  void leave(unsigned exception);
  bool anything_active() const { return running_rank_ < kThread; }

 private:
  static constexpr int kThread = 256;
  struct State {
    bool enabled = false;
    bool pending = false;
    bool active = false;
    bool line = false;
    std::uint8_t priority = 0;
  };

  int group_priority(unsigned exception) const;
  /// Group priority of an exception that may come.
  int rank(unsigned exception) const { return group_priority(exception); }
  int masked_rank(const ExceptionMasks& masks) const;
  void refresh();

  std::array<State, kFirstInterrupt + kInterruptLines> state_ = {};
  unsigned group_ = 0;
  unsigned next_ = 0;
  int running_rank_ = kThread;
};

}  // namespace emax::chip
