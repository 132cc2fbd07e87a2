# The images of a board: emax_add_board() for what they share, emax_add_image() for each.

set(EMAX_BOARD_COMMON ${CMAKE_CURRENT_LIST_DIR})

# Copies of memory, and arithmetic that the core lacks; nothing of these needs an operating system.
set(CMAKE_CXX_STANDARD_LIBRARIES "-lc -lgcc")

# emax_add_board(INCLUDES <folder>... SOURCES <source>...)
# The libraries emax_board, of startup and drivers, and emax_board_test, which adds what needs an emulator.
function(emax_add_board)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "INCLUDES;SOURCES")
  set(common ${EMAX_BOARD_COMMON}/src)
  add_library(emax_board STATIC
    ${common}/console_rings.cpp
    ${common}/fault_report.cpp
    ${common}/ram_store.cpp
    ${common}/stack_mark.cpp
    ${common}/startup.cpp
    ${arg_SOURCES})
  target_include_directories(emax_board PUBLIC ${EMAX_BOARD_COMMON}/include ${arg_INCLUDES})
  target_compile_definitions(emax_board PUBLIC EMAX_BOARD_NAME="${EMAX_BOARD}")
  target_link_libraries(emax_board PUBLIC emax_app emax_sim PRIVATE emax_firmware)

  # Time goes by in the simulated bench and in the loops of algo; everything else had better be small.
  target_compile_options(emax_app PRIVATE -Os)
  target_compile_options(emax_board PRIVATE -Os)
  foreach(library IN ITEMS emax_base emax_algo)
    get_target_property(seldom ${library} EMAX_SELDOM)
    set_source_files_properties(${seldom} TARGET_DIRECTORY ${library} PROPERTIES COMPILE_OPTIONS -Os)
  endforeach()

  add_library(emax_board_test STATIC
    ${common}/semihosting.cpp
    ${EMAX_BOARD_COMMON}/images/command_line.cpp
    ${EMAX_BOARD_COMMON}/images/test_image.cpp)
  target_include_directories(emax_board_test PUBLIC ${EMAX_BOARD_COMMON}/images)
  target_link_libraries(emax_board_test PUBLIC emax_board PRIVATE emax_firmware)
endfunction()

# emax_add_image(<name> <source>... [LIBRARIES <library>...])
# The image <name>.elf. Without emax_board_test it is a product: nothing in it needs an emulator.
function(emax_add_image name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBRARIES")
  set(memory ${CMAKE_CURRENT_SOURCE_DIR}/memory.ld)
  set(sections ${EMAX_BOARD_COMMON}/sections.ld)
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
  if(NOT emax_board_test IN_LIST arg_LIBRARIES)
    target_sources(${name} PRIVATE ${EMAX_BOARD_COMMON}/src/stop_and_wait.cpp)
  endif()
  set_target_properties(${name} PROPERTIES
    SUFFIX .elf
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}
    LINK_DEPENDS "${memory};${sections}")
  target_link_libraries(${name} PRIVATE emax_board ${arg_LIBRARIES} emax_firmware)
  target_link_options(${name} PRIVATE
    -nodefaultlibs -T${memory} -T${sections} LINKER:-Map=${PROJECT_BINARY_DIR}/${name}.map LINKER:--emit-relocs)
endfunction()

# The images that every board has.
function(emax_add_board_images)
  emax_add_image(emax_${EMAX_BOARD} ${EMAX_BOARD_COMMON}/main.cpp)
  foreach(image IN ITEMS drivers fault report self_test)
    emax_add_image(emax_${EMAX_BOARD}_${image} ${EMAX_BOARD_COMMON}/images/${image}_main.cpp LIBRARIES emax_board_test)
  endforeach()
  include(${EMAX_BOARD_COMMON}/../../cost/cost.cmake)
  emax_gate_image(emax_${EMAX_BOARD} RUN)
  emax_gate_image(emax_${EMAX_BOARD}_report RUN)
  emax_gate_image(emax_${EMAX_BOARD}_self_test)
  emax_gate_image(emax_${EMAX_BOARD}_cost RUN)
endfunction()
