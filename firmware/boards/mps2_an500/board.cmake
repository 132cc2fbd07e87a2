# MPS2 with a Cortex-M7.

include(${EMAX_BOARD_COMMON}/mps2/mps2.cmake)
emax_declare_board(${EMAX_MPS2}
  CORE cortex-m7
  RUNNER ${EMAX_BOARD_COMMON}/qemu.py qemu-system-arm -M mps2-an500 run
  CORE_TITLE Cortex-M7
  TABLE_CLOCK_MHZ 480
  EXTRA_JOBS all_trials
  GOOGLETEST_MEMORY googletest.ld
  SLOW_TEST_S 0.5)
