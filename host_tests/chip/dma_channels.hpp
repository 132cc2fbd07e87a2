// A DMA controller of eight channels, as the STM32G4 has them.
#pragma once

#include "chip/dma.hpp"

namespace emax::chip {

/// Found here: "dma_setting_while_enabled", "dma_nothing_to_transfer", "dma_no_request_chosen",
/// "dma_misaligned", "dma_unreachable", "dma_not_circular", "not_modelled".
class DmaChannels final : public Dma {
 public:
  DmaChannels(Context context, const std::string& name, DmaBus& bus, Dmamux& mux,
              unsigned first_mux, const std::array<unsigned, kChannels>& interrupts);

  bool on(unsigned channel) const override { return (get(control(channel)) & 1) != 0; }

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
  DmaAnswer serve(unsigned channel) override;
  void lose(unsigned channel) override;
  void fail(unsigned channel) override;
  std::uint32_t left(unsigned channel) const override { return stored(count(channel)); }
  void ask_in_vain(unsigned channel) override;
  void enable(unsigned channel);
  bool usable(unsigned channel) const;
  void transfer(unsigned channel);
  void set_flags(unsigned channel, std::uint32_t flags);
  void refresh(unsigned channel);

  std::array<Channel, kChannels> channels_ = {};
};

}  // namespace emax::chip
