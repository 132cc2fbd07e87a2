# Cortex-M7 with clang: floating point in double precision. -O2 makes the product too large for its flash, and with -Os
# another optimisation is seen.

set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard")
set(EMAX_CORE_OPTIMISATION -Os)
include(${CMAKE_CURRENT_LIST_DIR}/arm_clang.cmake)
