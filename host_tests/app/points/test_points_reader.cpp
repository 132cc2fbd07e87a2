// Tables of points: the paper's own, and everything that can be wrong with one.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <sstream>
#include <string>

#include "emax/app/points/points_reader.hpp"
#include "emax/base/capacity.hpp"

#include "support/table1.hpp"

namespace emax::app {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

PointsReader read(const std::string& text) {
  PointsReader reader;
  reader.start();
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    reader.add_line(Span<const char>(text.data() + begin, end - begin));
    begin = end + 1;
  }
  (void)reader.finish();
  return reader;
}

const std::string kHeader = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg\n";
const std::string kGood = "30,1.03,-0.1,0.01,1.0\n40,1.04,-0.4,0.01,1.0\n50,1.00,-0.3,0.01,1.0\n";

void expect_points(const std::string& text, std::size_t count) {
  const PointsReader reader = read(text);
  EXPECT_EQ(reader.error().problem, nullptr)
      << reader.error().line << ": " << reader.error().problem;
  EXPECT_EQ(reader.points().size(), count);
}

void expect_error(const std::string& text, std::size_t line, const std::string& problem,
                  const std::string& expectation = "expected") {
  const PointsReader reader = read(text);
  const PointsError& error = reader.error();
  ASSERT_NE(error.problem, nullptr) << text;
  ASSERT_NE(error.expectation, nullptr) << text;
  EXPECT_EQ(error.line, line) << text;
  EXPECT_NE(std::string(error.problem).find(problem), std::string::npos)
      << text << "says: " << error.problem;
  EXPECT_NE(std::string(error.expectation).find(expectation), std::string::npos)
      << text << "says: " << error.expectation;
}

const std::string kHeaderWithFit =
    "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,model_amplitude,model_phase_deg,residual_re,"
    "residual_im\n";

TEST(PointsReader, TableWithFit) {
  const std::string text = kHeaderWithFit +
                           "30,1.03,-0.1,0.01,1.0,1,2,3,4\n"
                           "40,1.04,-0.4,0.01,1.0,x,,nan,-1e-05\n"
                           "50,1.00,-0.3,0.01,1.0,1,2,3,4\n";
  expect_points(text, 3);
  const PointsReader with_fit = read(text);
  const PointsReader without = read(kHeader + kGood);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(with_fit.points().points()[i].amplitude, without.points().points()[i].amplitude);
    EXPECT_EQ(with_fit.points().points()[i].u_phase_rad, without.points().points()[i].u_phase_rad);
  }
  expect_error(kHeaderWithFit + kGood, 2, "5 columns", "as many columns as the header has");
  // And what the points have in common.
  expect_points(kHeader.substr(0, kHeader.size() - 1) + ",u_common\n" +
                    "30,1.03,-0.1,0.01,1.0,0.005\n40,1.04,-0.4,0.01,1.0,0.005\n"
                    "50,1.00,-0.3,0.01,1.0,0.005\n# shared: skew=1e-7\n",
                3);
  expect_error(kHeader.substr(0, kHeader.size() - 1) + ",mine\n" + kGood, 1, "6 columns");
  // Nine columns are those of emax only under its header.
  expect_error("30,1.03,-0.1,0.01,1.0,1,2,3,4\n", 1, "more than 8 columns", "five numbers");
  expect_error("a,b,c,d,e,f,g,h,i\n30,1.03,-0.1,0.01,1.0,1,2,3,4\n", 1, "more than 8 columns");
  // The next table starts without it.
  PointsReader reader = read(text);
  reader.start();
  reader.add_line(Span<const char>("30,1.03,-0.1,0.01,1.0", 21));
  EXPECT_EQ(reader.error().problem, nullptr);
}

TEST(PointsReader, KnowsTheLineOfEachPoint) {
  const PointsReader reader =
      read("# a\n\n" + kHeader + "30,1.03,-0.1,0.01,1.0\n# b\n40,1.04,-0.4,0.01,1.0\n" +
           "50,1.00,-0.3,0.01,1.0\n");
  ASSERT_EQ(reader.points().size(), 3U);
  EXPECT_EQ(reader.line_of(0), 4U);
  EXPECT_EQ(reader.line_of(1), 6U);
  EXPECT_EQ(reader.line_of(2), 7U);
}

TEST(PointsReader, TableOfThePaper) {
  const PointsReader reader = read(test::table1_text());
  ASSERT_EQ(reader.error().problem, nullptr);
  ASSERT_EQ(reader.points().size(), 42U);
  const ResponsePoint& first = reader.points().points()[0];
  EXPECT_EQ(first.frequency_hz, 30.0);
  EXPECT_EQ(first.amplitude, 1.03);
  EXPECT_NEAR(first.phase_rad, -0.1 * kDegree, 1e-17);
  EXPECT_EQ(first.u_amplitude, 0.005);
  EXPECT_NEAR(first.u_phase_rad, 0.5 * kDegree, 1e-17);
  const ResponsePoint& last = reader.points().points()[41];
  EXPECT_EQ(last.frequency_hz, 6000.0);
  EXPECT_EQ(last.amplitude, 0.96);
  EXPECT_NEAR(last.phase_rad, -158.5 * kDegree, 1e-15);
  EXPECT_EQ(last.u_amplitude, 0.015);
}

TEST(PointsReader, FormsThatAreAllowed) {
  expect_points(kGood, 3);
  expect_points(kHeader + kGood, 3);
  expect_points("\xEF\xBB\xBF" + kHeader + kGood, 3);
  expect_points("\xEF\xBB\xBF" + kGood, 3);
  expect_points("# of 2020\n\n" + kHeader + "# below\n" + kGood + "\n# end;\t,,,\n\n", 3);
  expect_points("Frequency in Hz,A,Phi,U(A),U(Phi)\n" + kGood, 3);
  expect_points("30 , 1.03,\t-0.1 ,0.01, 1.0 \n 40,+1.04,-.4,1e-2,1.\n5e1,1,0,0.01,1", 3);
  expect_points("30,1,-360,0.01,1\n40,1,360,0.01,1\n50,1,0,0.01,1\n", 3);
  std::string carriage_returns;
  for (const char character : kHeader + kGood) {
    carriage_returns += character == '\n' ? "\r\n" : std::string(1, character);
  }
  expect_points(carriage_returns, 3);
}

TEST(PointsReader, MarkOnlyAtTheStart) {
  expect_error(kGood +
                   "\xEF\xBB\xBF"
                   "60,1,0,0.01,1\n",
               4, "f_hz is not a number");
}

TEST(PointsReader, ColumnCount) {
  expect_error("30,1.03,-0.1,0.01\n", 1, "4 columns", "f_hz,amplitude,phase_deg");
  expect_error("30,1.03,-0.1,0.01,1.0,7\n", 1, "6 columns", "five numbers");
  expect_error(kHeader + "30\n", 2, "1 column", "five numbers");
  expect_error("1,2,3,4,5,6,7,8,9,10,11,12\n", 1, "more than 8 columns", "five numbers");
  expect_error("f_hz,amplitude,phase_deg\n" + kGood, 1, "3 columns", "five numbers");
  expect_error("just some words\n", 1, "1 column", "five numbers");
}

TEST(PointsReader, TextWhereANumberShouldBe) {
  expect_error("30,abc,-0.1,0.01,1.0\n", 1, "amplitude is not a number", "number");
  expect_error(kHeader + "abc,1,-0.1,0.01,1.0\n", 2, "f_hz is not a number");
  expect_error(kHeader + kGood + kHeader, 5, "f_hz is not a number");
  expect_error("30,1.03,-0.1deg,0.01,1.0\n", 1, "phase_deg is not a number");
  expect_error("30,1.03,-0.1,0.01,1.0x\n", 1, "u_phase_deg is not a number");
  expect_error("30,1.03,-0.1,0x1,1.0\n", 1, "u_amplitude is not a number");
  expect_error(
      "30,1.03,\xE2\x88\x92"
      "0.1,0.01,1.0\n",
      1, "phase_deg is not a number");
  expect_error("30,1 03,-0.1,0.01,1.0\n", 1, "amplitude is not a number");
  expect_error("30,,-0.1,0.01,1.0\n", 1, "amplitude is missing");
  expect_error(",,,,\n", 1, "f_hz is missing");
}

TEST(PointsReader, NotFinite) {
  for (const char* word :
       {"nan", "NaN", "-nan", "nan(1)", "inf", "Inf", "-inf", "INFINITY", "1e999"}) {
    expect_error(std::string("30,") + word + ",-0.1,0.01,1.0\n", 1,
                 "amplitude is not a finite number");
    expect_error(std::string(word) + ",1,-0.1,0.01,1.0\n", 1, "f_hz is not a finite number");
  }
}

TEST(PointsReader, ZeroAndNegative) {
  expect_error("30,1.03,-0.1,0,1.0\n", 1, "u_amplitude is zero or negative", "k = 2");
  expect_error("30,1.03,-0.1,-0.01,1.0\n", 1, "u_amplitude is zero or negative");
  expect_error("30,1.03,-0.1,0.01,0.0\n", 1, "u_phase_deg is zero or negative", "degrees");
  expect_error("30,1.03,-0.1,0.01,-1\n", 1, "u_phase_deg is zero or negative");
  expect_error("30,0,-0.1,0.01,1\n", 1, "amplitude is zero or negative", "above 0");
  expect_error("30,-1.03,-0.1,0.01,1\n", 1, "amplitude is zero or negative");
  expect_error("0,1.03,-0.1,0.01,1\n", 1, "f_hz is zero or negative", "above 0 Hz");
  expect_error("-30,1.03,-0.1,0.01,1\n", 1, "f_hz is zero or negative");
  expect_error("30,1.03,-0.1,5e-324,1\n", 1, "too small");
}

TEST(PointsReader, Phase) {
  expect_error("30,1.03,-360.1,0.01,1\n", 1, "phase_deg is outside -360 to 360", "degrees");
  expect_error("30,1.03,361,0.01,1\n", 1, "phase_deg is outside -360 to 360");
}

TEST(PointsReader, Order) {
  expect_error(kHeader + "30,1,0,0.01,1\n30,1,0,0.01,1\n", 3, "f_hz is not above", "ascending");
  expect_error("30,1,0,0.01,1\n29,1,0,0.01,1\n", 2, "f_hz is not above", "ascending");
}

TEST(PointsReader, HowMany) {
  constexpr const char* kRange = "3 to " EMAX_TEXT_OF(EMAX_MAX_POINTS);
  expect_error("", 0, "no points", kRange);
  expect_error("\n\n# nothing\n", 0, "no points");
  expect_error(kHeader, 0, "no points");
  expect_error("30,1,0,0.01,1\n", 0, "only 1 point", kRange);
  expect_error("30,1,0,0.01,1\n40,1,0,0.01,1\n", 0, "only 2 points");
  std::string many;
  const std::size_t most = emax::kMaxPoints;
  for (std::size_t i = 1; i <= most; ++i) {
    many += std::to_string(i) + ",1,0,0.01,1\n";
  }
  expect_points(many, most);
  const std::string next = std::to_string(most + 1);
  expect_error(many + next + ",1,0,0.01,1\n", most + 1, "one point more than", kRange);
}

TEST(PointsReader, NotText) {
  expect_error(std::string("\x7F"
                           "ELF\x02\x01\x01\0\0\0",
                           10) +
                   "\n",
               1, "not a text file");
  expect_error(std::string("3\0"
                           "0\0,\0",
                           6) +
                   "\n",
               1, "not a text file");
  expect_error("30,1,0,0.01,1\n40,1,0,\x01,1\n", 2, "control character", "text");
  expect_error("30,1,0,0.01,1\r40,1,0,0.01,1\n", 1, "control character");
}

TEST(PointsReader, LongLine) {
  expect_points("#" + std::string(249, 'x') + "\n" + kGood, 3);
  expect_points(kGood + "#" + std::string(249, 'x') + "\r\n", 3);
  expect_error("#" + std::string(250, 'x') + "\n" + kGood, 1, "250 characters");
}

TEST(PointsReader, OtherSeparators) {
  expect_error("30;1.03;-0.1;0.01;1.0\n", 1, "semicolons", "commas");
  expect_error("30;1,03;-0,1;0,01;1,0\n", 1, "semicolons", "point as decimal sign");
  expect_error("f_hz;amplitude;phase_deg;u_amplitude;u_phase_deg\n", 1, "semicolons", "commas");
  expect_error("30\t1.03\t-0.1\t0.01\t1.0\n", 1, "tabs", "commas");
  expect_error("30\t1,03\t-0,1\t0,01\t1,0\n", 1, "tabs", "commas");
}

TEST(PointsReader, StaysWithTheFirstError) {
  PointsReader reader = read("30,1,0,0.01,1\nbad,1,0,0.01,1\n" + kGood);
  EXPECT_EQ(reader.error().line, 2U);
  EXPECT_EQ(reader.points().size(), 1U);
  EXPECT_EQ(reader.finish().line, 2U);
  reader.start();
  EXPECT_EQ(reader.error().problem, nullptr);
  EXPECT_EQ(reader.points().size(), 0U);
}

// What random bytes, and good tables with a few bytes changed, end in: points that are all valid,
// or words. Sanitizers watch for the rest.
TEST(PointsReader, RandomBytes) {
  std::mt19937 random(3);
  const std::string alphabet = "0123456789.,-+eE #;\t\rnaif\n\n,,,";
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    if (i % 2 == 0) {
      text = kHeader + kGood;
      const std::size_t changes = 1 + random() % 3;
      for (std::size_t j = 0; j < changes; ++j) {
        text[random() % text.size()] = alphabet[random() % alphabet.size()];
      }
    } else {
      const std::size_t length = random() % 300;
      for (std::size_t j = 0; j < length; ++j) {
        text += i % 4 == 1 ? alphabet[random() % alphabet.size()] : static_cast<char>(random());
      }
    }
    const PointsReader reader = read(text);
    for (const ResponsePoint& point : reader.points().points()) {
      ASSERT_EQ(validate(point), Status::kOk) << text;
    }
    const bool is_good = reader.error().problem == nullptr;
    ASSERT_TRUE(!is_good || reader.points().size() >= 3) << text;
    ASSERT_TRUE(is_good || reader.error().expectation != nullptr) << text;
    accepted += is_good ? 1 : 0;
  }
  EXPECT_GT(accepted, 100);
}

}  // namespace
}  // namespace emax::app
