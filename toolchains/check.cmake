# Builds every configuration one after the other, each in its own tree, and lists the tests of all of them for one ctest.

enable_testing()
include(${CMAKE_CURRENT_LIST_DIR}/python.cmake)

set(compared host host-clang host-sanitize host-gcc-O0 host-gcc-native)
set(cross
  cortex-m0plus cortex-m3 cortex-m4f cortex-m7 cortex-m33 cortex-m55 cortex-m4f-clang cortex-m7-clang rv32)
set(configurations ${compared} fuzz ${cross})

set(subtrees "")
set(programs "")
foreach(configuration IN LISTS configurations)
  set(tree ${PROJECT_SOURCE_DIR}/build/${configuration})
  add_custom_target(${configuration} ALL
    COMMAND ${CMAKE_COMMAND} --preset ${configuration} --log-level=NOTICE
    COMMAND ${CMAKE_COMMAND} --build --preset ${configuration} -- --quiet
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Configuration ${configuration}"
    USES_TERMINAL)
  if(previous)
    add_dependencies(${configuration} ${previous})
  endif()
  set(previous ${configuration})
  string(APPEND subtrees "subdirs(\"${tree}\")\n")
endforeach()
foreach(configuration IN LISTS compared)
  list(APPEND programs ${configuration}=${PROJECT_SOURCE_DIR}/build/${configuration}/emax)
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/configurations.cmake "${subtrees}")
set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${PROJECT_BINARY_DIR}/configurations.cmake)

# What the program prints must not depend on compiler and optimisation.
set(comparison ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/host_tests/scenario/identical_reports.py ${programs} --)
set(model_job report --model 1.037,4073,0.3182,0.003,6,0.0004 --trials 1000)
set(points_job report --points ${PROJECT_SOURCE_DIR}/host_tests/data/djb_a1800v.csv --trials 1000)
set(bench_job report --trials 1000)
foreach(job IN ITEMS model points bench)
  add_test(NAME identical.${job}.text COMMAND ${comparison} ${${job}_job})
  add_test(NAME identical.${job}.json COMMAND ${comparison} ${${job}_job} --json)
endforeach()

# Only this build could use the fused multiply-add of the processor at hand.
set(native ${PROJECT_SOURCE_DIR}/build/host-gcc-native)
add_test(NAME host-gcc-native.gates.contraction
  COMMAND ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/contraction.py --objdump ${CMAKE_OBJDUMP}
    ${native}/algo/libemax_base.a ${native}/algo/libemax_algo.a ${native}/hal/libemax_hal.a
    ${native}/hal/sim/libemax_sim.a ${native}/firmware/app/libemax_app.a)

find_program(EMAX_CLANG_FORMAT clang-format REQUIRED)
find_program(EMAX_CLANG_TIDY clang-tidy REQUIRED)
set(areas algo hal firmware host_tests)
list(TRANSFORM areas PREPEND ${PROJECT_SOURCE_DIR}/)
list(TRANSFORM areas APPEND /*.hpp OUTPUT_VARIABLE header_patterns)
list(TRANSFORM areas APPEND /*.cpp OUTPUT_VARIABLE source_patterns)
file(GLOB_RECURSE formatted ${header_patterns} ${source_patterns})
add_test(NAME style.format COMMAND ${EMAX_CLANG_FORMAT} --dry-run --Werror ${formatted})
add_custom_target(format COMMAND ${EMAX_CLANG_FORMAT} -i ${formatted} COMMENT "Formats all sources in place")

file(GLOB tidied RELATIVE ${PROJECT_SOURCE_DIR}
  algo/src/*/*.cpp hal/src/*.cpp hal/sim/src/*.cpp
  firmware/app/src/*/*.cpp firmware/desk/*/*.cpp firmware/boards/host/*.cpp)
foreach(source IN LISTS tidied)
  add_test(NAME style.tidy.${source}
    COMMAND ${EMAX_CLANG_TIDY} --quiet -p ${PROJECT_SOURCE_DIR}/build/host-clang ${PROJECT_SOURCE_DIR}/${source})
endforeach()

get_property(tests DIRECTORY PROPERTY TESTS)
set_tests_properties(${tests} PROPERTIES TIMEOUT 240)

include(${CMAKE_CURRENT_LIST_DIR}/check_firmware.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/check_targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/check_clients.cmake)
