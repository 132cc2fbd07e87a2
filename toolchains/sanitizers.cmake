# Instruments the whole tree with EMAX_SANITIZE, since the sanitizers' runtimes must fit together.

set(EMAX_SANITIZE "" CACHE STRING "What -fsanitize= is given; empty for none")
if(NOT EMAX_SANITIZE)
  return()
endif()

# The check of an object's dynamic type needs the type information that our libraries leave out.
set(sanitize -fsanitize=${EMAX_SANITIZE} -fno-sanitize=vptr -fno-sanitize-recover=all)
add_compile_options(${sanitize} -fno-omit-frame-pointer)
# Each of a hundred test programs brings the runtimes: the other linker takes six times as long.
add_link_options(${sanitize} -fuse-ld=lld)

# The leak detector stops every program that it cannot inspect: without /proc, or where tracing is forbidden.
include(CheckCXXSourceRuns)
set(CMAKE_REQUIRED_FLAGS -fsanitize=${EMAX_SANITIZE})
check_cxx_source_runs("int main() { return 0; }" EMAX_LEAK_DETECTOR_RUNS)
unset(CMAKE_REQUIRED_FLAGS)
if(NOT EMAX_LEAK_DETECTOR_RUNS)
  message(NOTICE "emax: the leak detector cannot run on this machine; the other sanitizers do")
  set(source ${PROJECT_BINARY_DIR}/no_leak_detector.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT [[
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
]])
  target_sources(emax_hosted INTERFACE ${source})
endif()
