// Span's conversions and bounds, and the sentence of every status.
#include <array>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {
namespace {

static_assert(std::is_trivially_copyable_v<Span<double>>);
static_assert(std::is_convertible_v<Span<double>, Span<const double>>);
static_assert(!std::is_convertible_v<Span<const double>, Span<double>>);
static_assert(std::is_convertible_v<std::array<double, 3>&, Span<double>>);
static_assert(std::is_convertible_v<const std::array<double, 3>&, Span<const double>>);
static_assert(!std::is_convertible_v<const std::array<double, 3>&, Span<double>>);
static_assert(!std::is_convertible_v<std::array<double, 3>&, Span<float>>);

TEST(Span, IsEmptyFromNothing) {
  const Span<int> none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.size(), 0U);
  EXPECT_EQ(none.data(), nullptr);
  EXPECT_EQ(none.begin(), none.end());
}

TEST(Span, SeesAndChangesWhatItViews) {
  int plain[3] = {1, 2, 3};
  const Span<int> view = plain;
  view[1] = 20;
  EXPECT_EQ(plain[1], 20);
  EXPECT_EQ(view.size(), 3U);
  EXPECT_EQ(view.data(), plain);

  std::array<int, 4> array = {1, 2, 3, 4};
  const Span<int> of_array = array;
  for (int& element : of_array) {
    element *= 2;
  }
  EXPECT_EQ(array, (std::array<int, 4>{2, 4, 6, 8}));

  const std::array<int, 2> constant = {5, 6};
  const Span<const int> of_constant = constant;
  EXPECT_EQ(of_constant[1], 6);
  const Span<const int> widened = of_array;
  EXPECT_EQ(widened.data(), array.data());
  EXPECT_EQ(widened.size(), 4U);
}

TEST(Span, CutsAtEitherEnd) {
  int plain[5] = {0, 1, 2, 3, 4};
  const Span<int> view = plain;
  EXPECT_EQ(view.first(2).size(), 2U);
  EXPECT_EQ(view.first(2).data(), plain);
  EXPECT_EQ(view.from(2).size(), 3U);
  EXPECT_EQ(view.from(2)[0], 2);
  EXPECT_TRUE(view.first(0).empty());
  EXPECT_TRUE(view.from(5).empty());
  EXPECT_EQ(view.from(1).first(3)[2], 3);
}

TEST(Status, EveryStatusHasASentenceOfItsOwn) {
  // The sentence for a number that is no status ends the list, so that a new status is counted here
  // too.
  const std::string unknown = explain(static_cast<Status>(255));
  EXPECT_FALSE(unknown.empty());
  std::set<std::string> sentences = {unknown};
  std::uint8_t count = 0;
  for (; count < 255; ++count) {
    const std::string sentence = explain(static_cast<Status>(count));
    if (sentence == unknown) {
      break;
    }
    EXPECT_TRUE(sentences.insert(sentence).second) << sentence;
    EXPECT_EQ(sentence.back(), '.') << sentence;
    EXPECT_EQ(sentence.find('.'), sentence.size() - 1) << "One sentence: " << sentence;
    EXPECT_NE(sentence.find(';'), std::string::npos) << "What is wrong; what to do: " << sentence;
  }
  EXPECT_GT(count, static_cast<std::uint8_t>(Status::kStopped));
}

}  // namespace
}  // namespace emax
