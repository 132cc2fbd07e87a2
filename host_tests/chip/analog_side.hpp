// From the drive pin to the input pins: the front end of the board and a bench, step by step; and
// the record of what the drive pin did since the power was first on.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "emax/sim/volt_bench.hpp"

#include "chip/events.hpp"
#include "chip/stm32.hpp"

namespace emax::chip {

/// The bench, in volts outside the front end. One step is one period of the trigger.
class BenchInVolts {
 public:
  virtual sim::BenchVolts step(double drive_v) = 0;
  /// Called before the first step, and when the period has changed.
  virtual void set_period(double period_s) = 0;

 protected:
  ~BenchInVolts() = default;
};

/// A wire from the drive to both inputs.
class Wire final : public BenchInVolts {
 public:
  sim::BenchVolts step(double drive_v) override { return {drive_v, drive_v}; }
  void set_period(double) override {}
};

/// The simulated bench of `hal/sim`: same seed, same sensors.
class SimulatedBench final : public BenchInVolts {
 public:
  explicit SimulatedBench(const sim::BenchSettings& settings) : settings_(settings) {}
  sim::BenchVolts step(double drive_v) override { return bench_.step(drive_v); }
  void set_period(double period_s) override {
    status_ = bench_.configure(settings_, 1.0 / period_s);
  }
  const sim::VoltBench& bench() const { return bench_; }
  Status status() const { return status_; }

 private:
  sim::BenchSettings settings_;
  sim::VoltBench bench_;
  Status status_ = Status::kOk;
};

/// Volts outside per volt at the pin, around half of the supply.
struct FrontEnd {
  double half_supply_v = 1.65;  ///< Two resistors hold the drive pin there while it is off.
  double drive_gain = 1.0;
  double reference_gain = 1.0;  ///< Volts at the pin per volt outside.
  double device_gain = 1.0;
};

/// From then on the drive pin has this voltage.
struct DriveSample {
  Time at;
  double pin_v;
  bool on;  ///< Else the resistors hold it.
};

class AnalogSide final : public Pins {
 public:
  explicit AnalogSide(BenchInVolts& bench, const FrontEnd& front_end = FrontEnd{})
      : bench_(bench), front_end_(front_end), pin_v_(front_end.half_supply_v) {}

  const std::vector<DriveSample>& drive_record() const { return record_; }
  double drive_pin_v() const { return pin_v_; }
  /// The farthest that the drive pin has been from half of the supply, from this time on.
  double greatest_excursion_v(Time from = 0) const {
    double greatest_v = 0.0;
    for (const DriveSample& sample : record_) {
      if (sample.at >= from) {
        greatest_v = std::fmax(greatest_v, std::fabs(sample.pin_v - front_end_.half_supply_v));
      }
    }
    return greatest_v;
  }
  /// Triggers since the first.
  std::uint64_t steps() const { return steps_; }

  void drive(Time at, double pin_v) override {
    const bool on = !std::isnan(pin_v);
    const double volts = on ? pin_v : front_end_.half_supply_v;
    if (record_.empty() || volts != pin_v_ || on != record_.back().on) {
      record_.push_back({at, volts, on});
    }
    pin_v_ = volts;
  }

  void trigger(Time at, double period_s) override {
    if (period_s != period_s_) {
      period_s_ = period_s;
      bench_.set_period(period_s);
    } else {
      // The bench went on while there were no triggers; a second of it is enough to come to rest.
      const double missed =
          std::fmin(std::round(seconds(at - last_) / period_s) - 1.0, 1.0 / period_s);
      for (double i = 0; i < missed; i += 1.0) {
        step(held_v_);
      }
    }
    last_ = at;
    held_v_ = (pin_v_ - front_end_.half_supply_v) * front_end_.drive_gain;
    step(held_v_);
  }

  double reference_pin_v() override { return reference_pin_v_; }
  double device_pin_v() override { return device_pin_v_; }

 private:
  void step(double drive_v) {
    const sim::BenchVolts volts = bench_.step(drive_v);
    reference_pin_v_ = front_end_.half_supply_v + volts.reference_v * front_end_.reference_gain;
    device_pin_v_ = front_end_.half_supply_v + volts.device_v * front_end_.device_gain;
    ++steps_;
  }

  BenchInVolts& bench_;
  FrontEnd front_end_;
  std::vector<DriveSample> record_;
  double pin_v_;
  double held_v_ = 0.0;
  double reference_pin_v_ = 1.65;
  double device_pin_v_ = 1.65;
  double period_s_ = 0.0;
  Time last_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace emax::chip
