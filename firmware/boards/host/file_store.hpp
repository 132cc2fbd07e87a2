// The instrument's memory on a PC: slots of a store in one file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/store.hpp"

#include "desk/cli/problem.hpp"

namespace emax::host {

/// A slot is pages of the file by itself: what a power cut does to the page that is being written
/// leaves the others alone. Settings with 1024 frequencies take 9.7 KiB.
inline constexpr hal::StoreFormat kFileStoreFormat = {16, 16384, 256};

/// Bytes that can be read and replaced at any place, for a `FileStore` of that many.
class StoreBytes {
 public:
  StoreBytes(const StoreBytes&) = delete;
  StoreBytes& operator=(const StoreBytes&) = delete;

  // Each returns false if it failed; then some of the bytes may have been replaced.
  virtual bool read(std::size_t offset, Span<std::uint8_t> bytes) noexcept = 0;
  virtual bool write(std::size_t offset, Span<const std::uint8_t> bytes) noexcept = 0;
  /// Everything written so far outlives a power cut from now on.
  virtual bool sync() noexcept = 0;

 protected:
  StoreBytes() noexcept = default;
  ~StoreBytes() = default;
};

/// Bytes that are gone with the program, for kFileStoreFormat.
class VolatileBytes final : public StoreBytes {
 public:
  VolatileBytes();

  bool read(std::size_t offset, Span<std::uint8_t> bytes) noexcept override;
  bool write(std::size_t offset, Span<const std::uint8_t> bytes) noexcept override;
  bool sync() noexcept override { return true; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Bytes in a file, for kFileStoreFormat, which one program at a time has open. Before them the
/// file has a page that says what it is.
class FileBytes final : public StoreBytes {
 public:
  FileBytes() noexcept = default;
  ~FileBytes();

  /// Opens the file, or makes a new one in which nothing is stored. Once.
  ///
  /// A few flipped bits of the page that says what the file is are mended.
  ///
  /// @returns What is wrong if it cannot be opened, is something else, or is in use. A file that is
  ///          something else is left as it is.
  desk::Problem open(const std::string& path);
  /// @returns True if `open()` has mended that page: the disk may have damaged records, too.
  bool had_damaged_title() const noexcept { return had_damaged_title_; }

  bool read(std::size_t offset, Span<std::uint8_t> bytes) noexcept override;
  bool write(std::size_t offset, Span<const std::uint8_t> bytes) noexcept override;
  bool sync() noexcept override;

 private:
  desk::Problem take_over(const std::string& path);

  int file_ = -1;
  bool had_damaged_title_ = false;
};

/// Slots over such bytes. A write is on the disk when it answers kOk; killed on its way, the
/// program leaves any bytes in that one slot.
class FileStore final : public hal::Store {
 public:
  /// The bytes outlive this object.
  explicit FileStore(StoreBytes& bytes, const hal::StoreFormat& format = kFileStoreFormat) noexcept
      : Store(format), bytes_(bytes) {}

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override;
  Status do_erase(std::uint32_t slot) noexcept override;
  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override;

  StoreBytes& bytes_;
  bool is_synced_ = true;
};

}  // namespace emax::host
