# What the toolchain files of all Arm cores with clang share; they set EMAX_CORE_FLAGS and
# EMAX_CORE_OPTIMISATION before.

include(${CMAKE_CURRENT_LIST_DIR}/arm_libstdcxx.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/core_optimisation.cmake)
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER clang++)
set(CMAKE_CXX_COMPILER_TARGET thumbv7em-none-eabihf)
# Enumerations as small as gcc makes them, so that objects of both link.
set(CMAKE_CXX_FLAGS_INIT "${EMAX_CORE_FLAGS} -fshort-enums ${EMAX_LIBSTDCXX_FLAGS} -isystem /usr/include/newlib")
# gcc knows newlib and libgcc of the core. Their assembly does not say that the stack holds no code,
# clang's objects do, and the linker warns of the mixture.
set(CMAKE_CXX_LINK_EXECUTABLE
  "arm-none-eabi-g++ ${EMAX_CORE_FLAGS} -Wl,-z,noexecstack <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")
