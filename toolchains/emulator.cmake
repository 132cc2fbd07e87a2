# Sets CMAKE_CROSSCOMPILING_EMULATOR, the QEMU machine that runs the images of EMAX_BOARD, so that ctest can run them.

if(NOT EMAX_BOARD)
  return()
elseif(EMAX_BOARD STREQUAL "mps2_an386")
  set(machine qemu-system-arm -M mps2-an386)
  set(core cortex-m4f)
elseif(EMAX_BOARD STREQUAL "mps2_an500")
  set(machine qemu-system-arm -M mps2-an500)
  set(core cortex-m7)
elseif(EMAX_BOARD STREQUAL "riscv_virt")
  set(machine qemu-system-riscv32 -M virt -bios none)
  set(core rv32)
else()
  message(FATAL_ERROR "EMAX_BOARD is '${EMAX_BOARD}', which no emulator is known for")
endif()
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_SYSTEM_PROCESSOR STREQUAL core)
  message(FATAL_ERROR "EMAX_BOARD is '${EMAX_BOARD}' with a ${core}, "
                      "but the toolchain is for ${CMAKE_SYSTEM_PROCESSOR}")
endif()

# Tests that need further options put them before -kernel; the image comes last.
set(EMAX_MACHINE ${machine} -display none -monitor none -semihosting-config enable=on,target=native)
set(CMAKE_CROSSCOMPILING_EMULATOR ${EMAX_MACHINE} -serial stdio -kernel)
