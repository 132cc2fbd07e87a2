# What the toolchain files of all Arm cores with arm-none-eabi-gcc share; they set EMAX_CORE_FLAGS before.

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_CXX_FLAGS_INIT "${EMAX_CORE_FLAGS}")
