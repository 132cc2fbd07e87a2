// The files of one run in a directory: all of them, complete, or none.
#include "desk/files/output_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/pictures/gnuplot.hpp"

namespace emax::desk {

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

bool is_complete_svg(const std::string& svg) {
  constexpr std::string_view kEnd = "</svg>";
  const std::size_t last = svg.find_last_not_of(" \n");
  return last != std::string::npos && last + 1 >= kEnd.size() &&
         svg.compare(last + 1 - kEnd.size(), kEnd.size(), kEnd) == 0;
}

Problem describe(const GnuplotRun& run, const std::string& directory, const char* script) {
  switch (run.end) {
    case GnuplotEnd::kDone:
    case GnuplotEnd::kStopped:
      return {};
    case GnuplotEnd::kMissing:
      return {ExitStatus::kDone, "no pictures: there is no gnuplot; install it (package " +
                                     std::string("gnuplot-nox) and run gnuplot ") + script +
                                     " in " + printable(directory)};
    case GnuplotEnd::kFailed:
      break;
  }
  return fault("no pictures: gnuplot: " + run.reason + "; all other files have been kept");
}

}  // namespace

OutputFiles::~OutputFiles() {
  for (const std::string& name : written_) {
    std::remove(temporary_path_of(name).c_str());
  }
  if (!temporary_directory_.empty()) {
    rmdir(temporary_directory_.c_str());
  }
  if (directory_is_new_) {
    rmdir(directory_.c_str());
  }
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

Problem OutputFiles::make_temporary_directory() {
  if (!temporary_directory_.empty()) {
    return {};
  }
  std::string path = path_of(".emax.XXXXXX");
  if (mkdtemp(path.data()) == nullptr) {
    return cannot_write(directory_, errno);
  }
  temporary_directory_ = path;
  return {};
}

Problem OutputFiles::add_file(const char* name, WriteText write, void* context) {
  if (is_directory(path_of(name))) {
    return cannot_write(path_of(name), EISDIR);
  }
  if (Problem problem = make_temporary_directory()) {
    return problem;
  }
  std::FILE* file = std::fopen(temporary_path_of(name).c_str(), "wbx");
  if (file == nullptr) {
    return cannot_write(path_of(name), errno);
  }
  keep(name);
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

void OutputFiles::keep(const std::string& name) {
  written_.push_back(name);
  dropped_.erase(std::remove(dropped_.begin(), dropped_.end(), name), dropped_.end());
}

Problem OutputFiles::draw(const char* script, Span<const char* const> pictures, Problem& remark) {
  for (const char* picture : pictures) {
    if (is_directory(path_of(picture))) {
      return cannot_write(path_of(picture), EISDIR);
    }
  }
  GnuplotRun run = run_gnuplot(temporary_directory_, script);
  // A full disk is nothing to gnuplot.
  for (const char* picture : pictures) {
    if (run.end == GnuplotEnd::kDone && !is_complete_svg(content_of(picture))) {
      run = {GnuplotEnd::kFailed, std::string(picture) + " is not complete"};
    }
  }
  for (const char* picture : pictures) {
    if (run.end == GnuplotEnd::kDone) {
      keep(picture);
    } else {
      std::remove(temporary_path_of(picture).c_str());
      drop(picture);
    }
  }
  if (run.end == GnuplotEnd::kStopped) {
    return stopped();
  }
  remark = describe(run, directory_, script);
  return {};
}

std::string OutputFiles::content_of(const char* name) const {
  std::ifstream file(temporary_path_of(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
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

}  // namespace emax::desk
