#include "chip/nvic.hpp"

#include <algorithm>

namespace emax::chip {
namespace {

constexpr int kFaultMaskRank = -1;

/// Four bits are implemented, the upper ones.
constexpr std::uint8_t kPriorityBits = 0xF0;

}  // namespace

void Nvic::reset() {
  for (State& state : state_) {
    const bool line = state.line;
    state = {};
    state.line = line;
  }
  for (const unsigned always : {kNmi, kHardFault, kSvCall, kPendSv, kSysTick}) {
    state_.at(always).enabled = true;
  }
  group_ = 0;
  refresh();
}

void Nvic::enable(unsigned exception, bool on) {
  state_.at(exception).enabled = on;
  refresh();
}

void Nvic::pend(unsigned exception, bool on) {
  state_.at(exception).pending = on;
  refresh();
}

void Nvic::set_priority(unsigned exception, std::uint8_t priority) {
  state_.at(exception).priority = priority & kPriorityBits;
  refresh();
}

void Nvic::set_group(unsigned group) {
  group_ = group;
  refresh();
}

void Nvic::set_line(unsigned exception, bool high) {
  State& state = state_.at(exception);
  if (high && !state.line) {
    state.pending = true;
  }
  if (high != state.line) {
    state.line = high;
    refresh();
  }
}

int Nvic::group_priority(unsigned exception) const {
  if (exception == kNmi) {
    return -2;
  }
  if (exception == kHardFault) {
    return -1;
  }
  return state_.at(exception).priority & ~((2 << group_) - 1) & 0xFF;
}

int Nvic::masked_rank(const ExceptionMasks& masks) const {
  int rank = running_rank_;
  if (masks.basepri != 0) {
    rank = std::min(rank, masks.basepri & ~((2 << group_) - 1) & 0xFF);
  }
  if (masks.primask) {
    rank = std::min(rank, 0);
  }
  if (masks.faultmask) {
    rank = std::min(rank, kFaultMaskRank);
  }
  return rank;
}

unsigned Nvic::next(const ExceptionMasks& masks) const {
  return next_ != 0 && rank(next_) < masked_rank(masks) ? next_ : 0;
}

bool Nvic::wakes(const ExceptionMasks& masks) const {
  ExceptionMasks open = masks;
  open.primask = false;
  return next(open) != 0;
}

bool Nvic::can_enter(unsigned exception, const ExceptionMasks& masks) const {
  return state_.at(exception).enabled && rank(exception) < masked_rank(masks);
}

void Nvic::enter(unsigned exception) {
  state_.at(exception).pending = false;
  state_.at(exception).active = true;
  refresh();
}

void Nvic::leave(unsigned exception) {
  State& state = state_.at(exception);
  state.active = false;
  if (state.line) {
    state.pending = true;
  }
  refresh();
}

void Nvic::refresh() {
  next_ = 0;
  running_rank_ = kThread;
  int best = 2 * kThread;
  for (unsigned exception = kNmi; exception < state_.size(); ++exception) {
    const State& state = state_[exception];
    if (state.active) {
      running_rank_ = std::min(running_rank_, group_priority(exception));
    }
    if (state.pending && state.enabled) {
      // Group first, then the whole priority, then the lower number.
      const int order = exception <= kHardFault ? group_priority(exception) : state.priority;
      if (order < best) {
        best = order;
        next_ = exception;
      }
    }
  }
}

}  // namespace emax::chip
