# ST's board NUCLEO-G474RE: STM32G474RE, a Cortex-M4F.

set(stm32 ${EMAX_BOARD_COMMON}/stm32)
emax_declare_board(
  CORE cortex-m4f
  CLOCK_HZ 170000000
  INTERRUPTS 102
  WATCHDOG
  FLASH openocd -f board/st_nucleo_g4.cfg -c "program @IMAGE@ verify reset exit"
  CORE_TITLE STM32G474
  TABLE_CLOCK_MHZ 170
  INCLUDES
    ${EMAX_BOARD_COMMON}/cortex_m/include
    ${stm32}/include
    include
  SOURCES
    ${EMAX_BOARD_COMMON}/cortex_m/src/reset_cause.cpp
    ${EMAX_BOARD_COMMON}/cortex_m/src/start.cpp
    ${stm32}/src/converter_rings.cpp
    ${stm32}/src/status_led.cpp
    ${stm32}/src/stm32_clock.cpp
    ${stm32}/src/stm32_dac.cpp
    ${stm32}/src/stm32_uart.cpp
    ${stm32}/src/stm32_watchdog.cpp
    ${stm32}/src/timebase.cpp
    ${stm32}/src/unique_id.cpp
    src/board.cpp
    src/g474_adc_pair.cpp
    src/g474_clocks.cpp
    src/g474_flash_store.cpp
    src/g474_stream.cpp)
