// gnuplot as a child process.
#include "desk/pictures/gnuplot.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <string_view>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"

namespace emax::desk {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollInterval = 20;  // In milliseconds.
constexpr std::size_t kMostWords = 4096;

// Relative entries of the PATH are left out: they would be searched in the directory of the run.
std::string find_on_path(const char* program) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::string_view entry = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(entry.size() + 1, rest.size()));
    std::string candidate = std::string(entry) + "/" + program;
    struct stat status = {};
    if (entry.substr(0, 1) == "/" && access(candidate.c_str(), X_OK) == 0 &&
        stat(candidate.c_str(), &status) == 0 && S_ISREG(status.st_mode)) {
      return candidate;
    }
  }
  return {};
}

// The two ends of a pipe for what gnuplot complains of.
class Pipe final {
 public:
  Pipe() {
    if (pipe2(ends_, O_CLOEXEC | O_NONBLOCK) != 0) {
      ends_[0] = ends_[1] = -1;
    }
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }

  bool is_open() const noexcept { return ends_[0] >= 0; }
  int writer() const noexcept { return ends_[1]; }
  void close_writer() noexcept { close_end(1); }

  // Waits a little for words, and adds those that there are.
  void read_to(std::string& words) noexcept {
    pollfd ready = {ends_[0], POLLIN, 0};
    (void)poll(&ready, 1, kPollInterval);
    char piece[512];
    for (;;) {
      const ssize_t count = read(ends_[0], piece, sizeof piece);
      if (count <= 0) {
        // At the end of the words a poll would no longer wait.
        if (count == 0) {
          close_end(0);
        }
        return;
      }
      words.append(piece, std::min(static_cast<std::size_t>(count), kMostWords - words.size()));
    }
  }

 private:
  void close_end(std::size_t end) noexcept {
    if (ends_[end] >= 0) {
      close(ends_[end]);
      ends_[end] = -1;
    }
  }

  int ends_[2] = {-1, -1};
};

// gnuplot says where in several lines, and what in the last.
std::string last_line(std::string words) {
  while (!words.empty() && (words.back() == '\n' || words.back() == ' ')) {
    words.pop_back();
  }
  const std::size_t start = words.rfind('\n');
  return printable(start == std::string::npos ? words : words.substr(start + 1));
}

// Actions and attributes of posix_spawn().
class Spawn final {
 public:
  Spawn(const std::string& directory, int complaints) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, complaints, STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(&actions_, directory.c_str());
    sigset_t ignored;
    sigemptyset(&ignored);
    sigaddset(&ignored, SIGXFSZ);
    sigaddset(&ignored, SIGPIPE);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setsigdefault(&attributes_, &ignored);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF);
  }
  Spawn(const Spawn&) = delete;
  Spawn& operator=(const Spawn&) = delete;
  ~Spawn() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }

  int start(const std::string& program, const char* script, pid_t& child) const {
    // argv of exec() is not const, though nobody writes to it.
    std::string words[] = {"gnuplot", "--default-settings", script, "LC_ALL=C"};
    char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    char* environment[] = {words[3].data(), nullptr};
    return posix_spawn(&child, program.c_str(), &actions_, &attributes_, arguments, environment);
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

GnuplotRun failed(const std::string& reason) { return {GnuplotEnd::kFailed, reason}; }

GnuplotRun too_late(std::chrono::milliseconds longest) {
  StringSink reason;
  app::TextWriter(reason).text("it has not ended within ");
  app::TextWriter(reason).general(std::chrono::duration<double>(longest).count(), 6).text(" s");
  return failed(reason.text());
}

GnuplotRun wait_for(pid_t child, Pipe& complaints, std::chrono::milliseconds longest) {
  const Clock::time_point deadline = Clock::now() + longest;
  std::string words;
  int status = 0;
  for (;;) {
    complaints.read_to(words);
    if (waitpid(child, &status, WNOHANG) == child) {
      break;
    }
    const bool is_late = Clock::now() > deadline;
    if (is_late || stop_requested()) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return is_late ? too_late(longest) : GnuplotRun{GnuplotEnd::kStopped};
    }
  }
  if (stop_requested()) {
    return {GnuplotEnd::kStopped};
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    return {};
  }
  complaints.read_to(words);
  const std::string line = last_line(words);
  return failed(line.empty() ? "it has ended early" : line);
}

}  // namespace

GnuplotRun run_gnuplot(const std::string& directory, const char* script,
                       std::chrono::milliseconds longest) {
  const std::string program = find_on_path("gnuplot");
  if (program.empty()) {
    return {GnuplotEnd::kMissing};
  }
  Pipe complaints;
  if (!complaints.is_open()) {
    return failed(std::strerror(errno));
  }
  const Spawn spawn(directory, complaints.writer());
  pid_t child = 0;
  const int error = spawn.start(program, script, child);
  if (error != 0) {
    return failed(std::strerror(error));
  }
  complaints.close_writer();
  return wait_for(child, complaints, longest);
}

std::string gnuplot_string(const std::string& text) {
  std::string quoted = "'";
  bool is_quote = false;
  for (const char c : text) {
    if ((c == '\'') != is_quote) {
      is_quote = !is_quote;
      quoted += is_quote ? "'.\"" : "\".'";
    }
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + (is_quote ? "\"" : "'");
}

}  // namespace emax::desk
