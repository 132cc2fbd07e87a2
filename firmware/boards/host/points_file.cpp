// A table of measured points from a file or from standard input.
#include "points_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <string_view>
#include <unistd.h>

#include "emax/app/points_reader.hpp"
#include "emax/app/reference_uncertainty.hpp"
#include "emax/app/text_writer.hpp"

#include "console.hpp"
#include "stop_request.hpp"

namespace emax::host {

namespace {

constexpr std::size_t kMaxFileSize = std::size_t{1} << 20;

constexpr int kPollInterval = 100;  // In milliseconds.

// A file that is open for reading, or -1 and errno.
class InputFile final {
 public:
  explicit InputFile(const std::string& path)
      : file_(path == "-" ? STDIN_FILENO : open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() {
    if (file_ > STDIN_FILENO) {
      close(file_);
    }
  }

  bool is_open() const noexcept { return file_ >= 0; }

  // As read(), but a stop request ends the wait for somebody who types.
  ssize_t read_some(char* data, std::size_t size) const noexcept {
    pollfd ready = {file_, POLLIN, 0};
    while (poll(&ready, 1, kPollInterval) == 0 && !stop_requested()) {
    }
    if (stop_requested()) {
      errno = EINTR;
      return -1;
    }
    return read(file_, data, size);
  }

 private:
  int file_;
};

Problem unreadable(const std::string& name, int error) {
  if (stop_requested()) {
    return stopped();
  }
  return bad_input(name + ": " + std::strerror(error) + "; expected a CSV file of measured points");
}

Problem read_text(const std::string& path, const std::string& name, std::string& text) {
  const InputFile file(path);
  if (!file.is_open()) {
    return unreadable(name, errno);
  }
  text.resize(kMaxFileSize + 1);
  std::size_t size = 0;
  ssize_t count = 1;
  while (count > 0 && size < text.size()) {
    count = file.read_some(&text[size], text.size() - size);
    size += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  if (count < 0) {
    return unreadable(name, errno);
  }
  text.resize(size);
  if (size > kMaxFileSize) {
    return bad_input(name + ": larger than 1 MiB; expected a table of at most 64 points");
  }
  return {};
}

Problem describe(const std::string& name, const app::PointsError& error) {
  if (error.problem == nullptr) {
    return {};
  }
  std::string line = name;
  if (error.line != 0) {
    line += ":" + std::to_string(error.line);
  }
  line += std::string(": ") + error.problem;
  if (error.expectation != nullptr) {
    line += std::string("; ") + error.expectation;
  }
  return bad_input(line);
}

app::PointsError parse(std::string_view text, app::PointsReader& reader) {
  reader.start();
  while (!text.empty() && reader.error().problem == nullptr) {
    const std::string_view line = text.substr(0, text.find('\n'));
    reader.add_line(Span<const char>(line.data(), line.size()));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return reader.finish();
}

Problem take_common(const std::string& name, const app::PointsReader& reader,
                    double reference_percent, FrequencyResponse& points) {
  const app::CommonRemoval removal = app::remove_common(points, reference_percent);
  if (removal.status == Status::kOk) {
    return {};
  }
  const ResponsePoint& point = points.points()[removal.bad_point];
  StringSink sink;
  app::TextWriter line(sink);
  line.text(":").integer(reader.line_of(removal.bad_point)).text(": the uncertainty at ");
  line.general(point.frequency_hz, 7).text(" Hz is ");
  line.general(200.0 * point.u_amplitude / point.amplitude, 4);
  line.text(" % of the amplitude, not above the reference's ").general(reference_percent, 4);
  line.text(" %; expected totals (k = 2) that contain it, or a smaller --reference-uncertainty");
  return bad_input(name + sink.text());
}

}  // namespace

std::string name_of_points(const std::string& path) {
  return path == "-" ? "standard input" : printable(path);
}

Problem read_points(const std::string& path, double reference_percent, FrequencyResponse& points) {
  const std::string name = name_of_points(path);
  std::string text;
  if (Problem problem = read_text(path, name, text)) {
    return problem;
  }
  if (text.empty()) {
    return bad_input(name + ": the file is empty; expected a table of 3 to 64 points");
  }
  static app::PointsReader reader;
  const app::PointsError error = parse(text, reader);
  points = reader.points();
  if (Problem problem = describe(name, error)) {
    return problem;
  }
  return take_common(name, reader, reference_percent, points);
}

}  // namespace emax::host
