// DMA1 and DMA2 of eight channels each, and the multiplexer that hands them their requests.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "chip/register_block.hpp"

namespace emax::chip {

inline constexpr unsigned kAdc1Request = 5;
inline constexpr unsigned kDac1Request = 6;

/// What a channel moves data between.
class DmaBus {
 public:
  /// Memory that these controllers reach, with all of this many bytes. @returns Null elsewhere.
  virtual std::uint8_t* dma_memory(std::uint32_t address, std::uint32_t bytes) = 0;
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
  explicit Dmamux(Context context);
  unsigned request_of(unsigned channel) const { return get(4 * channel) & 0x7F; }
  /// Whether a channel of both controllers, 0 to 15, is on.
  void ask_with(std::function<bool(unsigned)> channel_on) { channel_on_ = std::move(channel_on); }

 private:
  void on_write(std::uint32_t offset, std::uint32_t value) override;

  std::function<bool(unsigned)> channel_on_;
};

/// Found here: "dma_setting_while_enabled", "dma_nothing_to_transfer", "dma_no_request_chosen",
/// "dma_misaligned", "dma_unreachable", "dma_not_circular", "not_modelled".
class Dma final : public RegisterBlock {
 public:
  static constexpr unsigned kChannels = 8;

  /// @param[in] first_mux The multiplexer's channel of the first of these.
  Dma(Context context, const std::string& name, DmaBus& bus, Dmamux& mux, unsigned first_mux,
      const std::array<unsigned, kChannels>& interrupts);

  bool on(unsigned channel) const { return (get(control(channel)) & 1) != 0; }
  /// Moves one item if this channel is on and has this request.
  /// @param[in] lost The item vanishes: it is read, and the channel does not move on.
  DmaAnswer request(unsigned channel, unsigned id, bool lost);
  /// Test: the next transfer of a channel, counted from 0, is an error on the bus.
  void fail_next(unsigned channel) { fail_.at(channel) = true; }

 private:
  struct Channel {
    std::uint32_t total = 0;
    bool over = false;  ///< Went to its end, not circular.
  };

  static constexpr std::uint32_t control(unsigned channel) { return 0x08 + 20 * channel; }
  static constexpr std::uint32_t count(unsigned channel) { return 0x0C + 20 * channel; }
  static constexpr std::uint32_t peripheral(unsigned channel) { return 0x10 + 20 * channel; }
  static constexpr std::uint32_t memory(unsigned channel) { return 0x14 + 20 * channel; }

  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  void enable(unsigned channel);
  bool usable(unsigned channel) const;
  void transfer(unsigned channel);
  void set_flags(unsigned channel, std::uint32_t flags);
  void fail(unsigned channel);
  void refresh(unsigned channel);

  DmaBus& bus_;
  Dmamux& mux_;
  unsigned first_mux_;
  std::array<unsigned, kChannels> interrupts_;
  std::array<Channel, kChannels> channels_ = {};
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
