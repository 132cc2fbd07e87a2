#include "chip/dma.hpp"

namespace emax::chip {

void Dmamux::on_write(std::uint32_t offset, std::uint32_t value) {
  if (offset < 0x40 && channel_on_(offset / 4) && value != stored(offset)) {
    report("dma_setting_while_enabled", offset, value);
  }
  if (offset < 0x40 && (value & 0x1FFF0200) != 0) {
    report("not_modelled", offset, value);
  }
  put(offset, masked(offset, value));
}

std::uint8_t* Dma::reach(std::uint32_t register_offset, std::uint32_t address,
                         std::uint32_t bytes) const {
  std::uint8_t* const begin = bus_.dma_memory(address, bytes);
  const char* const objection = bus_.dma_objection(address, bytes);
  if (begin == nullptr || objection != nullptr) {
    report(objection != nullptr ? objection : "dma_unreachable", register_offset, address);
  }
  return begin;
}

DmaAnswer Dma::request(unsigned channel, unsigned id, bool lost) {
  if (chosen(channel) != id || !gate().on) {
    return DmaAnswer::kNobody;
  }
  if (!on(channel) || left(channel) == 0) {
    ask_in_vain(channel);
    return DmaAnswer::kNobody;
  }
  if (std::exchange(fail_[channel], false)) {
    fail(channel);
    return DmaAnswer::kNobody;
  }
  if (lost) {
    lose(channel);
    return DmaAnswer::kDone;
  }
  return serve(channel);
}

DmaAnswer DmaRequests::request(unsigned id) {
  const bool lost = to_lose_ != 0 && id == lost_id_;
  to_lose_ -= lost ? 1 : 0;
  for (Dma* controller : controllers_) {
    for (unsigned channel = 0; channel < Dma::kChannels; ++channel) {
      const DmaAnswer answer = controller->request(channel, id, lost);
      if (answer != DmaAnswer::kNobody) {
        return answer;
      }
    }
  }
  return DmaAnswer::kNobody;
}

}  // namespace emax::chip
