// What all DMA controllers have: requests by the multiplexer, channels or streams, their faults.
#pragma once

#include <array>
#include <functional>
#include <utility>

#include "chip/register_block.hpp"

namespace emax::chip {

/// What a channel moves data between.
class DmaBus {
 public:
  /// Memory that these controllers reach, with all of this many bytes. @returns Null elsewhere.
  virtual std::uint8_t* dma_memory(std::uint32_t address, std::uint32_t bytes) = 0;
  /// Why that memory should not be used although it is reached: the name of a finding, or null.
  virtual const char* dma_objection(std::uint32_t address, std::uint32_t bytes) = 0;
  virtual bool is_register(std::uint32_t address) = 0;
  virtual std::uint32_t read(std::uint32_t address, unsigned bytes) = 0;
  virtual void write(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;

 protected:
  ~DmaBus() = default;
};

/// What became of a request.
enum class DmaAnswer {
  kNobody,  ///< No channel that is on has it.
  kDone,
  kLast,  ///< Done, and it was the last of the channel's transfers.
};

/// Found here: "dma_setting_while_enabled".
class Dmamux final : public RegisterBlock {
 public:
  Dmamux(Context context, Registers registers)
      : RegisterBlock(context, "DMAMUX", std::move(registers)) {}
  unsigned request_of(unsigned channel) const { return get(4 * channel) & 0x7F; }
  /// Whether a channel of both controllers, 0 to 15, is on.
  void ask_with(std::function<bool(unsigned)> channel_on) { channel_on_ = std::move(channel_on); }

 private:
  void on_write(std::uint32_t offset, std::uint32_t value) override;

  std::function<bool(unsigned)> channel_on_;
};

/// A controller of eight channels, or of eight streams.
class Dma : public RegisterBlock {
 public:
  static constexpr unsigned kChannels = 8;

  virtual bool on(unsigned channel) const = 0;
  /// Moves one item if this channel is on and has this request.
  /// @param[in] lost The item vanishes: it is read, and the channel does not move on.
  DmaAnswer request(unsigned channel, unsigned id, bool lost);
  /// Test: the next transfer of a channel, counted from 0, is an error on the bus.
  void fail_next(unsigned channel) { fail_.at(channel) = true; }

 protected:
  /// @param[in] first_mux The multiplexer's channel of the first of these.
  Dma(Context context, const std::string& name, Registers registers, DmaBus& bus, Dmamux& mux,
      unsigned first_mux, const std::array<unsigned, kChannels>& interrupts)
      : RegisterBlock(context, name, std::move(registers)),
        bus_(bus),
        mux_(mux),
        first_mux_(first_mux),
        interrupts_(interrupts) {}

  /// One item of a channel that is on.
  virtual DmaAnswer serve(unsigned channel) = 0;
  /// An item is read and goes nowhere.
  virtual void lose(unsigned channel) = 0;
  virtual void fail(unsigned channel) = 0;
  /// Items that are left; zero also behind the end.
  virtual std::uint32_t left(unsigned channel) const = 0;
  /// Came to its end, where it should have begun again.
  virtual void ask_in_vain(unsigned channel) = 0;

  unsigned chosen(unsigned channel) const { return mux_.request_of(first_mux_ + channel); }
  void set_line(unsigned channel, bool high) {
    context_.wires.set(interrupt(interrupts_[channel]), this, high);
  }
  /// The memory of a transfer, with what there is to say about it. @returns Null if unreachable.
  std::uint8_t* reach(std::uint32_t register_offset, std::uint32_t address,
                      std::uint32_t bytes) const;

  DmaBus& bus_;

 private:
  Dmamux& mux_;
  unsigned first_mux_;
  std::array<unsigned, kChannels> interrupts_;
  std::array<bool, kChannels> fail_ = {};
};

/// Both controllers, as peripherals see them.
class DmaRequests {
 public:
  DmaRequests(Dma& first, Dma& second) : controllers_{&first, &second} {}
  DmaAnswer request(unsigned id);
  /// Test: what so many requests of this kind move is lost, and does not count.
  void lose(unsigned id, unsigned requests) {
    lost_id_ = id;
    to_lose_ = requests;
  }

 private:
  std::array<Dma*, 2> controllers_;
  unsigned lost_id_ = 0;
  unsigned to_lose_ = 0;
};

}  // namespace emax::chip
