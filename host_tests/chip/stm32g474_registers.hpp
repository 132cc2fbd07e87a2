// The tables of the STM32G474's registers.
#pragma once

#include "chip/register_block.hpp"

namespace emax::chip {

Registers rcc_registers();
Registers pwr_registers();
Registers flash_registers();
Registers gpio_registers();
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

}  // namespace emax::chip
