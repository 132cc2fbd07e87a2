# What the images of a board print must not depend on the processor: the same bytes as the program on the PC.

# emax_add_identical_tests(<configuration> <board> [<job>...])
# The report of known parameters, that of the default job and of further ones, and the answers of the console. No line of
# a report names the board.
function(emax_add_identical_tests configuration EMAX_BOARD)
  if(NOT configuration IN_LIST configurations)
    return()
  endif()
  include(${PROJECT_SOURCE_DIR}/toolchains/emulator.cmake)
  list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)
  set(program ${PROJECT_SOURCE_DIR}/build/host/emax)
  set(image ${PROJECT_SOURCE_DIR}/build/${configuration}/emax_${EMAX_BOARD})
  set(scenario ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/host_tests/scenario/)
  set(comparison ${scenario}identical_reports.py
    host=${program} "${configuration}=${emulator} '${image}_report.elf'" --)
  set(tests identical.${configuration}.answers)
  add_test(NAME ${tests} COMMAND ${scenario}identical_answers.py ${program} "${emulator} '${image}.elf'")
  foreach(job IN ITEMS model bench ${ARGN})
    add_test(NAME identical.${configuration}.${job} COMMAND ${comparison} ${${job}_job})
    list(APPEND tests identical.${configuration}.${job})
  endforeach()
  # Double in software takes the default job through about 10^10 instructions; the long ones are started first.
  set_tests_properties(${tests} PROPERTIES TIMEOUT 600 COST 60 LABELS ${configuration})
endfunction()

set(all_trials_job report --trials 200000)
emax_add_identical_tests(cortex-m4f mps2_an386)
emax_add_identical_tests(cortex-m7 mps2_an500 all_trials)
emax_add_identical_tests(rv32 riscv_virt)

# Of the sources of boards, those that the PC's tests build too.
file(GLOB tidied RELATIVE ${PROJECT_SOURCE_DIR} host_tests/boards/test_*.cpp)
list(TRANSFORM tidied REPLACE "host_tests/boards/test_(.*)" "firmware/boards/common/src/\\1")
foreach(source IN LISTS tidied)
  add_test(NAME style.tidy.${source}
    COMMAND ${EMAX_CLANG_TIDY} --quiet -p ${PROJECT_SOURCE_DIR}/build/host-clang ${PROJECT_SOURCE_DIR}/${source})
endforeach()
