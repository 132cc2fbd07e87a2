// One file that appears under its name when it is complete.
#include "desk/files/single_file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

#include "desk/files/safe_directory.hpp"

namespace emax::desk {

namespace {

bool is_number(const std::string& text) noexcept {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

// Of a run that is no more: nobody holds its lock.
void remove_if_left(const std::string& path) noexcept {
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) {
    return;
  }
  if (!is_irregular(path) && flock(file, LOCK_EX | LOCK_NB) == 0) {
    (void)unlink(path.c_str());
  }
  (void)close(file);
}

}  // namespace

SingleFile::SingleFile(std::string path) : path_(std::move(path)) {
  const std::size_t slash = path_.rfind('/');
  const bool is_here = slash == std::string::npos;
  directory_ = is_here ? "./" : path_.substr(0, slash + 1);
  start_ = ".emax." + (is_here ? path_ : path_.substr(slash + 1)) + ".";
  temporary_ = directory_ + start_ + std::to_string(getpid());
}

SingleFile::~SingleFile() {
  if (file_ != nullptr) {
    (void)std::fclose(file_);
    (void)unlink(temporary_.c_str());
  }
}

Problem SingleFile::open() {
  if (path_.empty()) {
    return {};
  }
  if (is_irregular(path_)) {
    return bad_input("--out: " + printable(path_) +
                     ": not a regular file; expected the name of a new file or of one to replace");
  }
  DirectoryLock lock;  // Nobody takes the hidden file for a leftover before it is locked.
  if (lock.take(directory_)) {
    remove_leftovers();
  }
  file_ = std::fopen(temporary_.c_str(), "wbx");
  if (file_ == nullptr) {
    return bad_input("--out: " + printable(path_) + ": " + std::strerror(errno) +
                     "; expected a file in a directory that can be written to");
  }
  (void)flock(fileno(file_), LOCK_EX | LOCK_NB);
  return {};
}

void SingleFile::remove_leftovers() const {
  for (const std::string& name : names_in(directory_, start_)) {
    if (is_number(name.substr(start_.size()))) {
      remove_if_left(directory_ + name);
    }
  }
}

// @param[in] error errno of the first write that has failed; 0 if none has.
Problem SingleFile::finish(int error) {
  if (error == 0 && fsync(fileno(file_)) != 0) {
    error = errno;
  }
  if (error == 0 && is_irregular(path_)) {
    error = EISDIR;
  }
  // Renamed before it is closed: with its lock the hidden name is never a leftover.
  if (error == 0 && std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    error = errno;
  }
  if (error != 0) {
    (void)unlink(temporary_.c_str());
  }
  (void)std::fclose(file_);
  file_ = nullptr;
  return error == 0
             ? Problem{}
             : fault(printable(path_) + ": " + std::strerror(error) + "; it has not been kept");
}

}  // namespace emax::desk
