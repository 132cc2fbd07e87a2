// A file with a first page of its own, and slots in the pages behind it.
#include "file_store.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "desk/cli/console.hpp"

namespace emax::host {

namespace {

constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kStoreBytes =
    std::size_t{kFileStoreFormat.slot_count} * kFileStoreFormat.slot_bytes;
constexpr std::size_t kFileBytes = kPageBytes + kStoreBytes;
constexpr const char* kExpectation = "expected a file that --store has made, or a new name";

using Page = std::array<std::uint8_t, kPageBytes>;

// With slots of 4096 bytes, too short for the settings of a PC. The title of a later version has to
// differ from this one in more than kMostFlippedBits.
constexpr char kFirstTitle[] = "emax store 1\n";
constexpr char kTitle[] = "emax store 2\n";
constexpr std::size_t kTitleBytes = sizeof(kTitle) - 1;

Page title_page() noexcept {
  Page page = {};
  std::copy_n(kTitle, kTitleBytes, page.begin());
  return page;
}

// The title has 46 bits that are set, so a page of zeros is farther off, and so is that of anything
// else. A file of the version before has another size.
constexpr std::size_t kMostFlippedBits = 8;

std::size_t differing_bits(const Page& a, const Page& b) noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    count += std::bitset<8>(static_cast<unsigned>(a[i] ^ b[i])).count();
  }
  return count;
}

// As pread() and pwrite(), but all of it.
template <typename Byte, typename Transfer>
bool transfer(Span<Byte> bytes, std::size_t offset, const Transfer& some) noexcept {
  while (!bytes.empty()) {
    const ssize_t count = some(bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count == 0 || (count < 0 && errno != EINTR)) {
      return false;
    }
    const auto done = static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    bytes = bytes.from(done);
    offset += done;
  }
  return true;
}

bool read_at(int file, std::size_t offset, Span<std::uint8_t> bytes) noexcept {
  return transfer(bytes, offset, [file](std::uint8_t* data, std::size_t size, off_t at) {
    return pread(file, data, size, at);
  });
}

bool write_at(int file, std::size_t offset, Span<const std::uint8_t> bytes) noexcept {
  return transfer(bytes, offset, [file](const std::uint8_t* data, std::size_t size, off_t at) {
    return pwrite(file, data, size, at);
  });
}

/// The name of a new file outlives a power cut once its directory is on the disk.
bool sync_directory_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string directory =
      slash == std::string::npos ? "." : path.substr(0, std::max<std::size_t>(slash, 1));
  const int file = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) {
    return false;
  }
  const bool is_synced = fsync(file) == 0;
  close(file);
  return is_synced;
}

// Empty, or left by a program that was killed while it made the file: the first page comes last.
bool is_blank(int file, std::size_t size) {
  std::vector<std::uint8_t> bytes(std::min(size, kFileBytes));
  const std::size_t title = std::min(bytes.size(), kPageBytes);
  const auto all = [&bytes](std::size_t from, std::size_t to, std::uint8_t value) {
    const auto at = [&bytes](std::size_t i) {
      return bytes.begin() + static_cast<std::ptrdiff_t>(i);
    };
    return std::all_of(at(from), at(to), [value](std::uint8_t byte) { return byte == value; });
  };
  return size <= kFileBytes && read_at(file, 0, {bytes.data(), bytes.size()}) && all(0, title, 0) &&
         all(title, bytes.size(), hal::kErasedByte);
}

bool make_new(int file, const std::string& path) {
  Page erased;
  erased.fill(hal::kErasedByte);
  for (std::size_t offset = kPageBytes; offset < kFileBytes; offset += kPageBytes) {
    if (!write_at(file, offset, erased)) {
      return false;
    }
  }
  return fsync(file) == 0 && write_at(file, 0, title_page()) && fsync(file) == 0 &&
         sync_directory_of(path);
}

desk::Problem refused(const std::string& path, const char* reason) {
  return desk::bad_input("--store: " + desk::printable(path) + ": " + reason + "; " + kExpectation);
}

}  // namespace

VolatileBytes::VolatileBytes() : bytes_(kStoreBytes, hal::kErasedByte) {}

bool VolatileBytes::read(std::size_t offset, Span<std::uint8_t> bytes) noexcept {
  std::copy_n(bytes_.data() + offset, bytes.size(), bytes.data());
  return true;
}

bool VolatileBytes::write(std::size_t offset, Span<const std::uint8_t> bytes) noexcept {
  std::copy_n(bytes.data(), bytes.size(), bytes_.data() + offset);
  return true;
}

FileBytes::~FileBytes() {
  if (file_ >= 0) {
    close(file_);
  }
}

desk::Problem FileBytes::open(const std::string& path) {
  // O_NONBLOCK: a serial port without a peer would keep it waiting.
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
  if (file_ < 0) {
    return refused(path, std::strerror(errno));
  }
  desk::Problem problem = take_over(path);
  if (problem) {
    close(file_);
    file_ = -1;
  }
  return problem;
}

desk::Problem FileBytes::take_over(const std::string& path) {
  struct stat status = {};
  if (fstat(file_, &status) != 0) {
    return desk::fault("--store: " + desk::printable(path) + ": " + std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) {
    return refused(path, "not a regular file");
  }
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    return desk::bad_input("--store: " + desk::printable(path) +
                           ": in use by another program; end it first or take another file");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (is_blank(file_, size)) {
    return make_new(file_, path)
               ? desk::Problem{}
               : desk::fault("--store: " + desk::printable(path) + ": " + std::strerror(errno));
  }
  Page page = {};
  const bool is_read = read_at(file_, 0, page);
  if (is_read && std::equal(kFirstTitle, kFirstTitle + kTitleBytes, page.begin())) {
    return refused(path, "a store of an earlier version");
  }
  if (size != kFileBytes || !is_read || differing_bits(page, title_page()) > kMostFlippedBits) {
    return refused(path, "something else, or damaged");
  }
  had_damaged_title_ = page != title_page();
  if (had_damaged_title_ && (!write_at(file_, 0, title_page()) || fsync(file_) != 0)) {
    return desk::fault("--store: " + desk::printable(path) + ": " + std::strerror(errno));
  }
  return {};
}

bool FileBytes::read(std::size_t offset, Span<std::uint8_t> bytes) noexcept {
  return read_at(file_, kPageBytes + offset, bytes);
}

bool FileBytes::write(std::size_t offset, Span<const std::uint8_t> bytes) noexcept {
  return write_at(file_, kPageBytes + offset, bytes);
}

bool FileBytes::sync() noexcept { return fsync(file_) == 0; }

// A store reads back what it has written before it answers: from there on it has to be on the disk.
Status FileStore::do_read(std::uint32_t slot, std::uint32_t offset,
                          Span<std::uint8_t> bytes) noexcept {
  is_synced_ = is_synced_ || bytes_.sync();
  const std::size_t at = std::size_t{slot} * format().slot_bytes + offset;
  return is_synced_ && bytes_.read(at, bytes) ? Status::kOk : Status::kHardwareFault;
}

Status FileStore::do_erase(std::uint32_t slot) noexcept {
  Page erased;
  erased.fill(hal::kErasedByte);
  Status status = Status::kOk;
  for (std::uint32_t offset = 0; status == Status::kOk && offset < format().slot_bytes;) {
    const std::size_t count = std::min<std::size_t>(erased.size(), format().slot_bytes - offset);
    status = do_program(slot, offset, Span<const std::uint8_t>(erased).first(count));
    offset += static_cast<std::uint32_t>(count);
  }
  return status;
}

Status FileStore::do_program(std::uint32_t slot, std::uint32_t offset,
                             Span<const std::uint8_t> unit) noexcept {
  is_synced_ = false;
  const std::size_t at = std::size_t{slot} * format().slot_bytes + offset;
  return bytes_.write(at, unit) ? Status::kOk : Status::kHardwareFault;
}

}  // namespace emax::host
