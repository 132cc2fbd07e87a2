// Total uncertainties split into each point's own part and the common one.
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

#include "emax/app/points/reference_uncertainty.hpp"
#include "emax/identify/wlsp.hpp"

#include "support/table1.hpp"

namespace emax::app {
namespace {

using test::table1;

TEST(ReferenceUncertainty, Table1) {
  FrequencyResponse response = table1();
  ASSERT_EQ(remove_common(response, 0.5).status, Status::kOk);
  const FrequencyResponse table = table1();
  ASSERT_EQ(response.size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const ResponsePoint& before = table.points()[i];
    const ResponsePoint& after = response.points()[i];
    EXPECT_NEAR(std::hypot(after.u_amplitude, 0.0025 * before.amplitude), before.u_amplitude,
                1e-15);
    EXPECT_EQ(after.u_phase_rad, before.u_phase_rad);
    EXPECT_EQ(after.amplitude, before.amplitude);
    EXPECT_EQ(response.common()[i], 0.0025);
  }
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  // From a calculation outside this code, to half a unit of the last digit.
  EXPECT_NEAR(wlsp.result().model.sensitivity, 1.00645, 0.5e-5);
  EXPECT_NEAR(wlsp.result().u_sensitivity, 0.00270, 0.5e-5);
  EXPECT_NEAR(wlsp.result().chi2, 8911.7, 0.05);
}

TEST(ReferenceUncertainty, ZeroLeavesAllAsItIs) {
  FrequencyResponse response = table1();
  ASSERT_EQ(response.set_common(0.001), Status::kOk);
  ASSERT_EQ(remove_common(response, 0.0).status, Status::kOk);
  EXPECT_EQ(response.points()[3].u_amplitude, table1().points()[3].u_amplitude);
  EXPECT_EQ(response.common()[3], 0.001);
}

TEST(ReferenceUncertainty, TotalBelowTheCommonPart) {
  FrequencyResponse response = table1();
  // 0.01 expanded: of 0.96 to 1.05 at low frequencies, 0.95 % of the largest of them.
  const CommonRemoval removal = remove_common(response, 0.96);
  EXPECT_EQ(removal.status, Status::kUncertaintyNotPositive);
  // 1.05 at 300 Hz, the first with U/A of 0.952 %.
  EXPECT_EQ(removal.bad_point, 9U);
  EXPECT_EQ(response.points()[0].u_amplitude, table1().points()[0].u_amplitude);
  EXPECT_FALSE(response.has_common());
}

TEST(ReferenceUncertainty, BadPercent) {
  FrequencyResponse response = table1();
  for (const double bad : {-0.1, 100.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(remove_common(response, bad).status, Status::kInvalidArgument) << bad;
  }
  EXPECT_FALSE(response.has_common());
}

}  // namespace
}  // namespace emax::app
