# ST's board NUCLEO-G474RE: STM32G474RE, a Cortex-M4F.

include(${EMAX_BOARD_COMMON}/stm32/stm32.cmake)
emax_declare_board(
  CORE cortex-m4f
  CLOCK_HZ 170000000
  INTERRUPTS 102
  INTERRUPT_LEVELS ${EMAX_STM32_INTERRUPT_LEVELS}
  # All of its memory but the records. 2 KiB of the stack that other boards have are variables here, as DMA's buffers are in
  # the same RAM: the proof says that the stack does not need them. Constants go on into bank 2, as far as the records.
  BUDGET 503808 124928 6144
  WATCHDOG
  FLASH openocd -f board/st_nucleo_g4.cfg -c "program @IMAGE@ verify reset exit"
  CORE_TITLE STM32G474
  TABLE_CLOCK_MHZ 170
  INCLUDES
    ${EMAX_STM32_INCLUDES}
    include
  SOURCES
    ${EMAX_STM32_SOURCES}
    src/board.cpp
    src/g474_clocks.cpp
    src/g474_flash_store.cpp)
