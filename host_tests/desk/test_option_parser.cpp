// Command lines as any command reads them, and what is said of those that cannot be read.
#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

#include "desk/cli/option_parser.hpp"

namespace {

using emax::Span;
using emax::desk::ExitStatus;
using emax::desk::Given;
using emax::desk::Option;
using emax::desk::parse_options;
using emax::desk::Problem;
using emax::desk::Syntax;

/// A command with two options, a switch and files.
class Command {
 public:
  Command() {
    syntax.options = {Option{"level", "Group", "N", "3", "a digit", "how much",
                             [this](std::string_view text) {
                               level = text;
                               return text.size() == 1;
                             }},
                      Option{"label", "Other", "TEXT", "", "a label", "what it is called",
                             [this](std::string_view text) {
                               label = text;
                               return true;
                             }},
                      Option{"fast", "Other", "", "", "", "as fast\nas it goes",
                             [this](std::string_view) { return fast = true; }}};
    syntax.expected = "options, such as --level 2";
  }

  /// @returns The line of the problem; empty if there is none.
  std::string parse(const std::vector<std::string_view>& arguments) {
    given.clear();
    const Problem problem = parse_options(
        Span<const std::string_view>(arguments.data(), arguments.size()), syntax, given);
    EXPECT_EQ(problem.status, problem.line.empty() ? ExitStatus::kDone : ExitStatus::kBadInput);
    return problem.line;
  }

  void take_files() {
    syntax.take_file = [this](std::string_view path) {
      files.emplace_back(path);
      return files.size() < 3 ? Problem{} : emax::desk::bad_input("too many");
    };
  }

  Syntax syntax;
  std::vector<Given> given;
  std::string level;
  std::string label;
  std::vector<std::string> files;
  bool fast = false;
};

TEST(OptionParser, TakesValuesBehindABlankOrAnEqualsSign) {
  Command command;
  EXPECT_EQ(command.parse({"--level", "2", "--label=a=b", "--fast"}), "");
  EXPECT_EQ(command.level, "2");
  EXPECT_EQ(command.label, "a=b");
  EXPECT_TRUE(command.fast);
  ASSERT_EQ(command.given.size(), 3U);
  EXPECT_EQ(command.given[1].value, "a=b");
  EXPECT_TRUE(is_given(command.given, "fast"));
  EXPECT_EQ(command.parse({"--label", "-x"}), "");
  EXPECT_EQ(command.label, "-x");
  EXPECT_FALSE(is_given(command.given, "fast"));
  EXPECT_EQ(command.parse({}), "");
}

TEST(OptionParser, NamesWhatIsWrong) {
  Command command;
  EXPECT_EQ(command.parse({"--level"}), "--level: no value; expected a digit");
  EXPECT_EQ(command.parse({"--level="}), "--level: no value; expected a digit");
  EXPECT_EQ(command.parse({"--level", ""}), "--level: no value; expected a digit");
  EXPECT_EQ(command.parse({"--level", "--fast"}), "--level: no value; expected a digit");
  EXPECT_EQ(command.parse({"--level", "12"}), "--level: \"12\" given; expected a digit");
  EXPECT_EQ(command.parse({"--level", "1", "--level", "2"}), "--level: given twice; expected once");
  EXPECT_EQ(command.parse({"--fast=1"}), "--fast: takes no value; expected just --fast");
  EXPECT_EQ(command.parse({"--leve=1"}), "--leve: unknown option; did you mean --level?");
  EXPECT_EQ(command.parse({"--hlep"}), "--hlep: unknown option; did you mean --help?");
  EXPECT_EQ(command.parse({"--xyzzy=4"}), "--xyzzy: unknown option; --help lists them");
  command.syntax.other_words = {{"--levels", "--label"}};
  EXPECT_EQ(command.parse({"--levels=1"}), "--levels: unknown option; did you mean --label?");
  EXPECT_EQ(command.parse({"--leve=1"}), "--leve: unknown option; did you mean --level?");
  for (const char* stray : {"2", "-f", "--", "-", ""}) {
    EXPECT_EQ(command.parse({stray}), std::string(stray) + ": unexpected argument; expected " +
                                          "options, such as --level 2");
  }
}

TEST(OptionParser, TheFirstMistakeIsTheOneThatIsNamed) {
  Command command;
  EXPECT_EQ(command.parse({"--level", "12", "--bogus"}), "--level: \"12\" given; expected a digit");
  EXPECT_EQ(command.parse({"--label", "a", "b", "--level", "12"}),
            "b: unexpected argument; expected options, such as --level 2");
}

TEST(OptionParser, FilesStandAnywhere) {
  Command command;
  command.take_files();
  command.syntax.unknown = "no option of emax compare";
  EXPECT_EQ(command.parse({"a", "--level", "2", "-"}), "");
  EXPECT_EQ(command.files, (std::vector<std::string>{"a", "-"}));
  EXPECT_EQ(command.parse({"b"}), "too many");
  EXPECT_EQ(command.parse({"-f"}), "-f: no option of emax compare; did you mean --fast?");
}

TEST(OptionHelp, ShowsGroupsDefaultsAndLongNamesInColumns) {
  Command command;
  command.syntax.options[1].name = "label-of-the-device";
  EXPECT_EQ(help_on(command.syntax.options),
            "\nGroup\n"
            "  --level N              how much (default 3)\n"
            "\nOther\n"
            "  --label-of-the-device TEXT\n"
            "                         what it is called\n"
            "  --fast                 as fast\n"
            "                         as it goes\n");
}

}  // namespace
