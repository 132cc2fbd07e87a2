# Cortex-M7 with gcc: floating point in double precision.

set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard")
set(EMAX_CORE_OPTIMISATION -O2)
include(${CMAKE_CURRENT_LIST_DIR}/arm_gcc.cmake)
