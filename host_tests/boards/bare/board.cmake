# A board with next to nothing, outside firmware/boards: no bench, emulator, semihosting, watchdog, store or counter. Its
# product is built and gated; nobody runs it.

emax_declare_board(
  CORE cortex-m3
  CLOCK_HZ 1000000
  INTERRUPTS 102
  BUDGET 274432 122880 8192
  FLASH ${CMAKE_COMMAND} -E echo "A probe would now write @IMAGE@"
  INCLUDES ${EMAX_BOARD_COMMON}/cortex_m/include
  SOURCES
    ${EMAX_BOARD_COMMON}/cortex_m/src/reset_cause.cpp
    ${EMAX_BOARD_COMMON}/cortex_m/src/start.cpp
    board.cpp)
