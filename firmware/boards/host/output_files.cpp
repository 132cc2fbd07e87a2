// The files of one run in a directory: all of them, complete, or none.
#include "output_files.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>

#include "console.hpp"
#include "stop_request.hpp"

namespace emax::host {

namespace {

bool is_directory(const std::string& path) noexcept {
  struct stat status = {};
  return stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
}

// Full or broken is a fault of the machine; the rest is a directory badly chosen.
Problem cannot_write(const std::string& path, int error) {
  if (stop_requested()) {
    return stopped();
  }
  const std::string line = printable(path) + ": " + std::strerror(error);
  if (error == EACCES || error == EPERM || error == EROFS || error == EISDIR) {
    return bad_input("--out: " + line + "; expected a directory that can be written to");
  }
  return fault(line + "; no files have been kept");
}

Problem bad_directory(const std::string& directory, const char* problem) {
  return bad_input("--out: " + printable(directory) + ": " + problem +
                   "; expected a directory that can be written to, or a new one in one that can");
}

}  // namespace

OutputFiles::~OutputFiles() {
  for (const std::string& name : written_) {
    std::remove(temporary_path_of(name).c_str());
  }
  if (directory_is_new_) {
    rmdir(directory_.c_str());
  }
}

std::string OutputFiles::temporary_path_of(const std::string& name) const {
  return path_of("." + name + "." + std::to_string(getpid()));
}

Problem OutputFiles::open(const std::string& directory) {
  directory_ = directory;
  if (mkdir(directory.c_str(), 0777) == 0) {
    directory_is_new_ = true;
  } else if (errno != EEXIST) {
    return bad_directory(directory, std::strerror(errno));
  }
  if (!is_directory(directory)) {
    return bad_directory(directory, "not a directory");
  }
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    return bad_directory(directory, std::strerror(errno));
  }
  return {};
}

Problem OutputFiles::add_file(const char* name, WriteText write, void* context) {
  if (is_directory(path_of(name))) {
    return cannot_write(path_of(name), EISDIR);
  }
  const std::string temporary = temporary_path_of(name);
  std::remove(temporary.c_str());
  std::FILE* file = std::fopen(temporary.c_str(), "wbx");
  if (file == nullptr) {
    return cannot_write(path_of(name), errno);
  }
  written_.emplace_back(name);
  FileSink sink(file);
  app::TextWriter writer(sink);
  write(context, writer);
  sink.flush();
  errno = 0;
  const bool closed = std::fclose(file) == 0;
  if (sink.error() != 0 || !closed) {
    return cannot_write(path_of(name), sink.error() != 0 ? sink.error() : errno);
  }
  return {};
}

Problem OutputFiles::commit() {
  while (!written_.empty()) {
    const std::string& name = written_.back();
    if (std::rename(temporary_path_of(name).c_str(), path_of(name).c_str()) != 0) {
      return cannot_write(path_of(name), errno);
    }
    written_.pop_back();
    directory_is_new_ = false;
  }
  for (const std::string& name : dropped_) {
    std::remove(path_of(name).c_str());
  }
  return {};
}

}  // namespace emax::host
