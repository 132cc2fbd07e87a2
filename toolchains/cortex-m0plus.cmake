# Cortex-M0+ with gcc: no floating-point unit, no division.

set(CMAKE_SYSTEM_PROCESSOR cortex-m0plus)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m0plus -mthumb")
set(EMAX_CORE_OPTIMISATION -Os)
include(${CMAKE_CURRENT_LIST_DIR}/arm_gcc.cmake)
