# GoogleTest images as tests of ctest, and what of the tests they leave out.

# emax_leave_out(<program> <test>...)
# Tests of a program that its image does not run; no <test> for the whole program.
function(emax_leave_out program)
  set_property(GLOBAL APPEND PROPERTY EMAX_LEFT_OUT_${program} ${ARGN})
  set_property(GLOBAL APPEND PROPERTY EMAX_LEFT_OUT_TESTS ${ARGN})
  if(NOT ARGN)
    set_property(GLOBAL APPEND PROPERTY EMAX_LEFT_OUT_PROGRAMS ${program})
  endif()
endfunction()

# emax_run_on_target(<name> [CONFIGURATIONS <configuration>...])
# The GoogleTest image as one test of ctest, named after the configuration of the build.
function(emax_run_on_target name)
  get_property(left_out GLOBAL PROPERTY EMAX_LEFT_OUT_${name})
  list(JOIN left_out ":" left_out)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}_left_out.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT [[
extern const char* const emax_tests_left_out;
const char* const emax_tests_left_out = "@left_out@";
]] @ONLY)
  target_sources(${name} PRIVATE ${source})

  # Where nothing would run, only slow_tests builds the image.
  get_property(slow GLOBAL PROPERTY EMAX_SLOW_PROGRAMS)
  if(name IN_LIST slow)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    return()
  endif()

  # Its console is semihosting, and a terminal is not touched.
  set_target_properties(${name} PROPERTIES CROSSCOMPILING_EMULATOR "${EMAX_BOARD_RUNNER};--console;null")
  add_test(NAME ${EMAX_CONFIGURATION}.${name} COMMAND ${name} ${ARGN})
  set_tests_properties(${EMAX_CONFIGURATION}.${name} PROPERTIES
    TIMEOUT ${EMAX_TEST_TIMEOUT} LABELS ${EMAX_CONFIGURATION})
endfunction()

# emax_add_slow_tests_target(<name>...)
# cmake --build <dir> --target slow_tests: measures these programs and writes what they leave out for being slow.
function(emax_add_slow_tests_target)
  set(images ${ARGN})
  list(TRANSFORM images REPLACE "(.+)" "$<TARGET_FILE:\\1>")
  add_custom_target(slow_tests
    COMMAND ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/host_tests/target/slow_tests.py
      ${EMAX_SLOW_TESTS} ${EMAX_BOARD_SLOW_TEST_S} ${PROJECT_BINARY_DIR}/left_out.txt
      ${EMAX_BOARD_RUNNER} --console null -- ${images}
    COMMENT "Measures the tests on the emulated core"
    USES_TERMINAL VERBATIM)
  add_dependencies(slow_tests ${ARGN})
endfunction()

include(${CMAKE_CURRENT_LIST_DIR}/left_out.cmake)
