// One file that appears under its name when it is complete.
#pragma once

#include <cstdio>
#include <string>

#include "emax/app/base/text_writer.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Written under a hidden name beside its own, ".emax.NAME.PID", and renamed at the end. While the
/// object lives it holds a lock of the hidden file (flock(2)), so that the next run knows what a
/// killed one has left, and removes it.
///
///     SingleFile file(path);
///     Problem problem = file.open();  // Before the long work: is there room for it at all?
///     problem = file.write([&](app::TextWriter& out) { ... });
class SingleFile final {
 public:
  /// @param[in] path Empty for no file: all functions then do nothing.
  explicit SingleFile(std::string path);
  SingleFile(const SingleFile&) = delete;
  SingleFile& operator=(const SingleFile&) = delete;
  ~SingleFile();

  /// Makes the hidden file. What is no regular file is never replaced.
  Problem open();

  /// Writes the content and gives the file its name; an old file stays where that fails.
  template <typename Write>
  Problem write(const Write& write) {
    if (file_ == nullptr) {
      return {};
    }
    FileSink sink(file_);
    app::TextWriter out(sink);
    write(out);
    sink.flush();
    return finish(sink.error());
  }

 private:
  void remove_leftovers() const;
  Problem finish(int error);

  std::string path_;
  std::string directory_;
  std::string start_;      ///< Of every hidden name for this file.
  std::string temporary_;  ///< Path of ours.
  std::FILE* file_ = nullptr;
};

}  // namespace emax::desk
