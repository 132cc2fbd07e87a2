# PyVISA takes the product image of each board through the whole job, in QEMU, and compares with the program on the PC.

# emax_add_client_tests(<configuration> <board>)
function(emax_add_client_tests configuration EMAX_BOARD)
  if(NOT configuration IN_LIST configurations)
    return()
  endif()
  include(${PROJECT_SOURCE_DIR}/toolchains/emulator.cmake)
  set(directory ${PROJECT_SOURCE_DIR}/host_tests/clients)
  file(STRINGS ${directory}/test_pyvisa.py classes REGEX "^class [A-Za-z]+\\(ClientTest\\)")
  list(TRANSFORM classes REPLACE "^class ([A-Za-z]+).*" "\\1")
  foreach(class IN LISTS classes)
    add_test(NAME ${configuration}.clients.${class}
      COMMAND ${EMAX_PYTHON} -B test_pyvisa.py ${PROJECT_SOURCE_DIR}/build/host/emax
        ${PROJECT_SOURCE_DIR}/build/${configuration}/emax_${EMAX_BOARD}.elf ${EMAX_MACHINE} -- ${class}
      WORKING_DIRECTORY ${directory})
    # Double in software takes the whole job a minute.
    set_tests_properties(${configuration}.clients.${class} PROPERTIES TIMEOUT 600 LABELS ${configuration})
  endforeach()
endfunction()

emax_add_client_tests(cortex-m4f mps2_an386)
emax_add_client_tests(cortex-m7 mps2_an500)
emax_add_client_tests(rv32 riscv_virt)
