// Figures in as many digits as their uncertainty justifies.
#include "desk/compare/figure_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "emax/app/base/text_writer.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"

namespace emax::desk {

namespace {

constexpr int kDigitsAlone = 4;
constexpr int kMostDigits = 12;
constexpr const char* kNone = "-";

constexpr FigureWords kFigureWords[kFigureKinds] = {
    {"matched %", " % of S a", "matched"},
    {"in band %", " % of S a", "band"},
    {"E in V^2 s", " V^2 s", "energy"},
};

int exponent_of(double value) {
  return value != 0.0 ? static_cast<int>(std::floor(std::log10(std::abs(value)))) : 0;
}

std::string in_digits(double value, int digits, FigureKind kind) {
  constexpr double kLeastPlain = 1e-5;
  constexpr double kMostPlain = 1e6;
  const double size = std::abs(value);
  const bool is_plain = size == 0.0 || (size >= kLeastPlain && size < kMostPlain);
  StringSink sink;
  app::TextWriter out(sink);
  if (kind != FigureKind::kEnergy && is_plain) {
    out.fixed(value, std::clamp(digits - 1 - exponent_of(value), 0, kMostDigits));
  } else {
    out.scientific(value, digits - 1);
  }
  return sink.text();
}

}  // namespace

const FigureWords& figure_words(FigureKind kind) noexcept {
  return kFigureWords[static_cast<std::size_t>(kind)];
}

bool is_rounding(double size, double figure) noexcept {
  constexpr double kRounding = 1e-9;  // A figure with more of it is refused.
  return std::abs(size) <= kRounding * std::abs(figure);
}

std::string number_text(double value, double expanded, FigureKind kind) {
  constexpr int kLeast = 2;
  int digits = kDigitsAlone;
  if (expanded > 0.0) {
    digits = std::clamp(exponent_of(value) - exponent_of(expanded) + 2, kLeast, kMostDigits);
  }
  return in_digits(value, digits, kind);
}

std::string bound_text(const Figure& figure, FigureKind kind) {
  if (!figure.has_bound) {
    return kNone;
  }
  return in_digits(rounded_up(figure.bound, kDigitsAlone - 1), kDigitsAlone, kind);
}

double shown_expanded(const Figure& figure) noexcept {
  return is_rounding(figure.expanded, figure.value) ? 0.0 : figure.expanded;
}

std::string expanded_text(const Figure& figure, FigureKind kind) {
  const double expanded = shown_expanded(figure);
  if (!figure.has_uncertainty || figure.is_one_sided) {
    return kNone;
  }
  return expanded > 0.0 ? number_text(expanded, expanded, kind) : "0";
}

std::string value_text(const Figure& figure, FigureKind kind) {
  const double expanded = figure.is_one_sided ? 0.0 : shown_expanded(figure);
  return figure.exists ? number_text(figure.value, expanded, kind) : kNone;
}

std::string range_text(double low, double high) {
  constexpr int kDecimals = 1;  // Of the far end's power of ten.
  const int decimals = kDecimals - exponent_of(high);
  const double unit = std::pow(10.0, -decimals);
  constexpr double kRounding = 1e-9;
  const double down = std::floor(low / unit + kRounding) * unit;
  const double up = std::ceil(high / unit - kRounding) * unit;
  constexpr int kMostPlain = 9;
  StringSink sink;
  app::TextWriter out(sink);
  const auto write = [&](double end) {
    if (end == 0.0) {
      out.integer(0);
    } else if (decimals > kMostPlain || decimals < 0) {
      out.scientific(end, kDecimals);
    } else {
      out.fixed(end, decimals);
    }
  };
  write(down);
  out.text(" to ");
  write(up);
  return sink.text();
}

std::string interval_text(const Figure& figure, FigureKind kind) {
  if (!figure.has_interval && !figure.has_range) {
    return kNone;
  }
  if (figure.is_one_sided) {
    return range_text(figure.low, figure.high);
  }
  const double expanded = shown_expanded(figure);
  return number_text(figure.low, expanded, kind) + " to " +
         number_text(figure.high, expanded, kind);
}

std::string paper_text(const Result& result) {
  const Figure& energy = result.figure(FigureKind::kEnergy);
  if (energy.value < 0.0) {
    return kNone;
  }
  const double percent = result.rms_percent();
  // The root halves what is relative.
  const double expanded = energy.value > 0.0 ? 0.5 * percent * energy.expanded / energy.value : 0.0;
  return number_text(percent, expanded, FigureKind::kBand);
}

}  // namespace emax::desk
