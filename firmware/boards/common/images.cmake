# The images of the board, as far as it declares what they need.

# Copies of memory, and arithmetic that the core lacks; nothing of these needs an operating system.
set(CMAKE_CXX_STANDARD_LIBRARIES "-lc -lgcc")

# emax_add_image(<name> <source>... [LIBRARIES <library>...])
# The image <name>.elf. Without emax_board_test it is a product: nothing in it needs an emulator.
function(emax_add_image name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBRARIES")
  set(memory ${EMAX_BOARD_FOLDER}/memory.ld)
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

# Startup and drivers.
add_library(emax_board STATIC
  ${EMAX_BOARD_COMMON}/src/console_rings.cpp
  ${EMAX_BOARD_COMMON}/src/fault_report.cpp
  ${EMAX_BOARD_COMMON}/src/log_store.cpp
  ${EMAX_BOARD_COMMON}/src/ram_store.cpp
  ${EMAX_BOARD_COMMON}/src/stack_mark.cpp
  ${EMAX_BOARD_COMMON}/src/startup.cpp
  ${EMAX_BOARD_SOURCES})
target_include_directories(emax_board PUBLIC ${EMAX_BOARD_COMMON}/include ${EMAX_BOARD_INCLUDES})
target_compile_definitions(emax_board PUBLIC
  EMAX_BOARD_NAME="${EMAX_BOARD_NAME}"
  EMAX_BOARD_CLOCK_HZ=${EMAX_BOARD_CLOCK_HZ}
  EMAX_BOARD_INTERRUPTS=${EMAX_BOARD_INTERRUPTS})
target_link_libraries(emax_board PUBLIC emax_app PRIVATE emax_firmware)
if(EMAX_BOARD_SIMULATED_BENCH)
  target_link_libraries(emax_board PUBLIC emax_sim)
endif()

# Time goes by in the simulated bench and in the loops of algo; everything else had better be small.
target_compile_options(emax_app PRIVATE -Os)
target_compile_options(emax_board PRIVATE -Os)
foreach(library IN ITEMS emax_base emax_algo)
  get_target_property(seldom ${library} EMAX_SELDOM)
  set_source_files_properties(${seldom} TARGET_DIRECTORY ${library} PROPERTIES COMPILE_OPTIONS -Os)
endforeach()

set(product emax_${EMAX_BOARD_NAME})
emax_add_image(${product} ${EMAX_BOARD_COMMON}/main.cpp)
emax_gate_image(${product} RUN)

if(EMAX_BOARD_FLASH)
  list(TRANSFORM EMAX_BOARD_FLASH REPLACE "@IMAGE@" "$<TARGET_FILE:${product}>" OUTPUT_VARIABLE command)
  add_custom_target(flash COMMAND ${command} DEPENDS ${product} USES_TERMINAL VERBATIM)
  # For tools that take no ELF file, as a probe that shows itself as a drive.
  foreach(format IN ITEMS binary:bin ihex:hex)
    string(REPLACE ":" ";" format ${format})
    list(POP_BACK format suffix)
    add_custom_command(TARGET ${product} POST_BUILD
      COMMAND ${CMAKE_OBJCOPY} -O ${format} $<TARGET_FILE:${product}> ${PROJECT_BINARY_DIR}/${product}.${suffix}
      BYPRODUCTS ${PROJECT_BINARY_DIR}/${product}.${suffix}
      VERBATIM)
  endforeach()
endif()

if(NOT EMAX_BOARD_SEMIHOSTING)
  return()
endif()

# What test images need of an emulator or a debugger.
add_library(emax_board_test STATIC
  ${EMAX_BOARD_COMMON}/src/semihosting.cpp
  ${EMAX_BOARD_COMMON}/images/command_line.cpp
  ${EMAX_BOARD_COMMON}/images/test_image.cpp)
target_include_directories(emax_board_test PUBLIC ${EMAX_BOARD_COMMON}/images)
target_link_libraries(emax_board_test PUBLIC emax_board PRIVATE emax_firmware)

foreach(image IN ITEMS drivers fault report self_test)
  emax_add_image(${product}_${image} ${EMAX_BOARD_COMMON}/images/${image}_main.cpp LIBRARIES emax_board_test)
endforeach()
emax_gate_image(${product}_report RUN)
emax_gate_image(${product}_self_test)

if(EMAX_BOARD_COUNTER)
  include(${PROJECT_SOURCE_DIR}/firmware/cost/cost.cmake)
  emax_gate_image(${product}_cost RUN)
endif()
