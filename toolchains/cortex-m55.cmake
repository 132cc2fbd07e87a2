# Cortex-M55 with gcc: floating point in double precision, vector instructions.

set(CMAKE_SYSTEM_PROCESSOR cortex-m55)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m55 -mthumb -mfloat-abi=hard")
set(EMAX_CORE_OPTIMISATION -O2)
include(${CMAKE_CURRENT_LIST_DIR}/arm_gcc.cmake)
