# What every board with an STM32 is made of, beside what is in its own folder.

set(EMAX_STM32_INCLUDES
  ${EMAX_BOARD_COMMON}/cortex_m/include
  ${EMAX_BOARD_COMMON}/stm32/include)
# As start_drivers() sets them, which the tests on the chip models read back.
set(EMAX_STM32_INTERRUPT_LEVELS "*::on_console *::on_output *::on_clock" "*::on_watchdog *::on_fault")
set(EMAX_STM32_SOURCES
  ${EMAX_BOARD_COMMON}/cortex_m/src/reset_cause.cpp
  ${EMAX_BOARD_COMMON}/cortex_m/src/start.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/converter_rings.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/status_led.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_adc_pair.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_board.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_clock.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_dac.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_dma.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_stream.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_uart.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/stm32_watchdog.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/timebase.cpp
  ${EMAX_BOARD_COMMON}/stm32/src/unique_id.cpp)
