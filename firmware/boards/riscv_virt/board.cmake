# QEMU's machine virt with a 32-bit RISC-V core. No GoogleTest: there is no C++ library for the core.

emax_declare_board(
  CORE rv32
  CLOCK_HZ 10000000
  INTERRUPTS 32
  SIMULATED_BENCH
  SEMIHOSTING
  RUNNER ${EMAX_BOARD_COMMON}/qemu.py qemu-system-riscv32 -M virt -bios none run
  TELNET_BREAK
  COUNTER src/minstret_counter.cpp
  INSTRUCTION_NS 1
  CORE_TITLE RV32IMAFDC
  TABLE_CLOCK_MHZ 480
  INCLUDES include
  SOURCES src/board.cpp src/machine_clock.cpp src/ns16550.cpp src/start.cpp)
