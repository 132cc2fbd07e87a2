// A second implementation of responses and energies, in 113-bit arithmetic: partial fractions of
// the product forms, and Gauss-Legendre in place of Gramians.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

__extension__ typedef __float128 Quad;

// clang has no quadmath.h; the library is the same.
extern "C" {
Quad expq(Quad x);
Quad sinq(Quad x);
Quad cosq(Quad x);
Quad asinq(Quad x);
Quad sqrtq(Quad x);
Quad fabsq(Quad x);
}

namespace emax::test {

using Wide = Quad;

inline const Wide kWidePi = 2 * asinq(1);

struct WideComplex {
  Wide re = 0;
  Wide im = 0;
};

inline WideComplex operator+(WideComplex a, WideComplex b) { return {a.re + b.re, a.im + b.im}; }
inline WideComplex operator-(WideComplex a, WideComplex b) { return {a.re - b.re, a.im - b.im}; }
inline WideComplex operator*(WideComplex a, WideComplex b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
inline WideComplex operator*(Wide s, WideComplex a) { return {s * a.re, s * a.im}; }
inline WideComplex inverse(WideComplex a) {
  const Wide size = a.re * a.re + a.im * a.im;
  return {a.re / size, -a.im / size};
}
inline WideComplex exp(WideComplex a) {
  const Wide size = expq(a.re);
  return {size * cosq(a.im), size * sinq(a.im)};
}

enum class WideError { kSquare, kInBand, kIdeal };

/// y for switching signals of +-1, sensor S, f0, beta, a Butterworth filter, and for the in-band
/// error the reference delayed by its continued modes.
class WideResponse {
 public:
  WideResponse(double sensitivity, double f0_hz, double damping, int order, double cutoff_hz,
               double gain, WideError error, double delay_s = 0.0) {
    const Wide two_pi = 2 * kWidePi;
    const Wide s = sensitivity;
    const Wide w0 = two_pi * f0_hz;
    const Wide wc = two_pi * cutoff_hz;
    const Wide b = damping;
    const Wide g = gain;
    const auto sensor = [&](WideComplex p) {
      WideComplex below = p * p + (2 * b * w0) * p;
      below.re += w0 * w0;
      return (s * w0 * w0) * inverse(below);
    };
    std::vector<WideComplex> poles;
    for (int i = 1; i <= order; ++i) {
      const Wide angle = kWidePi * (2 * i + order - 1) / (2 * order);
      poles.push_back({wc * cosq(angle), 2 * i == order + 1 ? Wide(0) : wc * sinq(angle)});
    }
    const auto unit_filter = [&](WideComplex p, int without) {
      WideComplex product = {1, 0};
      for (int i = 0; i < order; ++i) {
        product = wc * product;
        if (i != without) {
          product = product * inverse(p - poles[static_cast<std::size_t>(i)]);
        }
      }
      return product;
    };
    settled_ = s - g;
    for (int i = 0; 2 * i + 1 <= order; ++i) {
      const WideComplex p = poles[static_cast<std::size_t>(i)];
      WideComplex residue = (2 * i + 1 == order ? 1 : 2) * unit_filter(p, i);
      if (error == WideError::kInBand) {
        residue = residue * (sensor(p) - g * exp(-Wide(delay_s) * p));
      } else {
        residue = -g * residue;
      }
      add(p, residue);
    }
    if (error != WideError::kIdeal) {
      const WideComplex p = {-b * w0, w0 * sqrtq((1 - b) * (1 + b))};
      WideComplex residue = {0, -s * w0 / sqrtq((1 - b) * (1 + b))};
      if (error == WideError::kInBand) {
        residue = residue * unit_filter(p, -1);
      }
      add(p, residue);
    }
    if (delay_s > 0.0) {
      settled_ = 0;
      for (std::size_t i = 0; i < poles_.size(); ++i) {
        settled_ -= (residues_[i] * inverse(poles_[i])).re;
      }
    }
  }

  Wide step_response(Wide time_s) const {
    Wide sum = settled_;
    for (std::size_t i = 0; i < poles_.size(); ++i) {
      sum += (residues_[i] * inverse(poles_[i]) * exp(time_s * poles_[i])).re;
    }
    return sum;
  }

  Wide impulse_response(Wide time_s) const {
    Wide sum = 0;
    for (std::size_t i = 0; i < poles_.size(); ++i) {
      sum += (residues_[i] * exp(time_s * poles_[i])).re;
    }
    return sum;
  }

  /// The integral of y^2 over [0, T], with 12 nodes on pieces of a radian of the fastest pole.
  double energy(const std::vector<double>& times_s, double duration_s) const {
    Wide nodes[12];
    Wide weights[12];
    fill_nodes(nodes, weights);
    std::vector<WideComplex> state(poles_.size());  // r/p e^(p t), with the sign of each switch.
    for (std::size_t i = 0; i < poles_.size(); ++i) {
      state[i] = residues_[i] * inverse(poles_[i]);
    }
    Wide sum = 0;
    Wide sign = 1;
    Wide last_s = 0;
    for (std::size_t k = 0; k <= times_s.size(); ++k) {
      const Wide end_s = k < times_s.size() ? times_s[k] : duration_s;
      const auto pieces = static_cast<int>((end_s - last_s) * fastest_) + 1;
      const Wide piece_s = (end_s - last_s) / pieces;
      for (int piece = 0; piece < pieces; ++piece) {
        for (int n = 0; n < 12; ++n) {
          Wide y = sign * settled_;
          for (std::size_t i = 0; i < poles_.size(); ++i) {
            y += (state[i] * exp((piece + nodes[n]) * piece_s * poles_[i])).re;
          }
          sum += piece_s * weights[n] * y * y;
        }
      }
      sign = -sign;
      for (std::size_t i = 0; i < poles_.size(); ++i) {
        state[i] = exp((end_s - last_s) * poles_[i]) * state[i] +
                   (2 * sign) * (residues_[i] * inverse(poles_[i]));
      }
      last_s = end_s;
    }
    return static_cast<double>(sum);
  }

 private:
  void add(WideComplex pole, WideComplex residue) {
    poles_.push_back(pole);
    residues_.push_back(residue);
    const Wide speed = sqrtq(pole.re * pole.re + pole.im * pole.im);
    fastest_ = speed > fastest_ ? speed : fastest_;
  }

  /// Of Gauss and Legendre on [0, 1], by Newton's method on the recursion of the polynomials.
  static void fill_nodes(Wide (&nodes)[12], Wide (&weights)[12]) {
    for (int i = 0; i < 12; ++i) {
      Wide x = cosq(kWidePi * (i + Wide(0.75)) / Wide(12.5));
      Wide slope = 1;
      for (int iteration = 0; iteration < 8; ++iteration) {
        Wide before = 1;
        Wide value = x;
        for (int n = 2; n <= 12; ++n) {
          const Wide next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
          before = value;
          value = next;
        }
        slope = 12 * (x * value - before) / (x * x - 1);
        x -= value / slope;
      }
      nodes[i] = (1 + x) / 2;
      weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
  }

  std::vector<WideComplex> poles_;
  std::vector<WideComplex> residues_;
  Wide settled_ = 0;
  Wide fastest_ = 0;
};

}  // namespace emax::test
