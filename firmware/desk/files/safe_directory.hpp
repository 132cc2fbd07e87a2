// Directories and names that files are moved to: locks, leftovers, what may be replaced.
#pragma once

#include <string>
#include <vector>

namespace emax::desk {

/// An open directory, locked while the object lives (flock(2)): the kernel lets go of the lock with
/// the process, however that ends.
class DirectoryLock final {
 public:
  DirectoryLock() = default;
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;
  ~DirectoryLock() { release(); }

  /// Waits until nobody else has it.
  ///
  /// @returns False, with errno, if there is no such directory or it cannot be locked.
  bool take(const std::string& directory) noexcept;
  /// The same without waiting.
  bool try_take(const std::string& directory) noexcept;
  /// Writes what the directory knows to the disk. @returns False, with errno, if that fails.
  bool sync() const noexcept;
  void release() noexcept;

 private:
  bool take(const std::string& directory, int how) noexcept;

  int file_ = -1;
};

/// Makes a directory with all its parents.
///
/// @param[out] made The directories that are new, from the outermost on; also after an error.
/// @returns False, with errno, if that fails.
bool make_directories(const std::string& path, std::vector<std::string>& made);

/// @returns Whether there is something under this name that is no regular file: a directory, a
/// device, a FIFO, a symbolic link. Such a thing is never replaced.
bool is_irregular(const std::string& path) noexcept;

/// Writes a file's content to the disk. @returns False, with errno, if that fails.
bool sync_file(const std::string& path) noexcept;

/// Names in a directory that begin with `start`, but not "." and "..".
std::vector<std::string> names_in(const std::string& directory, const std::string& start);

/// Removes a directory with the regular files and links in it.
void remove_flat(const std::string& directory) noexcept;

}  // namespace emax::desk
