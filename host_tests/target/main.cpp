// Runs the tests of a GoogleTest image but those that are left out on this core.

#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <set>
#include <sstream>
#include <string>

/// Names of tests, separated by colons.
extern const char* const emax_tests_left_out;

namespace {

std::set<std::string> names_of_tests() {
  std::set<std::string> names;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j) {
      names.insert(std::string(suite.name()) + '.' + suite.GetTestInfo(j)->name());
    }
  }
  return names;
}

/// A test that was renamed would else be run again, and nobody would know why it is slow.
bool all_exist(const std::string& left_out) {
  const std::set<std::string> names = names_of_tests();
  std::istringstream list(left_out);
  bool exist = true;
  for (std::string name; std::getline(list, name, ':');) {
    if (names.count(name) == 0) {
      std::printf("left out, but there is no such test: %s\n", name.c_str());
      exist = false;
    }
  }
  return exist;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string left_out = emax_tests_left_out;
  const std::string filter = left_out.empty() ? "*" : "-" + left_out;
  GTEST_FLAG_SET(filter, filter);
  testing::InitGoogleTest(&argc, argv);
  if (GTEST_FLAG_GET(filter) == filter && !all_exist(left_out)) {
    return EXIT_FAILURE;
  }
  const int status = RUN_ALL_TESTS();
  if (testing::UnitTest::GetInstance()->test_to_run_count() == 0) {
    std::printf("no test ran\n");
    return EXIT_FAILURE;
  }
  return status;
}
