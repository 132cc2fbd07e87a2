# Cortex-M4F with clang: floating point in single precision, double in software.

set(CMAKE_SYSTEM_PROCESSOR cortex-m4f)
set(EMAX_CORE_FLAGS "-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard")
set(EMAX_CORE_OPTIMISATION -Os)
include(${CMAKE_CURRENT_LIST_DIR}/arm_clang.cmake)
