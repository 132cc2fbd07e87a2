// Tables as text: separators, headers, units, repeats, and the words about what is wrong with them.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "emax/base/capacity.hpp"
#include "emax/identify/frequency_response.hpp"

#include "desk/import/import_options.hpp"
#include "desk/import/import_points.hpp"

namespace {

using emax::ResponsePoint;
using emax::desk::import_points;
using emax::desk::ImportedPoints;
using emax::desk::ImportError;
using emax::desk::ImportOptions;
using emax::desk::take_channel_delay;
using emax::desk::take_input_units;
using emax::desk::take_uncertainty;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

// Conversions round a few times.
constexpr double kRounding = 1e-14;

ImportedPoints imported(const std::string& text, const ImportOptions& options = {}) {
  ImportedPoints points;
  const ImportError error = import_points(text, options, points);
  EXPECT_FALSE(error) << error.line << ": " << error.problem << "; " << error.expectation;
  return points;
}

ImportError refused(const std::string& text, const ImportOptions& options = {}) {
  ImportedPoints points;
  const ImportError error = import_points(text, options, points);
  EXPECT_TRUE(error) << points.understanding;
  EXPECT_NE(error.expectation, "");
  return error;
}

void expect_point(const ResponsePoint& point, double f, double a, double phase_deg, double u_a,
                  double u_deg) {
  EXPECT_NEAR(point.frequency_hz, f, kRounding * f);
  EXPECT_NEAR(point.amplitude, a, kRounding * a);
  EXPECT_NEAR(point.phase_rad, phase_deg * kDegree, kRounding * std::abs(phase_deg));
  EXPECT_NEAR(point.u_amplitude, 0.5 * u_a, kRounding * u_a);
  EXPECT_NEAR(point.u_phase_rad, 0.5 * u_deg * kDegree, kRounding * u_deg);
}

const char* const kHeader = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg\n";
const char* const kRows = "30,1.5,-2,0.03,1\n40,2.5,-3,0.05,2\n50,3.5,-4,0.07,3\n";

void expect_rows(const ImportedPoints& found) {
  ASSERT_EQ(found.points.size(), 3U);
  expect_point(found.points.points()[0], 30.0, 1.5, -2.0, 0.03, 1.0);
  expect_point(found.points.points()[1], 40.0, 2.5, -3.0, 0.05, 2.0);
  expect_point(found.points.points()[2], 50.0, 3.5, -4.0, 0.07, 3.0);
}

TEST(Import, NativeForm) {
  expect_rows(imported(kRows));
  expect_rows(imported(std::string(kHeader) + kRows));
  expect_rows(imported(std::string("\xEF\xBB\xBF# by hand\n\n") + kHeader + kRows));
  const ImportedPoints found = imported(kRows);
  EXPECT_EQ(found.understanding, "read as Hz, V/(m/s2), deg; 3 points");
  EXPECT_EQ(found.lines, (std::vector<std::size_t>{1, 2, 3}));
  // The bits of the native reader: halved, then turned into radians.
  EXPECT_EQ(found.points.points()[1].u_phase_rad, 2.0 / 2.0 * 0.017453292519943295);
}

TEST(Import, Separators) {
  for (const char* separator : {";", "\t", " ", "  \t ", " ; ", ", ", "\t\t"}) {
    if (std::string(separator) == "\t\t") {
      continue;  // Two tabs are an empty cell.
    }
    std::string text;
    for (const char c : std::string(kHeader) + kRows) {
      text += c == ',' ? separator : std::string(1, c);
    }
    expect_rows(imported(text));
  }
}

TEST(Import, DecimalCommas) {
  for (const char separator : {';', '\t', ' '}) {
    std::string text;
    for (const char c : std::string(kHeader) + kRows) {
      text += c == ',' ? separator : c == '.' ? ',' : c;
    }
    const ImportedPoints found = imported(text);
    expect_rows(found);
    EXPECT_NE(found.understanding.find("decimal comma"), std::string::npos);
  }
  // A point among decimal commas groups thousands, or is a slip.
  EXPECT_EQ(refused("30;1,5;-2;0,03;1\n1.040;2,5;-3;0,05;2\n50;3,5;-4;0,07;3\n").problem,
            "f_hz has a point among decimal commas: \"1.040\" (column 1)");
}

TEST(Import, Encodings) {
  const std::string plain = std::string(kHeader) + kRows;
  for (const bool is_big : {false, true}) {
    for (const bool has_mark : {false, true}) {
      std::string text = has_mark ? (is_big ? "\xFE\xFF" : "\xFF\xFE") : "";
      for (const char c : plain) {
        text += is_big ? std::string{'\0', c} : std::string{c, '\0'};
      }
      const ImportedPoints found = imported(text);
      expect_rows(found);
      EXPECT_NE(found.understanding.find("UTF-16"), std::string::npos);
    }
  }
  expect_rows(imported("Gemessen in M\xFCnchen\n" + plain));
  EXPECT_EQ(refused(std::string("\xFF\xFE\0\0f\0\0\0", 8)).problem, "the encoding is UTF-32");
  EXPECT_EQ(refused(plain + "60,1\x01,0,0.1,1\n").line, 5U);
}

TEST(Import, LineEnds) {
  for (const char* end : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : std::string(kHeader) + kRows) {
      text += c == '\n' ? end : std::string(1, c);
    }
    expect_rows(imported(text));
  }
}

TEST(Import, QuotesCommentsAndTrailingSeparators) {
  expect_rows(
      imported("\"f_hz\",\"amplitude\",\"phase_deg\",\"u_amplitude\",\"u_phase_deg\",,\n"
               "% remark\n\"30\",\"1.5\",-2,0.03,1,\n40,2.5,-3,0.05,2  # again\n,,,,\n"
               "50,3.5,-4,0.07,3,,#\n"));
  expect_rows(
      imported("30,1.5,\xE2\x88\x92"
               "2,0.03,1\n40,2.5,-3,0.05,2\n50,3.5,-4,0.07,3\n"));
}

TEST(Import, LinesBeforeTheHeaderAndARowOfUnits) {
  const ImportedPoints found = imported(
      "Report 7; of a laboratory\nSerial: 12\n\nFrequency;S;Phase;U(S);U(Phase)\n"
      "kHz;mV/(m/s\xC2\xB2);\xC2\xB0;%;mrad\n0.03;1500;-2;2;17\n0.04;2500;-3;2;17\n"
      "0.05;3500;-4;2;17\n");
  ASSERT_EQ(found.points.size(), 3U);
  expect_point(found.points.points()[1], 40.0, 2.5, -3.0, 0.05, 17e-3 / kDegree);
  EXPECT_EQ(found.understanding,
            "read as kHz, mV/(m/s2), deg, percent, mrad; 3 points; semicolons");
  EXPECT_EQ(found.lines[0], 6U);
}

TEST(Import, NamesAndUnitsOfHeaders) {
  struct Case {
    const char* header;
    double f, a, phase_deg, u_a, u_deg;  // Of the row 3,2,1,0.4,0.5.
  };
  constexpr double kG = 9.80665;
  const Case cases[] = {
      {"Frequency [Hz],Amplitude,Phase [deg],U(A),U(phase)", 3, 2, 1, 0.4, 0.5},
      {"f/kHz,|K|/(mV/g),phi/deg,uA,uphi", 3e3, 2e-3 / kG, 1, 0.4e-3 / kG, 0.5},
      {"omega_rad_s,S_v_per_g,phase_rad,u_S_percent,u_phase_deg", 3 / (2 * 180 * kDegree), 2 / kG,
       1 / kDegree, 2 / kG * 0.004, 0.5},
      {"Frequenz in Hz,Empfindlichkeit,Phase in Grad,Unsicherheit [%],U Phase", 3, 2, 1, 0.008,
       0.5},
      {"f_MHz,sensitivity (pC/g),phase lag (deg),U k=2,u_phase", 3e6, 2 / kG, -1, 0.4 / kG, 0.5},
      // A standard uncertainty is half of what is expanded.
      {"f,A,phase,standard uncertainty of A [%],U(phase) k=1", 3, 2, 1, 2 * 0.008, 1.0},
      {"f,A,phase,u_dB,u_phase", 3, 2, 1, 2 * 0.4 * std::log(10.0) / 20.0, 0.5},
  };
  for (const Case& expected : cases) {
    SCOPED_TRACE(expected.header);
    const ImportedPoints found =
        imported(std::string(expected.header) + "\n3,2,1,0.4,0.5\n4,2,1,0.4,0.5\n5,2,1,0.4,0.5\n");
    ASSERT_EQ(found.points.size(), 3U);
    expect_point(found.points.points()[0], expected.f, expected.a, expected.phase_deg, expected.u_a,
                 expected.u_deg);
  }
}

TEST(Import, Decibels) {
  const ImportedPoints found = imported(
      "f_hz,amplitude [dB re 1 mV/g],phase_deg,u [dB],u_phase_deg\n1,40,0,0.1,1\n2,-20,0,0.1,1\n"
      "3,0,0,0.1,1\n");
  ASSERT_EQ(found.points.size(), 3U);
  constexpr double kUnit = 1e-3 / 9.80665;
  // A decibel is ln(10)/20 of the amplitude; exp() is good to an ulp.
  constexpr double kDecibel = 0.11512925464970229;
  expect_point(found.points.points()[0], 1.0, 100.0 * kUnit, 0.0, 10.0 * kDecibel * kUnit, 1.0);
  expect_point(found.points.points()[1], 2.0, 0.1 * kUnit, 0.0, 0.01 * kDecibel * kUnit, 1.0);
  EXPECT_NE(found.understanding.find("dB re 1 mV/g"), std::string::npos);
}

TEST(Import, RepeatedRowsAreAveragedWithTheirScatter) {
  const ImportedPoints found =
      imported("50,3.5,-4,0.07,3\n30,1.4,359,0.04,1\n40,2.5,-3,0.05,2\n30,1.6,-3,0.04,1\n");
  ASSERT_EQ(found.points.size(), 3U);
  const ResponsePoint& point = found.points.points()[0];
  EXPECT_NEAR(point.amplitude, 1.5, 1e-15);
  // The phase goes on from the first row's: 359 and 357 degrees.
  EXPECT_NEAR(point.phase_rad, 358.0 * kDegree, 1e-14);
  // s = 0.1 sqrt(2) of two rows, so the mean adds 0.1 to the stated 0.02.
  EXPECT_NEAR(point.u_amplitude, std::sqrt(0.02 * 0.02 + 0.1 * 0.1), 1e-15);
  EXPECT_NEAR(point.u_phase_rad, kDegree * std::sqrt(0.5 * 0.5 + 1.0), 1e-14);
  const ImportedPoints turned =
      imported("30,1,-100,0.1,1\n30,1,90,0.1,1\n40,1,0,0.1,1\n50,1,0,0.1,1\n");
  EXPECT_NEAR(turned.points.points()[0].phase_rad, -185.0 * kDegree, 1e-14);
  EXPECT_NE(found.understanding.find("1 of them the mean of repeated rows"), std::string::npos);
}

TEST(Import, PhasesMayBeMissing) {
  const ImportedPoints found =
      imported(std::string(kHeader) + "30,1.5,,0.03,\n40,2.5,-3,0.05,2\n50,3.5,-,0.07,---\n");
  ASSERT_EQ(found.points.size(), 3U);
  EXPECT_EQ(found.points.known_phases(), 1U);
  EXPECT_EQ(imported("f,A,U(A)\n1,2,0.1\n2,2,0.1\n3,2,0.1\n").points.known_phases(), 0U);
  EXPECT_EQ(refused(std::string(kHeader) + "30,1.5,,0.03,1\n" + kRows).problem,
            "phase_deg is missing (column 3)");
  EXPECT_EQ(refused(std::string(kHeader) + "30,1.5,2,0.03,\n" + kRows).problem,
            "u_phase_deg is missing (column 5)");
}

TEST(Import, OptionsSayWhatTheTableDoesNot) {
  ImportOptions options;
  ASSERT_TRUE(take_uncertainty("2%, 1deg", options));
  ASSERT_TRUE(take_input_units("mV/g,kHz,rad", options));
  const std::string text = "f,A,phase\n3,2,1\n4,2,1\n5,2,1\n";
  expect_point(imported(text, options).points.points()[0], 3e3, 2e-3 / 9.80665, 1.0 / kDegree,
               2e-3 / 9.80665 * 0.02, 1.0);
  // Rows without a header, too.
  ImportOptions units;
  ASSERT_TRUE(take_input_units("mV/(m/s^2)", units));
  expect_point(imported(kRows, units).points.points()[0], 30.0, 1.5e-3, -2.0, 0.03e-3, 1.0);
  EXPECT_NE(refused(std::string("f,A [V/g],phase,uA,uphi\n") + kRows, units).problem.find("V/g"),
            std::string::npos);
  EXPECT_NE(refused(kRows, options).problem.find("uncertainties of its own"), std::string::npos);
}

TEST(Import, WrongValuesOfOptionsChangeNothing) {
  for (const char* text : {"", "1", "%", "1%,1%", "1%,", "-1%", "1furlong", "1kHz", "nan%", "0%"}) {
    ImportOptions options;
    EXPECT_FALSE(take_uncertainty(text, options)) << text;
    EXPECT_EQ(options.amplitude_uncertainty.value, 0.0);
  }
  for (const char* text : {"", "x", "%", "dB", "mV/g,V/g", "mV/g,"}) {
    ImportOptions options;
    EXPECT_FALSE(take_input_units(text, options)) << text;
    EXPECT_FALSE(options.amplitude_unit.is_given());
  }
  for (const char* text : {"", "1.5", "x", "1 s", "nan", "-2"}) {
    ImportOptions options;
    EXPECT_FALSE(take_channel_delay(text, options)) << text;
  }
}

TEST(Import, DelayAndPolarityAreTakenOut) {
  ImportOptions options;
  ASSERT_TRUE(take_channel_delay("0.001", options));
  options.is_inverted = true;
  // 30 Hz times 1 ms are 10.8 degrees; 180 - 2 + 10.8 - 360.
  const ImportedPoints found = imported(kRows, options);
  EXPECT_NEAR(found.points.points()[0].phase_rad, -171.2 * kDegree, 1e-13);
}

TEST(Import, EveryComplaintNamesItsLine) {
  const std::string head = std::string("before\n\n") + kHeader + "30,1.5,-2,0.03,1\n";
  const struct {
    const char* row;
    const char* problem;
  } cases[] = {
      {"40,2.5,-3,0.05", "there are 4 columns: \"40,2.5,-3,0.05\""},
      {"40,2.5,-3,0.05,2,7", "there are 6 columns: \"40,2.5,-3,0.05,2,7\""},
      {"x,2.5,-3,0.05,2", "f_hz is not a number: \"x\" (column 1)"},
      {"40,2.5x,-3,0.05,2", "amplitude is not a number: \"2.5x\" (column 2)"},
      {"40,2.5,-3,inf,2", "u_amplitude is not a finite number: \"inf\" (column 4)"},
      {"40,0,-3,0.05,2", "amplitude is zero or negative: \"0\" (column 2)"},
      {"-40,2,-3,0.05,2", "f_hz is zero or negative: \"-40\" (column 1)"},
      {"40,2,-3,0,2", "u_amplitude is zero or negative: \"0\" (column 4)"},
      {"40,2,-3,0.05,-1", "u_phase_deg is zero or negative: \"-1\" (column 5)"},
      {"40,2,361,0.05,1", "phase_deg is outside -360 to 360: \"361\" (column 3)"},
      {"end of the table", "there is 1 column: \"end of the table\""},
  };
  for (const auto& expected : cases) {
    const ImportError error = refused(head + expected.row + "\n" + kRows);
    EXPECT_EQ(error.problem, expected.problem);
    EXPECT_EQ(error.line, 5U) << expected.row;
  }
  EXPECT_EQ(refused("30,x,-2,0.03,1\n40,2.5,-3,0.05,2\n").line, 1U);
}

// Standard uncertainties of the first row: of the amplitude 2 and of the phase in degrees.
void expect_uncertainties(const std::string& text, double u_amplitude, double u_deg) {
  SCOPED_TRACE(text);
  const ImportedPoints found = imported(text);
  ASSERT_EQ(found.points.size(), 3U);
  EXPECT_NEAR(found.points.points()[0].u_amplitude, u_amplitude, kRounding * u_amplitude);
  EXPECT_NEAR(found.points.points()[0].u_phase_rad, u_deg * kDegree, kRounding * u_deg);
}

const char* const kPlainRows = "3,2,1,0.4,0.5\n4,2,1,0.4,0.5\n5,2,1,0.4,0.5\n";

TEST(Import, CoverageFactors) {
  const std::string rows = kPlainRows;
  // In names.
  for (const char* names :
       {"U (k=1),U phase (k=1)", "U(A) (k = 1),U(phase) (k = 1.00)", "u_A k1,u_phase k 1",
        "standard uncertainty of A,std uncertainty of phase",
        "U(A) (1 sigma),U(phase) (1 \u03C3)"}) {
    expect_uncertainties(std::string("f,A,phase,") + names + "\n" + rows, 0.4, 0.5);
  }
  expect_uncertainties("f,A,phase,\"U(A) (k=2,00) [%]\",U(phase) (k=3)\n" + rows, 0.004, 0.5 / 3.0);
  expect_uncertainties("f,A,phase,U(A) (95 %) [%],U(phase) (2 sigma)\n" + rows, 0.004, 0.25);
  // In lines before the header and in comments, for both.
  const std::string plain = "f,A,phase,U(A),U(phase)\n" + rows;
  for (const char* line :
       {"Coverage factor: 3", "Coverage factor (k): 3.0", "k = 3", "# all uncertainties with k=3",
        "k,3", "Erweiterungsfaktor;3,0", "expanded uncertainty (k=3) of all values",
        "the standard uncertainty multiplied by the coverage factor k = 3, 99.7 %",
        "Facteur d'\u00E9largissement k = 3"}) {
    expect_uncertainties(std::string(line) + "\n" + plain, 0.4 / 3.0, 0.5 / 3.0);
  }
  expect_uncertainties("Standard uncertainties\n" + plain, 0.4, 0.5);
  expect_uncertainties("# k = 1\n" + rows, 0.4, 0.5);
  expect_uncertainties(rows + "# k = 1\n", 0.4, 0.5);
  EXPECT_NE(imported("k = 3\n" + plain).understanding.find(", k = 3;"), std::string::npos);
  EXPECT_NE(imported("k = 1\n" + plain).understanding.find("standard uncertainties"),
            std::string::npos);
  // Other letters k, and what is no coverage factor.
  for (const char* line : {"spring constant k = 3 N/m", "K = 3", "k = 300", "rank=3",
                           "Sensitivity k = 3.0 mV/g at 160 Hz", "stock=1"}) {
    expect_uncertainties(std::string(line) + "\n" + plain, 0.2, 0.25);
  }
}

TEST(Import, RatiosAreNoSensitivities) {
  for (const char* name : {"Sensitivity [-]", "Sensitivity (-)", "Relative sensitivity",
                           "Relative sensitivity [dB]"}) {
    const std::string text = std::string("f,") + name + ",phase,U(A) [%],U(phase)\n" + kPlainRows;
    const std::string whole = std::string("\"") + name + "\"";
    EXPECT_EQ(refused(text).problem, whole + " is a ratio, which leaves the sensitivity open");
  }
  for (const char* name : {"Relative sensitivity [mV/g]", "rel. Sensitivity [dB re 1 mV/g]"}) {
    EXPECT_EQ(imported(std::string("f,") + name + ",phase,U(A) [%],U(phase)\n" + kPlainRows)
                  .points.size(),
              3U);
  }
}

TEST(Import, CoverageFactorsThatContradict) {
  const std::string rows = kPlainRows;
  const auto problem = [&rows](const std::string& head) { return refused(head + rows).problem; };
  EXPECT_EQ(problem("k = 2\ncoverage factor 3\nf,A,phase,U(A),U(phase)\n"),
            "this line says k = 3, and line 1 says k = 2");
  EXPECT_EQ(problem("# k = 2\nf,A,phase,U(A) (k=1),U(phase) (k=2)\n"),
            "\"U(A) (k=1)\" says k = 1, and line 1 says k = 2");
  EXPECT_EQ(problem("f,A,phase,U(A) (k=3),U(phase)\n"),
            "\"U(A) (k=3)\" says k = 3, and \"U(phase)\" says nothing of its coverage factor");
  EXPECT_EQ(problem("f,A,phase,standard uncertainty of A (k=2),U(phase) k=2\n"),
            "\"standard uncertainty of A (k=2)\" states two coverage factors");
  // Perhaps only the reference's.
  for (const char* line :
       {"Certificate of reference sensor: Uncertainty 0.3 % (k = 3)",
        "# Uncertainty of the reference, coverage factor: 3", "Unsicherheit des Normals (k = 3)"}) {
    EXPECT_EQ(
        problem(std::string(line) + "\nf,A,phase,U(A),U(phase)\n"),
        "this line speaks of a reference and says k = 3: of that one, or of the uncertainties "
        "in the table");
    expect_uncertainties(std::string(line) + "\nf,A,phase,U(A) (k=1),U(phase) (k=1)\n" + rows, 0.4,
                         0.5);
  }
  EXPECT_EQ(
      refused("f,A,phase,U(A),U(phase)\n" + rows + "# Reference: standard uncertainty 0.25 %\n")
          .line,
      5U);
  expect_uncertainties("Reference: U = 0.3 % (k = 2)\nf,A,phase,U(A),U(phase)\n" + rows, 0.2, 0.25);
  // The same value twice is no contradiction.
  expect_uncertainties("k = 3\n# coverage factor: 3\nf,A,phase,U(A) (k=3),U(phase)\n" + rows,
                       0.4 / 3.0, 0.5 / 3.0);
}

TEST(Import, UnitsInLinesBeforeTheHeader) {
  const std::string table = std::string("f,A,phase,U(A),U(phase)\n") + kPlainRows;
  constexpr double kG = 9.80665;
  for (const char* line :
       {"Units: kHz, mV/g, rad", "Einheiten;kHz;mV/g;rad", "# f in kHz, A in mV/g, phase in rad",
        "Frequency (kHz), sensitivity (mV/g), phase (rad)"}) {
    SCOPED_TRACE(line);
    // A line with all names is itself a header: the names of the table would be a second one.
    const bool is_header = std::string(line).find("Frequency") == 0;
    const ImportedPoints found = is_header
                                     ? imported(std::string(line) + ",U(A),U(phase)\n" + kPlainRows)
                                     : imported(std::string(line) + "\n" + table);
    ASSERT_EQ(found.points.size(), 3U);
    expect_point(found.points.points()[0], 3e3, 2e-3 / kG, 1.0 / kDegree, 0.4e-3 / kG,
                 0.5 / kDegree);
  }
  EXPECT_EQ(refused("Units: kHz\nUnits: Hz\n" + table).problem,
            "this line says Hz, and line 1 says kHz");
  EXPECT_EQ(
      refused(std::string("Unit of A: mV/g\nf,A [V/g],phase,U(A),U(phase)\n") + kPlainRows).problem,
      "\"A [V/g]\" is in V/g, and line 1 says mV/g");
  // What says nothing of units is passed over.
  for (const char* line : {"Unit under test: 4711", "Sensitivity at 160 Hz: 10.2 mV/g",
                           "Phase reference: front", "Unit: no. 5"}) {
    expect_uncertainties(std::string(line) + "\n" + table, 0.2, 0.25);
  }
}

TEST(Import, HeadersOverTwoLines) {
  constexpr double kG = 9.80665;
  for (const char* header :
       {"f;Sensitivity;Phase;U(A);U(phase)\nkHz;mV/g;deg;%;deg",
        "f;Sensitivity;Phase;U(A);U(phase)\n[kHz];[mV/g];[\u00B0];[%];[\u00B0]",
        "Frequency;Sensitivity;Phase;Expanded;Expanded\nkHz;mV/g;deg;uncertainty [%];uncertainty "
        "[deg]"}) {
    SCOPED_TRACE(header);
    std::string rows = kPlainRows;
    std::replace(rows.begin(), rows.end(), ',', ';');
    expect_point(imported(std::string(header) + "\n" + rows).points.points()[0], 3e3, 2e-3 / kG,
                 1.0, 0.008e-3 / kG, 0.5);
  }
  // A name above several columns; the row is f, A, U, phase, U.
  for (const char* header : {"Frequency,Sensitivity,,Phase,\n,value,U,value,U",
                             ",Sensitivity,,Phase,\nf,value,U,value,U",
                             "Frequency,Sensitivity [V/(m/s^2)],,Phase [deg],\nHz,value,U,value,U",
                             "Frequency,Magnitude,,Phase,\n,value,U,value,U\nHz,,,deg,deg",
                             "Frequency,Magnitude,,Phase,\nHz,V/(m/s2),U (k=2),deg,U (k=2) deg"}) {
    SCOPED_TRACE(header);
    expect_point(imported(std::string(header) + "\n3,2,0.4,1,0.5\n4,2,0.4,1,0.5\n5,2,0.4,1,0.5\n")
                     .points.points()[0],
                 3.0, 2.0, 1.0, 0.4, 0.5);
  }
  EXPECT_EQ(refused("f;Sensitivity;Phase;U(A);U(phase)\nHz;lbf;deg;%;deg\n3;2;1;1;1\n4;2;1;1;1\n")
                .problem,
            "the unit \"lbf\" of \"Sensitivity lbf\" is not known");
}

TEST(Import, MoreNamesOfHeaders) {
  for (const char* header :
       {"f,|K| [V/(m/s2)],arg K [deg],U(|K|),U(arg K)",
        "Fr\u00E9quence (Hz),Sensibilit\u00E9 (V/(m/s\u00B2)),D\u00E9phasage (\u00B0),Incertitude "
        "\u00E9largie,Incertitude phase",
        "Frequency,Sensitivity magnitude [V/(m/s2)],Phase of sensitivity [deg],U of magnitude,U of "
        "phase",
        "Frequenz,\u00DCbertragungskoeffizient,Phasenverschiebung,Messunsicherheit,"
        "Messunsicherheit",
        "f,frequency response amplitude,frequency response phase,u amplitude,u phase"}) {
    expect_uncertainties(std::string(header) + "\n" + kPlainRows, 0.2, 0.25);
  }
  // A relative uncertainty without a unit is a part of 1.
  expect_uncertainties(std::string("f,A,phase,u_rel_A,u_phase\n") + kPlainRows, 0.4, 0.25);
  // The header is the first comment with all names, though others stand behind it.
  const ImportedPoints found =
      imported(std::string("# f_khz,A,phase,U(A),U(phase)\n# by hand\n") + kPlainRows);
  EXPECT_EQ(found.points.points()[0].frequency_hz, 3e3);
}

TEST(Import, WordsAroundTheTable) {
  const std::string table = std::string("f,A,phase,U(A),U(phase)\n") + kPlainRows;
  expect_uncertainties(table + "\nMeasured by,N. N.\nTemperature,23 C\n", 0.2, 0.25);
  expect_uncertainties(table + "\nCoverage factor k = 1\n", 0.4, 0.5);
  expect_uncertainties(std::string("f,A,phase,U(A),U(phase)\nk = 1\n") + kPlainRows, 0.4, 0.5);
  // What is no word there, or has no empty line before it, is a row with a fault.
  EXPECT_EQ(refused(table + "\n6,2,1\n").problem, "there are 3 columns: \"6,2,1\"");
  EXPECT_EQ(refused(table + "\nMeasured by N. N.\n6,2,1,0.4,0.5\n").line, 6U);
  EXPECT_EQ(refused(table + "x,2,1,0.4,0.5\n").problem, "f is not a number: \"x\" (column 1)");
}

TEST(Import, TwoUncertaintiesOfTheSameName) {
  for (const char* header :
       {"f,A,phase,U,U", "f,A,phase,U [V/(m/s2)],U [deg]", "f,A,phase,uncertainty,uncertainty"}) {
    expect_uncertainties(std::string(header) + "\n" + kPlainRows, 0.2, 0.25);
  }
  expect_uncertainties("f,A,U,phase,U\n3,2,0.4,1,0.5\n4,2,0.4,1,0.5\n5,2,0.4,1,0.5\n", 0.2, 0.25);
}

TEST(Import, MarksOfThousands) {
  const struct {
    const char* rows;
    const char* what;
  } tables[] = {
      {"1234.5,2,1,0.4,0.5\n", "none"},
      {"\"1,234.5\",2,1,0.4,0.5\n", "comma"},
      {"1'234.5,2,1,0.4,0.5\n", "apostrophe"},
      {"1 234.5,2,1,0.4,0.5\n", "blank"},
      {"1\u202F234.5,2,1,0.4,0.5\n", "narrow blank"},
  };
  for (const auto& table : tables) {
    SCOPED_TRACE(table.what);
    const ImportedPoints found =
        imported(std::string(table.rows) + "2000,2,1,0.4,0.5\n3000,2,1,0.4,0.5\n");
    EXPECT_EQ(found.points.points()[0].frequency_hz, 1234.5);
  }
  EXPECT_EQ(imported("1.234,5;2;1;0,4;0,5\n2.000.000;2;1;0,4;0,5\n3000;2;1;0,4;0,5\n")
                .points.points()[0]
                .frequency_hz,
            1234.5);
  // A thousand, or one with a decimal comma?
  const ImportError error = refused("30;1.5;-2;0.03;1\n1,040;2.5;-3;0.05;2\n50;3.5;-4;0.07;3\n");
  EXPECT_EQ(error.problem, "f_hz has a comma among decimal points: \"1,040\" (column 1)");
  EXPECT_EQ(error.line, 2U);
  for (const char* cell : {"1,23.5", "0,123.5", "12,34,567", "1,2345.5", "1234,567.5"}) {
    EXPECT_EQ(
        refused("30,2,1,0.4,0.5\n\"" + std::string(cell) + "\",2,1,0.4,0.5\n40,2,1,0.4,0.5\n").line,
        2U)
        << cell;
  }
}

TEST(Import, SaysWhichCoverageFactorItAssumes) {
  const std::string words = ", uncertainties taken as k = 2";
  const auto says = [&words](const std::string& header) {
    return imported(header + "\n" + kRows).understanding.find(words) != std::string::npos;
  };
  EXPECT_TRUE(says("Frequency,Magnitude,Phase,U95,U95"));  // What it covers, but not how.
  EXPECT_TRUE(says("Frequency,Magnitude,Phase,Uncertainty (Magnitude),Uncertainty (Phase)"));
  // The native form, the symbol of an expanded uncertainty, and where it is stated.
  EXPECT_FALSE(says("f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg"));
  EXPECT_FALSE(says("Frequency,Magnitude,Phase,U(Magnitude),U(Phase)"));
  EXPECT_FALSE(says("Frequency,Magnitude,Phase,u(Magnitude) k=2,u(Phase) k=2"));
  EXPECT_FALSE(says("# k = 2\nFrequency,Magnitude,Phase,u(Magnitude),u(Phase)"));
}

// By the GUM u is a standard uncertainty and U an expanded one; half as large or not is not
// guessed.
TEST(Import, AsksWhatASmallUIs) {
  const std::string rows = std::string("\n") + kPlainRows;
  for (const char* header : {"f,A,phase,u(A),u(phase)", "f,A,phase,U(A),u(phase) (deg)",
                             "f,A,phase,u (A) [%],U(phase)"}) {
    const ImportError error = refused(header + rows);
    EXPECT_NE(error.problem.find("is the symbol of a standard uncertainty"), std::string::npos)
        << header;
    EXPECT_NE(error.expectation.find("u(A) (k=1)"), std::string::npos);
  }
  expect_uncertainties("f,A,phase,u(A) (k=1),u(phase) (k=1)" + rows, 0.4, 0.5);
  expect_uncertainties("f,A,phase,u(A) (k=2),u(phase) (k=2)" + rows, 0.2, 0.25);
  expect_uncertainties("k = 1\nf,A,phase,u(A),u(phase)" + rows, 0.4, 0.5);
  // A combined standard uncertainty says k by its symbol, and the native names are expanded ones.
  expect_uncertainties("f,A,phase,uc(A),uc(phase)" + rows, 0.4, 0.5);
  expect_uncertainties("f,A,phase,u_c(A),u_c(phase)" + rows, 0.4, 0.5);
  expect_uncertainties("f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg" + rows, 0.2, 0.25);
}

TEST(Import, QuotesAUnitWithoutTheBracketOfItsName) {
  EXPECT_EQ(refused(std::string("f,A,phase,U(A) (% of S),U(phase)\n") + kPlainRows).problem,
            "the unit \"% of S\" of \"U(A) (% of S)\" is not known");
  EXPECT_EQ(refused(std::string("f,A,phase,U(A),U(phase) (%)\n") + kPlainRows).problem,
            "the unit \"%\" of \"U(phase) (%)\" is not known");
}

TEST(Import, UnitsBehindNumbers) {
  constexpr double kG = 9.80665;
  const ImportedPoints found = imported(
      "Frequency;Sensitivity;Phase;U;U\n100 Hz;2 mV/g;-1\u00B0;1 %;0.5 deg\n1 kHz;2 "
      "mV/g;-2\u00B0;1 "
      "%;0.5 deg\n3 kHz;0.002 V/g;-3\u00B0;1%;0.5 deg\n");
  ASSERT_EQ(found.points.size(), 3U);
  expect_point(found.points.points()[0], 100.0, 2e-3 / kG, -1.0, 0.02e-3 / kG, 0.5);
  expect_point(found.points.points()[2], 3000.0, 2e-3 / kG, -3.0, 0.02e-3 / kG, 0.5);
  EXPECT_NE(found.understanding.find("read as Hz, mV/g, deg, percent"), std::string::npos);
  EXPECT_EQ(
      refused("f;A;phase;U;U\n100 Hz;2 V/g;1;1;1\n200 Hz;2 Hz;1;1;1\n300 Hz;2 V/g;1;1;1\n").problem,
      "A is in another unit than its column: \"2 Hz\" (column 2)");
}

TEST(Import, CellsOfSpreadsheetsWithoutAValue) {
  const ImportedPoints found = imported(
      std::string(kHeader) + "30,1.5,#N/A,0.03,#N/A\n40,2.5,-3,0.05,2\n50,3.5,#NV,0.07,NA\n");
  ASSERT_EQ(found.points.size(), 3U);
  EXPECT_EQ(found.points.known_phases(), 1U);
  const struct {
    const char* row;
    const char* problem;
  } cases[] = {
      {"40,#N/A,-3,0.05,2", "amplitude is missing: \"#N/A\" (column 2)"},
      {"40,2.5,-3,#DIV/0!,2", "u_amplitude is not a number: \"#DIV/0!\" (column 4)"},
      {"#WERT!,2.5,-3,0.05,2", "f_hz is not a number: \"#WERT!\" (column 1)"},
      {"40,a cell with more than forty characters in it,-3,0.05,2",
       "amplitude is not a number: \"a cell with more than forty characters i...\" (column 2)"},
  };
  for (const auto& expected : cases) {
    EXPECT_EQ(refused(std::string(kHeader) + kRows + expected.row + "\n").problem,
              expected.problem);
  }
  // Behind a blank it is a comment as before.
  expect_rows(imported(std::string(kHeader) + "30,1.5,-2,0.03,1 # N/A\n" + (kRows + 16)));
}

TEST(Import, OptionsAboutPhasesThatAreNotThere) {
  const std::string table = "f,A,U(A)\n1,2,0.1\n2,2,0.1\n3,2,0.1\n";
  ImportOptions delay;
  ASSERT_TRUE(take_channel_delay("1e-5", delay));
  EXPECT_EQ(refused(table, delay).problem, "there are no phases that --channel-delay could change");
  ImportOptions inverted;
  inverted.is_inverted = true;
  EXPECT_EQ(refused(table, inverted).problem, "there are no phases that --invert could change");
  ImportOptions unit;
  ASSERT_TRUE(take_input_units("rad", unit));
  EXPECT_EQ(refused(table, unit).problem,
            "the table has no phase, and --input-units speaks of one");
  ImportOptions u;
  ASSERT_TRUE(take_uncertainty("1%,1deg", u));
  EXPECT_EQ(refused("f,A\n1,2\n2,2\n3,2\n", u).problem,
            "the table has no phase, and --uncertainty speaks of one");
  // An uncertainty is stated once.
  EXPECT_EQ(refused("f,A,phase,U(A)\n1,2,0,0.1\n2,2,0,0.1\n3,2,0,0.1\n", u).problem,
            "the table has uncertainties of its own for the amplitude");
}

TEST(Import, WhatWasUnderstoodHasItsValues) {
  ImportOptions options;
  ASSERT_TRUE(take_channel_delay("1e-5", options));
  ASSERT_TRUE(take_uncertainty("1%,0.5deg", options));
  EXPECT_EQ(imported("f,A,phase\n1,2,0\n2,2,0\n3,2,0\n", options).understanding,
            "read as Hz, V/(m/s2), deg, U = 1 percent and 0.5 deg by --uncertainty; 3 points; the "
            "channel's delay of 1e-05 s taken out");
}

TEST(Import, WhatThePointsHaveInCommon) {
  const std::string header = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,u_common\n";
  const std::string rows = "30,2,-2,0.10,1,0.06\n40,2,-3,0.10,2,0.08\n50,2,-4,0.10,3,0\n";
  const std::string shared =
      "# shared: skew=1e-07 clock=2e-05 drift=0.0001 corner=50 images=1e-6 leak=2e-6 "
      "leak_back=3e-6 "
      "linearity=1e-5\n";
  const ImportedPoints found = imported(header + rows + shared);
  ASSERT_EQ(found.points.size(), 3U);
  EXPECT_TRUE(found.states_common);
  // A right triangle of 3, 4 and 5; half of all for k = 2.
  EXPECT_NEAR(found.points.points()[0].u_amplitude, 0.04, 1e-15);
  EXPECT_NEAR(found.points.points()[1].u_amplitude, 0.03, 1e-15);
  EXPECT_NEAR(found.points.common()[0], 0.03 / 2.0, 1e-15);
  EXPECT_EQ(found.points.common()[2], 0.0);
  EXPECT_EQ(found.points.shared().skew_s, 1e-7);
  EXPECT_EQ(found.points.shared().linearity, 1e-5);
  EXPECT_EQ(found.points.shared().corner_hz, 50.0);
  EXPECT_EQ(refused(header + rows + "# shared: skew=x\n").line, 5U);
  EXPECT_EQ(refused(header + rows + "# shared: tilt=1\n").problem,
            "what all points share is not readable");
  EXPECT_EQ(refused(header + "30,2,-2,0.10,1,0.2\n" + rows).problem,
            "u_common is not below the uncertainty that contains it: \"0.2\" (column 6)");
}

TEST(Import, HowMany) {
  EXPECT_EQ(refused("").problem, "the table holds no points");
  EXPECT_EQ(refused(kHeader).problem, "the table holds no points");
  EXPECT_EQ(refused("30,1,0,0.01,1\n").problem, "the table holds only 1 point");
  EXPECT_EQ(refused("30,1,0,0.01,1\n30,1,0,0.01,1\n40,1,0,0.01,1\n").problem,
            "the table holds only 2 points");
  std::string many;
  for (std::size_t i = 1; i <= emax::kMaxPoints; ++i) {
    many += std::to_string(i) + ",1,0,0.01,1\n";
  }
  EXPECT_EQ(imported(many).points.size(), emax::kMaxPoints);
  EXPECT_EQ(refused(many + "5000,1,0,0.01,1\n").line, emax::kMaxPoints + 1);
}

TEST(Import, UncertaintiesBehindPlusAndMinus) {
  for (const char* sign : {"\u00B1", "\u00B1 ", "+/-", "+/- ", "+-"}) {
    std::string rows;
    for (const char* f : {"3", "4", "5"}) {
      rows += std::string(f) + ",2,1," + sign + "0.4," + sign + "0.5\n";
    }
    expect_uncertainties("f,A,phase,U(A),U(phase)\n" + rows, 0.2, 0.25);
  }
  const ImportedPoints with_units = imported(
      "f,A,phase,U,U\n3,2,1,\u00B1 20 %,\u00B10.5\u00B0\n4,2,1,\u00B1 20 %,\u00B10.5\u00B0\n"
      "5,2,1,\u00B1 20 %,\u00B10.5\u00B0\n");
  expect_point(with_units.points.points()[0], 3.0, 2.0, 1.0, 0.4, 0.5);
  EXPECT_NE(with_units.understanding.find("percent"), std::string::npos);
  // Nothing else has such a sign, and no uncertainty is below 0.
  EXPECT_EQ(refused(std::string(kHeader) + kRows + "60,1,\u00B13,0.1,1\n").problem,
            "phase_deg has a sign of plus and minus, as an uncertainty: \"\u00B13\" (column 3)");
  EXPECT_EQ(refused(std::string(kHeader) + kRows + "60,1,3,\u00B1-0.1,1\n").problem,
            "u_amplitude is zero or negative: \"\u00B1-0.1\" (column 4)");
}

TEST(Import, SymbolsOfResponses) {
  for (const char* header :
       {"f,|H|,arg(H),U(|H|),U(arg(H))", "f,|H(f)|,arg(H(f)),U,U", "f,abs(H),arg H,U(H),U(arg H)",
        "f,|H(j\u03C9)|,\u2220H(j\u03C9),U,U", "Frequency f,Sensitivity S,Phase phi,U,U",
        "Frequency (f) [Hz],Sensitivity (S),Phase (\u03C6) [deg],U,U"}) {
    expect_uncertainties(std::string(header) + "\n" + kPlainRows, 0.2, 0.25);
  }
  // A real and an imaginary part are neither.
  EXPECT_EQ(refused(std::string("f,Re(H),Im(H),U,U\n") + kPlainRows).problem,
            "the header has no name for the amplitude");
}

TEST(Import, NamesInOtherLanguages) {
  for (const char* header :
       {"Frequenz in Hz,Betrag des \u00DCbertragungskoeffizienten in V/(m/s\u00B2),"
        "Phasenverschiebung in \u00B0,erweiterte Messunsicherheit,erweiterte Messunsicherheit",
        "Messfrequenz / Hz,\u00DCbertragungskoeffizient / V/(m/s\u00B2),"
        "Phasenverschiebungswinkel / \u00B0,Erweiterte Messunsicherheit / V/(m/s\u00B2),"
        "Erweiterte Messunsicherheit / \u00B0",
        "Frequenz f [Hz],Spannungs\u00FCbertragungskoeffizient Sua [V/(m/s\u00B2)],"
        "Phasenverschiebung \u03C6ua [\u00B0],Messunsicherheit U (k=2),Messunsicherheit U (k=2)",
        "Frequenza (Hz),Sensibilit\u00E0 (V/(m/s\u00B2)),Fase (\u00B0),Incertezza,Incertezza",
        "FREQUENZA,SENSIBILIT\u00C0,SFASAMENTO,INCERTEZZA ESTESA,INCERTEZZA ESTESA",
        "Fr\u00E9quence,Sensibilit\u00E9,Phase,Incertitude,Incertitude",
        "Fr\u00E9quence,Module,D\u00E9phasage,Incertitude \u00E9largie,Incertitude \u00E9largie",
        "Frecuencia,Sensibilidad,Fase,Incertidumbre,Incertidumbre",
        "Frecuencia,M\u00F3dulo,Desfase,Incertidumbre expandida,Incertidumbre de la fase"}) {
    expect_uncertainties(std::string(header) + "\n" + kPlainRows, 0.2, 0.25);
  }
  EXPECT_EQ(refused(std::string("Frequenz,Querempfindlichkeit,Phase,U,U\n") + kPlainRows).problem,
            "the header has no name for the amplitude");
}

TEST(Import, StandardUncertaintiesByTheirNames) {
  for (const char* names : {"Combined standard uncertainty,Combined standard uncertainty",
                            "Kombinierte Standardunsicherheit,Kombinierte Standardmessunsicherheit",
                            "Incertitude-type compos\u00E9e,Incertitude type",
                            "Incertezza tipo,Incertezza tipo composta",
                            "Incertidumbre t\u00EDpica,Incertidumbre est\u00E1ndar combinada"}) {
    const std::string text = std::string("f,A,phase,") + names + "\n" + kPlainRows;
    expect_uncertainties(text, 0.4, 0.5);
    EXPECT_NE(imported(text).understanding.find("standard uncertainties"), std::string::npos);
  }
}

TEST(Import, Charges) {
  constexpr double kG = 9.80665;
  for (const char* header :
       {"f,Charge sensitivity [pC/g],phase,U [pC/g],U [deg]",
        "f,Ladungs\u00FCbertragungskoeffizient Sqa / pC/g,Phasenverschiebung,U / pC/g,U / \u00B0",
        "f,Charge Sensitivity,Phase,U,U\nHz,pC/g,deg,pC/g,deg"}) {
    const ImportedPoints found = imported(std::string(header) + "\n" + kPlainRows);
    expect_point(found.points.points()[0], 3.0, 2.0 / kG, 1.0, 0.4 / kG, 0.5);
    EXPECT_NE(found.understanding.find("1 pC is taken as 1 V"), std::string::npos);
  }
  const std::string table = std::string("f,Charge sensitivity,phase,U [%],U [deg]\n") + kPlainRows;
  const ImportError error = refused(table);
  EXPECT_EQ(error.problem, "\"Charge sensitivity\" is a charge, and its unit is not stated");
  EXPECT_NE(error.expectation.find("--input-units"), std::string::npos);
  ImportOptions options;
  ASSERT_TRUE(take_input_units("pC/g", options));
  EXPECT_NEAR(imported(table, options).points.points()[0].amplitude, 2.0 / kG, 1e-15);
  EXPECT_EQ(refused(std::string("f,Charge sensitivity [mV/g],phase,U [%],U [deg]\n") + kPlainRows)
                .problem,
            "\"Charge sensitivity [mV/g]\" is a charge, and its unit is one of voltage");
}

// 400 gon are a turn; German degrees are "Grad", and others call the gon so.
TEST(Import, GonAndGrad) {
  const auto with_unit = [](const char* names, const char* unit) {
    return std::string(names) + ",phase [" + unit + "],U [%],U [" + unit + "]\n" + kPlainRows;
  };
  expect_point(imported(with_unit("f,A", "gon")).points.points()[0], 3.0, 2.0, 0.9, 0.008, 0.45);
  expect_point(imported(with_unit("Frequenz,Empfindlichkeit", "Grad")).points.points()[0], 3.0, 2.0,
               1.0, 0.008, 0.5);
  const ImportError error = refused(with_unit("f,A", "grad"));
  EXPECT_NE(error.problem.find("may be degrees, as in German, or gon"), std::string::npos);
  EXPECT_EQ(error.expectation, "expected deg or gon in its place");
  ImportOptions options;
  EXPECT_FALSE(take_input_units("grad", options));
  EXPECT_FALSE(take_uncertainty("1%,1grad", options));
  EXPECT_TRUE(take_input_units("gon", options));
  EXPECT_TRUE(take_uncertainty("1%,1gon", options));
}

std::string with_frequencies(const std::vector<const char*>& frequencies, char separator) {
  std::string text = std::string("f") + separator + "A" + separator + "phase" + separator + "U" +
                     separator + "U\n";
  for (const char* f : frequencies) {
    for (const char* cell : {f, "2.5", "1", "0.4"}) {
      text += std::string(cell) + separator;
    }
    text += "0.5\n";
  }
  return text;
}

TEST(Import, ThousandsThatTheOrderTells) {
  const struct {
    std::vector<const char*> frequencies;
    double last;
  } tables[] = {
      {{"500", "800", "1,000", "1,250"}, 1250.0},
      {{"20", "1,000", "2,000", "10,000"}, 10000.0},
      {{"500", "800", "1 000", "1 250"}, 1250.0},
  };
  for (const auto& table : tables) {
    for (const char separator : {';', '\t'}) {
      const ImportedPoints found = imported(with_frequencies(table.frequencies, separator));
      EXPECT_EQ(found.points.points()[table.frequencies.size() - 1].frequency_hz, table.last);
      EXPECT_EQ(found.points.points()[0].frequency_hz, std::stod(table.frequencies[0]));
    }
  }
  EXPECT_NE(imported(with_frequencies({"500", "800", "1,000"}, ';'))
                .understanding.find("; a comma in a frequency is one of thousands"),
            std::string::npos);
  // Both ways they are in order, or neither is.
  for (const auto& open : {std::vector<const char*>{"0.5", "1,000", "2,000"},
                           std::vector<const char*>{"30", "1,040", "50"}}) {
    EXPECT_NE(refused(with_frequencies(open, ';')).problem.find("has a comma among decimal points"),
              std::string::npos);
  }
  EXPECT_NE(refused(with_frequencies({"1,000", "2,000", "3,000"}, ';')).problem, "");
  // No other column tells which sign is the decimal one.
  const auto integers = [](const std::string& f1, const std::string& f2, const std::string& f3) {
    return "f;A;phase;U;U\n" + f1 + ";2;1;1;1\n" + f2 + ";2;1;1;1\n" + f3 + ";2;1;1;1\n";
  };
  EXPECT_EQ(imported(integers("800", "1,000", "1,250")).points.points()[2].frequency_hz, 1250.0);
  EXPECT_EQ(refused(integers("1,000", "1,250", "1,600")).problem,
            "the comma in the frequency may be a decimal sign or a mark of thousands");
  EXPECT_EQ(imported(integers("0,5", "1,000", "1,250")).points.points()[2].frequency_hz, 1.25);
  EXPECT_EQ(imported(integers("1,000", "12,5", "20")).points.points()[1].frequency_hz, 12.5);
  // A point where the rest has commas.
  const ImportedPoints found = imported(
      "f;A;phase;U;U\n500;2,5;1;0,4;0,5\n800;2,5;1;0,4;0,5\n1.000;2,5;1;0,4;0,5\n"
      "1.250;2,5;1;0,4;0,5\n");
  EXPECT_EQ(found.points.points()[3].frequency_hz, 1250.0);
}

TEST(Import, WordsThatEndATable) {
  const std::string table = std::string("f,A,phase,U(A),U(phase)\n") + kPlainRows;
  for (const char* words : {"Page 1 of 1", "End of data", "*** End of data ***", "--- end ---",
                            "Page 1 of 1,,,,", "End of data\nPage 1/1", "Page,1,of,1"}) {
    const ImportedPoints found = imported(table + words + "\n");
    EXPECT_EQ(found.points.size(), 3U);
    EXPECT_NE(found.understanding.find("; not read from line 5 on"), std::string::npos) << words;
    EXPECT_EQ(imported(table + words + "\n\nMeasured by,N. N.\n").points.size(), 3U);
  }
  const std::string blanks = "f A phase U U\n3 2 1 0.4 0.5\n4 2 1 0.4 0.5\n5 2 1 0.4 0.5\n";
  EXPECT_EQ(imported(blanks + "Page 1 of 1\n").points.size(), 3U);
  // Words where the rows should be end nothing.
  EXPECT_EQ(refused("f,A,phase,U(A),U(phase)\nnothing here\n").line, 2U);
  // Rows with a fault are none of them.
  for (const char* row : {"x,2,1", "6OO,2,1,0.4", "abc,2,1,0.4,0.5", "abc,2,1,0.4", "6,2,1"}) {
    EXPECT_EQ(refused(table + row + "\n").line, 5U) << row;
  }
}

std::string labview(const std::string& dimension, const std::string& names, const char* row_end) {
  std::string text =
      "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
      "Decimal_Separator\t.\nMulti_Headings\tNo\nX_Columns\tOne\nTime_Pref\tAbsolute\n"
      "Operator\tk = 1\nDate\t2024/03/05\nTime\t14:03:11.2345\n***End_of_Header***\t\n\t\n"
      "Channels\t4\t\t\t\t\nSamples\t3\t3\t3\t3\t\nDate\t2024/03/05\t2024/03/05\t\n"
      "Y_Unit_Label\tmV/g\tdeg\t%\tmrad\t\nX_Dimension\t" +
      dimension + "\t" + dimension +
      "\t\nX0\t0.0E+0\t0.0E+0\t0.0E+0\t0.0E+0\t\nDelta_X\t1.0\t1.0\t1.0\t1.0\t\n"
      "***End_of_Header***\t\t\t\t\t\nX_Value\t" +
      names + "\n";
  for (const char* f : {"3", "4", "5"}) {
    text += std::string(f) + "\t2\t1\t20\t0.5" + row_end + "\n";
  }
  return text;
}

TEST(Import, FilesOfLabview) {
  constexpr double kUnit = 1e-3 / 9.80665;
  const std::string names = "Amplitude\tPhase\tU amplitude\tU phase\tComment";
  for (const char* row_end : {"", "\t", "\tfine"}) {
    const ImportedPoints found = imported(labview("Frequency", names, row_end));
    ASSERT_EQ(found.points.size(), 3U);
    expect_point(found.points.points()[0], 3.0, 2.0 * kUnit, 1.0, 0.4 * kUnit, 0.5e-3 / kDegree);
    EXPECT_NE(found.understanding.find("LabVIEW, X_Value is the frequency"), std::string::npos);
  }
  EXPECT_EQ(refused(labview("Time", names, "")).problem,
            "X_Value of this LabVIEW file is no frequency");
  const ImportError error =
      refused(labview("Frequency", "Untitled\tUntitled 1\tUntitled 2\tUntitled 3\tComment", ""));
  EXPECT_EQ(error.problem, "the header has no name for the amplitude");
  EXPECT_EQ(error.line, 22U);
}

TEST(Import, RemarksInALastColumn) {
  const ImportedPoints found = imported(
      "f,A,phase,U(A),U(phase),remark\n3,2,1,0.4,0.5,ok\n4,2,1,0.4,0.5,\n5,2,1,0.4,0.5,noisy\n");
  ASSERT_EQ(found.points.size(), 3U);
  expect_point(found.points.points()[2], 5.0, 2.0, 1.0, 0.4, 0.5);
  EXPECT_NE(found.understanding.find("not used: remark"), std::string::npos);
  EXPECT_EQ(refused("f,A,phase,U(A),U(phase)\n3,2,1,0.4,x\n4,2,1,0.4,0.5\n5,2,1,0.4,0.5\n").problem,
            "U(phase) is not a number: \"x\" (column 5)");
}

TEST(Import, AUnitInSomeRowsOnly) {
  const ImportError error = refused(std::string(kHeader) + kRows + "60,4.5,-5,1%,3\n");
  EXPECT_EQ(error.problem, "u_amplitude has a unit, and other rows have none: \"1%\" (column 4)");
  EXPECT_EQ(error.expectation,
            "expected the unit of all in the name of the column, such as \"u_amplitude [%]\"");
  EXPECT_EQ(error.line, 5U);
}

// A header that never ends is none; its names would grow with each line.
TEST(Import, HeadersHaveAnEnd) {
  std::string text = "Frequency,Sensitivity,,Phase,\n";
  for (int i = 0; i < 20'000; ++i) {
    text += ",value,U,value,U\n";
  }
  const ImportError error = refused(text + "3,2,0.4,1,0.5\n4,2,0.4,1,0.5\n5,2,0.4,1,0.5\n");
  EXPECT_EQ(error.line, 5U);
  // Twice the same is the same.
  expect_rows(imported(std::string(kHeader) + kHeader + kRows));
}

// A permutation of the rows is the same table.
TEST(Import, OrderDoesNotMatter) {
  std::vector<std::string> rows;
  for (int i = 1; i <= 50; ++i) {
    rows.push_back(std::to_string(7 * i) + ",1." + std::to_string(i) + ",-1,0.01,1\n");
  }
  const auto text_of = [&rows] {
    std::string text;
    for (const std::string& row : rows) {
      text += row;
    }
    return text;
  };
  const ImportedPoints first = imported(text_of());
  std::shuffle(rows.begin(), rows.end(), std::mt19937(7));
  const ImportedPoints second = imported(text_of());
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(first.points.points()[i].amplitude, second.points.points()[i].amplitude);
  }
}

}  // namespace
