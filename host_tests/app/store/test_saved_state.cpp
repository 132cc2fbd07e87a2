// Settings and identification as bytes: the same after a power cut, and refused if they cannot be.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"

#include "support/evaluations.hpp"
#include "support/memory_store.hpp"

namespace {

using emax::Span;
using emax::Status;
using emax::app::default_sweep_settings;
using emax::app::Identification;
using emax::app::kDefaultSettings;
using emax::app::RecordStore;
using emax::app::SavedSettings;
using emax::app::Settings;
using emax::app::Source;
using emax::app::SweepSettings;

using Bytes = std::vector<std::uint8_t>;

constexpr emax::hal::StreamFormat kFormat = {100000.0, 10.0, 10.0, 64, 37};

Bytes encoded(const Settings& settings, const SweepSettings& sweep) {
  Bytes bytes(emax::app::kMaxSavedSettingsBytes);
  bytes.resize(emax::app::encode(settings, sweep, {bytes.data(), bytes.size()}));
  return bytes;
}

Bytes encoded(const Identification& identification) {
  Bytes bytes(emax::app::kSavedIdentificationBytes);
  bytes.resize(emax::app::encode(identification, {bytes.data(), bytes.size()}));
  return bytes;
}

/// Targets that hold something recognisable.
struct Target {
  SavedSettings scratch;
  Settings settings = kDefaultSettings;
  SweepSettings sweep = default_sweep_settings();

  Target() {
    settings.trials = 4711;
    sweep.cycles = 17;
    std::memset(static_cast<void*>(&scratch), 0xC3, sizeof(scratch));
  }
  Status decode(const Bytes& bytes) {
    return emax::app::decode({bytes.data(), bytes.size()}, kFormat, scratch, settings, sweep);
  }
  bool is_untouched() const {
    return encoded(settings, sweep) == encoded(Target().settings, Target().sweep);
  }
};

/// Every member off its default, within what `check()` permits, every table full.
void fill(Settings& settings, SweepSettings& sweep) {
  settings.filter_order = 7;
  settings.cutoff_hz = 1234.5678901234567;
  settings.gain_mode = emax::app::GainMode::kTrack;
  settings.gain = 1.0 / 3.0;
  settings.duration_s = 0.0031;
  settings.limit_is_auto = false;
  settings.limit_mps2 = 9.80665;
  settings.criterion = emax::Criterion::kEnergyDifference;
  settings.delay_choice = emax::app::DelayChoice::kGiven;
  settings.delay_s = 2.5e-5;
  settings.method = emax::Method::kPaper;
  settings.step_s = 3e-6;
  settings.iterations = 77;
  settings.trials = 123456789;
  settings.adaptive = true;
  settings.probability = 0.99;
  settings.distribution = emax::Distribution::kNormal;
  settings.birge = true;
  settings.seed = {1, 2, 3, 2147483122};
  settings.generator = emax::Generator::k1982;
  settings.trend_count = emax::app::kMaxTrendPoints;
  for (std::size_t i = 0; i < settings.trend_s.size(); ++i) {
    settings.trend_s[i] = 0.001 * static_cast<double>(i + 1);
  }
  settings.common_percent = 0.75;
  sweep.frequency_count = emax::kMaxPoints;
  for (std::size_t i = 0; i < sweep.frequency_hz.size(); ++i) {
    sweep.frequency_hz[i] = 33.3 * static_cast<double>(i + 1);
  }
  sweep.level_mps2 = 2.5;
  sweep.acceleration_limit_mps2 = 31.0;
  sweep.drive_limit_v = 4.25;
  sweep.slew_v_per_s = 12345.0;
  sweep.settle_s = 0.25;
  sweep.cycles = 11;
  sweep.repeat_s = 0.75;
  sweep.repeats = 9;
  sweep.reference.count = emax::app::kMaxReferencePoints;
  for (std::size_t i = 0; i < emax::app::kMaxReferencePoints; ++i) {
    sweep.reference.frequency_hz[i] = 100.0 * static_cast<double>(i + 1);
    sweep.reference.sensitivity[i] = 0.1 + 1e-5 * static_cast<double>(i);
  }
  sweep.reference.expanded_percent = 0.7;
  sweep.reference_gain = 3.0;
  sweep.device_gain = 5.0;
  sweep.reference_gain_expanded_percent = 0.05;
  sweep.device_gain_expanded_percent = 0.11;
  sweep.ratio_correction = 1.03;
  sweep.ratio_expanded_percent = 0.02;
  sweep.skew_expanded_s = 1e-8;
  sweep.clock_expanded_ppm = 50.0;
  sweep.crosstalk_expanded_percent = 0.03;
  sweep.linearity_expanded_percent = 0.04;
  sweep.drive_full_scale_v = 11.0;
  sweep.reference_full_scale_v = 12.0;
  sweep.device_full_scale_v = 13.0;
  sweep.mounting_expanded_percent = 0.22;
  sweep.skew_s = -2e-6;
  sweep.check_hz = 80.0;
  sweep.expected_sensitivity = 0.0;
}

void expect_same(const SweepSettings& found, const SweepSettings& expected) {
  EXPECT_EQ(found.frequency_hz, expected.frequency_hz);
  EXPECT_EQ(found.frequency_count, expected.frequency_count);
  EXPECT_EQ(found.level_mps2, expected.level_mps2);
  EXPECT_EQ(found.acceleration_limit_mps2, expected.acceleration_limit_mps2);
  EXPECT_EQ(found.drive_limit_v, expected.drive_limit_v);
  EXPECT_EQ(found.slew_v_per_s, expected.slew_v_per_s);
  EXPECT_EQ(found.settle_s, expected.settle_s);
  EXPECT_EQ(found.cycles, expected.cycles);
  EXPECT_EQ(found.repeat_s, expected.repeat_s);
  EXPECT_EQ(found.repeats, expected.repeats);
  EXPECT_EQ(found.reference.frequency_hz, expected.reference.frequency_hz);
  EXPECT_EQ(found.reference.sensitivity, expected.reference.sensitivity);
  EXPECT_EQ(found.reference.count, expected.reference.count);
  EXPECT_EQ(found.reference.expanded_percent, expected.reference.expanded_percent);
  EXPECT_EQ(found.reference_gain, expected.reference_gain);
  EXPECT_EQ(found.device_gain, expected.device_gain);
  for (const emax::app::SettingField& field : fields_of(expected)) {
    EXPECT_TRUE(is_same(field, &found, &expected)) << field.name;
  }
  EXPECT_EQ(found.mounting_expanded_percent, expected.mounting_expanded_percent);
  EXPECT_EQ(found.skew_s, expected.skew_s);
  EXPECT_EQ(found.check_hz, expected.check_hz);
  EXPECT_EQ(found.expected_sensitivity, expected.expected_sensitivity);
}

TEST(SavedSettings, ComeBackAsTheyWere) {
  Settings settings = kDefaultSettings;
  SweepSettings sweep = default_sweep_settings();
  EXPECT_EQ(encoded(settings, sweep).size(), 317U + 8 * 5 + 8 * 42 + 16 * 1);
  Target target;
  ASSERT_EQ(target.decode(encoded(settings, sweep)), Status::kOk);
  expect_same(target.sweep, sweep);
  EXPECT_EQ(target.settings.trials, 200000U);
  EXPECT_EQ(target.settings.seed, settings.seed);
  EXPECT_EQ(target.settings.trend_s, settings.trend_s);

  fill(settings, sweep);
  const Bytes bytes = encoded(settings, sweep);
  EXPECT_EQ(bytes.size(), emax::app::kMaxSavedSettingsBytes);
  ASSERT_EQ(target.decode(bytes), Status::kOk);
  expect_same(target.sweep, sweep);
  EXPECT_EQ(target.settings.filter_order, 7);
  EXPECT_EQ(target.settings.cutoff_hz, 1234.5678901234567);
  EXPECT_EQ(target.settings.gain_mode, emax::app::GainMode::kTrack);
  EXPECT_EQ(target.settings.gain, 1.0 / 3.0);
  EXPECT_EQ(target.settings.duration_s, 0.0031);
  EXPECT_FALSE(target.settings.limit_is_auto);
  EXPECT_EQ(target.settings.limit_mps2, 9.80665);
  EXPECT_EQ(target.settings.criterion, emax::Criterion::kEnergyDifference);
  EXPECT_EQ(target.settings.method, emax::Method::kPaper);
  EXPECT_EQ(target.settings.step_s, 3e-6);
  EXPECT_EQ(target.settings.iterations, 77U);
  EXPECT_EQ(target.settings.trials, 123456789U);
  EXPECT_TRUE(target.settings.adaptive);
  EXPECT_EQ(target.settings.probability, 0.99);
  EXPECT_EQ(target.settings.distribution, emax::Distribution::kNormal);
  EXPECT_TRUE(target.settings.birge);
  EXPECT_EQ(target.settings.seed, settings.seed);
  EXPECT_EQ(target.settings.generator, emax::Generator::k1982);
  EXPECT_EQ(target.settings.trend_s, settings.trend_s);
  EXPECT_EQ(target.settings.trend_count, settings.trend_count);
  EXPECT_EQ(target.settings.common_percent, 0.75);
}

// The layout is a promise to later versions. The numbers' bytes are from Python's struct.pack.
TEST(SavedSettings, BytesOfTheDefaults) {
  const Bytes bytes = encoded(kDefaultSettings, default_sweep_settings());
  const std::array<std::uint8_t, 33> expected = {
      'E',  'S',  4,    0,                              // Kind and version.
      10,   0,    0,    0,                              // Order.
      0x00, 0x00, 0x00, 0x00, 0x00, 0x40, 0x8F, 0x40,   // 1000.0.
      0,                                                // GainMode::kAuto.
      0,    0,    0,    0,    0,    0,    0,    0,      // 0.0.
      0xFC, 0xA9, 0xF1, 0xD2, 0x4D, 0x62, 0x60, 0x3F};  // 0.002.
  ASSERT_GE(bytes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(bytes[i], expected[i]) << i;
  }
}

TEST(SavedSettings, NoRoomNoBytes) {
  Settings settings = kDefaultSettings;
  SweepSettings sweep = default_sweep_settings();
  fill(settings, sweep);
  Bytes room(emax::app::kMaxSavedSettingsBytes, 0x77);
  for (std::size_t size = 0; size < room.size(); ++size) {
    EXPECT_EQ(emax::app::encode(settings, sweep, {room.data(), size}), 0U) << size;
  }
  EXPECT_EQ(room.back(), 0x77);
  settings.trend_count = emax::app::kMaxTrendPoints + 1;
  EXPECT_EQ(emax::app::encode(settings, sweep, {room.data(), room.size()}), 0U);
}

TEST(SavedSettings, TooFewOrTooManyBytesAreRefused) {
  Settings settings = kDefaultSettings;
  SweepSettings sweep = default_sweep_settings();
  fill(settings, sweep);
  const Bytes whole = encoded(settings, sweep);
  Target target;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(
        target.decode(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
        Status::kUnknownRecord)
        << size;
  }
  Bytes longer = whole;
  longer.push_back(0);
  EXPECT_EQ(target.decode(longer), Status::kUnknownRecord);
  EXPECT_TRUE(target.is_untouched());
}

TEST(SavedSettings, OtherKindsAndVersionsAreRefused) {
  const Bytes whole = encoded(kDefaultSettings, default_sweep_settings());
  Target target;
  for (std::size_t byte = 0; byte < 4; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes other = whole;
      other[byte] = static_cast<std::uint8_t>(other[byte] ^ (1U << bit));
      EXPECT_EQ(target.decode(other), Status::kUnknownRecord) << byte << ' ' << bit;
    }
  }
  EXPECT_EQ(target.decode(encoded(Identification())), Status::kUnknownRecord);
  EXPECT_TRUE(target.is_untouched());
}

// Bytes with a right checksum but of wrong values: each is refused, or is what `check()` lets pass.
TEST(SavedSettings, NoBytesLeadToSettingsThatCheckRefuses) {
  Settings settings = kDefaultSettings;
  SweepSettings sweep = default_sweep_settings();
  fill(settings, sweep);
  for (const Bytes& whole :
       {encoded(kDefaultSettings, default_sweep_settings()), encoded(settings, sweep)}) {
    std::size_t accepted = 0;
    std::size_t refused = 0;
    for (std::size_t byte = 4; byte < whole.size(); ++byte) {
      for (const int value : {0x00, 0x01, 0x02, 0x03, 0x7F, 0x80, 0xF0, 0xFF}) {
        Bytes other = whole;
        other[byte] = static_cast<std::uint8_t>(value);
        Target target;
        if (target.decode(other) != Status::kOk) {
          EXPECT_TRUE(target.is_untouched());
          ++refused;
          continue;
        }
        ++accepted;
        EXPECT_EQ(emax::app::check(target.settings).setting, nullptr);
        EXPECT_EQ(emax::app::check(target.sweep, kFormat).setting, nullptr);
        EXPECT_EQ(encoded(target.settings, target.sweep), other);
      }
    }
    EXPECT_GT(accepted, 100U);
    EXPECT_GT(refused, 100U);
  }
}

TEST(SavedSettings, WhatCheckRefusesIsRefused) {
  using Change = std::function<void(Settings&, SweepSettings&)>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Change changes[] = {
      [](Settings& s, SweepSettings&) { s.filter_order = 16; },
      [](Settings& s, SweepSettings&) { s.filter_order = -1; },
      [](Settings& s, SweepSettings&) { s.trials = 999; },
      [](Settings& s, SweepSettings&) { s.seed[2] = 0; },
      [](Settings& s, SweepSettings&) { s.trend_s[1] = s.trend_s[0]; },
      // Not used, and so not checked, in this mode: not a number all the same.
      [nan](Settings& s, SweepSettings&) { s.gain = nan; },
      [infinity](Settings& s, SweepSettings&) { s.limit_mps2 = infinity; },
      [](Settings& s, SweepSettings&) { s.gain_mode = static_cast<emax::app::GainMode>(3); },
      [](Settings& s, SweepSettings&) { s.criterion = static_cast<emax::Criterion>(3); },
      [](Settings& s, SweepSettings&) { s.method = static_cast<emax::Method>(2); },
      [](Settings& s, SweepSettings&) { s.distribution = static_cast<emax::Distribution>(2); },
      [](Settings& s, SweepSettings&) { s.generator = static_cast<emax::Generator>(2); },
      [](Settings&, SweepSettings& s) { s.frequency_count = 2; },
      [](Settings&, SweepSettings& s) { s.frequency_hz[5] = s.frequency_hz[4]; },
      [](Settings&, SweepSettings& s) { s.level_mps2 = 0.0; },
      [](Settings&, SweepSettings& s) { s.repeats = 17; },
      [](Settings&, SweepSettings& s) { s.reference.count = 0; },
      [](Settings&, SweepSettings& s) { s.reference.sensitivity[0] = -0.1; },
      [nan](Settings&, SweepSettings& s) { s.expected_sensitivity = nan; },
      // Right in itself, but not for this stream.
      [](Settings&, SweepSettings& s) { s.drive_limit_v = 10.5; },
      [](Settings&, SweepSettings& s) { s.frequency_hz[41] = 50000.0; },
  };
  std::size_t index = 0;
  for (const Change& change : changes) {
    Settings settings = kDefaultSettings;
    SweepSettings sweep = default_sweep_settings();
    change(settings, sweep);
    Target target;
    EXPECT_EQ(target.decode(encoded(settings, sweep)), Status::kUnknownRecord) << index;
    EXPECT_TRUE(target.is_untouched()) << index;
    ++index;
  }
}

Identification measured() {
  // Table 2 of the paper, with correlations of 0.2, -0.3 and 0.1.
  Identification id;
  id.source = Source::kPoints;
  id.device = {{1.037, 4073.0, 0.3182}, {0.003, 6.0, 0.0004}};
  const double u[] = {0.003, 6.0, 0.0004};
  const double r[3][3] = {{1.0, 0.2, -0.3}, {0.2, 1.0, 0.1}, {-0.3, 0.1, 1.0}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      id.covariance[i][j] = r[i][j] * u[i] * u[j];
    }
  }
  id.chi2 = 82.148;
  id.dof = 81;
  return id;
}

Status decode(const Bytes& bytes, Identification& id) {
  return emax::app::decode({bytes.data(), bytes.size()}, id);
}

TEST(SavedIdentification, ComesBackAsItWas) {
  const Identification expected = measured();
  const Bytes bytes = encoded(expected);
  ASSERT_EQ(bytes.size(), emax::app::kSavedIdentificationBytes);
  // struct.pack("<IBd", 0x00014945, 0, 1.037).
  const std::array<std::uint8_t, 13> front = {'E',  'I',  1,    0,    0,    0x64, 0x3B,
                                              0xDF, 0x4F, 0x8D, 0x97, 0xF0, 0x3F};
  for (std::size_t i = 0; i < front.size(); ++i) {
    EXPECT_EQ(bytes[i], front[i]) << i;
  }
  Identification found;
  ASSERT_EQ(decode(bytes, found), Status::kOk);
  EXPECT_EQ(found.source, Source::kPoints);
  EXPECT_EQ(found.device.estimate.sensitivity, 1.037);
  EXPECT_EQ(found.device.estimate.natural_frequency_hz, 4073.0);
  EXPECT_EQ(found.device.estimate.damping, 0.3182);
  EXPECT_EQ(found.device.u.sensitivity, 0.003);
  EXPECT_EQ(found.device.u.natural_frequency_hz, 6.0);
  EXPECT_EQ(found.device.u.damping, 0.0004);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(found.covariance[i][j], expected.covariance[i >= j ? i : j][i >= j ? j : i]);
    }
  }
  EXPECT_EQ(found.chi2, 82.148);
  EXPECT_EQ(found.dof, 81U);
}

TEST(SavedIdentification, IsTheOneOfTheEvaluation) {
  emax::app::EvaluationResults& evaluation = emax::test::shared_evaluation();
  const Settings settings = kDefaultSettings;
  ASSERT_EQ(emax::test::run_on(evaluation)
                .start_from_points(emax::test::table1(), settings, emax::app::Goal::kModel),
            Status::kOk);
  emax::test::finish(evaluation);
  const emax::WlspFit& fit = evaluation.fit.result();
  ASSERT_EQ(fit.status, Status::kOk);
  Identification found;
  ASSERT_EQ(decode(encoded(identification_of(evaluation)), found), Status::kOk);
  EXPECT_EQ(found.source, Source::kPoints);
  EXPECT_EQ(found.device.estimate.natural_frequency_hz, fit.model.natural_frequency_hz);
  EXPECT_EQ(found.device.u.damping, fit.u_damping);
  EXPECT_EQ(found.covariance[2][1], fit.covariance[2][1]);
  EXPECT_EQ(found.chi2, fit.chi2);
  EXPECT_EQ(found.dof, 81U);
  ASSERT_EQ(emax::test::run_on(evaluation)
                .start_from_model(emax::test::kTable2, settings, emax::app::Goal::kModel),
            Status::kOk);
  emax::test::finish(evaluation);
  ASSERT_EQ(decode(encoded(identification_of(evaluation)), found), Status::kOk);
  EXPECT_EQ(found.source, Source::kModel);
  EXPECT_EQ(found.device.estimate.sensitivity, 1.037);
  EXPECT_EQ(found.covariance[1][1], 36.0);
  EXPECT_EQ(found.covariance[1][0], 0.0);
  EXPECT_EQ(found.chi2, 0.0);
  EXPECT_EQ(found.dof, 0U);
}

TEST(SavedIdentification, WithoutUncertainty) {
  Identification exact;
  exact.device.estimate = {1.037, 4073.0, 0.3182};
  Identification found = measured();
  ASSERT_EQ(decode(encoded(exact), found), Status::kOk);
  EXPECT_EQ(found.source, Source::kModel);
  EXPECT_EQ(found.device.u.sensitivity, 0.0);
  EXPECT_EQ(found.dof, 0U);
}

TEST(SavedIdentification, WhatCannotBeIsRefused) {
  using Change = std::function<void(Identification&)>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto correlate = [](double r01, double r02, double r12) {
    return [r01, r02, r12](Identification& id) {
      const double u[] = {0.003, 6.0, 0.0004};
      id.covariance[1][0] = r01 * u[0] * u[1];
      id.covariance[2][0] = r02 * u[0] * u[2];
      id.covariance[2][1] = r12 * u[1] * u[2];
    };
  };
  const Change possible[] = {correlate(0.0, 0.0, 0.0),
                             correlate(1.0, 0.0, 0.0),
                             correlate(1.0, 1.0, 1.0),
                             correlate(1.0, -1.0, -1.0),
                             correlate(0.6, 0.8, 0.0),
                             [](Identification& id) { id.dof = 125; },
                             [](Identification& id) { id.chi2 = 0.0; }};
  const Change impossible[] = {[](Identification& id) { id.device.estimate.sensitivity = 0.0; },
                               [](Identification& id) { id.device.estimate.damping = 1.0; },
                               [](Identification& id) { id.device.u.damping = 0.0005; },
                               [](Identification& id) { id.device.u.sensitivity = -0.003; },
                               [](Identification& id) { id.covariance[1][1] = -36.0; },
                               [](Identification& id) { id.covariance[2][2] = 0.0; },
                               [](Identification& id) { id.chi2 = -1.0; },
                               [](Identification& id) { id.dof = 2 * emax::kMaxPoints + 1; },
                               [nan](Identification& id) { id.covariance[2][0] = nan; },
                               [](Identification& id) { id.source = static_cast<Source>(2); },
                               // A correlation above 1; three that exclude one another.
                               correlate(1.001, 0.0, 0.0), correlate(0.0, -1.001, 0.0),
                               correlate(0.0, 0.0, 1.001), correlate(0.9, 0.9, -0.9),
                               correlate(1.0, 1.0, 0.0)};
  for (const Change& change : possible) {
    Identification id = measured();
    change(id);
    Identification found;
    EXPECT_EQ(decode(encoded(id), found), Status::kOk) << &change - possible;
  }
  for (const Change& change : impossible) {
    Identification id = measured();
    change(id);
    Identification found = measured();
    found.dof = 55;
    EXPECT_EQ(decode(encoded(id), found), Status::kUnknownRecord) << &change - impossible;
    EXPECT_EQ(found.dof, 55U);
  }
}

TEST(SavedIdentification, TooFewOrTooManyBytesAreRefused) {
  Bytes bytes = encoded(measured());
  Identification found;
  found.dof = 55;
  bytes.push_back(0);
  EXPECT_EQ(decode(bytes, found), Status::kUnknownRecord);
  bytes.pop_back();
  while (!bytes.empty()) {
    bytes.pop_back();
    EXPECT_EQ(decode(bytes, found), Status::kUnknownRecord) << bytes.size();
  }
  EXPECT_EQ(decode(encoded(kDefaultSettings, default_sweep_settings()), found),
            Status::kUnknownRecord);
  EXPECT_EQ(found.dof, 55U);
}

// As *SAV does it: cut at every byte, what *RCL reads is the settings of before or the new ones.
TEST(SavedSettings, CutAtEveryByteOfTheMemory) {
  const emax::hal::StoreFormat format = {2 * emax::app::kSavedRecords, 1536, 32};
  const auto save = [](emax::hal::Store& store, std::uint32_t trials) {
    Settings settings = kDefaultSettings;
    settings.trials = trials;
    Bytes frame(emax::app::kMaxSavedSettingsBytes + RecordStore::kFrameBytes);
    const std::size_t size = emax::app::encode(
        settings, default_sweep_settings(), RecordStore::record_in({frame.data(), frame.size()}));
    return RecordStore(store).write(3, {frame.data(), size + RecordStore::kFrameBytes});
  };
  bool was_cut = true;
  std::uint64_t cuts = 0;
  for (; was_cut; ++cuts) {
    emax::test::MemoryStore memory(format);
    ASSERT_EQ(save(memory, 1001), Status::kOk);
    memory.cut_power_after(cuts);
    (void)save(memory, 1002);
    was_cut = !memory.powered();
    memory.restore_power();
    Bytes bytes(emax::app::kMaxSavedSettingsBytes);
    const emax::app::StoredRecord stored =
        RecordStore(memory).read(3, {bytes.data(), bytes.size()});
    ASSERT_EQ(stored.status, Status::kOk) << cuts;
    bytes.resize(stored.bytes);
    Target target;
    ASSERT_EQ(target.decode(bytes), Status::kOk) << cuts;
    ASSERT_TRUE(target.settings.trials == 1002 || (was_cut && target.settings.trials == 1001));
  }
  // A slot erased, and the record with its frame in whole units.
  EXPECT_EQ(cuts, 1536U + (701U + 20U + 31U) / 32U * 32U + 1U);
}

}  // namespace
