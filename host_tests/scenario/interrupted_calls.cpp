// Preloaded into the program: counts the calls that change files, and ends the process or fails the
// call at a number given by EMAX_KILL_AT or EMAX_FAIL_AT. EMAX_COUNT_FILE gets the number of calls.
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

int number_from(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? -1 : std::atoi(text);
}

// What comes once the program has ended, as the counts of a build that counts branches, is not the
// program's.
bool has_ended = false;

[[gnu::constructor]] void watch_the_end() {
  (void)std::atexit([] { has_ended = true; });
}

// @returns Whether this call is to fail.
bool is_struck() {
  if (has_ended) {
    return false;
  }
  static int calls = 0;
  ++calls;
  if (calls == number_from("EMAX_KILL_AT")) {
    (void)raise(SIGKILL);
  }
  if (calls == number_from("EMAX_FAIL_AT")) {
    errno = ENOSPC;
    return true;
  }
  return false;
}

template <typename Function>
Function next(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  Function function = nullptr;
  static_assert(sizeof function == sizeof found);
  std::memcpy(&function, &found, sizeof found);
  return function;
}

}  // namespace

extern "C" {

int fsync(int file) { return is_struck() ? -1 : next<int (*)(int)>("fsync")(file); }

int rename(const char* from, const char* to) noexcept {
  return is_struck() ? -1 : next<int (*)(const char*, const char*)>("rename")(from, to);
}

int link(const char* from, const char* to) noexcept {
  return is_struck() ? -1 : next<int (*)(const char*, const char*)>("link")(from, to);
}

int unlink(const char* path) noexcept {
  return is_struck() ? -1 : next<int (*)(const char*)>("unlink")(path);
}

int mkdir(const char* path, mode_t mode) noexcept {
  return is_struck() ? -1 : next<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}

char* mkdtemp(char* path) noexcept {
  return is_struck() ? nullptr : next<char* (*)(char*)>("mkdtemp")(path);
}

FILE* fopen(const char* path, const char* mode) {
  return is_struck() ? nullptr : next<FILE* (*)(const char*, const char*)>("fopen")(path, mode);
}

// A buffer of the library goes to the disk about once in so many bytes; only then can a write fail.
size_t fwrite(const void* text, size_t size, size_t count, FILE* file) {
  using Write = size_t (*)(const void*, size_t, size_t, FILE*);
  constexpr size_t kBuffer = 4096;
  static size_t written = 0;
  const size_t before = written / kBuffer;
  written += file == stdout || file == stderr ? 0 : size * count;
  const bool fails = written / kBuffer != before && is_struck();
  return fails ? 0 : next<Write>("fwrite")(text, size, count, file);
}

int fflush(FILE* file) {
  const bool is_counted = file != stdout && file != stderr && file != nullptr;
  return is_counted && is_struck() ? EOF : next<int (*)(FILE*)>("fflush")(file);
}

int fclose(FILE* file) {
  const bool fails = is_struck();
  const int error = errno;
  const int result = next<int (*)(FILE*)>("fclose")(file);
  errno = fails ? error : errno;
  return fails ? EOF : result;
}

int remove(const char* path) noexcept {
  return is_struck() ? -1 : next<int (*)(const char*)>("remove")(path);
}

int rmdir(const char* path) noexcept {
  return is_struck() ? -1 : next<int (*)(const char*)>("rmdir")(path);
}
}
