// A DMA controller of eight streams with a FIFO each, as the STM32H7 has them.
#pragma once

#include <deque>

#include "chip/dma.hpp"

namespace emax::chip {

/// Found here: "dma_setting_while_enabled", "dma_nothing_to_transfer", "dma_no_request_chosen",
/// "dma_misaligned", "dma_unreachable", "dma_not_circular", "dma_old_flags", "dma_packs",
/// "dma_memory_size_ignored", "dma_burst_in_direct_mode", "dma_burst_and_threshold",
/// "dma_burst_misaligned", "dma_count_not_multiple", "dma_without_trbuff", "not_modelled", and what
/// the bus objects to.
class DmaStreams final : public Dma {
 public:
  DmaStreams(Context context, const std::string& name, DmaBus& bus, Dmamux& mux, unsigned first_mux,
             const std::array<unsigned, kChannels>& interrupts);

  bool on(unsigned stream) const override { return (get(control(stream)) & 1) != 0; }

 private:
  struct Stream {
    std::uint32_t total = 0;        ///< Items of a turn, of the peripheral's size.
    std::uint32_t memory_done = 0;  ///< Bytes of this turn that memory has given or got.
    bool over = false;              ///< Went to its end, not circular.
    std::deque<std::uint8_t> fifo;
  };

  static constexpr std::uint32_t control(unsigned stream) { return 0x10 + 0x18 * stream; }
  static constexpr std::uint32_t count(unsigned stream) { return control(stream) + 0x04; }
  static constexpr std::uint32_t peripheral(unsigned stream) { return control(stream) + 0x08; }
  static constexpr std::uint32_t memory(unsigned stream) { return control(stream) + 0x0C; }
  static constexpr std::uint32_t fifo_control(unsigned stream) { return control(stream) + 0x14; }

  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  DmaAnswer serve(unsigned stream) override;
  void lose(unsigned stream) override;
  void fail(unsigned stream) override;
  std::uint32_t left(unsigned stream) const override { return stored(count(stream)); }
  void ask_in_vain(unsigned stream) override;

  void write_stream(unsigned stream, std::uint32_t offset, std::uint32_t value);
  void enable(unsigned stream);
  bool fifo_is_right(unsigned stream);
  bool usable(unsigned stream) const;
  bool is_direct(unsigned stream) const { return !has(fifo_control(stream), 4); }
  unsigned peripheral_bytes(unsigned stream) const;
  /// Of the memory's items: in direct mode the peripheral's.
  unsigned memory_bytes(unsigned stream) const;
  unsigned burst_bytes(unsigned stream) const;
  std::uint32_t turn_bytes(unsigned stream) const;
  std::uint8_t* memory_now(unsigned stream);
  void fill(unsigned stream);
  void drain(unsigned stream, bool all);
  bool move_on(unsigned stream);
  std::uint32_t flags(unsigned stream) const;
  void set_flags(unsigned stream, std::uint32_t flags);
  void refresh(unsigned stream);

  std::array<Stream, kChannels> streams_ = {};
};

}  // namespace emax::chip
