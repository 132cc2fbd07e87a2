// Writing and reading go through the same fields: those of the settings are their rows.
#include "emax/app/store/saved_state.hpp"

#include <algorithm>
#include <limits>

#include "emax/app/settings/setting_field.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

// "ES" and "EI" with the version of what follows. A change of what follows needs a new version.
constexpr std::uint32_t kSettingsVersion4 = 0x00045345;
constexpr std::uint32_t kIdentificationVersion1 = 0x00014945;
static_assert(kMaxSavedSettingsBytes ==
                  317 + 8 * kMaxTrendPoints + 8 * kMaxPoints + 16 * kMaxReferencePoints,
              "the settings have changed: they need a new version, and their new size here");

// The root of a square, or the square of a root, is off by this at most.
constexpr double kRounding = 1e-15;

/// Appends fields to bytes.
class Writer {
 public:
  explicit Writer(Span<std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  /// @returns The bytes written; 0 if they found no room.
  std::size_t size() const noexcept { return is_good_ ? at_ : 0; }

  void number(double value) noexcept;
  void whole(std::uint32_t value) noexcept { put(value, sizeof(value)); }
  void byte(std::uint8_t value, std::size_t /*last*/) noexcept { put(value, 1); }
  template <typename Enum>
  void choice(Enum value, Enum /*last*/) noexcept {
    put(static_cast<std::uint8_t>(value), 1);
  }
  void count(std::size_t value, std::size_t most) noexcept {
    is_good_ = is_good_ && value <= most;
    whole(static_cast<std::uint32_t>(value));
  }
  void numbers(Span<const double> table, std::size_t count) noexcept {
    for (std::size_t i = 0; is_good_ && i < count; ++i) {
      number(table[i]);
    }
  }

 private:
  void put(std::uint64_t value, std::size_t size) noexcept;

  Span<std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool is_good_ = true;
};

// Out of line, as the three below: in line, the calls of all fields take more than twice the flash.
[[gnu::noinline]] void Writer::put(std::uint64_t value, std::size_t size) noexcept {
  is_good_ = is_good_ && size <= bytes_.size() - at_;
  for (std::size_t i = 0; is_good_ && i < size; ++i) {
    bytes_[at_++] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

[[gnu::noinline]] void Writer::number(double value) noexcept {
  put(__builtin_bit_cast(std::uint64_t, value), sizeof(std::uint64_t));
}

/// Takes the same fields from bytes, in the same order, and refuses what none can be.
class Reader {
 public:
  explicit Reader(Span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  /// @returns True if all was there and as it can be, so far.
  bool is_good() const noexcept { return is_good_; }
  bool is_at_end() const noexcept { return at_ == bytes_.size(); }

  void number(double& value) noexcept;
  void whole(std::uint32_t& value) noexcept {
    value = static_cast<std::uint32_t>(taken(sizeof(value)));
  }
  void byte(std::uint8_t& value, std::size_t last) noexcept {
    const std::uint64_t bits = taken(1);
    is_good_ = is_good_ && bits <= last;
    value = is_good_ ? static_cast<std::uint8_t>(bits) : std::uint8_t{0};
  }
  template <typename Enum>
  void choice(Enum& value, Enum last) noexcept {
    const auto bits = static_cast<std::uint8_t>(taken(1));
    is_good_ = is_good_ && bits <= static_cast<std::uint8_t>(last);
    value = is_good_ ? static_cast<Enum>(bits) : Enum{};
  }
  void count(std::size_t& value, std::size_t most) noexcept {
    std::uint32_t bits = 0;
    whole(bits);
    is_good_ = is_good_ && bits <= most;
    value = is_good_ ? bits : 0;
  }
  // Whatever is behind them is zero, so that nothing of before remains.
  void numbers(Span<double> table, std::size_t count) noexcept {
    for (double& entry : table) {
      entry = 0.0;
      if (count > 0) {
        number(entry);
        --count;
      }
    }
  }

 private:
  std::uint64_t taken(std::size_t size) noexcept;

  Span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool is_good_ = true;
};

[[gnu::noinline]] std::uint64_t Reader::taken(std::size_t size) noexcept {
  is_good_ = is_good_ && size <= bytes_.size() - at_;
  std::uint64_t value = 0;
  for (std::size_t i = 0; is_good_ && i < size; ++i) {
    value |= std::uint64_t{bytes_[at_++]} << (8 * i);
  }
  return value;
}

[[gnu::noinline]] void Reader::number(double& value) noexcept {
  value = __builtin_bit_cast(double, taken(sizeof(std::uint64_t)));
  is_good_ = is_good_ && is_finite(value);
}

// AnySettings is `void` to read, `const void` to write. To go by the type of the table would double
// the code.
template <typename AnySettings, typename Fields>
void go_through(const SettingField& field, AnySettings* settings, Fields& fields) noexcept {
  switch (field.kind) {
    case SettingKind::kNumber:
      return fields.number(member_at<double>(settings, field.offset));
    case SettingKind::kWhole:
      return fields.whole(member_at<std::uint32_t>(settings, field.offset));
    case SettingKind::kSwitch:
    case SettingKind::kChoice:
      return fields.byte(member_at<std::uint8_t>(settings, field.offset), field.last);
    case SettingKind::kNumberOrWord:
      fields.byte(member_at<std::uint8_t>(settings, field.beside), field.last);
      return fields.number(member_at<double>(settings, field.offset));
    case SettingKind::kNumbers:
      fields.count(member_at<std::size_t>(settings, field.beside), field.last);
      [[fallthrough]];
    case SettingKind::kMoreNumbers:
      return fields.numbers({&member_at<double>(settings, field.offset), field.last},
                            member_at<std::size_t>(settings, field.beside));
    case SettingKind::kWholes:
      for (std::size_t i = 0; i < field.last; ++i) {
        fields.whole(member_at<std::uint32_t>(settings, field.offset + i * sizeof(std::uint32_t)));
      }
      return;
  }
}

template <typename AnySettings, typename Fields>
void go_through_all(AnySettings& settings, Fields& fields) noexcept {
  for (const SettingField& field : fields_of(settings)) {
    using Any = std::conditional_t<std::is_const_v<AnySettings>, const void, void>;
    go_through(field, static_cast<Any*>(&settings), fields);
  }
}

template <typename AnyIdentification, typename Fields>
void go_through_identification(AnyIdentification& identification, Fields& fields) noexcept {
  auto& [source, device, covariance, chi2, dof] = identification;
  auto& [estimate, u] = device;
  auto& [sensitivity, natural_frequency_hz, damping] = estimate;
  auto& [u_sensitivity, u_natural_frequency_hz, u_damping] = u;
  fields.choice(source, Source::kModel);
  fields.number(sensitivity);
  fields.number(natural_frequency_hz);
  fields.number(damping);
  fields.number(u_sensitivity);
  fields.number(u_natural_frequency_hz);
  fields.number(u_damping);
  for (std::size_t i = 0; i < 3; ++i) {
    fields.numbers(covariance[i], i + 1);
  }
  fields.number(chi2);
  fields.whole(dof);
}

bool is_uncertainty(double u, double variance) noexcept {
  return u >= 0.0 && abs(u * u - variance) <= 4.0 * kRounding * variance;
}

double correlation(double covariance, double variance, double other) noexcept {
  // The roots apart, so that their product does not leave the range of double.
  return covariance == 0.0 ? 0.0 : covariance / sqrt(variance) / sqrt(other);
}

/// @returns Whether random numbers can have this covariance: no correlation beyond 1, none of the
/// three that the other two exclude.
bool is_covariance(const double (&c)[3][3]) noexcept {
  constexpr double kSlack = 64.0 * kRounding;
  const double r[] = {correlation(c[1][0], c[1][1], c[0][0]),
                      correlation(c[2][0], c[2][2], c[0][0]),
                      correlation(c[2][1], c[2][2], c[1][1])};
  double determinant = 1.0 + 2.0 * r[0] * r[1] * r[2];
  for (const double one : r) {
    if (!(abs(one) <= 1.0 + kSlack)) {
      return false;
    }
    determinant -= one * one;
  }
  return determinant >= -kSlack;
}

bool is_possible(const Identification& id) noexcept {
  const auto& c = id.covariance;
  return validate(id.device.estimate) == Status::kOk &&
         is_uncertainty(id.device.u.sensitivity, c[0][0]) &&
         is_uncertainty(id.device.u.natural_frequency_hz, c[1][1]) &&
         is_uncertainty(id.device.u.damping, c[2][2]) && is_covariance(c) && id.chi2 >= 0.0 &&
         id.dof <= 2 * kMaxPoints;
}

}  // namespace

Identification identification_of(const EvaluationResults& results) noexcept {
  Identification identification;
  identification.source = results.source;
  identification.device = results.device;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      identification.covariance[i][j] = results.covariance(i, j);
    }
  }
  if (results.source == Source::kPoints) {
    identification.chi2 = results.fit.result().chi2;
    identification.dof = results.fit.result().dof;
  }
  return identification;
}

std::size_t encode(const Settings& settings, const SweepSettings& sweep,
                   Span<std::uint8_t> bytes) noexcept {
  Writer writer(bytes);
  writer.whole(kSettingsVersion4);
  go_through_all(settings, writer);
  go_through_all(sweep, writer);
  return writer.size();
}

std::size_t encode(const Identification& identification, Span<std::uint8_t> bytes) noexcept {
  Writer writer(bytes);
  writer.whole(kIdentificationVersion1);
  go_through_identification(identification, writer);
  return writer.size();
}

Status decode(Span<const std::uint8_t> bytes, const hal::StreamFormat& format,
              SavedSettings& scratch, Settings& settings, SweepSettings& sweep) noexcept {
  Reader reader(bytes);
  std::uint32_t version = 0;
  reader.whole(version);
  if (version != kSettingsVersion4) {
    return Status::kUnknownRecord;
  }
  go_through_all(scratch.settings, reader);
  go_through_all(scratch.sweep, reader);
  if (!reader.is_good() || !reader.is_at_end() || check(scratch.settings).setting != nullptr ||
      check(scratch.sweep, format).setting != nullptr) {
    return Status::kUnknownRecord;
  }
  settings = scratch.settings;
  sweep = scratch.sweep;
  return Status::kOk;
}

Status decode(Span<const std::uint8_t> bytes, Identification& identification) noexcept {
  Reader reader(bytes);
  std::uint32_t version = 0;
  reader.whole(version);
  if (version != kIdentificationVersion1) {
    return Status::kUnknownRecord;
  }
  Identification found;
  go_through_identification(found, reader);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 3; ++j) {
      found.covariance[i][j] = found.covariance[j][i];
    }
  }
  if (!reader.is_good() || !reader.is_at_end() || !is_possible(found)) {
    return Status::kUnknownRecord;
  }
  identification = found;
  return Status::kOk;
}

}  // namespace emax::app
