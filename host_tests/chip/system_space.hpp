// The processor's own registers at 0xE0000000: SysTick, NVIC, system control, MPU, DWT.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "chip/engine.hpp"
#include "chip/events.hpp"
#include "chip/findings.hpp"
#include "chip/nvic.hpp"

namespace emax::chip {

/// What differs between the processors.
struct CoreFeatures {
  std::uint32_t cpuid;
  unsigned mpu_regions;
  std::uint32_t vectors_alignment;  ///< For all interrupts of the chip.
  bool caches;
  bool trace_lock;  ///< DWT must be unlocked before it is written.
};

/// One region of the memory protection unit.
struct MpuRegion {
  std::uint32_t base = 0;
  std::uint32_t attributes = 0;  ///< RASR.
};

/// What the registers say, and what they do to NVIC and engine.
class SystemSpace {
 public:
  SystemSpace(Core core, Events& events, Findings& findings, Nvic& nvic);

  void reset(std::uint32_t vectors, bool power_lost);
  /// The time of a cycle and the count of cycles come from the processor.
  void set_clock(std::function<Time()> cycle, std::function<std::uint64_t()> cycles);
  void on_reset_request(std::function<void()> action) { reset_request_ = std::move(action); }

  std::uint32_t read(std::uint32_t address, unsigned bytes);
  void write(std::uint32_t address, unsigned bytes, std::uint32_t value);

  std::uint32_t vectors() const { return vtor_; }
  bool fpu_enabled() const { return (cpacr_ & 0xF00000) == 0xF00000; }
  /// Does the regions' permissions; not while the engine runs.
  bool mpu_changed() const { return mpu_changed_; }
  void apply_mpu(Engine& engine);
  /// After memory has come or gone.
  void renew_mpu() { mpu_changed_ = true; }
  bool ignores_bus_faults() const { return (ccr_ & 0x100) != 0; }
  /// Whether data at this address are kept in the data cache, which is on.
  bool is_cached(std::uint32_t address) const;
  /// @returns Whether the MPU forbids this access, so that it is a MemManage fault.
  bool mpu_forbids(std::uint32_t address, bool write) const;

  /// Puts the reasons of a fault into CFSR, HFSR and the address registers.
  void note_fault(std::uint32_t cfsr, std::uint32_t address);
  void note_escalation() { hfsr_ |= 1U << 30; }
  unsigned active_exception = 0;  ///< Kept by the processor, for ICSR.
  bool sleep_on_exit() const { return (scr_ & 2) != 0; }
  bool deep_sleep() const { return (scr_ & 4) != 0; }

 private:
  std::uint32_t read_word(std::uint32_t address);
  void write_word(std::uint32_t address, std::uint32_t value);
  std::uint32_t read_nvic(std::uint32_t offset) const;
  void write_nvic(std::uint32_t offset, std::uint32_t value);
  std::uint32_t read_control(std::uint32_t address) const;
  void write_control(std::uint32_t address, std::uint32_t value);
  std::uint32_t read_systick(std::uint32_t address);
  void write_systick(std::uint32_t address, std::uint32_t value);
  void write_mpu(std::uint32_t address, std::uint32_t value);
  std::uint32_t read_debug(std::uint32_t address) const;
  void write_debug(std::uint32_t address, std::uint32_t value);
  void write_priorities(unsigned first, std::uint32_t value);
  std::uint32_t priorities(unsigned first) const;
  void pend_from_icsr(std::uint32_t value);
  Time systick_period() const;
  void start_systick();
  std::uint32_t permissions_at(std::uint32_t address, std::uint32_t otherwise) const;
  /// The region that decides here; null: none.
  const MpuRegion* region_at(std::uint32_t address) const;
  bool write_cache(std::uint32_t address, std::uint32_t value);
  void write_configuration(std::uint32_t value);

  const CoreFeatures core_;
  Events& events_;
  Findings& findings_;
  Nvic& nvic_;
  std::function<Time()> cycle_;
  std::function<std::uint64_t()> cycles_;
  std::function<void()> reset_request_;

  std::uint32_t vtor_ = 0, aircr_ = 0, scr_ = 0, ccr_ = 0x200, cfsr_ = 0, hfsr_ = 0;
  std::uint32_t mmfar_ = 0, bfar_ = 0, cpacr_ = 0, fpccr_ = 0xC0000000;
  std::uint32_t demcr_ = 0, dwt_control_ = 0x40000000;
  std::uint64_t cycle_origin_ = 0;
  std::uint32_t cycle_count_ = 0;

  std::uint32_t mpu_control_ = 0, mpu_number_ = 0;
  std::array<MpuRegion, 16> mpu_ = {};
  bool mpu_changed_ = false;
  bool trace_unlocked_ = false;
  unsigned cleared_lines_ = 0;  ///< Of the data cache, since it was last off.
  bool code_cleared_ = false;

  std::uint32_t systick_control_ = 0, systick_reload_ = 0, systick_stopped_at_ = 0;
  bool systick_counted_ = false;
  Time systick_due_ = 0;
  Events::Id systick_event_ = 0;
};

}  // namespace emax::chip
