#include "chip/events.hpp"

namespace emax::chip {

Events::Id Events::at(Time due, Action action) {
  ++last_;
  waiting_.emplace(std::make_pair(due, last_), std::move(action));
  due_.emplace(last_, due);
  return last_;
}

void Events::cancel(Id id) {
  const auto found = due_.find(id);
  if (found == due_.end()) {
    return;
  }
  waiting_.erase({found->second, id});
  due_.erase(found);
}

void Events::clear() {
  waiting_.clear();
  due_.clear();
}

void Events::run_due() {
  const Time end = now_;
  while (next() <= end) {
    const auto first = waiting_.begin();
    const Action action = std::move(first->second);
    now_ = first->first.first;
    due_.erase(first->first.second);
    waiting_.erase(first);
    action();
  }
  now_ = end;
}

}  // namespace emax::chip
