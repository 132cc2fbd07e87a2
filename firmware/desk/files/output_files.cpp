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

// Of hidden directories: of a run that works, and of one whose files are being moved.
constexpr char kHidden[] = ".emax.";
constexpr char kCommitted[] = ".emax-complete";
constexpr char kDropped[] = ".dropped";  // In it: the names of files to remove,
constexpr char kAside[] = ".aside";      // and of those that get another name.

// Where a directory is sticky, as /tmp is, files of others can neither be replaced nor removed.
bool belongs_to_another(const std::string& directory, const std::string& path) noexcept {
  struct stat of_directory = {};
  struct stat of_file = {};
  const bool are_known =
      stat(directory.c_str(), &of_directory) == 0 && lstat(path.c_str(), &of_file) == 0;
  const uid_t user = geteuid();
  return are_known && (of_directory.st_mode & S_ISVTX) != 0 && user != 0 &&
         of_directory.st_uid != user && of_file.st_uid != user;
}

bool are_same(const std::string& path, const std::string& other) noexcept {
  struct stat status = {};
  struct stat of_other = {};
  return lstat(path.c_str(), &status) == 0 && lstat(other.c_str(), &of_other) == 0 &&
         status.st_ino == of_other.st_ino && status.st_dev == of_other.st_dev;
}

// What is no regular file is not ours to replace.
Problem check_replaceable(const std::string& path) {
  if (is_directory(path)) {
    return cannot_write(path, EISDIR);
  }
  return desk::is_irregular(path)
             ? bad_input("--out: " + printable(path) +
                         ": not a regular file; expected a directory without a device, FIFO or "
                         "link of this name")
             : Problem{};
}

bool is_complete_svg(const std::string& svg) {
  constexpr std::string_view kEnd = "</svg>";
  const std::size_t last = svg.find_last_not_of(" \n");
  return last != std::string::npos && last + 1 >= kEnd.size() &&
         svg.compare(last + 1 - kEnd.size(), kEnd.size(), kEnd) == 0;
}

Problem of_another(const std::string& path) {
  return bad_input("--out: " + printable(path) +
                   ": belongs to another user, and the directory is sticky; expected a directory "
                   "of your own");
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
  abandon();
  for (auto directory = made_.rbegin(); directory != made_.rend(); ++directory) {
    rmdir(directory->c_str());
  }
}

void OutputFiles::abandon() {
  if (!temporary_directory_.empty()) {
    desk::remove_flat(temporary_directory_);
  }
  temporary_directory_.clear();
  temporary_lock_.release();
  written_.clear();
  dropped_.clear();
  set_aside_.clear();
}

Problem OutputFiles::open(const std::string& directory) {
  directory_ = directory;
  if (!desk::make_directories(directory, made_)) {
    return bad_directory(directory, std::strerror(errno));
  }
  if (!is_directory(directory)) {
    return bad_directory(directory, "not a directory");
  }
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    return bad_directory(directory, std::strerror(errno));
  }
  clear_leftovers();
  return {};
}

// A hidden directory that nobody holds a lock of belongs to a run that was killed.
void OutputFiles::clear_leftovers() {
  desk::DirectoryLock lock;
  if (!lock.take(directory_)) {
    return;
  }
  (void)finish_moves(path_of(kCommitted));
  for (const std::string& name : desk::names_in(directory_, kHidden)) {
    desk::DirectoryLock left;
    if (left.try_take(path_of(name))) {
      desk::remove_flat(path_of(name));
    }
  }
}

Problem OutputFiles::make_temporary_directory() {
  if (!temporary_directory_.empty()) {
    return {};
  }
  desk::DirectoryLock lock;  // Nobody takes it for a leftover before it is locked.
  std::string path = path_of(std::string(kHidden) + "XXXXXX");
  if (!lock.take(directory_) || mkdtemp(path.data()) == nullptr) {
    return cannot_write(directory_, errno);
  }
  temporary_directory_ = path;
  return temporary_lock_.take(path) ? Problem{} : cannot_write(directory_, errno);
}

Problem OutputFiles::add_file(const char* plain_name, WriteText write, void* context) {
  const std::string name = prefix_ + plain_name;
  if (Problem problem = check_replaceable(path_of(name))) {
    return problem;
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
  const bool is_synced = sink.error() == 0 && fsync(fileno(file)) == 0;
  const int sync_error = is_synced ? 0 : errno;
  const bool closed = std::fclose(file) == 0;
  if (sink.error() != 0 || !is_synced || !closed) {
    const int error = sink.error() != 0 ? sink.error() : !is_synced ? sync_error : errno;
    return cannot_write(path_of(name), error);
  }
  return {};
}

bool OutputFiles::has(const char* name) const {
  return access(path_of(prefix_ + name).c_str(), F_OK) == 0;
}

void OutputFiles::keep(const std::string& name) {
  written_.push_back(name);
  dropped_.erase(std::remove(dropped_.begin(), dropped_.end(), name), dropped_.end());
}

Problem OutputFiles::draw(const char* script, Span<const char* const> pictures, Problem& remark) {
  for (const char* picture : pictures) {
    if (Problem problem = check_replaceable(path_of(picture))) {
      return problem;
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
    if (run.end == GnuplotEnd::kDone && desk::sync_file(temporary_path_of(picture))) {
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

// What is to be done beside moving files, for whoever finishes it.
Problem OutputFiles::write_list(const char* list_name, const std::vector<std::string>& names) {
  std::FILE* const list = std::fopen(temporary_path_of(list_name).c_str(), "wbx");
  if (list == nullptr) {
    return cannot_write(directory_, errno);
  }
  for (const std::string& name : names) {
    (void)std::fprintf(list, "%s\n", name.c_str());
  }
  const bool is_synced = std::fflush(list) == 0 && fsync(fileno(list)) == 0;
  const int error = errno;
  if (std::fclose(list) != 0 || !is_synced) {
    return cannot_write(directory_, is_synced ? errno : error);
  }
  return {};
}

Problem OutputFiles::commit() {
  if (Problem problem = make_temporary_directory()) {
    return problem;
  }
  for (const std::string& name : written_) {
    if (Problem problem = check_replaceable(path_of(name))) {
      return problem;
    }
  }
  for (const std::vector<std::string>* names : {&written_, &dropped_, &set_aside_}) {
    for (const std::string& name : *names) {
      if (belongs_to_another(directory_, path_of(name))) {
        return of_another(path_of(name));
      }
    }
  }
  Problem problem = write_list(kDropped, dropped_);
  problem = problem ? problem : write_list(kAside, set_aside_);
  if (problem) {
    return problem;
  }
  desk::DirectoryLock lock;
  if (!lock.take(directory_)) {
    return cannot_write(directory_, errno);
  }
  if (!finish_moves(path_of(kCommitted))) {
    return cannot_write(directory_, errno);
  }
  // From here on the run counts: whoever comes next finishes what is left of it.
  if (std::rename(temporary_directory_.c_str(), path_of(kCommitted).c_str()) != 0 || !lock.sync()) {
    return cannot_write(directory_, errno);
  }
  temporary_directory_.clear();
  written_.clear();
  made_.clear();
  return finish_moves(path_of(kCommitted)) && lock.sync()
             ? Problem{}
             : fault(printable(directory_) + ": " + std::strerror(errno) +
                     "; the next run with this --out moves the rest of the files");
}

// Moves the files of a complete run to where they belong; with the lock of the directory.
//
// @returns False, with errno, if a file cannot be moved; the next run tries again.
bool OutputFiles::finish_moves(const std::string& from) {
  if (!is_directory(from)) {
    return true;
  }
  std::ifstream aside(from + "/" + kAside);
  for (std::string name; std::getline(aside, name);) {
    if (name.find('/') == std::string::npos && name.find('.') != std::string::npos) {
      move_aside(name);
    }
  }
  std::ifstream dropped(from + "/" + kDropped);
  for (std::string name; std::getline(dropped, name);) {
    if (name.find('/') == std::string::npos && !desk::is_irregular(path_of(name))) {
      std::remove(path_of(name).c_str());
    }
  }
  for (const std::string& name : desk::names_in(from, "")) {
    std::string source = from;
    source += "/" + name;
    if (name != kDropped && name != kAside && !desk::is_irregular(path_of(name)) &&
        std::rename(source.c_str(), path_of(name).c_str()) != 0) {
      return false;
    }
  }
  desk::remove_flat(from);
  return true;
}

void OutputFiles::move_aside(const std::string& name) const {
  constexpr int kMostNumbers = 10'000;
  const std::size_t dot = name.rfind('.');
  for (int number = 1; number < kMostNumbers; ++number) {
    const std::string other =
        path_of(name.substr(0, dot) + "." + std::to_string(number) + name.substr(dot));
    // link() never replaces: of two runs at once each gets a number of its own. One that was killed
    // here has made the link already.
    if (link(path_of(name).c_str(), other.c_str()) == 0 || are_same(path_of(name), other)) {
      (void)unlink(path_of(name).c_str());
      return;
    }
    if (access(path_of(name).c_str(), F_OK) != 0 || access(other.c_str(), F_OK) != 0) {
      return;
    }
  }
}

}  // namespace emax::desk
