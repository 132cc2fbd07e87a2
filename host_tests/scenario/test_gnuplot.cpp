// The limit of time for a gnuplot that hangs; the scenarios have whatever else it may do.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/types.h>
#include <thread>
#include <unistd.h>

#include "desk/pictures/gnuplot.hpp"

namespace {

namespace fs = std::filesystem;
using emax::host::GnuplotEnd;
using emax::host::GnuplotRun;
using emax::host::run_gnuplot;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// A directory with a gnuplot that is a shell script, which is the only one on the PATH.
class FakeGnuplot {
 public:
  explicit FakeGnuplot(const std::string& script) {
    std::string name = (fs::temp_directory_path() / "emax.XXXXXX").string();
    directory_ = mkdtemp(name.data());
    const fs::path program = directory_ / "gnuplot";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
    setenv("PATH", directory_.c_str(), 1);
  }
  FakeGnuplot(const FakeGnuplot&) = delete;
  FakeGnuplot& operator=(const FakeGnuplot&) = delete;
  ~FakeGnuplot() {
    setenv("PATH", path_.c_str(), 1);
    fs::remove_all(directory_);
  }

  GnuplotRun run(milliseconds longest) const {
    return run_gnuplot(directory_.string(), "pictures.gp", longest);
  }

  /// What the script has written to the file `child`: the number of its process.
  pid_t child() const {
    pid_t number = 0;
    std::ifstream(directory_ / "child") >> number;
    return number;
  }

 private:
  std::string path_ = std::getenv("PATH");
  fs::path directory_;
};

TEST(Gnuplot, OneThatHangsIsKilledAtTheLimit) {
  const FakeGnuplot gnuplot("echo $$ > child; exec /bin/sleep 100");
  const auto start = steady_clock::now();
  const GnuplotRun run = gnuplot.run(milliseconds(500));
  const auto taken = steady_clock::now() - start;
  EXPECT_EQ(run.end, GnuplotEnd::kFailed);
  EXPECT_EQ(run.reason, "it has not ended within 0.5 s");
  EXPECT_GE(taken, milliseconds(500));
  EXPECT_LT(taken, milliseconds(10'000));  // Far less than it sleeps, on a machine however busy.
  ASSERT_GT(gnuplot.child(), 0);
  EXPECT_NE(kill(gnuplot.child(), 0), 0);
}

TEST(Gnuplot, OneThatIsSlowIsWaitedFor) {
  const FakeGnuplot gnuplot("/bin/sleep 0.3");
  EXPECT_EQ(gnuplot.run(milliseconds(60'000)).end, GnuplotEnd::kDone);
}

TEST(Gnuplot, TheProgramGivesItTwentySeconds) {
  EXPECT_EQ(emax::host::kDrawingTime, std::chrono::seconds(20));
}

}  // namespace
