# Cortex-M3 with gcc: no floating-point unit.

set(CMAKE_SYSTEM_PROCESSOR cortex-m3)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m3 -mthumb")
set(EMAX_CORE_OPTIMISATION -Os)
include(${CMAKE_CURRENT_LIST_DIR}/arm_gcc.cmake)
