// Directories and names that files are moved to: locks, leftovers, what may be replaced.
#include "desk/files/safe_directory.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace emax::desk {

bool DirectoryLock::take(const std::string& directory, int how) noexcept {
  release();
  file_ = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file_ < 0) {
    return false;
  }
  while (flock(file_, how) != 0) {
    if (errno != EINTR) {
      const int error = errno;
      release();
      errno = error;
      return false;
    }
  }
  return true;
}

bool DirectoryLock::take(const std::string& directory) noexcept { return take(directory, LOCK_EX); }

bool DirectoryLock::try_take(const std::string& directory) noexcept {
  return take(directory, LOCK_EX | LOCK_NB);
}

bool DirectoryLock::sync() const noexcept {
  // Some file systems cannot do that for a directory; then there is nothing to wait for.
  return fsync(file_) == 0 || errno == EINVAL;
}

void DirectoryLock::release() noexcept {
  if (file_ >= 0) {
    close(file_);
    file_ = -1;
  }
}

bool make_directories(const std::string& path, std::vector<std::string>& made) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    if (mkdir(part.c_str(), 0777) == 0) {
      made.push_back(part);
    } else if (errno != EEXIST && (end == std::string::npos || errno != EACCES)) {
      return false;
    }
    if (end == std::string::npos) {
      return true;
    }
  }
}

bool is_irregular(const std::string& path) noexcept {
  struct stat status = {};
  return lstat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

bool sync_file(const std::string& path) noexcept {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return false;
  }
  const bool is_synced = fsync(file) == 0;
  const int error = errno;
  close(file);
  errno = error;
  return is_synced;
}

std::vector<std::string> names_in(const std::string& directory, const std::string& start) {
  std::vector<std::string> names;
  DIR* const open_directory = opendir(directory.c_str());
  if (open_directory == nullptr) {
    return names;
  }
  while (const dirent* entry = readdir(open_directory)) {
    const std::string name = static_cast<const char*>(entry->d_name);
    if (name != "." && name != ".." && name.compare(0, start.size(), start) == 0) {
      names.push_back(name);
    }
  }
  closedir(open_directory);
  return names;
}

void remove_flat(const std::string& directory) noexcept {
  for (const std::string& name : names_in(directory, "")) {
    std::string path = directory;
    path += "/" + name;
    (void)unlink(path.c_str());
  }
  (void)rmdir(directory.c_str());
}

}  // namespace emax::desk
