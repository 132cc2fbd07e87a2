// The tables of the STM32H743's registers.
#pragma once

#include "chip/register_block.hpp"

namespace emax::chip::h743 {

Registers rcc_registers();
Registers pwr_registers();
Registers flash_registers();
/// @param[in] letter Of the port; A and B have pins of the debug probe.
Registers gpio_registers(char letter);
Registers basic_timer_registers();
Registers general_timer_registers();
Registers usart_registers();
Registers dma_registers();
Registers dmamux_registers();
Registers dac_registers();
Registers adc_registers();
Registers adc_common_registers();
Registers iwdg_registers();
Registers syscfg_registers();
Registers dbgmcu_registers(std::uint32_t id_code);
Registers exti_registers();

}  // namespace emax::chip::h743
