# The page emax.html, which holds the instrument as a module of WebAssembly.

include(${EMAX_BOARD_FOLDER}/interface.cmake)

# In bytes. Both stacks lie below the variables, so that an overflow traps.
set(EMAX_WEB_STACK 262144)

# emax_add_web_module(<name> MEMORY <bytes> EXPORTS <function>... SOURCES <file>...)
# <name>.wasm with a memory of that size, no more and no less.
function(emax_add_web_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "MEMORY" "EXPORTS;SOURCES")
  add_executable(${name} ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES SUFFIX .wasm RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  target_link_libraries(${name} PRIVATE emax_arithmetic emax_warnings)
  target_compile_definitions(${name} PRIVATE EMAX_BOARD_NAME="${EMAX_BOARD_NAME}")
  target_link_options(${name} PRIVATE
    LINKER:--stack-first LINKER:-z,stack-size=${EMAX_WEB_STACK}
    LINKER:--initial-memory=${arg_MEMORY} LINKER:--max-memory=${arg_MEMORY} LINKER:--fatal-warnings)
  foreach(function IN LISTS arg_EXPORTS)
    target_link_options(${name} PRIVATE LINKER:--export=${function})
  endforeach()
endfunction()

# The instrument. Time goes by in algo and in the simulated bench; the rest had better be small.
set(desk ${PROJECT_SOURCE_DIR}/firmware/desk)
emax_add_web_module(emax_${EMAX_BOARD_NAME}
  MEMORY 25165824
  EXPORTS ${EMAX_WEB_EXPORTS}
  SOURCES
    ${EMAX_BOARD_FOLDER}/instrument/main.cpp
    ${EMAX_BOARD_FOLDER}/instrument/memory.cpp
    ${EMAX_BOARD_FOLDER}/instrument/ports.cpp
    ${desk}/scpi/command_list.cpp)
target_include_directories(emax_${EMAX_BOARD_NAME} PRIVATE
  ${EMAX_BOARD_COMMON}/include ${PROJECT_SOURCE_DIR}/firmware)
target_compile_options(emax_app PRIVATE -Os)
target_link_libraries(emax_${EMAX_BOARD_NAME} PRIVATE emax_app emax_sim emax_freestanding)

# What the PC program does beside it: the same sources, with memory of a fixed size for their strings.
file(GLOB import ${desk}/import/*.cpp)
emax_add_web_module(emax_${EMAX_BOARD_NAME}_desk
  MEMORY 67108864
  EXPORTS ${EMAX_WEB_DESK_EXPORTS}
  SOURCES
    ${EMAX_BOARD_FOLDER}/desk/main.cpp
    ${EMAX_BOARD_FOLDER}/desk/page_files.cpp
    ${EMAX_BOARD_FOLDER}/desk/runtime.cpp
    ${EMAX_BOARD_FOLDER}/desk/table_lines.cpp
    ${EMAX_BOARD_FOLDER}/instrument/memory.cpp
    ${desk}/cli/console.cpp
    ${desk}/compare/comparison.cpp
    ${desk}/compare/comparison_csv.cpp
    ${desk}/compare/comparison_json.cpp
    ${desk}/compare/comparison_report.cpp
    ${desk}/compare/comparison_words.cpp
    ${desk}/compare/figure_text.cpp
    ${desk}/compare/name_lines.cpp
    ${desk}/files/json_reader.cpp
    ${desk}/files/points_file.cpp
    ${desk}/files/result_file.cpp
    ${desk}/files/rounding.cpp
    ${desk}/files/utf8_text.cpp
    ${desk}/report/warning_words.cpp
    ${import})
target_include_directories(emax_${EMAX_BOARD_NAME}_desk PRIVATE ${PROJECT_SOURCE_DIR}/firmware)
target_link_libraries(emax_${EMAX_BOARD_NAME}_desk PRIVATE emax_app)
target_compile_options(emax_${EMAX_BOARD_NAME}_desk PRIVATE
  -Os -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -ffunction-sections -fdata-sections)

# The page.
find_program(EMAX_WEB_PYTHON python3 REQUIRED)
set(page ${PROJECT_BINARY_DIR}/emax.html)
file(GLOB parts CONFIGURE_DEPENDS ${EMAX_BOARD_FOLDER}/page/*)
add_custom_command(
  OUTPUT ${page}
  COMMAND ${EMAX_WEB_PYTHON} -B ${EMAX_BOARD_FOLDER}/make_page.py ${EMAX_BOARD_FOLDER}/page
    $<TARGET_FILE:emax_${EMAX_BOARD_NAME}> $<TARGET_FILE:emax_${EMAX_BOARD_NAME}_desk> ${page}
  DEPENDS ${EMAX_BOARD_FOLDER}/make_page.py ${parts} emax_${EMAX_BOARD_NAME} emax_${EMAX_BOARD_NAME}_desk
  COMMENT "The page emax.html"
  VERBATIM)
add_custom_target(page ALL DEPENDS ${page})
