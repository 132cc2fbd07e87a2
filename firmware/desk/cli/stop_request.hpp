// Ctrl-C and requests to terminate, noted for the next moment at which the work can end cleanly.
#pragma once

namespace emax::desk {

/// From here on SIGINT, SIGTERM and SIGHUP only leave a note, unless they were ignored before, and
/// interrupt what waits. A file that grows beyond the permitted size is an error of the write.
void watch_for_stop_requests() noexcept;

bool stop_requested() noexcept;

}  // namespace emax::desk
