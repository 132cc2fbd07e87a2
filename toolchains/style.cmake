# How the sources are formatted, as a test; and the target `format`, which formats them.

find_program(EMAX_CLANG_FORMAT clang-format)
if(NOT EMAX_CLANG_FORMAT)
  message(FATAL_ERROR "The tests look at the format of the sources with clang-format; run toolchains/install.sh.")
endif()
set(areas algo hal firmware host_tests)
list(TRANSFORM areas PREPEND ${PROJECT_SOURCE_DIR}/)
list(TRANSFORM areas APPEND /*.hpp OUTPUT_VARIABLE header_patterns)
list(TRANSFORM areas APPEND /*.cpp OUTPUT_VARIABLE source_patterns)
file(GLOB_RECURSE formatted CONFIGURE_DEPENDS ${header_patterns} ${source_patterns})
add_test(NAME style.format COMMAND ${EMAX_CLANG_FORMAT} --dry-run --Werror ${formatted})
set_tests_properties(style.format PROPERTIES TIMEOUT ${EMAX_TEST_TIMEOUT} LABELS ${EMAX_CONFIGURATION})
add_custom_target(format COMMAND ${EMAX_CLANG_FORMAT} -i ${formatted} COMMENT "Formats all sources in place")
