// The files of one run in a directory: all of them, complete, or none.
#pragma once

#include <string>
#include <vector>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"
#include "desk/files/safe_directory.hpp"

namespace emax::desk {

/// Writes files into a hidden directory inside the one they are for, and moves them there at the
/// end, so that neither an error nor Ctrl-C leaves part of a run behind. The hidden directory is
/// locked while its run lives; the next run removes those of runs that were killed. What is moved
/// is on the disk before, and the moves of one run are complete before those of another begin: the
/// hidden directory gets another name when it is complete, and the next run finishes the moves of
/// one that was killed in the middle of them. Only regular files are replaced, never a device, a
/// FIFO, a directory or what a symbolic link names.
///
///     if (Problem problem = files.open(directory)) ...     before the long work
///     if (Problem problem = files.add("report.txt", write)) ...
///     if (Problem problem = files.draw("pictures.gp", pictures, remark)) ...
///     if (Problem problem = files.commit()) ...
///
/// Without `commit()` the destructor removes what there is, the directory too if it is new.
class OutputFiles final {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// Makes the directory and its parents if they are missing, checks that it can be written to, and
  /// clears away what a killed run has left.
  Problem open(const std::string& directory);

  /// Writes one file.
  ///
  /// @param[in] write Called with a TextWriter.
  template <typename Write>
  Problem add(const char* name, Write write);

  /// Has gnuplot run a script that has been added. Either all of its pictures are files of this run
  /// then, or none is, and those of an earlier run go.
  ///
  /// @param[in]  pictures The names of the SVG files that the script makes.
  /// @param[out] remark   Why there are none: that there is no gnuplot (kDone), or its fault. What
  ///                      else there is can be kept.
  /// @returns What ends the run, if there is something.
  Problem draw(const char* script, Span<const char* const> pictures, Problem& remark);

  /// @returns What a file of this run holds, before `commit()`; empty if there is none.
  std::string content_of(const char* name) const;

  /// @returns Whether the directory holds a file of this name.
  bool has(const char* name) const;

  /// Names of files added or dropped from now on begin with this, so that others are kept.
  void set_prefix(const char* prefix) { prefix_ = prefix; }
  const std::string& prefix() const noexcept { return prefix_; }

  /// Has a file of an earlier run, which this run has none of, get a new name by `commit()`:
  /// "table.1.csv" for "table.csv", or the next number that is free.
  void set_aside(const char* name) { set_aside_.emplace_back(prefix_ + name); }

  /// Has a file of an earlier run removed by `commit()`, unless this run comes to add one of that
  /// name.
  void drop(const char* name) { dropped_.emplace_back(prefix_ + name); }

  /// Puts all files in place, over those of an earlier run.
  Problem commit();

  /// Takes back all that has been added, dropped or set aside, which makes room on a full disk.
  void abandon();

 private:
  using WriteText = void (*)(void* context, app::TextWriter& out);

  Problem add_file(const char* name, WriteText write, void* context);
  std::string path_of(const std::string& name) const { return directory_ + "/" + name; }
  std::string temporary_path_of(const std::string& name) const {
    return temporary_directory_ + "/" + name;
  }
  Problem make_temporary_directory();
  void keep(const std::string& name);
  void clear_leftovers();
  bool finish_moves(const std::string& from);
  Problem write_list(const char* list_name, const std::vector<std::string>& names);
  void move_aside(const std::string& name) const;

  std::string directory_;
  std::string temporary_directory_;   // Empty before the first file.
  std::vector<std::string> written_;  // Still in the temporary directory.
  std::vector<std::string> dropped_;
  std::vector<std::string> set_aside_;
  std::vector<std::string> made_;  // Directories that are new; none once there are files in them.
  std::string prefix_;
  desk::DirectoryLock temporary_lock_;
};

template <typename Write>
Problem OutputFiles::add(const char* name, Write write) {
  return add_file(
      name, [](void* context, app::TextWriter& out) { (*static_cast<Write*>(context))(out); },
      &write);
}

}  // namespace emax::desk
