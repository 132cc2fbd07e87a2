# MPS2 with a Cortex-M4F.

include(${EMAX_BOARD_COMMON}/mps2/mps2.cmake)
emax_declare_board(${EMAX_MPS2}
  CORE cortex-m4f
  RUNNER ${EMAX_BOARD_COMMON}/qemu.py qemu-system-arm -M mps2-an386 run
  CORE_TITLE Cortex-M4F
  TABLE_CLOCK_MHZ 170
  TABLE_LEFT_OUT steps-10 report
  GOOGLETEST_MEMORY googletest.ld
  SLOW_TEST_S 0.5)
