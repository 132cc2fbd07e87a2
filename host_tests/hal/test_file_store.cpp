// The store in a file: the contract of every store, and what is left when the program is killed.
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"

#include "file_store.hpp"
#include "hal/board_conformance.hpp"

namespace emax::host {
namespace {

using app::RecordStore;
using desk::Problem;
using hal::StoreFormat;
using test::violated_by_store;

/// A directory of its own, which is removed with all that is in it.
class Directory {
 public:
  Directory() : path_(::testing::TempDir() + "emax_store_XXXXXX") {
    EXPECT_NE(mkdtemp(path_.data()), nullptr);
  }
  ~Directory() { EXPECT_EQ(std::system(("rm -r " + path_).c_str()), 0); }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;

  std::string file() const { return path_ + "/store"; }

 private:
  std::string path_;
};

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A store over bytes whose power can be cut within any write.
class CutBench final : public StoreBytes {
 public:
  CutBench(StoreBytes& bytes, const StoreFormat& format) : bytes_(bytes), store_(*this, format) {}

  FileStore& store() { return store_; }
  void cut_power_after(std::uint64_t bytes) {
    left_ = bytes;
    can_be_cut_ = true;
  }
  void restore_power() {
    can_be_cut_ = false;
    powered_ = true;
  }
  bool powered() const { return powered_; }
  int syncs() const { return syncs_; }

  bool read(std::size_t offset, Span<std::uint8_t> bytes) noexcept override {
    return powered_ && bytes_.read(offset, bytes);
  }
  bool write(std::size_t offset, Span<const std::uint8_t> bytes) noexcept override {
    if (!powered_) {
      return false;
    }
    if (!can_be_cut_ || bytes.size() <= left_) {
      left_ -= can_be_cut_ ? bytes.size() : 0;
      return bytes_.write(offset, bytes);
    }
    EXPECT_TRUE(bytes_.write(offset, bytes.first(left_)));
    powered_ = false;
    return false;
  }
  bool sync() noexcept override {
    ++syncs_;
    return powered_ && bytes_.sync();
  }

 private:
  StoreBytes& bytes_;
  FileStore store_;
  std::uint64_t left_ = 0;
  int syncs_ = 0;
  bool can_be_cut_ = false;
  bool powered_ = true;
};

TEST(FileStore, KeepsTheContractOfAStore) {
  const Directory directory;
  FileBytes file;
  ASSERT_FALSE(file.open(directory.file()));
  for (const StoreFormat& format : {StoreFormat{3, 64, 8}, StoreFormat{2, 21, 7}}) {
    CutBench bench(file, format);
    EXPECT_TRUE(violated_by_store(bench).none()) << format.slot_bytes;
  }
  VolatileBytes bytes;
  CutBench bench(bytes, {3, 64, 8});
  EXPECT_TRUE(violated_by_store(bench).none());
}

// As much of the disk as of the store: the greatest record into the last slot, and read again by
// the next program.
TEST(FileStore, HoldsForTheNextProgram) {
  const Directory directory;
  const std::vector<std::uint8_t> expected(kFileStoreFormat.slot_bytes, 0xA7);
  const std::uint32_t last = kFileStoreFormat.slot_count - 1;
  for (int program = 0; program < 3; ++program) {
    FileBytes file;
    ASSERT_FALSE(file.open(directory.file()));
    FileStore store(file);
    std::vector<std::uint8_t> found(expected.size(), 0x11);
    ASSERT_EQ(store.read(last, {found.data(), found.size()}), Status::kOk);
    EXPECT_EQ(found, program == 0 ? std::vector<std::uint8_t>(found.size(), 0xFF) : expected);
    ASSERT_EQ(store.write(last, {expected.data(), expected.size()}), Status::kOk);
  }
  EXPECT_EQ(text_of(directory.file()).size(), 65U * 4096U);
}

TEST(FileStore, IsOnTheDiskWhenItSaysSo) {
  VolatileBytes bytes;
  CutBench bench(bytes, {3, 64, 8});
  const std::array<std::uint8_t, 20> record = {};
  ASSERT_EQ(bench.store().write(0, record), Status::kOk);
  EXPECT_EQ(bench.syncs(), 1);
  std::array<std::uint8_t, 20> found;
  ASSERT_EQ(bench.store().read(0, found), Status::kOk);
  EXPECT_EQ(bench.syncs(), 1);
  ASSERT_EQ(bench.store().write(1, record), Status::kOk);
  EXPECT_EQ(bench.syncs(), 2);
}

TEST(FileStore, RefusesWhatItCannotUse) {
  const Directory directory;
  const std::string path = directory.file();
  const std::string theirs[] = {"f_hz,amplitude\n30,1\n",
                                std::string(100, '\0') + "x",
                                std::string(65 * 4096, '\0'),
                                std::string(70 * 4096, '\0'),
                                "emax store of today\n" + std::string(65 * 4096 - 20, '\0'),
                                std::string(4096, '\0') + std::string(65 * 4096, '\xFF')};
  for (const std::string& text : theirs) {
    std::ofstream(path, std::ios::binary) << text;
    FileBytes file;
    const Problem problem = file.open(path);
    EXPECT_EQ(problem.status, desk::ExitStatus::kBadInput);
    EXPECT_EQ(problem.line, "--store: " + path +
                                ": something else, or damaged; expected a file that --store has "
                                "made, or a new name");
    EXPECT_EQ(text_of(path), text);
  }
  FileBytes file;
  EXPECT_EQ(file.open(path + "/below").line, "--store: " + path +
                                                 "/below: Not a directory; expected a file that "
                                                 "--store has made, or a new name");
  EXPECT_EQ(file.open("/dev/null").line,
            "--store: /dev/null: not a regular file; expected a file that --store has made, or a "
            "new name");
  ASSERT_EQ(unlink(path.c_str()), 0);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(file.open(path).status, desk::ExitStatus::kBadInput) << "a pipe: no waiting";
}

// The page says what the file is, and nothing else: the records are whole without it.
TEST(FileStore, AFlippedBitOfTheTitlePageLocksNothingOut) {
  const Directory directory;
  const std::array<std::uint8_t, 4> record = {1, 2, 3, 4};
  {
    FileBytes file;
    ASSERT_FALSE(file.open(directory.file()));
    EXPECT_FALSE(file.had_damaged_title());
    FileStore store(file);
    ASSERT_EQ(store.write(5, record), Status::kOk);
  }
  const std::string whole = text_of(directory.file());
  for (std::size_t bit = 0; bit < 8U * 4096U; bit += bit < 8U * 13U ? 1 : 3001) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    std::ofstream(directory.file(), std::ios::binary) << damaged;
    FileBytes file;
    ASSERT_FALSE(file.open(directory.file())) << bit;
    EXPECT_TRUE(file.had_damaged_title()) << bit;
    FileStore store(file);
    std::array<std::uint8_t, 4> found = {};
    EXPECT_EQ(store.read(5, found), Status::kOk) << bit;
    EXPECT_EQ(found, record) << bit;
    EXPECT_EQ(text_of(directory.file()), whole) << "mended: " << bit;
  }
}

TEST(FileStore, SaysThatAFileIsOfAnEarlierVersion) {
  const Directory directory;
  const std::string path = directory.file();
  std::ofstream(path, std::ios::binary) << "emax store 1\n" + std::string(17 * 4096 - 13, '\0');
  FileBytes file;
  EXPECT_EQ(file.open(path).line, "--store: " + path +
                                      ": a store of an earlier version; expected a file that "
                                      "--store has made, or a new name");
}

// As `emax scpi --store` keeps them: with as many frequencies as there can be.
TEST(FileStore, HasRoomForAllSettings) {
  EXPECT_GE(kFileStoreFormat.slot_bytes,
            app::kMaxSavedSettingsBytes + app::RecordStore::kFrameBytes);
  EXPECT_GE(kFileStoreFormat.slot_count, 2 * app::kSavedRecords);
}

TEST(FileStore, OneProgramAtATime) {
  const Directory directory;
  FileBytes second;
  {
    FileBytes first;
    ASSERT_FALSE(first.open(directory.file()));
    EXPECT_EQ(second.open(directory.file()).line,
              "--store: " + directory.file() +
                  ": in use by another program; end it first or take another file");
  }
  EXPECT_FALSE(second.open(directory.file()));
}

TEST(FileStore, WasKilledWhileItWasMade) {
  const Directory directory;
  {
    FileBytes whole;
    ASSERT_FALSE(whole.open(directory.file()));
  }
  const std::string whole = text_of(directory.file());
  std::string pages = whole;
  pages.replace(0, 4096, std::string(4096, '\0'));
  for (const std::size_t size : {0U, 1U, 4096U, 4097U, 9999U, 17U * 4096U}) {
    std::ofstream(directory.file(), std::ios::binary) << pages.substr(0, size);
    FileBytes file;
    EXPECT_FALSE(file.open(directory.file())) << size;
    EXPECT_EQ(text_of(directory.file()), whole) << size;
  }
}

/// Writes records 1, 2, 3, ... one after the other, each of its number all over.
[[noreturn]] void write_for_ever(const std::string& path, int told) {
  FileBytes file;
  if (file.open(path)) {
    _exit(1);
  }
  FileStore store(file);
  RecordStore records(store);
  for (std::uint32_t number = 1;; ++number) {
    std::array<std::uint8_t, 1000 + RecordStore::kFrameBytes> frame = {};
    const Span<std::uint8_t> record = RecordStore::record_in(frame);
    for (std::size_t i = 0; i < record.size(); ++i) {
      record[i] = static_cast<std::uint8_t>(number >> (8 * (i % 4)));
    }
    if (records.write(0, frame) != Status::kOk) {
      _exit(1);
    }
    if (write(told, &number, sizeof(number)) != sizeof(number)) {
      _exit(1);
    }
  }
}

// What the killed program has answered kOk for is there, or the record that it was writing.
TEST(FileStore, KilledAtAnyMomentLeavesTheOldOrTheNew) {
  const Directory directory;
  for (int kill_after_ms = 1; kill_after_ms < 25; kill_after_ms += 2) {
    ASSERT_TRUE(unlink(directory.file().c_str()) == 0 || kill_after_ms == 1);
    int told[2] = {};
    ASSERT_EQ(pipe(told), 0);
    const pid_t child = fork();
    if (child == 0) {
      close(told[0]);
      write_for_ever(directory.file(), told[1]);
    }
    close(told[1]);
    std::uint32_t last = 0;
    ASSERT_EQ(read(told[0], &last, sizeof(last)), static_cast<ssize_t>(sizeof(last)));
    std::this_thread::sleep_for(std::chrono::milliseconds(kill_after_ms));
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer had failed";
    while (read(told[0], &last, sizeof(last)) == static_cast<ssize_t>(sizeof(last))) {
    }
    close(told[0]);

    FileBytes file;
    ASSERT_FALSE(file.open(directory.file()));
    FileStore store(file);
    std::array<std::uint8_t, 1000> record = {};
    ASSERT_EQ(RecordStore(store).read(0, record).status, Status::kOk);
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      number |= std::uint32_t{record[i]} << (8 * i);
    }
    EXPECT_TRUE(number == last || number == last + 1) << number << " after " << last;
    for (std::size_t i = 4; i < record.size(); ++i) {
      ASSERT_EQ(record[i], record[i % 4]) << i;
    }
  }
}

}  // namespace
}  // namespace emax::host
