# Cortex-M33 with gcc: floating point in single precision, double in software.

set(CMAKE_SYSTEM_PROCESSOR cortex-m33)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m33 -mthumb -mfpu=fpv5-sp-d16 -mfloat-abi=hard")
set(EMAX_CORE_OPTIMISATION -Os)
include(${CMAKE_CURRENT_LIST_DIR}/arm_gcc.cmake)
