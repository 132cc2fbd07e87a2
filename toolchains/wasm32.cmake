# WebAssembly with clang and wasm-ld: what a browser runs. No C library; the C++ headers are those of the microcontrollers.

set(EMAX_CORE_OPTIMISATION -O2)
include(${CMAKE_CURRENT_LIST_DIR}/core_optimisation.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/arm_libstdcxx.cmake)
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER clang++)
set(CMAKE_CXX_COMPILER_TARGET wasm32-unknown-unknown)
# newlib's headers have to be told the order of bytes of a core that they do not know.
set(CMAKE_CXX_FLAGS_INIT "${EMAX_LIBSTDCXX_FLAGS} -isystem /usr/include/newlib -D__IEEE_LITTLE_ENDIAN")
# The compiler is the linker's driver, too, and gets the flags on headers there.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostdlib -Wl,--no-entry -Wno-unused-command-line-argument")
