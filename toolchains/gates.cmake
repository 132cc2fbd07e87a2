# The gates on the images of a board, as tests: emax_gate_image().

set(EMAX_GATES ${CMAKE_CURRENT_LIST_DIR}/gates)
set(EMAX_INDIRECT_CALLS ${EMAX_GATES}/indirect_calls.txt)
if(EMAX_TESTS)
  include(${CMAKE_CURRENT_LIST_DIR}/python.cmake)
endif()

# emax_add_gate(<name> <script> <argument>...)
# One test that a script of gates/ makes.
function(emax_add_gate name script)
  set(test ${EMAX_CONFIGURATION}.gates.${name})
  add_test(NAME ${test} COMMAND ${EMAX_PYTHON} -B ${EMAX_GATES}/${script} ${ARGN} COMMAND_EXPAND_LISTS)
  set_tests_properties(${test} PROPERTIES TIMEOUT ${EMAX_TEST_TIMEOUT} LABELS ${EMAX_CONFIGURATION})
endfunction()

# emax_gate_image(<image> [RUN])
# Symbols, contraction, flash and RAM of an image, and with gcc its stack; with RUN that is measured, too, if the board
# has a runner. Call it in the folder that the image is made in.
function(emax_gate_image image)
  cmake_parse_arguments(PARSE_ARGV 1 arg "RUN" "" "")
  if(NOT EMAX_TESTS)
    return()
  endif()
  set(linked $<TARGET_FILE:${image}>)
  set(semihosting "")
  get_target_property(libraries ${image} LINK_LIBRARIES)
  if(emax_board_test IN_LIST libraries)
    set(semihosting --semihosting)
  endif()
  emax_add_gate(${image}.symbols image_symbols.py --objdump ${CMAKE_OBJDUMP} ${semihosting} ${linked})
  # Not the linked image: where the product is exact, the compiler's own conversions do fuse.
  emax_add_gate(${image}.contraction contraction.py --objdump ${CMAKE_OBJDUMP} $<TARGET_OBJECTS:${image}>)
  emax_add_gate(${image}.footprint footprint.py
    --budget ${EMAX_BOARD_BUDGET} --recorded ${PROJECT_SOURCE_DIR}/firmware/README.md ${linked})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    emax_gate_stack(${image} ${arg_RUN})
  endif()
endfunction()

function(emax_gate_stack image run)
  set(folders "")
  emax_collect_callgraphs(${image} folders)
  emax_add_gate(${image}.stack stack.py --objdump ${CMAKE_OBJDUMP} --calls ${EMAX_INDIRECT_CALLS}
    --levels ${EMAX_BOARD_INTERRUPT_LEVELS} --budget ${EMAX_BOARD_BUDGET}
    --callgraph ${folders} --image $<TARGET_FILE:${image}>)
  list(JOIN folders "\", \"" folders)
  set_property(GLOBAL APPEND PROPERTY EMAX_GATED_IMAGES "\n    \"${image}\": [\"${folders}\"]")
  get_property(deferred GLOBAL PROPERTY EMAX_WRITES_IMAGES)
  if(NOT deferred)
    set_property(GLOBAL PROPERTY EMAX_WRITES_IMAGES TRUE)
    cmake_language(DEFER DIRECTORY ${PROJECT_SOURCE_DIR} CALL emax_write_images)
  endif()
  if(run AND EMAX_BOARD_RUNNER)
    emax_add_gate(${image}.stack_measured stack_measured.py
      --calls ${EMAX_INDIRECT_CALLS} --tree ${PROJECT_BINARY_DIR} ${image})
  endif()
endfunction()

# The folders of the objects that a target and its libraries are made of: gcc's call graphs are beside these.
function(emax_collect_callgraphs target result)
  get_target_property(type ${target} TYPE)
  set(folders ${${result}})
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    get_target_property(folder ${target} BINARY_DIR)
    list(APPEND folders ${folder}/CMakeFiles/${target}.dir)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    foreach(library IN LISTS libraries)
      if(TARGET ${library})
        emax_collect_callgraphs(${library} folders)
      endif()
    endforeach()
  endif()
  list(REMOVE_DUPLICATES folders)
  set(${result} ${folders} PARENT_SCOPE)
endfunction()

# emax_to_json(<variable>...): makes each list the inside of an array of strings, in the caller's scope.
function(emax_to_json)
  foreach(variable IN LISTS ARGN)
    list(TRANSFORM ${variable} REPLACE "(.+)" "\"\\1\"")
    list(JOIN ${variable} ", " text)
    set(${variable} "${text}" PARENT_SCOPE)
  endforeach()
endfunction()

# Writes images.json: how the images of this tree are run and read.
function(emax_write_images)
  get_property(images GLOBAL PROPERTY EMAX_GATED_IMAGES)
  list(JOIN images "," images)
  emax_to_json(EMAX_BOARD_RUNNER EMAX_BOARD_TABLE_LEFT_OUT EMAX_BOARD_INTERRUPT_LEVELS)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/images.json CONTENT [[{
  "name": "@EMAX_BOARD_NAME@",
  "core": "@EMAX_BOARD_CORE@",
  "core_title": "@EMAX_BOARD_CORE_TITLE@",
  "clock_mhz": "@EMAX_BOARD_TABLE_CLOCK_MHZ@",
  "left_out": [@EMAX_BOARD_TABLE_LEFT_OUT@],
  "runner": [@EMAX_BOARD_RUNNER@],
  "instruction_ns": "@EMAX_BOARD_INSTRUCTION_NS@",
  "objdump": "@CMAKE_OBJDUMP@",
  "interrupt_levels": [@EMAX_BOARD_INTERRUPT_LEVELS@],
  "images": {@images@
  }
}
]] @ONLY)
endfunction()
