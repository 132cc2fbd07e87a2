// The paper's procedure for many devices, four at a time in the lanes of a vector.
#pragma once

#include <cstddef>
#include <vector>

#include "emax/base/span.hpp"
#include "emax/model/modal_model.hpp"

namespace emax::desk {

/// Whether the processor has vectors of four doubles (AVX2).
bool has_lanes() noexcept;

/// Runs the fixed point from Phi's first column for one device after the other, as `FixedPoint`
/// with `Method::kPaper` does, in double precision: every bit of every energy is the same, as each
/// lane does what the scalar code does, in its order. A lane that has finished takes the next
/// device, so none waits for the slowest.
///
/// 64 bytes for each cell. Where has_lanes() is false it must not be called.
class PaperLanes {
 public:
  /// @param[in] model          Filter and criterion, with any sensor.
  /// @param[in] max_iterations The paper's J.
  PaperLanes(const ModalModel& model, double duration_s, std::size_t cells,
             std::size_t max_iterations);

  /// @param[in]  devices  Valid ones.
  /// @param[out] energies One for each device, for a = 1; NaN for a device that is not valid.
  void run(Span<const Accelerometer> devices, Span<double> energies);

 private:
  static constexpr std::size_t kLanes = 4;
  static constexpr std::size_t kPlaces = kMaxModes + 1;  // One that is nothing follows the modes.

  /// One number for each lane.
  struct alignas(kLanes * sizeof(double)) Numbers {
    double of[kLanes] = {};
  };
  struct ComplexNumbers {
    Numbers re;
    Numbers im;
  };
  /// What a lane is at.
  struct Run {
    ModalModel model = {};
    double energy = 0.0;
    std::size_t device = 0;
    std::size_t iterations = 0;
    bool is_active = false;
    bool has_energy = false;
  };

  bool take_next_device(std::size_t lane, Span<const Accelerometer> devices, Span<double> energies);
  void multiply();
  void go_forward();
  void take_end();
  void go_back();
  void take_signs();
  bool is_finished(std::size_t lane);

  double duration_s_;
  std::size_t cells_;
  std::size_t max_iterations_;
  std::size_t count_;
  std::size_t next_device_ = 0;
  Run runs_[kLanes];
  ComplexNumbers step_[kPlaces] = {};
  ComplexNumbers correlation_[kPlaces] = {};
  ComplexNumbers end_[kPlaces] = {};
  ComplexNumbers state_[kPlaces] = {};  // At T, going forward; then going back.
  Numbers diagonal_ = {};
  Numbers energy_ = {};   // Of the patterns that the product belongs to.
  Numbers changes_ = {};  // 1 in lanes where a sign has changed.
  std::vector<Numbers> signs_;
  std::vector<Numbers> product_;
  std::vector<double> column_;
};

}  // namespace emax::desk
