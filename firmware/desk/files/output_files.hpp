// The files of one run in a directory: all of them, complete, or none.
#pragma once

#include <string>
#include <vector>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Writes files into a hidden directory inside the one they are for, and moves them there at the
/// end, so that neither an error nor Ctrl-C leaves part of a run behind.
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

  /// Makes the directory if it is missing (not its parents), and checks that it can be written to.
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

  /// Has a file of an earlier run removed by `commit()`, unless this run comes to add one of that
  /// name.
  void drop(const char* name) { dropped_.emplace_back(name); }

  /// Puts all files in place, over those of an earlier run.
  Problem commit();

 private:
  using WriteText = void (*)(void* context, app::TextWriter& out);

  Problem add_file(const char* name, WriteText write, void* context);
  std::string path_of(const std::string& name) const { return directory_ + "/" + name; }
  std::string temporary_path_of(const std::string& name) const {
    return temporary_directory_ + "/" + name;
  }
  Problem make_temporary_directory();
  void keep(const std::string& name);

  std::string directory_;
  std::string temporary_directory_;   // Empty before the first file.
  std::vector<std::string> written_;  // Still in the temporary directory.
  std::vector<std::string> dropped_;
  bool directory_is_new_ = false;
};

template <typename Write>
Problem OutputFiles::add(const char* name, Write write) {
  return add_file(
      name, [](void* context, app::TextWriter& out) { (*static_cast<Write*>(context))(out); },
      &write);
}

}  // namespace emax::desk
