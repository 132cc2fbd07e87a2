# Builds every configuration one after the other, each in its own tree, and lists the tests of all of them for one ctest.

enable_testing()
include(${CMAKE_CURRENT_LIST_DIR}/board.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/presets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/python.cmake)

# The compared ones are those that have the program `emax`.
emax_list_configurations(configurations)
set(compared "")
set(cross "")
foreach(configuration IN LISTS configurations)
  emax_read_preset(${configuration} toolchain toolchainFile)
  if(toolchain)
    list(APPEND cross ${configuration})
  else()
    list(APPEND compared ${configuration})
  endif()
endforeach()

list(LENGTH configurations count)
message(NOTICE
  "emax: builds ${count} configurations and runs their tests: about 45 minutes on two idle cores, 1 GB in build/.")

set(subtrees "")
set(programs "")
set(number 0)
foreach(configuration IN LISTS configurations)
  set(tree ${PROJECT_SOURCE_DIR}/build/${configuration})
  math(EXPR number "${number} + 1")
  add_custom_target(${configuration} ALL
    COMMAND ${EMAX_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/build_configuration.py
      "configuration ${number} of ${count}" ${configuration} ${CMAKE_COMMAND}
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
  list(APPEND programs ${configuration}='${PROJECT_SOURCE_DIR}/build/${configuration}/emax')
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/configurations.cmake "${subtrees}")
set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${PROJECT_BINARY_DIR}/configurations.cmake)

# What the program prints must not depend on compiler and optimisation, nor on how many switches and cells there is room
# for where the fewer ones fit: host-gcc-native has the capacities of a board.
set(comparison ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/host_tests/scenario/identical_reports.py ${programs} --)
set(model_job report --model 1.037,4073,0.3182,0.003,6,0.0004 --trials 1000)
set(points_job report --points ${PROJECT_SOURCE_DIR}/host_tests/data/djb_a1800v.csv --trials 1000)
set(bench_job report --trials 1000)
set(all_trials_job report --trials 200000)
# Figures list up to 32 of their switches on a board: none of these has more.
set(many_switches_job report --model 0.0102,50000,0.02 --trend none)
set(long_job report --model 1.037,4073,0.3182,0.003,6,0.0004 --time 0.01 --trials 1000 --trend 0.004,0.02)
set(many_cells_job report --model 1,30000,0.7 --order 4 --time 0.01 --trend none)
set(difference_job report --model 1,300,0.5 --order 4 --criterion difference --time 0.004 --trials 1000 --trend none)
set(band_job report --model 1.037,4073,0.3182,0.003,6,0.0004 --criterion band --order 15 --trials 1000 --trend none)
set(first_order_job report --model 1,10858.8,0.364,0.001,20,0.001 --order 1 --time 0.0005
  --trials 1000 --trend none)
foreach(job IN ITEMS many_switches long many_cells difference band first_order)
  add_test(NAME identical.${job}.json COMMAND ${comparison} ${${job}_job} --json)
endforeach()
foreach(job IN ITEMS model points bench)
  add_test(NAME identical.${job}.text COMMAND ${comparison} ${${job}_job})
  add_test(NAME identical.${job}.json COMMAND ${comparison} ${${job}_job} --json)
endforeach()

# emax_add_contraction_test(<configuration>)
function(emax_add_contraction_test configuration)
  add_test(NAME ${configuration}.gates.contraction
    COMMAND ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/contraction.py
      --tree ${PROJECT_SOURCE_DIR}/build/${configuration}
      algo/libemax_base.a algo/libemax_algo.a hal/libemax_hal.a hal/sim/libemax_sim.a firmware/app/libemax_app.a)
endfunction()

# Of the PC's builds, only this one could use the fused multiply-add of the processor at hand.
emax_add_contraction_test(host-gcc-native)
foreach(configuration IN LISTS cross)
  emax_add_contraction_test(${configuration})
endforeach()

find_program(EMAX_CLANG_TIDY clang-tidy REQUIRED)
file(GLOB tidied RELATIVE ${PROJECT_SOURCE_DIR}
  algo/src/*/*.cpp hal/src/*.cpp hal/sim/src/*.cpp
  firmware/app/src/*/*.cpp firmware/boards/host/*.cpp)
# Of the sources of boards, those that the PC's tests build too.
file(GLOB common RELATIVE ${PROJECT_SOURCE_DIR} host_tests/boards/test_*.cpp)
list(TRANSFORM common REPLACE "host_tests/boards/test_(.*)" "firmware/boards/common/src/\\1")
foreach(source IN LISTS common)
  if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${source})
    list(REMOVE_ITEM common ${source})
  endif()
endforeach()
file(GLOB drivers RELATIVE ${PROJECT_SOURCE_DIR}
  firmware/boards/common/stm32/src/*.cpp firmware/boards/nucleo_*/src/*.cpp)
list(FILTER drivers EXCLUDE REGEX "/(board|stm32_board|h743_memory)[.]cpp$")
list(APPEND common ${drivers})
foreach(source IN LISTS tidied common)
  add_test(NAME style.tidy.${source}
    COMMAND ${EMAX_CLANG_TIDY} --quiet --checks=-clang-analyzer-* -p ${PROJECT_SOURCE_DIR}/build/host-sanitize
      ${PROJECT_SOURCE_DIR}/${source})
endforeach()
# The standard library's headers are most of what these read.
set(desk "")
file(GLOB folders LIST_DIRECTORIES true RELATIVE ${PROJECT_SOURCE_DIR} firmware/desk/*)
foreach(folder IN LISTS folders)
  file(GLOB sources ${folder}/*.cpp)
  if(sources)
    add_test(NAME style.tidy.${folder}
      COMMAND ${EMAX_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/tidy_folder.py ${EMAX_CLANG_TIDY} ${PROJECT_SOURCE_DIR}/.clang-tidy
        ${PROJECT_SOURCE_DIR}/build/host-sanitize ${PROJECT_BINARY_DIR}/tidy/${folder}.cpp ${sources})
    list(APPEND desk ${sources})
  endif()
endforeach()
# cmake --build build/check --target analyze, by hand: with the analyzer it takes four times as long.
list(TRANSFORM tidied PREPEND ${PROJECT_SOURCE_DIR}/)
list(TRANSFORM common PREPEND ${PROJECT_SOURCE_DIR}/)
add_custom_target(analyze
  COMMAND ${EMAX_CLANG_TIDY} --quiet -p ${PROJECT_SOURCE_DIR}/build/host-sanitize ${tidied} ${common} ${desk} VERBATIM)

get_property(tests DIRECTORY PROPERTY TESTS)
set_tests_properties(${tests} PROPERTIES TIMEOUT ${EMAX_TEST_TIMEOUT})

include(${CMAKE_CURRENT_LIST_DIR}/check_boards.cmake)

# Once the tests have run: whether a test came too near to its time limit.
add_custom_target(time_limits
  COMMAND ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/time_limits.py ${CMAKE_CTEST_COMMAND} ${PROJECT_BINARY_DIR}
  USES_TERMINAL VERBATIM)
