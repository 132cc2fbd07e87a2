// Ctrl-C and requests to terminate.
#include "desk/cli/stop_request.hpp"

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction() is not in <csignal>.

namespace emax::desk {

namespace {

volatile sig_atomic_t g_stop_requested = 0;

extern "C" void note_stop_request(int /*signal*/) { g_stop_requested = 1; }

void watch_for(int signal) noexcept {
  struct sigaction action = {};
  if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) {
    return;
  }
  action = {};
  action.sa_handler = note_stop_request;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void watch_for_stop_requests() noexcept {
  watch_for(SIGINT);
  watch_for(SIGTERM);
  watch_for(SIGHUP);
  signal(SIGXFSZ, SIG_IGN);
}

bool stop_requested() noexcept { return g_stop_requested != 0; }

}  // namespace emax::desk
