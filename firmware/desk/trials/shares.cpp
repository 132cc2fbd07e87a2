// Work shared out to threads.
#include "desk/trials/shares.hpp"

#include <algorithm>
#include <system_error>
#include <thread>
#include <vector>

namespace emax::desk {

void share_out(std::size_t threads, std::size_t count,
               const std::function<void(const Share&)>& run) {
  const std::size_t shares = std::max<std::size_t>(std::min(threads, count), 1);
  std::vector<std::thread> helpers;
  helpers.reserve(shares);
  for (std::size_t index = 0; index < shares; ++index) {
    const std::size_t begin = count * index / shares;
    const Share share = {index, begin, count * (index + 1) / shares - begin};
    if (index + 1 == shares) {
      run(share);
      continue;
    }
    try {
      helpers.emplace_back(run, share);
    } catch (const std::system_error&) {
      run(share);
    }
  }
  for (std::thread& helper : helpers) {
    helper.join();
  }
}

}  // namespace emax::desk
