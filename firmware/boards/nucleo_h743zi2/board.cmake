# ST's board NUCLEO-H743ZI2: STM32H743ZI, a Cortex-M7 with double precision.

include(${EMAX_BOARD_COMMON}/stm32/stm32.cmake)
emax_declare_board(
  CORE cortex-m7
  CLOCK_HZ 400000000
  INTERRUPTS 150
  INTERRUPT_LEVELS ${EMAX_STM32_INTERRUPT_LEVELS}
  # As much for the program as on the other boards, and 4 KiB elsewhere for DMA's buffers.
  BUDGET 286720 126976 8192
  WATCHDOG
  FLASH openocd -f board/st_nucleo_h743zi.cfg -c "program @IMAGE@ verify reset exit"
  CORE_TITLE STM32H743
  TABLE_CLOCK_MHZ 400
  INCLUDES
    ${EMAX_STM32_INCLUDES}
    include
  SOURCES
    ${EMAX_STM32_SOURCES}
    ${EMAX_BOARD_COMMON}/cortex_m/src/caches.cpp
    src/board.cpp
    src/h743_clocks.cpp
    src/h743_flash.cpp
    src/h743_memory.cpp)
