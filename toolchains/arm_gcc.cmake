# What the toolchain files of all Arm cores with arm-none-eabi-gcc share; they set EMAX_CORE_FLAGS and
# EMAX_CORE_OPTIMISATION before.

include(${CMAKE_CURRENT_LIST_DIR}/core_optimisation.cmake)
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_CXX_FLAGS_INIT "${EMAX_CORE_FLAGS}")
