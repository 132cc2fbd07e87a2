// The files of one run in a directory: all of them, complete, or none.
#pragma once

#include <string>
#include <vector>

#include "emax/app/text_writer.hpp"

#include "problem.hpp"

namespace emax::host {

/// Writes files under temporary names and gives them their own at the end, so that neither an error
/// nor Ctrl-C leaves part of a run behind.
///
///     if (Problem problem = files.open(directory)) ...     before the long work
///     if (Problem problem = files.add("report.txt", write)) ...
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

  /// Has a file of an earlier run removed by `commit()`, because this run has none of that name.
  void drop(const char* name) { dropped_.emplace_back(name); }

  /// Puts all files in place, over those of an earlier run.
  Problem commit();

 private:
  using WriteText = void (*)(void* context, app::TextWriter& out);

  Problem add_file(const char* name, WriteText write, void* context);
  std::string path_of(const std::string& name) const { return directory_ + "/" + name; }
  std::string temporary_path_of(const std::string& name) const;

  std::string directory_;
  std::vector<std::string> written_;  // Still under their temporary names.
  std::vector<std::string> dropped_;
  bool directory_is_new_ = false;
};

template <typename Write>
Problem OutputFiles::add(const char* name, Write write) {
  return add_file(
      name, [](void* context, app::TextWriter& out) { (*static_cast<Write*>(context))(out); },
      &write);
}

}  // namespace emax::host
