# The compiler flags of the project's own code, and the two functions that make its libraries with them.

set(CMAKE_CXX_EXTENSIONS OFF)

add_library(emax_warnings INTERFACE)
target_compile_options(emax_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wfloat-conversion -Wdouble-promotion
  -Wold-style-cast -Wcast-align -Wcast-qual -Wnon-virtual-dtor -Woverloaded-virtual -Wundef -Wvla
  -Wswitch-enum -Wformat=2 -Wimplicit-fallthrough -Wextra-semi
  $<$<BOOL:${EMAX_WERROR}>:-Werror>)

# A fused multiply-add changes digits, so contraction is off, for everybody who includes a header of ours too: the
# linker may keep their copy of an inline function. gcc's vectorizer (12.2, x86 with FMA) makes fused
# multiply-add-subtracts of complex products even so.
add_library(emax_arithmetic INTERFACE)
target_compile_features(emax_arithmetic INTERFACE cxx_std_17)
target_compile_options(emax_arithmetic INTERFACE
  -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:-fno-tree-vectorize>)

# What code does without that must also run where there is no operating system.
add_library(emax_freestanding INTERFACE)
target_compile_options(emax_freestanding INTERFACE
  -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -fno-math-errno
  -fno-unwind-tables -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections)

# The gate on the stack reads what gcc writes beside each object.
if(CMAKE_CROSSCOMPILING AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(emax_freestanding INTERFACE -fstack-usage -fcallgraph-info=su)
endif()

# Images of a board: startup and memory map are the board's own, and what nothing uses is left out.
add_library(emax_firmware INTERFACE)
target_link_libraries(emax_firmware INTERFACE emax_arithmetic emax_freestanding emax_warnings)
target_link_options(emax_firmware INTERFACE -nostartfiles LINKER:--gc-sections,--fatal-warnings)

# Programs of a PC: the instrument's host board, tests and benchmarks.
add_library(emax_hosted INTERFACE)
target_link_libraries(emax_hosted INTERFACE emax_arithmetic emax_warnings)

include(${CMAKE_CURRENT_LIST_DIR}/sanitizers.cmake)

# Functions count before they are inlined, so that each has its branches once, and a choice between two values is a
# branch. Without exceptions there are no branches that only an exception would take; a file that catches one needs
# them, and gcov marks those branches of it.
if(EMAX_COVERAGE)
  add_compile_options(--coverage -fno-early-inlining -fno-ssa-phiopt -fno-exceptions)
  add_link_options(--coverage)
endif()

# emax_add_freestanding_library(<name> <source>...)
# A static library, also as emax::<name without emax_>, whose public headers are in include/.
function(emax_add_freestanding_library name)
  add_library(${name} STATIC ${ARGN})
  string(REPLACE "emax_" "" short_name ${name})
  add_library(emax::${short_name} ALIAS ${name})
  set_target_properties(${name} PROPERTIES EXPORT_NAME ${short_name})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${name}
    PUBLIC emax_arithmetic
    PRIVATE $<BUILD_INTERFACE:emax_freestanding> $<BUILD_INTERFACE:emax_warnings>)
endfunction()

# emax_compile_headers_alone(<library>)
# Compiles each header in include/ by itself, included twice, as somebody who uses only that header would.
function(emax_compile_headers_alone library)
  if(NOT EMAX_HEADERS_ALONE)
    return()
  endif()
  file(GLOB_RECURSE headers RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/include CONFIGURE_DEPENDS include/*.hpp)
  set(sources "")
  foreach(header IN LISTS headers)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/headers/${header}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${header}\"\n#include \"${header}\"\n")
    list(APPEND sources ${source})
  endforeach()
  if(NOT sources)
    return()
  endif()
  add_library(${library}_headers OBJECT ${sources})
  target_link_libraries(${library}_headers PRIVATE ${library} emax_freestanding emax_warnings)
endfunction()
