# What the boards MPS2 have in common: all but the core.

set(EMAX_MPS2
  CLOCK_HZ 25000000
  INTERRUPTS 32
  # No priority is written, so all have the same.
  INTERRUPT_LEVELS "*::on_receive *::on_transmit *::on_clock *::on_fault"
  SIMULATED_BENCH
  WATCHDOG
  SEMIHOSTING
  COUNTER ${EMAX_BOARD_COMMON}/cmsdk/src/cmsdk_counter.cpp
  INSTRUCTION_NS 64
  INCLUDES
    ${EMAX_BOARD_COMMON}/cmsdk/include
    ${EMAX_BOARD_COMMON}/cortex_m/include
  SOURCES
    ${EMAX_BOARD_COMMON}/cmsdk/src/cmsdk_clock.cpp
    ${EMAX_BOARD_COMMON}/cmsdk/src/cmsdk_uart.cpp
    ${EMAX_BOARD_COMMON}/cmsdk/src/cmsdk_watchdog.cpp
    ${EMAX_BOARD_COMMON}/cortex_m/src/reset_cause.cpp
    ${EMAX_BOARD_COMMON}/cortex_m/src/start.cpp
    ${EMAX_BOARD_COMMON}/mps2/src/board.cpp)
