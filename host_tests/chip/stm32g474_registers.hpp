// The tables of the STM32G474's registers.
#pragma once

#include "chip/register_block.hpp"

namespace emax::chip::g474 {

Registers rcc_registers();
Registers pwr_registers();
Registers flash_registers();
/// @param[in] letter Of the port; A and B have pins of the debug probe.
Registers gpio_registers(char letter);
Registers basic_timer_registers();
Registers lpuart_registers();
Registers dma_registers();
Registers dmamux_registers();
Registers dac_registers();
Registers adc_registers();
Registers adc_common_registers();
Registers iwdg_registers();
Registers syscfg_registers();
Registers dbgmcu_registers();
Registers general_timer_registers();
Registers exti_registers();

}  // namespace emax::chip::g474
